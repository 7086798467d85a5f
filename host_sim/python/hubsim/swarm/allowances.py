# SPDX-License-Identifier: Apache-2.0
"""What physics forbids to hold: kinds of fault that widen one limit by a factor.

``forbidden.toml`` has, for faults by name (images included) and one invariant: the factor by which
its limit is wider, the physics, and the hardware that would close it. A run's limit is the widest
of its faults'.
"""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from hubsim.errors import HubsimError
from hubsim.scenario import faults

FILE = Path(__file__).with_name("forbidden.toml")


@dataclass(frozen=True)
class Forbidden:
    """One line of the list."""

    faults: tuple[str, ...]
    invariant: str
    factor: float
    physics: str
    hardware: str


@cache
def listed() -> tuple[Forbidden, ...]:
    """Return the list, its names checked."""
    data = tomllib.loads(FILE.read_text(encoding="utf-8"))
    found = tuple(
        Forbidden(tuple(e["faults"]), e["invariant"], float(e["factor"]), e["physics"],
                  e["hardware"])
        for e in data.get("forbidden", [])
    )  # fmt: skip
    known = faults.table()
    for entry in found:
        for name in entry.faults:
            if name not in known:
                raise HubsimError(f"{FILE}: no fault {name!r}")
        if not 1.0 < entry.factor < float("inf"):
            raise HubsimError(f"{FILE}: factor {entry.factor:g}, accepted: a number above 1")
    return found


@cache
def _factors() -> dict[tuple[str, str], float]:
    """Return the factor by invariant and fault."""
    out: dict[tuple[str, str], float] = {}
    for entry in listed():
        for name in entry.faults:
            for image in faults.images(name):
                for variant in (image, image + faults.MEASURED_SUFFIX):
                    key = (entry.invariant, variant)
                    out[key] = max(out.get(key, 1.0), entry.factor)
    return out


def factor(invariant: str, names: Iterable[str]) -> float:
    """Return by how much a limit is wider in a run with these faults."""
    return max((_factors().get((invariant, name), 1.0) for name in names), default=1.0)
