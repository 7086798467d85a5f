# SPDX-License-Identifier: Apache-2.0
"""The laws and loop invariants that the proofs of contracts use are sound (lemmas.py)."""

import itertools
import re

import contracts
import lemmas
import pytest

LAWS = [law for laws in lemmas.LAWS.values() for law in laws]


def value(text: str, names: dict[str, int]) -> int:
    """Return the value of a C expression of integers, with products that do not wrap."""
    for name in sorted(names, key=len, reverse=True):
        text = re.sub(rf"(?<![\w>]){re.escape(name)}(?![\w(])", f"({names[name]})", text)
    for written, meant in (("(int64_t)", ""), ("INT64_C", ""), ("GRID_WHOLE_Q20", str(1 << 20))):
        text = text.replace(written, meant)
    return int(eval(text, {"__builtins__": {}, "product": lambda a, b: a * b}))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.text[:40])
def test_a_law_of_products_holds_for_all_integers(law: lemmas.Law) -> None:
    """Both sides are polynomials of degree two at most in each variable.

    Two of them are equal if they are at three values of each, and then modulo 2^64 as well.
    """
    text = law.text
    variables = list(law.variables)
    for n, term in enumerate(variables):
        if "(" in term:
            variables[n] = f"term_{n}"
            text = text.replace(term, variables[n])
    left, right = text.split(" == ")
    for numbers in itertools.product(range(3), repeat=len(variables)):
        names = dict(zip(variables, numbers, strict=True))
        others = {name: value(text, names) for name, text in law.where.items()}
        assert value(left, names | others) == value(right, names | others)


def test_a_law_that_is_none_is_noticed() -> None:
    wrong = lemmas.Law("product(a, b) == product(a, b + 1)", ("a", "b"))
    with pytest.raises(AssertionError):
        test_a_law_of_products_holds_for_all_integers(wrong)


def body_of(loop: lemmas.Loop) -> str:
    """Return what is between the braces of a loop."""
    text = (contracts.FIRMWARE / loop.source).read_text(encoding="utf-8")
    begin = text.index(loop.head) + len(loop.head)
    depth, end = 1, begin
    while depth > 0:
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
    return text[begin:end]


def assigned(text: str) -> set[str]:
    """Return the variables that statements change: no call may get the address of one."""
    assert "&" not in text
    changed = re.findall(r"(\w+)(?:\+\+|--)|(\w+) (?:[-+*/%&|^]|<<|>>)?=(?!=)", text)
    return {one for pair in changed for one in pair if one}


@pytest.mark.parametrize("loop", lemmas.LOOPS, ids=lambda loop: loop.head)
def test_every_variable_that_a_loop_changes_has_any_value_at_its_step(loop: lemmas.Loop) -> None:
    changed = assigned(body_of(loop)) | (assigned(loop.step) & set(re.findall(r"\w+", loop.head)))
    assert changed == set(loop.changed)
    given = assigned(loop.any) - {name for name in assigned(loop.any) if name not in loop.changed}
    assert given == set(loop.changed)


@pytest.mark.parametrize("loop", lemmas.LOOPS, ids=lambda loop: loop.head)
def test_a_cut_loop_keeps_condition_and_step(loop: lemmas.Loop) -> None:
    head = loop.head.removesuffix(") {")
    if head.startswith("while ("):
        assert head == f"while ({loop.condition}"
    else:
        step = loop.step.removesuffix(";")
        assert head == f"for ({loop.begin} {loop.condition}; {step}"


def test_every_product_in_a_header_becomes_a_call() -> None:
    for name in lemmas.PRODUCTS:
        text = (contracts.FIRMWARE / name).read_text(encoding="utf-8")
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        left = lemmas.without_products(text)
        assert " * " not in left
        assert left.count("product(") == text.count(" * ")
