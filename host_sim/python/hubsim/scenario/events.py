# SPDX-License-Identifier: Apache-2.0
"""What happens to the simulated world during a run.

Parameters set or led along straight lines at their times.

An event sets parameters by name, or starts an injection, a disturbance that has a name of its own.
Changes reach the controllers at the millisecond in which they happen; a ramp moves once a
millisecond.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, model_validator
from regen_table.suggest import suggestion

from hubsim import engine
from hubsim.engine import Engine, Parameter
from hubsim.scenario import faults
from hubsim.scenario.keys import Section, listed, number

STEP_S = 1e-3  # of the slow loop
TRACE_STEP_S = {"road.slope": 0.05}  # of a trace that changes slowly
_EARLY_S = 1e-9

Point = tuple[float, float]


@dataclass(frozen=True)
class Injection:
    """A disturbance with a name: the parameters it sets, and its description.

    ``amount`` is the one of them that an event may set to another value.
    """

    sets: Mapping[str, float]
    text: str
    amount: str = ""


INJECTIONS: Mapping[str, Injection] = {
    "abs": Injection({"driver.abs_active": 1.0}, "anti-lock intervention"),
    "vehicle_off": Injection({"driver.enable": 0.0}, "the driver switches the vehicle off"),
    "no_charging": Injection(
        {"battery.max_charge_current_a": 0.0}, "the battery management allows no charging"
    ),
    "no_discharging": Injection(
        {"battery.max_discharge_current_a": 0.0}, "the battery management allows no discharging"
    ),
    **{name: Injection(f.sets, f.text, f.amount) for name, f in faults.table().items()},
}


class Event(Section):
    """One thing that happens; the section's name is its name."""

    at_s: Annotated[float, number(0.0, 1e6, "when, s after the run began")]
    set: Annotated[
        dict[str, float],
        listed(
            "parameters of the simulated world and their new values",
            "a section of parameters and numbers",
        ),
    ] = Field(default_factory=dict)
    inject: Annotated[
        str | None,
        listed("a disturbance by name", "a name of 'hubsim list' or 'hubsim faults --list'"),
    ] = None
    amount: Annotated[
        float | None,
        number(-1e6, 1e6, "how much of the disturbance, instead of its own value"),
    ] = None
    over_s: Annotated[
        float, number(0.0, 1e6, "parameters move to their values in a straight line for so long, s")
    ] = 0.0
    until_s: Annotated[
        float | None, number(0.0, 1e6, "when everything is again as it was before, s")
    ] = None

    @model_validator(mode="after")
    def _says_something(self) -> "Event":
        if bool(self.set) == (self.inject is not None):
            raise ValueError("accepted: either set or inject")
        if self.inject is not None and self.inject not in INJECTIONS:
            hint = suggestion(self.inject, INJECTIONS, "'hubsim faults --list' shows all")
            raise ValueError(f"inject: {self.inject!r} is not accepted, {hint}")
        if self.amount is not None and not (self.inject and INJECTIONS[self.inject].amount):
            raise ValueError(
                "amount: accepted with an injection that has one (hubsim faults --list)"
            )
        if self.until_s is not None and self.until_s < self.at_s + self.over_s:
            raise ValueError(
                f"until_s: {self.until_s:g} is not accepted, accepted: not before "
                f"{self.at_s + self.over_s:g}"
            )
        for name, value in self.values.items():
            check_parameter(name, value)
        return self

    @property
    def values(self) -> Mapping[str, float]:
        """The parameters that the event sets."""
        if self.inject is None:
            return self.set
        injection = INJECTIONS[self.inject]
        if self.amount is None:
            return injection.sets
        return {**injection.sets, injection.amount: self.amount}


def range_of(parameter: Parameter) -> str:
    """Describe the values that a parameter takes."""
    unit = f" {parameter.unit}" if parameter.unit not in {"", "1"} else ""
    return f"a number from {parameter.lowest:g} to {parameter.highest:g}{unit}"


