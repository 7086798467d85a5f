# SPDX-License-Identifier: Apache-2.0
"""The table of faults, and what the sweep makes of rows of signals."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hubsim import engine, reasons, run
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario, events, faults
from hubsim.sweep import drives, faults_sweep
from hubsim.sweep.faults_outcome import Outcome
from hubsim.sweep.faults_sweep import (
    BRAKE,
    FAULT,
    HYDRAULIC,
    LIMIT,
    MOTOR,
    SIGNALS,
    SPEED,
    TIME,
    WARNING,
)


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
    # Of the application alone, and how long a restart takes (test_application.py,
    # test_hold_over_restart.py).
    apart = {"fault.can_load", "fault.can_unsent", "fault.restart_s", "fault.restart_cold"}
    assert own - used <= {"fault.wheels", *apart}


def test_every_fault_of_the_sweep_has_at_most_two_reasons_that_exist() -> None:
    expected = faults.expected()
    swept = {image for fault in faults.swept() for image in faults.images(fault.name)}
    assert set(expected) == swept
    assert all(len(right) <= 2 for right in expected.values())
    named = {name for right in expected.values() for name in right}
    assert named <= set(reasons.codes())


def test_a_fault_has_reasons_with_their_cause_or_is_called_invisible() -> None:
    for name, line in faults.reasons_given().items():
        assert set(line) == {"right", "because" if line["right"] else "invisible"}, name
        assert line.get("because") or line.get("invisible"), name


def test_a_mirror_image_is_the_same_fault_of_another_phase_or_switch() -> None:
    places = {
        "fault.current_sensors", "fault.phase_open", "fault.phase_short", "fault.high_switch_open",
        "fault.low_switch_open", "fault.high_switch_closed", "fault.low_switch_closed",
        "fault.leg_high", "fault.leg_low",
    }  # fmt: skip
    known = faults.table()
    images = [fault for fault in known.values() if fault.image_of != fault.name]
    assert len(images) >= 25
    for image in images:
        first = known[image.image_of]
        assert first.image_of == first.name
        assert image.group == first.group
        assert set(image.sets) == set(first.sets)
        moved = {name for name in image.sets if image.sets[name] != first.sets[name]}
        assert len(moved) == 1
        assert moved <= places
    sets = [tuple(sorted(fault.sets.items())) for fault in known.values()]
    own = [tuple(sorted(fault.sets.items())) for fault in images]
    assert all(sets.count(one) == 1 for one in own)


def test_each_phase_and_switch_has_its_faults() -> None:
    names = set(faults.table())
    for phase in "abc":
        for kind in ("dead", "stuck", "at_rail", "frozen", "offset", "drift", "gain"):
            assert f"current_{phase}_{kind}" in names
        assert f"phase_{phase}_open" in names
        for side in ("high", "low"):
            assert {f"{side}_switch_{phase}_open", f"{side}_switch_{phase}_closed"} <= names
            assert f"leg_{phase}_{side}" in names
    assert {"phases_shorted", "phases_bc_shorted", "phases_ca_shorted"} <= names


def test_a_sweep_draws_mirror_images_and_numbers_and_a_name_is_that_fault() -> None:
    bridge = faults.named(["bridge"])
    drawn = faults_sweep.plan(bridge)
    assert faults_sweep.plan(bridge) == drawn
    plain = faults_sweep.plan(bridge, exact=[fault.name for fault in bridge])
    assert len(drawn) == len(plain)
    assert {case.fault for case in plain} == {fault.name for fault in bridge}
    wanted = {image for fault in bridge for image in faults.images(fault.name)}
    assert {case.fault for case in drawn} == wanted
    several = faults_sweep.plan(faults.named(["state_bit"]))
    bits = {faults_sweep.values(case)["fault.state_bit"] for case in several}
    assert len(bits) == len(several)
    assert all(bit == int(bit) >= 1 for bit in bits)


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
    drive = drives.drive_named("lu2013")
    scenario = Scenario(initial_speed_kmh=20.0, max_duration_s=1.0, demand_nm=20.0)
    vehicle, _ = run.prepare(drive, scenario, Path(), {})
    with vehicle:
        vehicle.start()
        vehicle.set("fault.wheels", 2.0)
        for name, value in faults.table()["current_a_offset"].sets.items():
            vehicle.set(name, value)
        vehicle.run(0.2)
        found = [vehicle.value(f"wheel{k}.warning_reason") for k in range(4)]
    assert [reasons.identifier(code) if code else "" for code in found] == [
        "",
        "CURRENT_SENSOR_A",
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


def test_a_limit_is_a_reason_where_it_is_right_and_the_fault_brought_it() -> None:
    high, charge = (reasons.codes()[name] for name in ("BUS_VOLTAGE_HIGH", "CHARGE_CURRENT"))
    found = rows(100)
    found[:, LIMIT] = charge
    found[70:, LIMIT] = high
    found[80:, WARNING] = reasons.codes()["BUS_SENSOR"]
    assert faults_sweep._first_reason(found, 50)[0] == "BUS_SENSOR"
    reason, at_s = faults_sweep._first_reason(found, 50, [high])
    assert (reason, round(at_s, 6)) == ("BUS_VOLTAGE_HIGH", 0.07)
    assert faults_sweep._first_reason(found, 75, [high])[0] == "BUS_SENSOR"
    assert faults_sweep._first_reason(found, 50, [charge])[0] == "BUS_SENSOR"


def test_a_limit_that_the_run_without_the_fault_shows_names_no_fault() -> None:
    plain = object.__new__(faults_sweep._Vehicle)
    plain.rows = rows(100)
    right = ["BUS_VOLTAGE_HIGH", "BUS_SENSOR", "BATTERY_DISCONNECTED"]
    high = reasons.codes()["BUS_VOLTAGE_HIGH"]
    plain.rows[:50, LIMIT] = high
    assert plain._new_limits(right, 50) == [high]
    plain.rows[60, LIMIT] = high
    assert plain._new_limits(right, 50) == []


def test_the_longest_time_of_driving_torque_is_that_of_one_piece() -> None:
    flags = [bool(x) for x in (0, 1, 1, 0, 1, 1, 1, 0, 1)]
    assert faults_sweep._longest(flags) == 3
    assert faults_sweep._longest([False] * 5) == 0


def test_torque_against_the_motion_has_the_sign_of_the_motion() -> None:
    found = rows(3)
    found[:, MOTOR] = -10.0  # brakes forward motion
    assert faults_sweep._total(found) == pytest.approx([10.0] * 3)
    found[:, HYDRAULIC] = 4.0  # and so does this
    assert faults_sweep._total(found) == pytest.approx([14.0] * 3)
    found[:, SPEED] = -5.0
    assert faults_sweep._total(found) == pytest.approx([-14.0] * 3)
    found[:, MOTOR] = 10.0
    assert faults_sweep._total(found) == pytest.approx([6.0] * 3)
    found[:, HYDRAULIC] = -4.0
    assert faults_sweep._total(found) == pytest.approx([14.0] * 3)


def test_torque_against_a_roll_back_obeys_newtons_law() -> None:
    """The wheel's share of the mass: m a, and what the slope pulls less rolling resistance.

    Blending hands the torque from the motor to the hydraulic brake meanwhile, so each of them has
    a large part of it: one wrong sign is off by twice that part.
    """
    group = faults_sweep.Group("lu2013", "hall", faults_sweep.ROLL_BACK, 36.0)
    vehicle = faults_sweep._Vehicle(group, [])
    with vehicle.engine:
        body = vehicle.drive.vehicle
    mass_kg = body.mass_kg / body.driven_wheels
    slope = math.atan(faults_sweep.BACK_SLOPE_PERCENT / 100.0)
    pull_n = mass_kg * 9.81 * (math.sin(slope) - body.rolling_resistance * math.cos(slope))
    found = vehicle.rows[(vehicle.rows[:, TIME] >= 2.2) & (vehicle.rows[:, TIME] <= 4.2)]
    assert np.all(found[:, SPEED] < 0.0)
    for share in (np.abs(found[:, MOTOR]), np.abs(found[:, HYDRAULIC])):
        assert share.min() < 8.0
        assert share.max() > 25.0
    for part in np.array_split(found, 4):  # drag of the air at 6 km/h: below 0.2 N m
        slower = (part[-1, SPEED] - part[0, SPEED]) / (part[-1, TIME] - part[0, TIME])
        expected = body.wheel_radius_m * (mass_kg * slower + pull_n)
        assert np.mean(faults_sweep._total(part)) == pytest.approx(expected, abs=0.5)


def test_instants_lie_while_driving_coasting_and_in_the_whole_stop() -> None:
    group = faults_sweep.Group("lu2013", "hall", faults_sweep.STOP, 75.0)
    times = faults_sweep.instants(group)
    assert times == sorted(times)
    assert times[0] < faults_sweep.COAST_S < times[1] < faults_sweep.BRAKE_S < times[2]
    # 165 kg from 40 km/h with 75 N m on 0.3 m: 7.3 s.
    drive = drives.drive_named("lu2013")
    whole = 165.0 * 40.0 / 3.6 * drive.vehicle.wheel_radius_m / 75.0
    assert times[-1] == pytest.approx(faults_sweep.BRAKE_S + 0.9 * whole, abs=1e-3)


def test_limits_of_a_run_are_those_of_every_fault() -> None:
    good = Outcome(
        "current_a_dead", "lu2013", "hall", "stop", 75.0, 1.0, 1.05, 4.0, 30.0, 4.0, 0.5, 1.2, 60.0,
        75.0, "CURRENT_SUM", 1, 2.0, 0, "FAULT", 0, 0,
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
        "acknowledged_turning": 1,
    }
    for name, value in bad.items():
        assert len(replace(good, **{name: value}).misses()) == 1, name
    assert replace(good, reason_expected=0, harmless=1).misses() == []


@pytest.mark.parametrize(
    ("fault", "missed"),
    [
        ("hydraulic_weak", ["excess"]),
        ("hydraulic_late_measured", ["excess"]),
        ("hydraulic_strong", []),
        ("hydraulic_stuck_on", []),
        ("hydraulic_report_gain_low", ["distance", "excess"]),
    ],
)
def test_a_wrong_brake_has_a_quarter_of_the_distance_and_a_strong_one_its_own_torque(
    fault: str, missed: list[str]
) -> None:
    run = Outcome(
        fault, "lu2013", "hall", "stop", 75.0, 1.0, 1.2, 0.0, 0.0, 8.0, 0.5, 0.5, 60.0,
        75.0, "", 1, math.nan, 0, "RUN", 0, 0,
    )  # fmt: skip
    assert run.misses() == missed


class _Wheel:
    """A braking wheel of the paper's vehicle, and a fault in it."""

    def __init__(self, name: str, needs: dict[str, float] | None = None) -> None:
        drive = drives.drive_named("lu2013")
        plant = {"bus.capacitance_f": 0.004, **(needs or {})}
        scenario = Scenario(
            initial_speed_kmh=30.0, max_duration_s=9.0, demand_nm=60.0, noise=False, plant=plant
        )
        self.engine, _ = run.prepare(drive, scenario, Path(), {})
        stops.as_one_wheel(self.engine, drive)
        self.engine.start()
        self.engine.run(0.5)
        for parameter, value in faults.table()[name].sets.items():
            self.engine.set(parameter, value)

    def after(self, duration_s: float, *signals: str) -> list[float]:
        """Go on, and return signals."""
        self.engine.run(duration_s)
        return [self.engine.value(f"wheel0.{name}") for name in signals]

    def mean(self, duration_s: float, signal: str) -> float:
        """Go on, and return the mean of a rate, whose value is its integral."""
        before = self.engine.value(f"wheel0.{signal}")
        return (self.after(duration_s, signal)[0] - before) / duration_s


