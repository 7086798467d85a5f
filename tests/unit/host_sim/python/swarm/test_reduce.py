# SPDX-License-Identifier: Apache-2.0
"""Reduction keeps what a violation needs, and leaves out everything else."""

from copy import deepcopy
from typing import Any

import pytest
from hubsim.swarm import draw, reduce
from hubsim.swarm.draw import Case, Data
from hubsim.swarm.reduce import Reduction, moved
from hubsim.swarm.work import Record, Task

WRONG = {"invariant": "excess_braking", "wheel": 0, "value": 9.0, "limit": 5.0, "unit": "N m"}


@pytest.fixture(scope="module")
def several() -> Case:
    """Return a run with several faults, the last of them late."""
    return next(
        case
        for case in (draw.case(seed, 4) for seed in range(400))
        if len(case.faults) == 3 and max(case.begins_s(name) for name in case.faults) > 20.0
        and "sensors.current_noise_a" in case.data["plant"]
    )  # fmt: skip


class World:
    """Fails where all the needed keys are there, whatever else is."""

    def __init__(self, fault: str, part: str, at_s: float) -> None:
        self.fault, self.part, self.at_s, self.other = fault, part, at_s, False

    def run(self, task: Task) -> Record:
        case = Case(task["seed"], task["config"], task["data"])
        fails = self.fault in case.faults and self.part in case.data["plant"]
        fails = fails and case.begins_s(self.fault) <= case.data["max_duration_s"]
        at_s = case.begins_s(self.fault) if fails else 0.0
        other: list[dict[str, Any]] = [{**WRONG, "wheel": 1, "time_s": 0.0}] if self.other else []
        speeds = [20.0] * (int(case.data["max_duration_s"]) + 1)
        found = [{**WRONG, "time_s": at_s}] if fails else other
        return {"violations": found, "speeds_kmh": speeds}


def test_what_is_needed_stays_and_the_rest_goes(several: Case) -> None:
    fault = max(several.faults, key=several.begins_s)
    world = World(fault, "sensors.current_noise_a", several.begins_s(fault))
    before = deepcopy(several.data)
    found = Reduction(several, world.run)
    found.go()
    assert several.data == before
    assert found.runs <= reduce.RUNS_MAX
    small = found.case
    assert small.faults == (fault,)
    assert "sensors.current_noise_a" in small.data["plant"]
    assert not [name for name in small.data["plant"] if name.startswith(("battery.", "motor."))]
    assert not [name for name in small.data["events"] if name.startswith(("road", "gear"))]
    assert small.data["max_duration_s"] < 0.5 * several.data["max_duration_s"]
    assert small.begins_s(fault) <= small.data["max_duration_s"]
    assert world.run({"seed": 0, "config": small.config, "data": small.data})["violations"]
    assert found.found is not None
    assert found.found["invariant"] == "excess_braking"


def test_another_wheel_or_invariant_does_not_count(several: Case) -> None:
    fault = several.faults[0]
    world = World(fault, "sensors.current_noise_a", several.begins_s(fault))
    world.other = True
    found = Reduction(several, world.run)
    found.go()
    assert fault in found.case.faults
    assert "sensors.current_noise_a" in found.case.data["plant"]


def test_a_seed_that_violates_nothing_is_left_alone(several: Case) -> None:
    found = Reduction(several, lambda _task: {"violations": []})
    assert found.target is None
    assert found.runs == 1


def test_a_ride_that_begins_later_has_the_same_pedals_road_and_faults() -> None:
    data: Data = {
        "initial_speed_kmh": 0.0, "boots_rolling": True, "max_duration_s": 20.0,
        "drive_trace_nm": [[0.0, 0.0], [4.0, 8.0], [12.0, 8.0]],
        "demand_trace_nm": [[0.0, 0.0], [15.0, 0.0], [16.0, 9.0]],
        "drive": {}, "plant": {},
        "events": {
            "road0": {"at_s": 1.0, "over_s": 0.5, "set": {"road.slope": 0.02}},
            "road1": {"at_s": 8.0, "over_s": 0.5, "set": {"road.slope": 0.0}},
            "state_bit": {"at_s": 10.0, "set": {"fault.state_bit": 3.0}},
        },
    }  # fmt: skip
    later = moved(data, 2.0, 15.0)
    assert later["max_duration_s"] == 18.0
    assert (later["initial_speed_kmh"], later["boots_rolling"]) == (15.0, False)
    assert later["drive_trace_nm"] == [[0.0, 4.0], [2.0, 8.0], [10.0, 8.0]]
    assert later["demand_trace_nm"] == [[0.0, 0.0], [13.0, 0.0], [14.0, 9.0]]
    begins = {name: (event["at_s"], event.get("over_s")) for name, event in later["events"].items()}
    assert begins == {"road0": (0.0, 0.0), "road1": (6.0, 0.5), "state_bit": (8.0, None)}
