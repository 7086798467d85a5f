# SPDX-License-Identifier: Apache-2.0
"""A run that fails, made small: the same invariant on the same wheel, with less of everything.

Faults, then time after and before what is wrong, then the parts of the vehicle that differ from its
file and the road are left out one after another; what still fails is kept.
"""

import math
from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import Any

from hubsim.scenario import faults
from hubsim.swarm.draw import Case, Data
from hubsim.swarm.work import Record, Task

RUNS_MAX = 60
AFTER_S = 0.5  # of the ride that stays behind what is wrong
SHARES = (0.9, 0.75, 0.5, 0.25)  # of the time before it, that are left out
NEVER = ("record_interval_s", "seed", "drive", "plant", "events", "max_duration_s")

Run = Callable[[Task], Record]


class Reduction:
    """The search: so many runs have been made, and the smallest case that still fails."""

    def __init__(self, case: Case, run: Run) -> None:
        self._run, self.runs = run, 0
        self.case = case
        self._speeds_kmh: list[float] = []
        self._tried_kmh: list[float] = []
        first = self._violations(case)
        self._speeds_kmh = self._tried_kmh
        self.target: dict[str, Any] | None = first[0] if first else None
        self.found = self.target

    def _violations(self, case: Case) -> list[dict[str, Any]]:
        self.runs += 1
        record = self._run({"seed": case.seed, "config": case.config, "data": case.data})
        found: list[dict[str, Any]] = record["violations"]
        self._tried_kmh = record.get("speeds_kmh", [])
        return found

    def _fails(self, data: Data) -> bool:
        """Try a smaller case, and keep it if it fails alike."""
        if self.runs >= RUNS_MAX or self.target is None or data == self.case.data:
            return False
        smaller = Case(self.case.seed, self.case.config, data)
        for each in self._violations(smaller):
            alike = ("invariant", "wheel")
            if all(each[key] == self.target[key] for key in alike):
                self.case, self.found = smaller, each
                self._speeds_kmh = self._tried_kmh
                return True
        return False

    def go(self) -> None:
        """Leave out what can be left out."""
        for step in (self._faults, self._later, self._earlier, self._parts, self._road):
            for data in step():
                self._fails(data)

    def _copy(self) -> Data:
        return deepcopy(self.case.data)

    def _faults(self) -> Iterator[Data]:
        for name in self.case.faults:
            if len(self.case.faults) > 1:
                data = self._copy()
                _drop(data["events"], name)
                yield data
        for name in [n for n in self.case.data["events"] if n.partition("-")[2].isdigit()][::-1]:
            data = self._copy()
            del data["events"][name]
            yield data

    def _later(self) -> Iterator[Data]:
        assert self.found is not None
        end_s = round(self.found["time_s"] + AFTER_S, 3)
        if end_s < self.case.data["max_duration_s"]:
            data = self._copy()
            data["max_duration_s"] = end_s
            for key in ("drive_trace_nm", "demand_trace_nm"):
                if key in data:
                    data[key] = [point for point in data[key] if point[0] <= end_s + 1.0]
            data["events"] = {k: e for k, e in data["events"].items() if e["at_s"] <= end_s}
            yield data

    def _earlier(self) -> Iterator[Data]:
        """Begin later, prepared and rolling at several speeds."""
        for share in SHARES:
            assert self.found is not None
            begins = [self.case.begins_s(name) for name in self.case.faults]
            latest_s = min([self.found["time_s"], *begins])
            by_s = math.floor(share * latest_s)
            if 1 <= by_s < len(self._speeds_kmh):
                yield moved(self.case.data, by_s, self._speeds_kmh[by_s])

    def _parts(self) -> Iterator[Data]:
        needed = {key for fault in self.case.faults for key in faults.table()[fault].needs}
        sections = dict.fromkeys(name.partition(".")[0] for name in self.case.data["plant"])
        kept = {"thermal.active", *needed}
        everything = self._copy()
        everything["plant"] = {k: v for k, v in everything["plant"].items() if k in kept}
        yield everything
        for section in sections:
            data = self._copy()
            data["plant"] = {
                k: v
                for k, v in data["plant"].items()
                if not k.startswith(f"{section}.") or k in kept
            }
            yield data

    def _road(self) -> Iterator[Data]:
        for name in [n for n in self.case.data["events"] if n.startswith(("road", "gear"))]:
            data = self._copy()
            del data["events"][name]
            yield data
        for key in [key for key in self.case.data if key not in NEVER]:
            if key.endswith(("_trace_nm", "_kmh", "rolling")):
                continue
            data = self._copy()
            del data[key]
            yield data


def _drop(events: dict[str, Any], fault: str) -> None:
    for name in [n for n in events if n.partition("-")[0] == fault]:
        del events[name]


def moved(data: Data, by_s: float, speed_kmh: float) -> Data:
    """Return a scenario that begins so much later, the controllers prepared, at a speed."""
    out = deepcopy(data)
    out["initial_speed_kmh"], out["boots_rolling"] = speed_kmh, False
    out["max_duration_s"] = round(out["max_duration_s"] - by_s, 3)
    for key in ("drive_trace_nm", "demand_trace_nm"):
        if key in out:
            out[key] = _cut(out[key], by_s)
    events = {}
    for name, event in out["events"].items():
        if event["at_s"] < by_s and name.startswith(("road", "gear")):
            event["at_s"] = 0.0
            event["over_s"] = 0.0
        else:
            event["at_s"] = round(max(event["at_s"] - by_s, 0.0), 3)
        if "until_s" in event and event["until_s"] is not None:
            event["until_s"] = round(max(event["until_s"] - by_s, 0.001), 3)
        events[name] = event
    out["events"] = events
    return out


def _cut(points: list[Any], by_s: float) -> list[Any]:
    """Return a trace from a time on, which becomes zero."""
    before = [point for point in points if point[0] <= by_s]
    after = [point for point in points if point[0] > by_s]
    value = before[-1][1] if before else 0.0
    if before and after:
        (t0, v0), (t1, v1) = before[-1], after[0]
        value = v0 + (v1 - v0) * (by_s - t0) / (t1 - t0)
    return [[0.0, value], *([round(t - by_s, 3), v] for t, v in after)]
