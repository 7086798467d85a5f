# SPDX-License-Identifier: Apache-2.0
"""tools/conditions: what is missing of an export of the compiler's counts, module by module."""

import sys
from pathlib import Path
from typing import Any

import pytest
from conditions import __main__ as command
from conditions import measure
from conditions.reached import Module, modules_of

FIRMWARE = Path("/project/firmware")
SOURCE = """\
bool f(int a, int b)
{
    const bool both = a > 0 && b > 0;
    while (true) {
        g();
    }
    return both;
}
"""
# Line, columns, counts of true and false; kinds 4 and 6: a branch, a condition of a decision.
A, B, LOOP = (3, 23, 3, 28), (3, 32, 3, 37), (4, 12, 4, 16)
BRANCH, CONDITION, DECISION = 4, 6, 5


def record(
    a: tuple[int, int], b: tuple[int, int], alone: list[bool], name: str = "f"
) -> dict[str, Any]:
    """Return a function as llvm-cov exports it."""
    return {
        "name": name,
        "filenames": [str(FIRMWARE / "core" / "f.c")],
        "branches": [
            [*A, *a, 0, 0, CONDITION],
            [*B, *b, 0, 0, CONDITION],
            [*LOOP, 7, 0, 0, 0, BRANCH],
        ],
        "mcdc_records": [[3, 23, 3, 37, 0, DECISION, alone]],
    }


def measured(*records: dict[str, Any], path: str = "core/f.c") -> Module:
    """Return the figures of the module core."""
    for one in records:
        one["filenames"] = [str(FIRMWARE / path)]
    export = {"data": [{"functions": list(records)}]}
    return modules_of(export, FIRMWARE, ["core"], lambda _: SOURCE)[0]


def names(module: Module) -> list[str]:
    """Return what is missing, without its place."""
    return [one.removeprefix("core/f.c:3: f: ") for one in module.missing]


def test_everything_reached_is_counted_and_a_constant_is_not() -> None:
    module = measured(record((5, 3), (2, 3), [True, True]))
    assert (module.branches, module.branches_reached) == (4, 4)
    assert (module.conditions, module.conditions_shown) == (2, 2)
    assert module.missing == []


@pytest.mark.parametrize(
    ("a", "b", "alone", "missing"),
    [
        ((0, 3), (0, 0), [False, False], ["a > 0: true", "b > 0: true", "b > 0: false"]),
        ((5, 3), (5, 0), [True, False], ["b > 0: false"]),
        ((5, 3), (2, 3), [False, True], ["a > 0: alone"]),
    ],
)
def test_what_is_missing_is_named_by_condition_and_value(
    a: tuple[int, int], b: tuple[int, int], alone: list[bool], missing: list[str]
) -> None:
    module = measured(record(a, b, alone))
    assert names(module) == missing
    assert module.missing[0].startswith("core/f.c:3: f: ")


def test_instances_of_an_inline_function_count_together() -> None:
    module = measured(
        record((5, 0), (5, 0), [False, False], "one.c:f"),
        record((0, 3), (0, 0), [True, False], "two.c:f"),
    )
    assert names(module) == ["b > 0: false"]
    assert (module.branches, module.branches_reached) == (4, 3)
    assert (module.conditions, module.conditions_shown) == (2, 1)


@pytest.mark.parametrize("path", ["core/generated/f.c", "app/f.c", "../tests/f.c"])
def test_other_files_are_not_counted(path: str) -> None:
    module = measured(record((0, 0), (0, 0), [False, False]), path=path)
    assert (module.branches, module.missing) == (0, [])


@pytest.mark.parametrize(
    ("a", "alone", "share"),
    [((5, 0), [True, True], 3 / 4), ((5, 3), [True, False], 1 / 2)],
)
def test_a_module_below_the_least_share_of_branches_or_conditions_fails(
    a: tuple[int, int], alone: list[bool], share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = measured(record(a, (2, 3), alone))
    assert module.share == pytest.approx(share)
    monkeypatch.setattr(measure, "run", lambda _: {})
    monkeypatch.setattr(command, "modules_of", lambda *_: [module])
    for least, status in ((share, 0), (share + 0.01, 1)):
        monkeypatch.setattr(sys, "argv", ["conditions", "--least", str(least)])
        assert command.main() == status


def test_a_module_of_which_nothing_is_counted_fails() -> None:
    assert Module("renamed").share == 0.0
