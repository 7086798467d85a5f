# SPDX-License-Identifier: Apache-2.0
"""What physics forbids to hold: kinds of fault that widen one limit to a stated bound.

``forbidden.toml`` has, for faults by name (mirror images and measured variants included) and one
invariant: by which factor its limit is wider, what is added to it (``ADDITIONS``), the physics, and
the hardware that would close it. A run's limit is the widest of its faults'.
"""

import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from regen_table.schema import Drive

from hubsim.errors import HubsimError
from hubsim.scenario import faults
from hubsim.swarm import motion

FILE = Path(__file__).with_name("forbidden.toml")
PARTS = 1.25  # of it: inductances and flux wrong by their tolerances, two phases alone
SPEEDS = 400  # of the search for the short circuit's largest torque
DRAG_SHARE = 0.25  # of the largest hydraulic torque: the most that a stuck brake is drawn with


def _short_circuit(drive: Drive) -> float:
    """Return the largest torque of a short circuit of parts within their tolerances, N m."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    return PARTS * float(np.max(motion.short_nm(drive, np.linspace(0.0, top, SPEEDS))))


ADDITIONS: Mapping[str, Callable[[Drive], float]] = {
    "": lambda _drive: 0.0,
    "short_circuit": _short_circuit,
    "motor": lambda drive: drive.motor.max_torque_nm,
    "short_current": lambda drive: 2.0 * drive.motor.flux_linkage_wb / drive.motor.d_inductance_h,
    "no_bound": lambda _drive: float("inf"),
    "hydraulic_drag": lambda drive: DRAG_SHARE * drive.brake.max_hydraulic_torque_nm,
}


@dataclass(frozen=True)
class Forbidden:
    """One line of the list."""

    faults: tuple[str, ...]
    invariant: str
    factor: float
    adds: str
    physics: str
    hardware: str


@cache
def listed() -> tuple[Forbidden, ...]:
    """Return the list, its names checked."""
    data = tomllib.loads(FILE.read_text(encoding="utf-8"))
    found = tuple(
        Forbidden(tuple(e["faults"]), e["invariant"], float(e.get("factor", 1.0)),
                  e.get("adds", ""), e["physics"], e["hardware"])
        for e in data.get("forbidden", [])
    )  # fmt: skip
    known = faults.table()
    for entry in found:
        for name in entry.faults:
            if name not in known:
                raise HubsimError(f"{FILE}: no fault {name!r}")
        if not 1.0 <= entry.factor < float("inf") or entry.adds not in ADDITIONS:
            raise HubsimError(f"{FILE}: {entry.factor:g}, {entry.adds!r}: accepted: a factor from "
                              f"1, and one of {', '.join(ADDITIONS)}")  # fmt: skip
    return found


def limit(invariant: str, names: Iterable[str], drive: Drive, plain: float) -> float:
    """Return the limit of an invariant in a run with these faults, from what it is without."""
    bases = {faults.table()[name].image_of for name in _plain(names)}
    return max(
        (
            entry.factor * plain + ADDITIONS[entry.adds](drive)
            for entry in listed()
            if entry.invariant == invariant and bases & set(entry.faults)
        ),
        default=plain,
    )


def _plain(names: Iterable[str]) -> set[str]:
    """Return the faults without the suffix of those that are measured."""
    return {name.removesuffix(faults.MEASURED_SUFFIX) for name in names}