def test_the_watchdog_restarts_a_controller_whose_slow_step_has_stopped() -> None:
    wheel = _Wheel("slow_step_stopped")
    mode, reason = wheel.after(0.020, "mode", "first_fault_reason")
    assert (wheel.engine.mode_text(mode), reasons.identifier(reason)) == ("FAULT", "PROGRAM_FLOW")
    mode, bridge = wheel.after(0.010, "mode", "bridge")
    assert (wheel.engine.mode_text(mode), bridge) == ("BOOT", 0.0)
    # The brake system misses the messages' counter after 50 ms, and takes the pedal's 60 N m.
    assert wheel.after(0.025, "hydraulic_valid") == [0.0]
    wheel.engine.run(0.8)
    assert wheel.mean(0.1, "hydraulic_torque_nm") == pytest.approx(60.0, abs=0.5)


def test_a_restart_boots_on_the_turning_wheel_and_comes_back() -> None:
    wheel = _Wheel("watchdog_restart")
    assert wheel.engine.mode_text(wheel.after(0.002, "mode")[0]) != "RUN"
    assert wheel.engine.mode_text(wheel.after(1.5, "mode")[0]) == "RUN"


@pytest.mark.parametrize(
    ("part", "reason"),
    [("mode", "MEMORY"), ("fault", "MEMORY"), ("current_limit", "SELFTEST_FAILED"),
     ("voltage_limit", "SELFTEST_FAILED")],
)  # fmt: skip
def test_a_flipped_bit_of_a_safety_variable_is_found_in_two_milliseconds(
    part: str, reason: str
) -> None:
    wheel = _Wheel(f"state_bit_{part}")
    mode, found, bridge = wheel.after(0.0031, "mode", "first_fault_reason", "bridge")
    assert (wheel.engine.mode_text(mode), reasons.identifier(found)) == ("FAULT", reason)
    assert bridge != 1.0


