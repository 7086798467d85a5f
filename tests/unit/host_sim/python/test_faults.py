# SPDX-License-Identifier: Apache-2.0
"""The table of faults, and what the sweep makes of rows of signals."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hubsim import engine, events, faults, faults_sweep, reasons, run, stored_share
from hubsim.errors import HubsimError
from hubsim.faults_sweep import BRAKE, FAULT, MOTOR, SIGNALS, SPEED, TIME, WARNING
from hubsim.scenario import Scenario


def test_every_fault_sets_parameters_that_exist_within_their_ranges() -> None:
    for fault in faults.table().values():
        assert fault.sets
        for name, value in {**fault.sets, **fault.needs}.items():
            events.check_parameter(name, value)
        assert not fault.amount or fault.amount in fault.sets
        assert set(fault.sensors) <= set(faults.SENSORS)


def test_every_parameter_of_a_fault_is_used_by_one() -> None:
    used = {name for fault in faults.table().values() for name in fault.sets}
    own = {name for name in engine.parameters() if name.startswith("fault.")}
    assert own - used <= {"fault.wheels"}


def test_every_fault_of_the_sweep_has_at_most_two_reasons_that_exist_or_are_planned() -> None:
    expected = faults.expected()
    assert set(expected) == {fault.name for fault in faults.named(())}
    assert all(len(right) <= 2 for right in expected.values())
    named = {name for right in expected.values() for name in right}
    assert named <= set(reasons.codes()) | faults.planned()
    assert not faults.planned() & set(reasons.codes())


def test_faults_are_chosen_by_name_and_by_group_and_an_unknown_name_is_one_line() -> None:
    assert [f.name for f in faults.named(["can_silence"])] == ["can_silence"]
    assert all(f.group == "currents" for f in faults.named(["currents"]))
    with pytest.raises(HubsimError, match=r"^no fault 'rotor_frozn', did you mean rotor_frozen\?$"):
        faults.named(["rotor_frozn"])


def test_the_list_has_a_line_for_every_fault() -> None:
    text = "\n".join(faults.lines())
    assert all(f"  {fault.name} " in text for fault in faults.table().values())
    assert "(amount: 90) [hall" not in text


def test_an_event_takes_an_amount_where_the_fault_has_one() -> None:
    slip = events.Event(at_s=1.0, inject="rotor_slips", amount=-20.0)
    assert slip.values == {"fault.rotor_slip_deg_per_s": -20.0}
    with pytest.raises(ValueError, match="amount: accepted with an injection that has one"):
        events.Event(at_s=1.0, inject="can_silence", amount=1.0)
    with pytest.raises(ValueError, match="accepted: a number from -10000 to 10000"):
        events.Event(at_s=1.0, inject="rotor_slips", amount=1e5)


def test_a_fault_concerns_the_chosen_wheels_only() -> None:
    drive = stored_share.drive_named("lu2013")
    scenario = Scenario(initial_speed_kmh=20.0, max_duration_s=1.0, demand_nm=20.0)
    vehicle, _ = run.prepare(drive, scenario, Path(), {})
    with vehicle:
        vehicle.start()
        vehicle.set("fault.wheels", 2.0)
        for name, value in faults.table()["current_a_offset"].sets.items():
            vehicle.set(name, value)
        vehicle.run(0.2)
        found = [vehicle.value(f"wheel{k}.first_fault_reason") for k in range(4)]
    assert [reasons.identifier(code) if code else "" for code in found] == [
        "",
        "CURRENT_SUM",
        "",
        "",
    ]


def rows(count: int) -> np.ndarray:
    out = np.zeros((count, len(SIGNALS)))
    out[:, TIME] = 0.001 * np.arange(count)
    out[:, SPEED] = 5.0
    out[:, BRAKE] = 20.0
    return out


def test_the_first_reason_is_the_one_that_was_not_there_before() -> None:
    found = rows(100)
    found[:, WARNING] = reasons.codes()["OFFSETS_STORED"]
    assert faults_sweep._first_reason(found, 50)[0] == ""
    found[50:, WARNING] = reasons.codes()["ROTOR_UNCERTAIN"]
    found[60:, FAULT] = reasons.codes()["ROTOR_LOST"]
    reason, at_s = faults_sweep._first_reason(found, 50)
    assert (reason, round(at_s, 6)) == ("ROTOR_UNCERTAIN", 0.05)
    reason, at_s = faults_sweep._first_reason(found, 55)
    assert (reason, round(at_s, 6)) == ("ROTOR_LOST", 0.06)


def test_the_longest_time_of_driving_torque_is_that_of_one_piece() -> None:
    flags = [bool(x) for x in (0, 1, 1, 0, 1, 1, 1, 0, 1)]
    assert faults_sweep._longest(flags) == 3
    assert faults_sweep._longest([False] * 5) == 0


def test_torque_against_the_motion_has_the_sign_of_the_motion() -> None:
    found = rows(3)
    found[:, MOTOR] = -10.0  # brakes forward motion
    assert faults_sweep._total(found) == pytest.approx([10.0] * 3)
    found[:, SPEED] = -5.0
    assert faults_sweep._total(found) == pytest.approx([-10.0] * 3)


def test_instants_lie_while_driving_coasting_and_in_the_whole_stop() -> None:
    group = faults_sweep.Group("lu2013", "hall", faults_sweep.STOP, 75.0)
    times = faults_sweep.instants(group)
    assert times == sorted(times)
    assert times[0] < faults_sweep.COAST_S < times[1] < faults_sweep.BRAKE_S < times[2]
    # 165 kg from 40 km/h with 75 N m on 0.3 m: 7.3 s.
    drive = stored_share.drive_named("lu2013")
    whole = 165.0 * 40.0 / 3.6 * drive.vehicle.wheel_radius_m / 75.0
    assert times[-1] == pytest.approx(faults_sweep.BRAKE_S + 0.9 * whole, abs=1e-3)


def test_limits_of_a_run_are_those_of_every_fault() -> None:
    good = faults_sweep.Outcome(
        "current_a_dead", "lu2013", "hall", "stop", 75.0, 1.0, 1.05, 4.0, 30.0, 4.0, 0.5, 1.2, 60.0,
        75.0, "CURRENT_SUM", 1, 2.0, 0, "FAULT", 0,
    )  # fmt: skip
    assert good.misses() == []
    bad: dict[str, Any] = {
        "distance_ratio": math.nan,
        "wrong_sign_ms": 6.0,
        "excess_nm": 8.0,
        "current_ratio": 1.4,
        "bus_peak_v": 76.0,
        "reason_expected": 0,
        "healed_under_braking": 1,
    }
    for name, value in bad.items():
        assert len(replace(good, **{name: value}).misses()) == 1, name
    assert replace(good, reason_expected=0, harmless=1).misses() == []
