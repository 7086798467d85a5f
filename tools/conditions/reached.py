# SPDX-License-Identifier: Apache-2.0
"""Branches and conditions of the modules in an export of llvm-cov, and which of them are missing.

A condition is missing as ``true`` or ``false`` if it never had that value, and as ``alone`` if it
had both but never decided the outcome of its decision by itself (modified condition/decision
coverage: two evaluations that differ in this condition only and in the outcome).
"""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Place = tuple[int, int, int, int]
# A compile-time constant has one value only.
_CONSTANT = re.compile(r"true|false|[01]|\(?[A-Z][A-Z0-9_]+\)?")


@dataclass
class Module:
    """What the tests reach in one module."""

    name: str
    branches: int = 0
    branches_reached: int = 0
    conditions: int = 0
    conditions_shown: int = 0
    missing: list[str] = field(default_factory=list)

    @property
    def share(self) -> float:
        """The share of its branches that the tests reach, or of its conditions if that is less."""
        branches = self.branches_reached / max(self.branches, 1)
        return min(branches, self.conditions_shown / self.conditions if self.conditions else 1.0)


@dataclass
class Function:
    """Conditions of one function: how often true and false, and whether each decided alone."""

    branches: dict[Place, tuple[int, int]] = field(default_factory=dict)
    alone: dict[Place, bool] = field(default_factory=dict)

    def add(self, record: dict[str, Any]) -> None:
        """Add the counts of one instance (an inline function has one in each file)."""
        own = [row for row in record["branches"] if row[6] == 0]
        for row in own:
            place = (row[0], row[1], row[2], row[3])
            true, false = self.branches.get(place, (0, 0))
            self.branches[place] = (true + row[4], false + row[5])
        for row in record["mcdc_records"]:
            decision = (row[0], row[1], row[2], row[3])
            for place, shown in zip(conditions_of(decision, own, row[6]), row[6], strict=True):
                self.alone[place] = self.alone.get(place, False) or shown


def conditions_of(
    decision: Place, branches: Sequence[Sequence[int]], shown: Sequence[bool]
) -> list[Place]:
    """Return the places of a decision's conditions, in the order of the source."""
    kind_of_condition = 6
    places = sorted(
        (row[0], row[1], row[2], row[3])
        for row in branches
        if row[8] == kind_of_condition
        and decision[:2] <= (row[0], row[1])
        and (row[2], row[3]) <= decision[2:]
    )
    if len(places) == len(shown):
        return places
    # Written by a macro: all at the place of the decision.
    return [(*decision[:3], decision[3] + index) for index in range(len(shown))]


def text_at(lines: Sequence[str], place: Place) -> str:
    """Return the source between two places, on one line."""
    first, column, last, end = place
    part = list(lines[first - 1 : last])
    part[-1] = part[-1][: end - 1]
    part[0] = part[0][column - 1 :]
    return " ".join(" ".join(part).split())


def functions_in(
    export: dict[str, Any], firmware: Path, modules: Iterable[str]
) -> dict[str, dict[tuple[Path, str], Function]]:
    """Return the functions of each module by file and name."""
    found: dict[str, dict[tuple[Path, str], Function]] = {name: {} for name in modules}
    for record in export["data"][0]["functions"]:
        path = Path(record["filenames"][0])
        if not path.is_relative_to(firmware) or "generated" in path.parts:
            continue
        module = path.relative_to(firmware).parts[0]
        if module in found:
            key = (path, record["name"].rpartition(":")[2])
            found[module].setdefault(key, Function()).add(record)
    return found


def modules_of(
    export: dict[str, Any],
    firmware: Path,
    modules: Iterable[str],
    read: Callable[[Path], str],
) -> list[Module]:
    """Return what the tests reach in each module."""
    out = []
    for name, functions in functions_in(export, firmware, modules).items():
        module = Module(name)
        for (path, function), counts in sorted(functions.items()):
            _add(module, path, function, counts, read(path).splitlines())
        out.append(module)
    return out


def _add(module: Module, path: Path, function: str, counts: Function, lines: Sequence[str]) -> None:
    for place, (true, false) in sorted(counts.branches.items()):
        text = text_at(lines, place)
        if _CONSTANT.fullmatch(text):
            continue
        where = f"{path.parent.name}/{path.name}:{place[0]}: {function}: {text}"
        module.branches += 2
        module.branches_reached += (true > 0) + (false > 0)
        if not true:
            module.missing.append(f"{where}: true")
        if not false:
            module.missing.append(f"{where}: false")
        if place in counts.alone:
            module.conditions += 1
            module.conditions_shown += counts.alone[place]
            if true and false and not counts.alone[place]:
                module.missing.append(f"{where}: alone")
