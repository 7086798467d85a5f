# SPDX-License-Identifier: Apache-2.0
"""Refusals name keys of the user's own file and numbers that would do, all in one answer."""

import copy
import math
import os
import random
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from regen_table import schema
from regen_table.errors import ConfigurationError
from regen_table.section import Section
from regen_table.sections import Drive, bounds

MOTORS = Path(__file__).resolve().parents[4] / "tools" / "motors"
NAMES = ("lu2013", "ipm400v")
Tree = dict[str, Any]
# What only the simulated plant reads has no relations, and no range that another key moves.
PLANT = {"sensors", "bus", "bms", "chassis", "tyre", "thermal"}


def tree_of(name: str) -> Tree:
    return tomllib.loads((MOTORS / f"{name}.toml").read_text(encoding="utf-8"))


def numbers() -> list[tuple[str, float, float]]:
    """Return every key that is a number, with its range."""
    found = []
    for section, field in Drive.model_fields.items():
        kind = field.annotation
        assert isinstance(kind, type) and issubclass(kind, Section)
        for key, info in kind.model_fields.items():
            lowest, highest = bounds(info.metadata)
            if (
                isinstance(lowest, int | float)
                and isinstance(info.json_schema_extra, dict)
                and "unit" in info.json_schema_extra
            ):
                found.append((f"{section}.{key}", lowest, highest))
    return found


NUMBERS = [entry for entry in numbers() if entry[0].partition(".")[0] not in PLANT]
FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
PAIRS = 100 if FOR_LONG else 25
EVERY = 1 if FOR_LONG else 4  # key, another quarter of them with each drive


def with_keys(tree: Tree, changes: dict[str, float]) -> Tree:
    tree = copy.deepcopy(tree)
    for name, value in changes.items():
        section, key = name.split(".")
        tree.setdefault(section, {})[key] = value
    return tree


def lines_of(tree: Tree) -> list[str]:
    """Return the lines of the answer; none for an accepted drive."""
    try:
        schema.parse(tree, name="changed", source="changed.toml")
    except ConfigurationError as error:
        lines = str(error).splitlines()
        assert all(line.startswith("changed.toml: ") for line in lines), lines
        return [line.removeprefix("changed.toml: ") for line in lines]
    return []


def values_of(lowest: float, highest: float, dice: random.Random) -> list[float]:
    """Return both ends of a range and two values of its decades."""
    least = max(lowest, min(1e-9, highest / 1e9)) if highest > 0.0 else lowest
    inner = (
        [math.exp(dice.uniform(math.log(least), math.log(highest))) for _ in range(2)]
        if 0.0 < least < highest
        else [dice.uniform(lowest, highest) for _ in range(2)]
    )
    whole = isinstance(lowest, int) and isinstance(highest, int)
    return [lowest, highest, *((round(x) for x in inner) if whole else inner)]


def blamed(line: str) -> str:
    found = re.match(r"(\w+\.\w+): ", line)
    assert found is not None, line
    return found[1]


def assert_own_key(line: str, tree: Tree) -> None:
    """The key that a line begins with stands in the file."""
    section, key = blamed(line).split(".")
    assert key in tree.get(section, {}), line
    assert "accepted" in line, line


def number_that_would_do(line: str) -> float | None:
    """Return the number of a line that names one end, a thousandth within an open one."""
    found = re.search(
        r"accepted: (at most|at least|less than|more than|of at least) "
        r"(-?\d[\d.]*(?:e[+-]?\d+)?)(?![\w.])",
        line,
    )
    strict = {"less than": 0.999, "more than": 1.001}
    return float(found[2]) * strict.get(found[1], 1.0) if found else None


@pytest.mark.parametrize("name", NAMES)
def test_each_key_broken_in_turn_is_answered_with_keys_of_the_file(name: str) -> None:
    tree, dice = tree_of(name), random.Random(name)
    refused = 0
    for key, lowest, highest in NUMBERS:
        for value in values_of(lowest, highest, dice):
            broken = with_keys(tree, {key: value})
            lines = lines_of(broken)
            refused += bool(lines)
            for line in lines:
                assert_own_key(line, broken)
            assert len({blamed(line) for line in lines}) == len(lines), lines
    assert refused > 60


def mended(tree: Tree, lines: list[str], rounding: float) -> Tree:
    """Return the tree with the numbers of all answers."""
    changes = {}
    for line in lines:
        number = number_that_would_do(line)
        if number is not None:
            changes[blamed(line)] = number * rounding
    return with_keys(tree, changes)


def still_asked(broken: Tree, lines: list[str], asked: set[str]) -> set[str]:
    """Return what is asked for again whatever numbers of the answer are put in, all or one."""
    for variant in (lines, *([line] for line in lines)):
        for rounding in (1.0, 0.9995, 1.0005):
            if not asked:
                return asked
            asked = asked & {blamed(line) for line in lines_of(mended(broken, variant, rounding))}
    return asked


@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_of_an_answer_would_do(name: str) -> None:
    """Put in, together or one, they are not asked for again; they are rounded, to either side."""
    tree, dice = tree_of(name), random.Random(f"number {name}")
    tried = 0
    for key, lowest, highest in NUMBERS[NAMES.index(name) :: EVERY]:
        for value in values_of(lowest, highest, dice):
            broken = with_keys(tree, {key: value})
            lines = lines_of(broken)
            asked = {blamed(line) for line in lines if number_that_would_do(line) is not None}
            assert not still_asked(broken, lines, asked), lines
            tried += len(asked)
    assert tried > 20 // EVERY


@pytest.mark.parametrize("name", NAMES)
def test_pairs_of_keys_beyond_their_ranges_are_answered_together(name: str) -> None:
    tree, dice = tree_of(name), random.Random(f"pairs {name}")
    for _ in range(PAIRS):
        (first, _, most), (second, least, _) = dice.sample(NUMBERS, 2)
        above = most + 1 if isinstance(most, int) else 1.01 * most + 1e-3
        below = least - 1 if isinstance(least, int) else least - 1e-3 - 0.01 * abs(least)
        broken = with_keys(tree, {first: above, second: below})
        lines = lines_of(broken)
        assert {blamed(line) for line in lines} == {first, second}
        for line in lines:
            assert_own_key(line, broken)


@pytest.mark.parametrize("name", NAMES)
def test_pairs_of_keys_within_their_ranges_are_answered_with_keys_of_the_file(name: str) -> None:
    tree, dice = tree_of(name), random.Random(f"relations {name}")
    for _ in range(2 * PAIRS):
        changes = {
            key: dice.choice(values_of(lowest, highest, dice))
            for key, lowest, highest in dice.sample(NUMBERS, 2)
        }
        broken = with_keys(tree, changes)
        for line in lines_of(broken):
            assert_own_key(line, broken)


def test_a_mistake_of_every_kind_is_in_one_answer() -> None:
    """A misspelt key, a missing one, one beyond its range, a relation of two others."""
    tree = with_keys(
        tree_of("lu2013"),
        {"motor.pole_pairs": 0, "motor.frictoin_torque_nm": 1.0, "control.handover_end_rpm": 30.0},
    )
    del tree["vehicle"]["mass_kg"]
    lines = lines_of(tree)
    assert [blamed(line) for line in lines] == [
        "motor.frictoin_torque_nm",
        "vehicle.mass_kg",
        "motor.pole_pairs",
    ]
    tree["vehicle"]["mass_kg"] = 660.0
    lines = lines_of(tree)
    assert [blamed(line) for line in lines] == [
        "motor.frictoin_torque_nm",
        "motor.pole_pairs",
        "control.handover_end_rpm",
    ]
