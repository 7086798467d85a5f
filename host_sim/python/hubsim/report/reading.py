# SPDX-License-Identifier: Apache-2.0
"""What the report reads: runs, the map of the optimal torque, stops at constant demand.

Everything may be missing; nothing here raises for that.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


# What the page draws, by the engine's names ("*" for the wheels); anything else that was recorded
# is left alone.
SIGNALS = (
    "driver.reference_m_per_s",
    "driver.drive_nm",
    "driver.brake_nm",
    "vehicle.speed_m_per_s",
    "vehicle.acceleration_m_per_s2",
    "battery.voltage_v",
    "battery.current_a",
    "bus.voltage_v",
    "wheel*.motor_torque_nm",
    "wheel*.hydraulic_torque_nm",
    "wheel*.speed_rad_per_s",
    "wheel*.current_d_a",
    "wheel*.current_q_a",
    "wheel*.winding_temperature_c",
    "wheel*.switch_temperature_c",
    "wheel*.reason",
)


class RunLike(Protocol):
    """A finished run.

    ``summary`` is the run object of summary.json. Beyond its fixed keys the report uses, where they
    are there, ``while_driving_j`` and ``while_braking_j`` (the losses split by what the driver
    does: battery, inverter, copper, iron, bearing, hydraulic), ``drag``, ``rolling``, ``climbed``
    and ``stored_kinetic`` in ``energy_j``, and ``reason_texts`` (words for the codes in the signal
    ``reason``).

    ``signals`` holds arrays of shape (samples,) like ``time_s``, each in the unit at the end of its
    name.
    """

    @property
    def cycle(self) -> str:
        """Name of the cycle or scenario."""

    @property
    def strategy(self) -> str:
        """Name of the braking strategy."""

    @property
    def vehicle(self) -> str:
        """Name of the configuration."""

    @property
    def summary(self) -> Mapping[str, Any]:
        """Results in J and shares."""

    @property
    def time_s(self) -> Array:
        """Times of the samples, rising."""

    @property
    def signals(self) -> Mapping[str, Array]:
        """Recorded signals by name."""


@dataclass(frozen=True)
class Strategy:
    """How a braking strategy is called and what it does, in one sentence."""

    title: str
    sentence: str


STRATEGIES = {
    "parallel_ratio": Strategy(
        "Parallel, fixed ratio",
        "The motor takes a fixed share of every braking demand, the hydraulic brake takes the "
        "rest.",
    ),
    "parallel_free_travel": Strategy(
        "Parallel, free travel",
        "The motor takes the demand up to its rated braking torque, the hydraulic brake adds what "
        "is beyond.",
    ),
    "series_optimal": Strategy(
        "Series, loss-optimal",
        "The motor takes up to the torque that returns the most energy at this speed and "
        "temperature, the hydraulic brake adds the rest.",
    ),
}
OPTIMUM = "series_optimal"
WHEEL_DIFFERENCE = 0.03  # mean distance of torques over their peak: noise is below it

CYCLES = {
    "ece15": "the urban cycle ECE\u201115",
    "udds": "the urban cycle UDDS",
    "stop": "a stop at constant demand",
}


def strategy(run: RunLike) -> Strategy:
    """Return how a run's strategy is called; a name of its own stays what it is."""
    return STRATEGIES.get(run.strategy, Strategy(run.strategy, ""))


def cycle(name: str) -> str:
    """Return how a cycle is called."""
    return CYCLES.get(name, name.replace("_", " "))


def by_cycle(runs: Sequence[RunLike]) -> dict[str, list[RunLike]]:
    """Sort runs into cycles in the order of their first run, strategies from least to best."""
    order = {name: place for place, name in enumerate(STRATEGIES)}
    found: dict[str, list[RunLike]] = {}
    for run in runs:
        found.setdefault(run.cycle, []).append(run)
    return {
        name: sorted(group, key=lambda run: order.get(run.strategy, len(order)))
        for name, group in found.items()
    }


def as_number(value: object) -> float:
    """Return a number, or NaN for anything that is none."""
    return (
        float(value)
        if isinstance(value, int | float | np.number) and not isinstance(value, bool)
        else math.nan
    )


def energy_j(run: RunLike, name: str) -> float:
    """Return an entry of the run's energies in J, NaN where it is missing."""
    energies = run.summary.get("energy_j")
    return as_number(energies.get(name)) if isinstance(energies, Mapping) else math.nan


def phase_j(run: RunLike, phase: str) -> dict[str, float] | None:
    """Return the losses in J ``while_driving_j`` or ``while_braking_j``.

    None unless the four electric ones are known.
    """
    entries = run.summary.get(phase)
    if not isinstance(entries, Mapping):
        return None
    found = {str(name): as_number(value) for name, value in entries.items()}
    return (
        found
        if all(
            math.isfinite(found.get(name, math.nan))
            for name in ("battery", "inverter", "copper", "iron")
        )
        else None
    )


