# SPDX-License-Identifier: Apache-2.0
"""What the proofs of contracts use where the solvers do not finish (README.md, Lemmas).

Loops are replaced by one step from any state that meets an invariant: the checker proves that the
invariant holds at the beginning and after the step. Products in some files are replaced
by a function that is not interpreted: the checker knows of it only that equal factors give equal
products, its signs and the laws that a proof names. test_lemmas.py proves these laws, and that a
loop changes no more than what is taken to be any value.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Loop:
    """A loop of a source, found by its head, which stands there once."""

    source: str  # below firmware/
    head: str  # up to the brace
    begin: str  # what is done before the first pass
    step: str  # what is done after each
    condition: str
    changed: tuple[str, ...]  # variables
    any: str  # statements that give them any values
    invariant: str

    def cut(self, text: str) -> str:
        """Return the source with this loop as one step of an induction."""
        assert text.count(self.head) == 1, self
        after = f"{self.step} PROVE({self.invariant}); ASSUME(false);"
        return text.replace(
            self.head,
            f"{self.begin} PROVE({self.invariant}); {self.any} ASSUME({self.invariant}); "
            f"for (; {self.condition}; ({{ {after} }})) {{",
        )


LOOPS = (
    # The index that is any is here the one of the first such line, which exists (PRE).
    Loop("torque/torque_limits.c", "while (lines->torque_mNm > torque_mNm) {",
         "const limit_t *const first = lines; int at = 0; "
         "ASSUME(is_first_at_most(first, proof_any_index, torque_mNm));",
         "at++;", "lines->torque_mNm > torque_mNm", ("lines",),
         "int any_at; ASSUME(is_within(any_at, 0, proof_any_index)); at = any_at; "
         "lines = first + at;",
         "is_within(at, 0, proof_any_index) && lines == first + at"),
    Loop("torque/torque_limits.c",
         "for (torque_line_t line = 1; line < TORQUE_LINE_COUNT; line++) {",
         "torque_line_t line = 1;", "line++;", "line < TORQUE_LINE_COUNT",
         ("line", "out"), "torque_line_t any_line, any_out; line = any_line; out = any_out;",
         "is_within((int)line, 1, TORQUE_LINE_COUNT) && is_within((int)out, 0, (int)line - 1) && "
         "is_first_of_the_tightest(lines, line, out)"),
)  # fmt: skip


@dataclass(frozen=True)
class Law:
    """An equation that holds for any integers, whose products are those of the source."""

    text: str
    variables: tuple[str, ...]
    where: dict[str, str] = field(default_factory=dict)  # others, by the variables
    given: str = "true"  # no arithmetic in C wraps around, and what `where` says holds


def _weighted(edge: str, of_it: str, sign: str) -> Law:
    """Return what a weighted sum is beyond an edge of the range of its corners."""
    corners = ("00", "10", "01", "11")
    sums = " + ".join(f"product(weights->at_{one}, at_{one})" for one in corners)
    rest = " + ".join(f"product(weights->at_{one}, {of_it.format(one)})" for one in corners)
    return Law(
        f"{sums} == (int64_t){edge} * (1 << 16) {sign} ({rest})",
        (*(f"weights->at_{one}" for one in corners[1:]), *(f"at_{one}" for one in corners), edge),
        {"weights->at_00": "(1 << 16) - weights->at_10 - weights->at_01 - weights->at_11"},
        "grid_weights_hold(*weights) && grid_entries_hold(at_00, at_10, at_01, at_11)",
    )


_X, _Y = "(x_q20 >> 4)", "(y_q20 >> 4)"
_FRACTIONS = "is_within(x_q20, 0, GRID_WHOLE_Q20) && is_within(y_q20, 0, GRID_WHOLE_Q20)"
# Headers with products, and the laws that the proofs of their functions use.
PRODUCTS = ("core/include/core/grid.h",)
LAWS: dict[str, tuple[Law, ...]] = {
    "grid_interpolate": (
        Law("product((b - a), fraction_q20) + product((b - a), GRID_WHOLE_Q20 - fraction_q20) == "
            "(int64_t)(b - a) * GRID_WHOLE_Q20", ("a", "b", "fraction_q20"),
            given="is_within(fraction_q20, 0, GRID_WHOLE_Q20) && grid_values_hold(a, b)"),
    ),
    "grid_weights": (
        Law(f"product({_X}, {_Y}) + product({_X}, (1 << 16) - {_Y}) == (int64_t){_X} * (1 << 16)",
            (_X, _Y), given=_FRACTIONS),
        Law(f"product({_X}, {_Y}) + product((1 << 16) - {_X}, {_Y}) == (int64_t){_Y} * (1 << 16)",
            (_X, _Y), given=_FRACTIONS),
        Law(f"product((1 << 16) - {_X}, (1 << 16) - {_Y}) == (INT64_C(1) << 32) - "
            f"(int64_t){_X} * (1 << 16) - (int64_t){_Y} * (1 << 16) + product({_X}, {_Y})",
            (_X, _Y), given=_FRACTIONS),
    ),
    "grid_weighted": (
        _weighted("LEAST_OF(at_00, at_10, at_01, at_11)",
                  "at_{} - LEAST_OF(at_00, at_10, at_01, at_11)", "+"),
        _weighted("MOST_OF(at_00, at_10, at_01, at_11)",
                  "MOST_OF(at_00, at_10, at_01, at_11) - at_{}", "-"),
    ),
}  # fmt: skip
_PRODUCT = re.compile(r"(?:\(int64_t\))?(\([^()]*\)|[\w>-]+) \* ([\w>-]+)")


def without_products(text: str) -> str:
    """Return a source whose products are calls of product() (product.h)."""
    replaced, count = _PRODUCT.subn(r"product(\1, \2)", text)
    assert count > 0
    first = replaced.index("#include")
    return f'{replaced[:first]}#include "product.h"\n{replaced[first:]}'


def assumed(function: str) -> list[str]:
    """Return the laws of a function's products, as assumptions of its proof."""
    return [f"    ASSUME(!({law.given}) || {law.text});" for law in LAWS.get(function, ())]


def cut(path: Path, firmware: Path, text: str) -> str:
    """Return a source with its loops as inductions."""
    for loop in LOOPS:
        if path == firmware / loop.source:
            text = loop.cut(text)
    return text