def test_a_flipped_bit_of_the_trip_ends_the_torque_at_once_and_is_named() -> None:
    wheel = _Wheel("state_bit_trip")
    assert wheel.after(0.0012, "bridge") != [1.0]
    mode, found = wheel.after(0.002, "mode", "first_fault_reason")
    assert (wheel.engine.mode_text(mode), reasons.identifier(found)) == ("FAULT", "MEMORY")


def test_a_fault_is_acknowledged_at_standstill_and_not_while_the_wheel_turns() -> None:
    wheel = _Wheel("gate_driver")
    assert wheel.after(0.1, "fault_reason") != [0.0]
    wheel.engine.set("fault.gate_driver", 0.0)
    wheel.engine.set("driver.fault_reset_every_s", faults_sweep.RESETS_S)
    while wheel.engine.value("vehicle.speed_m_per_s") > 1.0:
        assert wheel.after(0.05, "fault_reason") != [0.0]
    wheel.engine.set("driver.brake_demand_nm", 0.0)  # and one without a demand, turning
    assert wheel.after(0.2, "fault_reason") != [0.0]
    wheel.engine.set("driver.brake_demand_nm", 60.0)
    while wheel.engine.value("vehicle.speed_m_per_s") > 0.0:
        wheel.engine.run(0.02)
    wheel.engine.set("driver.brake_demand_nm", 0.0)
    assert wheel.after(4.0, "fault_reason") == [0.0]  # the bound of the speed needs some seconds


