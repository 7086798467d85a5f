# SPDX-License-Identifier: Apache-2.0
"""Every invariant: kept by a quiet ride, violated by a recording that is made to violate it."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hubsim import reasons
from hubsim.engine import Rows, mode_text
from hubsim.run import plant
from hubsim.swarm import judge, motion
from hubsim.swarm.drives import numbered
from hubsim.swarm.judge import Finding, judged
from hubsim.swarm.ride import LATER, VEHICLE_SIGNALS, WHEEL_SIGNALS, Recording
from regen_table import derived, loops

ROWS = 6000
SPEED = 5.0
DRIVE = numbered(0).drive  # one wheel of the paper's vehicle
RUN = next(code for code in range(8) if mode_text(code) == "RUN")
LIMP, FAULT, BOOT = (
    next(code for code in range(8) if mode_text(code) == name) for name in ("LIMP", "FAULT", "BOOT")
)
DEMAND = 30.0


def quiet(faults: tuple[str, ...] = (), **parameters: float) -> Recording:
    """Return a ride at a constant speed on which nothing happens."""
    names = [*VEHICLE_SIGNALS, *(f"wheel0.{name}" for name in WHEEL_SIGNALS)]
    signals: dict[str, Rows] = {name: np.zeros(ROWS, dtype=np.float64) for name in names}
    signals["time_s"] += np.arange(1, ROWS + 1) * 1e-3
    signals["vehicle.speed_m_per_s"] += SPEED
    signals["bus.voltage_v"] += 53.0
    signals["bms.charge_a"] += 50.0
    signals["wheel0.mode"] += RUN
    signals["wheel0.direction"] += 1.0  # forward
    for part in ("winding", "switch"):
        signals[f"wheel0.{part}_temperature_c"] += 25.0
    off = ("driver.demand_period_s", "driver.demand_jitter_s", "driver.fault_reset_every_s",
           "brake.torque_loss")  # fmt: skip
    world = {**plant.parameters(DRIVE), **dict.fromkeys(off, 0.0), **parameters}
    return Recording(
        drive=DRIVE, wheels=1, signals=signals, parameters=world,
        most={name: world.get(name, 0.0) for name in LATER}, peak_current_a=(10.0,),
        bus_peak_v=53.0, residual_j=0.0, turned_over_j=1e4, faults=faults, duration_s=ROWS * 1e-3,
    )  # fmt: skip


def with_signals(recording: Recording, changes: Mapping[str, Rows]) -> Recording:
    return replace(recording, signals={**recording.signals, **changes})


def steps(*pieces: tuple[int, float]) -> Rows:
    """Return a signal that has each value from its row on."""
    out = np.zeros(ROWS)
    for row, value in pieces:
        out[row:] = value
    return out


def braked(motor: float, hydraulic: float, demand: float = DEMAND) -> Recording:
    """Return a ride that is braked from the row 1000 on, speed as these torques make it."""
    inertia = DRIVE.vehicle.mass_kg * DRIVE.vehicle.wheel_radius_m
    speed = np.maximum(SPEED - np.cumsum(steps((1000, hydraulic - motor))) / inertia * 1e-3, 0.0)
    return with_signals(quiet(), {
        "vehicle.speed_m_per_s": speed,
        "driver.brake_nm": steps((1000, demand)),
        "wheel0.motor_torque_nm": steps((1000, motor)),
        "wheel0.hydraulic_torque_nm": steps((1000, hydraulic)),
    })  # fmt: skip


def found(recording: Recording, invariant: str) -> Finding:
    several = [finding for finding in judged(recording) if finding.invariant == invariant]
    return max(several, key=lambda finding: finding.share)


def violated(recording: Recording) -> set[str]:
    return {finding.invariant for finding in judge.violations(judged(recording))}


def test_a_quiet_ride_and_a_good_stop_violate_nothing() -> None:
    assert violated(quiet()) == set()
    assert violated(braked(-DEMAND, 0.0)) == set()
    assert violated(braked(0.0, DEMAND)) == set()
    names = {finding.invariant for finding in judged(quiet())}
    assert names == {*judge.INVARIANTS, *judge.HEALTHY, *judge.OPEN}


@pytest.mark.parametrize(("rows", "wrong"), [(5, False), (6, True)])
def test_driving_torque_while_braking(rows: int, wrong: bool) -> None:
    limit = max(2.0, 0.05 * DRIVE.motor.rated_torque_nm)
    torque = steps((1000, -DEMAND), (3000, limit + 0.1), (3000 + rows, -DEMAND))
    recording = with_signals(braked(-DEMAND, 0.0), {"wheel0.motor_torque_nm": torque})
    recording = with_signals(recording, {"vehicle.speed_m_per_s": np.full(ROWS, SPEED)})
    assert ("driving_while_braking" in violated(recording)) is wrong
    assert found(recording, "driving_while_braking").value == rows
    backwards = {"vehicle.speed_m_per_s": np.full(ROWS, -SPEED), "wheel0.motor_torque_nm": -torque}
    assert ("driving_while_braking" in violated(with_signals(recording, backwards))) is wrong


def test_torque_that_the_driver_has_just_asked_for_may_go_down_at_its_rate() -> None:
    ends = 1000 + round(1e3 * DRIVE.motor.max_torque_nm / DRIVE.control.torque_rate_nm_per_s)
    torque = np.interp(np.arange(ROWS), [0, 1000, ends], [20.0, 20.0, 0.0])
    recording = with_signals(braked(0.0, DEMAND), {"wheel0.motor_torque_nm": torque})
    assert "driving_while_braking" not in violated(recording)


@pytest.mark.parametrize(("beyond", "wrong"), [(4.0, False), (8.0, True)])
def test_excess_of_both_brakes(beyond: float, wrong: bool) -> None:
    lost = motion.coasting_nm(DRIVE, np.array([SPEED / DRIVE.vehicle.wheel_radius_m]))[0]
    recording = braked(0.0, DEMAND + beyond + (lost if wrong else 0.0))
    assert ("excess_braking" in violated(recording)) is wrong
    short = steps((1000, DEMAND), (2000, 3.0 * DEMAND), (2005, DEMAND))
    spike = with_signals(braked(0.0, DEMAND), {"wheel0.hydraulic_torque_nm": short})
    assert "excess_braking" not in violated(spike)


@pytest.mark.parametrize(("times", "wrong"), [(0.9, False), (1.1, True)])
def test_a_hold_below_the_configured_standstill_is_no_excess(times: float, wrong: bool) -> None:
    rad_s = DRIVE.monitor.standstill_rpm * 2.0 * math.pi / 60.0
    rolls = np.full(ROWS, -times * rad_s * DRIVE.vehicle.wheel_radius_m)
    recording = braked(0.0, -3.0 * DEMAND)
    slow = with_signals(recording, {"vehicle.speed_m_per_s": rolls})
    assert ("excess_braking" in violated(slow)) is wrong


@pytest.mark.parametrize(("slope", "wrong"), [(0.2, False), (0.05, True), (-0.2, True)])
def test_a_hold_just_before_standstill_may_be_what_the_slope_needs(
    slope: float, wrong: bool
) -> None:
    vehicle = DRIVE.vehicle
    needs_nm = vehicle.mass_kg * 9.80665 * 0.2 * vehicle.wheel_radius_m  # on the first slope
    recording, stands = braked(0.0, DEMAND), 4000
    speed = np.interp(np.arange(ROWS), [1000, stands], [SPEED, 0.0])
    distance = np.cumsum(speed) * 1e-3
    climbs = {
        "vehicle.speed_m_per_s": speed,
        "vehicle.distance_m": distance,
        "vehicle.height_m": slope * distance,
        "wheel0.hydraulic_torque_nm": steps((1000, DEMAND), (stands - 150, needs_nm)),
    }
    assert needs_nm > 2.0 * DEMAND
    assert ("excess_braking" in violated(with_signals(recording, climbs))) is wrong
    early = climbs | {"wheel0.hydraulic_torque_nm": steps((1000, needs_nm))}
    assert "excess_braking" in violated(with_signals(recording, early))


@pytest.mark.parametrize(("cogging", "wrong"), [(2.0, True), (8.0, False)])
def test_cogging_is_no_excess(cogging: float, wrong: bool) -> None:
    lost = motion.coasting_nm(DRIVE, np.array([SPEED / DRIVE.vehicle.wheel_radius_m]))[0]
    recording = braked(0.0, DEMAND + 8.0 + lost)
    cogs = {**recording.parameters, "motor.cogging_torque_nm": cogging}
    assert ("excess_braking" in violated(replace(recording, parameters=cogs))) is wrong


def test_a_demand_that_falls_counts_until_the_brake_can_have_followed() -> None:
    falls = {"driver.brake_nm": steps((1000, DEMAND), (2000, 0.2 * DEMAND)),
             "wheel0.hydraulic_torque_nm": steps((1000, DEMAND), (2150, 0.2 * DEMAND))}  # fmt: skip
    assert "excess_braking" not in violated(with_signals(braked(0.0, DEMAND), falls))
    stays = falls | {"wheel0.hydraulic_torque_nm": steps((1000, DEMAND))}
    assert "excess_braking" in violated(with_signals(braked(0.0, DEMAND), stays))


def test_braking_that_nobody_asked_for() -> None:
    recording = with_signals(quiet(), {"wheel0.motor_torque_nm": steps((3000, -6.0))})
    assert "braking_without_demand" in violated(recording)
    lifts = {"driver.drive_nm": np.full(ROWS, -6.0)}
    assert "braking_without_demand" not in violated(with_signals(recording, lifts))
    backwards = {
        "driver.drive_nm": np.full(ROWS, 6.0),
        "vehicle.speed_m_per_s": np.full(ROWS, -SPEED),
    }
    starts = {"wheel0.motor_torque_nm": np.full(ROWS, 6.0)}
    assert "braking_without_demand" not in violated(with_signals(quiet(), backwards | starts))


def test_lift_off_braking_of_a_wheel_that_rolls_back_is_a_demand() -> None:
    rolls = {"vehicle.speed_m_per_s": np.full(ROWS, -SPEED)}
    back = with_signals(quiet(), rolls | {"wheel0.motor_torque_nm": steps((3000, 6.0))})
    lifts = {"driver.drive_nm": np.full(ROWS, -6.0)}
    assert "braking_without_demand" not in violated(with_signals(back, lifts))
    reverse = {"wheel0.direction": np.full(ROWS, 2.0)}
    assert "braking_without_demand" in violated(with_signals(back, lifts | reverse))


def test_the_least_of_an_open_bridge_and_a_short_circuit_may_brake() -> None:
    top = DRIVE.motor.max_speed_rpm * math.pi / 30.0
    low_v = 0.6 * math.sqrt(3.0) * DRIVE.motor.flux_linkage_wb * DRIVE.motor.pole_pairs * top
    speed = np.full(ROWS, top * DRIVE.vehicle.wheel_radius_m)
    bus = {"vehicle.speed_m_per_s": speed, "bus.voltage_v": np.full(ROWS, low_v)}
    opened, _ = motion.open_nm(DRIVE, np.array([top]), np.array([low_v]))
    assert opened[0] > judge.WRONG_NM
    torque = {"wheel0.motor_torque_nm": np.full(ROWS, -opened[0])}
    assert "braking_without_demand" not in violated(with_signals(quiet(), bus | torque))
    assert "braking_without_demand" in violated(with_signals(quiet(), torque))


def test_current_bus_and_temperatures() -> None:
    trip_a = loops.overcurrent_pu(DRIVE) * DRIVE.inverter.current_full_scale_a
    assert violated(replace(quiet(), peak_current_a=(1.29 * trip_a,))) == set()
    assert violated(replace(quiet(), peak_current_a=(1.31 * trip_a,))) == {"current"}
    rating = derived.device_voltage_v(DRIVE)
    assert violated(replace(quiet(), bus_peak_v=rating)) == set()
    assert violated(replace(quiet(), bus_peak_v=rating + 0.1)) == {"bus_voltage"}
    switch_c = DRIVE.inverter.max_switch_temperature_c
    assert switch_c is not None
    for part, end_c in (("winding", DRIVE.motor.max_winding_temperature_c), ("switch", switch_c)):
        name = f"wheel0.{part}_temperature_c"
        hot = {name: np.linspace(end_c, end_c + 12.0, ROWS)}  # 10 K and a fifth of 12 K
        assert violated(with_signals(quiet(), hot)) == set()
        hotter = {name: np.linspace(end_c, end_c + 13.0, ROWS)}
        assert violated(with_signals(quiet(), hotter)) == {"temperature"}


@pytest.mark.parametrize(("share", "wrong"), [(1.0, False), (0.9, False), (0.6, True), (0.0, True)])
def test_stopping_distance(share: float, wrong: bool) -> None:
    recording = braked(0.0, share * 2.0 * DEMAND, 2.0 * DEMAND)
    assert ("stopping_distance" in violated(recording)) is wrong


def test_a_brake_that_is_dead_leaves_no_claim_to_a_distance() -> None:
    recording = braked(0.0, 0.0)
    assert "stopping_distance" in violated(recording)
    most = {**recording.most, "brake.torque_loss": 1.0}
    assert "stopping_distance" not in violated(replace(recording, most=most))


def test_energy_that_comes_from_nowhere() -> None:
    assert (
        violated(replace(quiet(), residual_j=0.99e-4 * (1e4 + 12.5 * DRIVE.vehicle.mass_kg)))
        == set()
    )
    assert violated(
        replace(quiet(), residual_j=1.01e-4 * (1e4 + 12.5 * DRIVE.vehicle.mass_kg))
    ) == {"energy"}


def latched(ends: int, mode: float = FAULT) -> dict[str, Rows]:
    code = reasons.codes()["OVERCURRENT"]
    return {
        "wheel0.fault_reason": steps((2000, code), (ends, 0.0)),
        "wheel0.mode": steps((0, RUN), (2000, FAULT), (ends, mode)),
    }


def test_a_latched_fault_stays_until_it_is_acknowledged_at_rest() -> None:
    fault = ("current_a_dead",)
    assert violated(with_signals(quiet(fault), latched(ROWS))) == set()
    assert violated(with_signals(quiet(fault), latched(3000, RUN))) == {"healed"}
    assert violated(with_signals(quiet(fault), latched(3000, BOOT))) == set()  # a restart
    stands = {"vehicle.speed_m_per_s": np.zeros(ROWS)}
    acknowledged = quiet(fault, **{"driver.fault_reset_every_s": 1.0})
    assert violated(with_signals(acknowledged, latched(3000, RUN) | stands)) == set()
    assert violated(with_signals(quiet(fault), latched(3000, RUN) | stands)) == {"healed"}
    assert violated(with_signals(acknowledged, latched(3000, RUN))) == {"healed"}


@pytest.mark.parametrize(("times", "wrong"), [(5, False), (6, True)])
def test_modes_and_reasons_that_flicker(times: int, wrong: bool) -> None:
    fault = ("current_a_dead",)
    flickers = steps(*((2000 + 100 * k, float((k + 1) % 2)) for k in range(times)))
    mode = {"wheel0.mode": RUN + flickers * (LIMP - RUN)}
    assert violated(with_signals(quiet(fault), mode)) == ({"changes"} if wrong else set())
    warns = {"wheel0.warning_reason": flickers * reasons.codes()["ROTOR_UNCERTAIN"]}
    assert violated(with_signals(quiet(fault), warns)) == ({"changes"} if wrong else set())
    limits = {"wheel0.reason": flickers}
    assert violated(with_signals(quiet(), limits)) == ({"changes"} if wrong else set())


def test_the_sequence_of_a_start_is_no_flicker() -> None:
    start = steps(*((2000 + 10 * k, float(mode)) for k, mode in enumerate((0, 1, 2, 3, 4, 5, 4))))
    mode = np.where(np.arange(ROWS) < 2000, RUN, start)
    reason = np.where(mode == RUN, 0.0, mode)
    signals = {"wheel0.mode": mode, "wheel0.reason": reason}
    assert "changes" not in violated(with_signals(quiet(), signals))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("wheel0.estimate_nm", math.nan),
        ("vehicle.speed_m_per_s", math.inf),
        ("wheel0.command_nm", 1.01 * DRIVE.motor.max_torque_nm),
        ("wheel0.command_nm", -1.01 * DRIVE.motor.max_torque_nm),
        ("wheel0.hydraulic_command_nm", -0.1),
        ("wheel0.hydraulic_command_nm", 1.01 * DRIVE.brake.max_hydraulic_torque_nm),
        ("wheel0.available_nm", -0.1),
    ],
)
def test_numbers_that_are_none_or_out_of_range(name: str, value: float) -> None:
    recording = quiet()
    values = recording.signals[name].copy()
    values[-1] = value
    with np.errstate(invalid="ignore"):
        assert "finite" in violated(with_signals(recording, {name: values}))


def test_a_healthy_run_has_no_warning() -> None:
    code = reasons.codes()["FLUX_WEAK"]
    warns = {"wheel0.warning_reason": steps((2000, code), (2001, 0.0))}
    assert violated(with_signals(quiet(), warns)) == {"warning"}
    assert found(with_signals(quiet(), warns), "warning").text == "FLUX_WEAK"
    assert violated(with_signals(quiet(("current_a_dead",)), warns)) == set()
    limps = {"wheel0.mode": steps((0, RUN), (2000, LIMP), (2001, RUN))}
    assert found(with_signals(quiet(), limps), "warning").text == "LIMP"


@pytest.mark.parametrize(("beyond_a", "wrong"), [(2.5, False), (2.8, True)])
def test_charge_beyond_the_limit_that_is_sent(beyond_a: float, wrong: bool) -> None:
    assert DRIVE.battery.max_charge_current_a == 50.0
    recording = with_signals(quiet(), {"battery.current_a": steps((2000, -50.0 - beyond_a))})
    assert found(recording, "charge_current").violated is wrong
    assert violated(recording) == set()  # shown, but no violation
    peak = steps((2000, -90.0), (2050, -40.0))
    assert not found(with_signals(quiet(), {"battery.current_a": peak}), "charge_current").violated
    falls = {
        "bms.charge_a": steps((0, 50.0), (2900, 10.0)),
        "battery.current_a": steps((2000, -50.0), (3000, -10.0)),
    }
    assert not found(with_signals(quiet(), falls), "charge_current").violated


def test_a_value_that_is_no_number_is_a_violation() -> None:
    assert Finding("current", 0, 0.0, math.nan, 1.0, "A").violated
    assert not Finding("current", 0, 0.0, 1.0, 1.0, "A").violated
    assert Finding("healed", 0, 0.0, 1.0, 0.0, "1").share == math.inf