def signal(run: RunLike, name: str, short: bool = True) -> Array | None:
    """Return a signal of shape (samples,) by the engine's name ``group.name_unit``.

    Also by ``group_name_unit`` and, with ``short``, by ``name_unit``.

    NaN stands for every value that is none; None where it was not recorded, does not fit the times
    or never has a value.
    """
    spellings = (name, name.replace(".", "_"), *([name.rpartition(".")[2]] if short else []))
    for spelling in spellings:
        values = run.signals.get(spelling)
        if values is not None:
            array = np.asarray(values, dtype=np.float64)
            known = np.isfinite(array)
            fits = array.shape == np.shape(run.time_s) and array.size > 1
            return np.where(known, array, np.nan) if fits and bool(np.any(known)) else None
    return None


def wheels(run: RunLike) -> int:
    """Return of how many wheels signals were recorded."""
    found = re.findall(r"\bwheel(\d+)[._]", " ".join(run.signals))
    return 1 + max(map(int, found)) if found else 1


def wheels_differ(runs: Sequence[RunLike]) -> bool:
    """Whether the wheels of any run do different things, so that one cannot stand for all.

    The mean distance of a wheel's torque, motor and hydraulic apart, from that of the first wheel
    is more than ``WHEEL_DIFFERENCE`` of its peak.
    """
    for run in runs:
        for name in ("motor_torque_nm", "hydraulic_torque_nm"):
            first = signal(run, f"wheel0.{name}")
            others = [signal(run, f"wheel{k}.{name}", short=False) for k in range(1, wheels(run))]
            for other in others:
                if first is not None and other is not None and _differ(first, other):
                    return True
    return False


def _differ(first: Array, other: Array) -> bool:
    peak = max(float(np.nanmax(np.abs(first))), float(np.nanmax(np.abs(other))), 1.0)
    return float(np.nanmean(np.abs(first - other))) > WHEEL_DIFFERENCE * peak


def criteria(run: RunLike) -> list[Mapping[str, Any]]:
    """Return what the criteria of a run came to, as its JSON holds them."""
    found = run.summary.get("criteria")
    if not isinstance(found, Sequence):
        return []
    return [one for one in found if isinstance(one, Mapping) and "name" in one]


def ideal(run: RunLike) -> Mapping[str, Any]:
    """Return the ideal stop that belongs to a run, empty without one."""
    found = run.summary.get("ideal_stop")
    known = isinstance(found, Mapping) and isinstance(found.get("energy_j"), Mapping)
    return found if known and found is not None else {}


def origin(run: RunLike) -> dict[str, str]:
    """Return where a run comes from: version, commit, configuration, CRC, scenario, seed, date."""
    found = run.summary.get("provenance")
    if not isinstance(found, Mapping):
        return {}
    return {str(key): str(value) for key, value in found.items() if value is not None}


def reason_text(run: RunLike, code: int) -> str:
    """Return the words for a reason code, or its number where no words came with the run."""
    texts = run.summary.get("reason_texts")
    words = texts.get(str(code), texts.get(code)) if isinstance(texts, Mapping) else None
    return str(words) if words else f"reason {code}"


class MapLike(Protocol):
    """The loss-optimal braking torque over wheel speed.

    Arrays of shape (points,), torques as magnitudes in N m.
    """

    @property
    def temperature_c(self) -> float:
        """Of the winding."""

    @property
    def wheel_radius_m(self) -> float:
        """Rolling radius."""

    @property
    def speed_rad_s(self) -> Array:
        """Of the wheel."""

    @property
    def optimal_nm(self) -> Array:
        """What returns the most energy."""

    @property
    def zero_nm(self) -> Array:
        """Beyond it braking takes energy out of the battery."""

    @property
    def limit_nm(self) -> Array:
        """Torque and power limits of the motor."""


class CurveLike(Protocol):
    """Stored share of the kinetic energy (1) over the demand at a wheel (N m), of one strategy."""

    @property
    def strategy(self) -> str:
        """Name of the strategy."""

    @property
    def demand_nm(self) -> Sequence[float]:
        """Of the simulated stops, rising."""

    @property
    def stored(self) -> Sequence[float]:
        """By the simulated stops."""

    @property
    def settled(self) -> Sequence[float]:
        """By ideal stops of the same demands whose battery is in steady state throughout."""

    @property
    def ideal_demand_nm(self) -> Sequence[float]:
        """Of the ideal stops, rising."""

    @property
    def ideal(self) -> Sequence[float]:
        """By the ideal stops, whose battery is at rest before each."""


@dataclass(frozen=True)
class FaultRecord:
    """What a controller recorded around its first fault."""

    name: str
    """Of the file that it comes from."""
    reason: str
    lines: Sequence[str]
    """What there is to say, a line each."""
    picture: bytes
    """SVG."""


@dataclass(frozen=True)
class Extras:
    """Maps by the name of the vehicle, the curves of one vehicle's stops, records of faults."""

    maps: Mapping[str, MapLike] = field(default_factory=dict)
    stops: Sequence[CurveLike] = ()
    command: str = "./tools/dev sim"
    records: Sequence[FaultRecord] = ()