def test_a_bridge_without_fast_steps_is_open_within_two_periods() -> None:
    """Two of 50 us until the stop timer has taken it, and one in which the current dies out."""
    wheel = _Wheel("fast_step_stopped")
    assert wheel.after(0.00015, "bridge") == [0.0]
    assert wheel.after(0.0005, "current_q_a", "bridge") == [0.0, 0.0]


def test_the_fault_line_and_open_drivers_stop_the_motor() -> None:
    wheel = _Wheel("gate_driver")
    reason, bridge, current = wheel.after(0.05, "first_fault_reason", "bridge", "current_q_a")
    assert reasons.identifier(reason) == "HARDWARE_BREAK"
    assert (bridge, round(current, 1)) == (0.0, 0.0)


def test_a_stuck_brake_adds_its_torque() -> None:
    """45 N m of 300 never release."""
    stuck, healthy = _Wheel("hydraulic_stuck_on"), _Wheel("hydraulic_stuck_on")
    healthy.engine.set("fault.hydraulic_drag", 0.0)
    added = stuck.mean(0.1, "hydraulic_torque_nm") - healthy.mean(0.1, "hydraulic_torque_nm")
    assert added == pytest.approx(45.0, abs=1.0)


def test_weak_magnets_make_less_torque_of_the_same_current() -> None:
    healthy, weak = _Wheel("magnets_weak"), _Wheel("magnets_weak")
    healthy.engine.set("fault.magnet_loss", 0.0)
    for wheel in (healthy, weak):
        wheel.engine.run(0.3)
    ratio = weak.mean(0.1, "motor_torque_nm") / healthy.mean(0.1, "motor_torque_nm")
    currents = [wheel.engine.value("wheel0.current_q_a") for wheel in (healthy, weak)]
    assert ratio == pytest.approx(0.7 * currents[1] / currents[0], rel=0.03)


