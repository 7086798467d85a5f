# SPDX-License-Identifier: Apache-2.0
"""The faults that can be injected, by name (``faults.toml``), and what a controller should say.

``expected_reasons.toml`` holds, for every fault, the reasons that are right by physics, at most
two; it is written by hand from what can be seen of a fault, not from runs.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from regen_table.suggest import suggestion

from hubsim.errors import HubsimError

NAMES = ("faults.toml", "faults_program.toml", "faults_links.toml", "faults_images.toml")
TABLES = tuple(Path(__file__).with_name(name) for name in NAMES)
EXPECTED = tuple(
    Path(__file__).with_name(f"expected_reasons{part}.toml") for part in ("", "_images")
)
MEASURED_SUFFIX = "_measured"
MEASURED = {"brake_sensor.fitted": 1.0}
SENSORS = ("hall", "encoder", "angle")


@dataclass(frozen=True)
class Fault:
    """One fault.

    Attributes
    ----------
    sets : mapping
        The parameters of the simulated world that make it, by name.
    needs : mapping
        Parameters that must be set before the run begins.
    amount : str
        The parameter that says how much of it there is; empty: none.
    sensors : tuple of str
        Rotor sensors with which it exists.
    at_start : bool
        It is there when the wheel begins to turn, a mistake of assembly.
    in_sweep : bool
        ``hubsim faults`` runs it.
    brake : str
        What is wrong with the hydraulic brake itself, which sets the limits of the run: "short" of
        torque or late, "strong" or stuck; empty: it is healthy.
    draws : str
        The parameter whose number the sweep draws for each run; empty: none.
    image_of : str
        The fault of which this is the mirror image in another phase or switch; its own name: none.
    """

    name: str
    group: str
    text: str
    sets: Mapping[str, float]
    needs: Mapping[str, float]
    amount: str
    sensors: tuple[str, ...]
    at_start: bool
    in_sweep: bool
    brake: str
    draws: str
    image_of: str


@cache
def table() -> dict[str, Fault]:
    """Return all faults by name, in the order of the files."""
    data: dict[str, Any] = {}
    for path in TABLES:
        data |= tomllib.loads(path.read_text(encoding="utf-8"))
    lines = {name: data[line["image_of"]] | line if "image_of" in line else line
             for name, line in data.items()}  # fmt: skip
    return {
        variant: Fault(
            variant,
            line["group"],
            line["text"] + (", its torque measured" if variant != name else ""),
            _numbers(line["set"]),
            _numbers(line.get("needs", {})) | (MEASURED if variant != name else {}),
            line.get("amount", ""),
            tuple(line.get("sensors", SENSORS)),
            line.get("at_start", False),
            line.get("sweep", True),
            line.get("brake", ""),
            line.get("draws", ""),
            line.get("image_of", variant),
        )
        for name, line in lines.items()
        for variant in _variants(name, line.get("measured", False))
    }


def _variants(name: str, measured: bool) -> list[str]:
    return [name, name + MEASURED_SUFFIX] if measured else [name]


def _numbers(section: Mapping[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in section.items()}


def named(names: Sequence[str]) -> list[Fault]:
    """Return the faults with these names or of these groups; none: all of the sweep."""
    known = table()
    groups = {fault.group for fault in known.values()}
    found: dict[str, Fault] = {}
    for name in names:
        if name in groups:
            found |= {f.name: f for f in swept() if f.group == name}
        elif name in known:
            found[name] = known[name]
        else:
            hint = suggestion(name, [*known, *groups], "'hubsim faults --list' shows all")
            raise HubsimError(f"no fault {name!r}, {hint}")
    return list(found.values()) if names else swept()


def swept() -> list[Fault]:
    """Return the faults of the sweep, of mirror images the first."""
    return [f for f in table().values() if f.in_sweep and f.image_of == f.name]


@cache
def images(name: str) -> tuple[str, ...]:
    """Return a fault and its mirror images."""
    return (name, *(f.name for f in table().values() if f.image_of == name != f.name))


@cache
def expected() -> dict[str, tuple[str, ...]]:
    """Return the reasons that are right for each fault."""
    found = reasons_given()
    return {
        name: tuple(found[name.removesuffix(MEASURED_SUFFIX)]["right"])
        for name in (*found, *(n for n in table() if n.endswith(MEASURED_SUFFIX)))
    }


def reasons_given() -> dict[str, Any]:
    """Return the entries of the lists of reasons."""
    found: dict[str, Any] = {}
    for path in EXPECTED:
        found |= tomllib.loads(path.read_text(encoding="utf-8"))["reasons"]
    return found


def lines() -> list[str]:
    """Return the list of all faults, for people: name, meaning, how much."""
    out: list[str] = []
    group = ""
    known = list(table().values())
    order = [fault.group for fault in known]
    for fault in sorted(known, key=lambda fault: order.index(fault.group)):
        if fault.group != group:
            group = fault.group
            out.append(f"{group}:")
        amount = f" (amount: {fault.sets[fault.amount]:g})" if fault.amount else ""
        only = "" if fault.sensors == SENSORS else f" [{', '.join(fault.sensors)}]"
        out.append(f"  {fault.name:24s} {fault.text}{amount}{only}")
    return out