def check_parameter(name: str, value: float) -> None:
    """Refuse a parameter that does not exist or a value beyond its range, with ValueError."""
    known = engine.parameters()
    if name not in known:
        hint = suggestion(name, known, "'hubsim list --parameters' shows all")
        raise ValueError(f"{name}: unknown key, {hint}")
    parameter = known[name]
    if not parameter.lowest <= value <= parameter.highest:
        raise ValueError(f"{name}: {value:g} is not accepted, accepted: {range_of(parameter)}")


@dataclass
class _Line:
    """A parameter led through points (time in s, value).

    A first value of NaN is wherever the parameter is then.
    """

    name: str
    points: list[Point]
    due_s: float
    step_s: float = STEP_S


class Timeline:
    """All changes of one run, in the order of their times."""

    def __init__(self, events: Mapping[str, Event], traces: Mapping[str, Sequence[Point]]) -> None:
        self._lines = [
            _Line(name, list(points), points[0][0], TRACE_STEP_S.get(name, STEP_S))
            for name, points in traces.items()
        ]
        self._undo: dict[tuple[str, str], float] = {}
        self._returns: list[tuple[float, str, str]] = []
        self._first_s = {name: event.at_s for name, event in events.items()}
        for event_name, event in events.items():
            for name, value in event.values.items():
                points = (
                    [(event.at_s, math.nan), (event.at_s + event.over_s, value)]
                    if event.over_s > 0.0
                    else [(event.at_s, value)]
                )
                self._lines.append(_Line(name, points, event.at_s))
                if event.until_s is not None:
                    self._undo[event_name, name] = event.at_s
                    self._returns.append((event.until_s, event_name, name))
        self._lines.sort(key=lambda line: line.points[0][0])
        self._before: dict[tuple[str, str], float] = {}

    def next_s(self, now_s: float) -> float:
        """Return when something has to be done next; infinity if never."""
        later_s, next_s = now_s + _EARLY_S, math.inf
        for line in self._lines:
            if later_s < line.due_s < next_s:
                next_s = line.due_s
        for time in (*(time for time, _, _ in self._returns), *self._undo.values()):
            if later_s < time < next_s:
                next_s = time
        return next_s

    def apply(self, vehicle: Engine, now_s: float) -> None:
        """Make the changes that are due."""
        due_s = now_s + _EARLY_S
        for (event, name), at_s in list(self._undo.items()):
            if at_s <= due_s:
                self._before[event, name] = vehicle.get(name)
                del self._undo[event, name]
        for line in self._lines:
            if line.due_s <= due_s:
                self._move(line, vehicle, now_s)
        for entry in sorted(self._returns):
            if entry[0] <= due_s:
                vehicle.set(entry[2], self._before[entry[1:]])
                self._returns.remove(entry)

    def missed(self, end_s: float) -> dict[str, float]:
        """Return the events whose time had not come when the run ended."""
        return {name: at_s for name, at_s in self._first_s.items() if at_s > end_s}

    @staticmethod
    def _move(line: _Line, vehicle: Engine, now_s: float) -> None:
        points = line.points
        if math.isnan(points[0][1]):
            points[0] = (points[0][0], vehicle.get(line.name))
        while len(points) > 1 and points[1][0] <= now_s + _EARLY_S:
            points.pop(0)
        (t0, v0), rest = points[0], points[1:]
        if not rest:
            vehicle.set(line.name, v0)
            line.due_s = math.inf
            return
        (t1, v1) = rest[0]
        vehicle.set(line.name, v0 + (v1 - v0) * max(now_s - t0, 0.0) / (t1 - t0))
        line.due_s = t1 if v1 == v0 else min(now_s + line.step_s, t1)


def rising(points: Iterable[Point], what: str) -> tuple[Point, ...]:
    """Check the times of a trace: 0 first, then rising."""
    out = tuple(points)
    times = [t for t, _ in out]
    if not out or times[0] != 0.0 or any(b <= a for a, b in itertools.pairwise(times)):
        raise ValueError(
            f"{what}: {str(times)[:40]} s, accepted: at least one point, 0 first, then rising"
        )
    return out