def test_a_corroded_cable_lifts_the_bus_by_its_resistance() -> None:
    """Cable and cells times four, times the current that is charged."""
    wheel = _Wheel("cable_corroded")
    wheel.engine.run(0.3)
    value, get = wheel.engine.value, wheel.engine.get
    ohm = get("battery.series_resistance_ohm") + get("bus.cable_resistance_ohm")
    lifted = value("bus.voltage_v") - value("battery.voltage_v")
    own = get("bus.cable_resistance_ohm")
    assert value("battery.current_a") < -1.0
    assert lifted == pytest.approx(-(4.0 * ohm + own) * value("battery.current_a"), rel=0.02)


def test_a_bouncing_contactor_is_open_half_of_the_time() -> None:
    wheel = _Wheel("contactor_bounces")
    currents = []
    for _ in range(200):
        wheel.engine.run(0.001)
        currents.append(wheel.engine.value("battery.current_a"))
    assert sum(current == 0.0 for current in currents) == pytest.approx(100, abs=5)


def test_a_blocked_wheel_slides() -> None:
    wheel = _Wheel("wheel_locked", {"road.friction": 0.8})
    assert wheel.after(0.4, "speed_rad_per_s")[0] == pytest.approx(0.0, abs=0.1)
    assert wheel.engine.value("vehicle.speed_m_per_s") > 1.0


def test_a_bit_of_the_configuration_flips_and_comes_back() -> None:
    wheel = _Wheel("config_bit")
    flipped = wheel.engine.save()
    wheel.engine.set("fault.config_bit", 0.0)
    back = wheel.engine.save()
    changed = [a ^ b for a, b in zip(flipped, back, strict=True) if a != b]
    number = int(faults.table()["config_bit"].sets["fault.config_bit"])
    assert 1 << (number - 1) % 8 in changed
    assert len(changed) < 16  # the parameter, its copy as a number, the bit


def test_the_gate_drivers_protect_a_bridge_with_a_stuck_switch() -> None:
    wheel = _Wheel("low_switch_a_closed")
    reason = wheel.after(0.05, "first_fault_reason")[0]
    assert reasons.identifier(reason) == "HARDWARE_BREAK"


def test_an_open_phase_carries_no_current() -> None:
    wheel = _Wheel("phase_b_open")
    for _ in range(20):
        assert wheel.after(0.0005, "phase_b_a")[0] == pytest.approx(0.0, abs=0.2)
