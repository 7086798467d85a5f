# SPDX-License-Identifier: Apache-2.0
"""A seed or a case in, everything that is kept of its run out: one record, plain data."""

import itertools
import math
import time
from typing import Any, TypedDict

import numpy as np
from regen_table import installation

from hubsim import configuration, reasons
from hubsim.engine import mode_text
from hubsim.scenario import faults
from hubsim.swarm import draw, judge, ride, share
from hubsim.swarm.draw import Case
from hubsim.swarm.judge import Finding
from hubsim.swarm.ride import Recording

BRIDGE = "bridge"  # the group of faults
DIMENSIONS = ("fault", "mode", "limit", "sensor")


class Task(TypedDict, total=False):
    """What is to be run: a seed (with how many drives, healthy or not), or a case by its data."""

    seed: int
    drives: int
    healthy: bool
    config: str
    data: dict[str, Any]


Record = dict[str, Any]


def case_of(task: Task) -> Case:
    """Return the run that a task means."""
    if "data" in task:
        return Case(task["seed"], task["config"], task["data"])
    return draw.case(task["seed"], task["drives"], task["healthy"] or None)


def done(task: Task) -> Record:
    """Make a run and judge it."""
    began_s = time.process_time()
    case = case_of(task)
    out: Record = {
        "seed": case.seed,
        "config": case.config,
        "drive": case.drive.motor.name,
        "kind": case.kind,
        "image_crc32": installation.crc32(configuration.image_of(case.drive)),
    }
    found, pairs, speeds = _findings(case)
    worst: dict[str, Finding] = {}
    for each in found:
        worst[each.invariant] = max(worst.get(each.invariant, each), each, key=lambda f: f.share)
    out["worst"] = {name: _plain(each) for name, each in worst.items()}
    out["violations"] = [_plain(each) for each in judge.violations(found)]
    out["coverage"] = pairs
    if "data" in task:
        out["speeds_kmh"] = speeds
    out["cpu_s"] = time.process_time() - began_s
    return out


def _findings(case: Case) -> tuple[list[Finding], list[str], list[float]]:
    """Return the findings, the pairs that were seen, and the speed in every second, km/h."""
    try:
        recording = ride.simulated(case)
    except ride.CollapsedError as error:
        # A leg that is closed on both sides shorts the battery: nothing is left to judge.
        if any(faults.table()[name].group == BRIDGE for name in case.faults):
            return [], [], []
        return [Finding(judge.PROCESS, 0, 0.0, 1.0, 0.0, "1", str(error))], [], []
    except ride.NotStartedError as error:
        limit = Finding("warning", 0, 0.0, 1.0, 0.0, "ms", f"{judge.NOT_STARTED}: {error}")
        return [limit], [], []
    found = judge.judged(recording)
    if not case.faults:
        gap = share.gap(case)
        found += [] if gap is None else [gap]
    speeds = [round(3.6 * float(speed), 3) for speed in recording.speed[:: judge.ROWS_PER_S]]
    return found, covered(case, recording), speeds


def _plain(finding: Finding) -> dict[str, Any]:
    """Return a finding as JSON has it: null for what is infinite or no number."""
    value, limit = (number if math.isfinite(number) else None
                    for number in (finding.value, finding.limit))  # fmt: skip
    return {
        "invariant": finding.invariant,
        "wheel": None if finding.wheel == judge.VEHICLE else finding.wheel,
        "time_s": round(finding.time_s, 3),
        "value": value,
        "limit": limit,
        "unit": finding.unit,
        "text": finding.text,
        "share": finding.share if math.isfinite(finding.share) else None,
    }


def covered(case: Case, recording: Recording) -> list[str]:
    """Return the pairs of fault, mode, tightest limit and rotor sensor where a fault comes."""
    found: set[str] = set()
    pressed = recording.signals["driver.brake_nm"] > 0.0
    for fault in case.faults:
        at = int(np.searchsorted(recording.time_s, case.begins_s(fault)))
        at = min(at, len(recording.time_s) - 1)
        side = "braking" if pressed[at] else "driving"
        values = (
            fault,
            mode_text(recording.wheel(0, "mode")[at]),
            reasons.identifier(recording.wheel(0, f"limit_{side}_reason")[at]),
            recording.drive.rotor.sensor,
        )
        named = (
            f"{dimension}={value}" for dimension, value in zip(DIMENSIONS, values, strict=True)
        )
        found |= {f"{a} {b}" for a, b in itertools.combinations(named, 2)}
    return sorted(found)


def possible() -> int:
    """Return how many pairs there are at most; a sensor's faults exist with that sensor alone."""
    modes = {mode_text(code) for code in range(7)}
    limits = reasons.limits()
    sensors = ("hall", "encoder", "angle")
    names = {sensor: {f.name for fs in draw.candidates(sensor).values() for f in fs}
             for sensor in sensors}  # fmt: skip
    every = set().union(*names.values())
    return (
        len(every) * (len(modes) + len(limits))
        + sum(len(each) for each in names.values())
        + len(modes) * len(limits)
        + len(sensors) * (len(modes) + len(limits))
    )
