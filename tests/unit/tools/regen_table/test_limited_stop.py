# SPDX-License-Identifier: Apache-2.0
"""The ideal stop inside a drive's limits: each limit against a figure derived by hand.

LOSSLESS is the paper's motor with copper loss only. With i_d = 0, the best there, P = 1.5 (R i^2 +
w psi i) and T = 1.5 p psi i.
"""

import itertools
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from regen_table import (
    STOP_LIMITS,
    STRATEGIES,
    ideal,
    joint,
    limited_stop,
    loops,
    models,
    schema,
    stop_limits,
)

Change = Callable[[dict[str, Any]], schema.Drive]
ROOT = Path(__file__).resolve().parents[4]
MOTORS = {
    path.stem: schema.load(path) for path in sorted((ROOT / "tools" / "motors").glob("*.toml"))
}
# For what takes seconds a drive: magnets on the surface and inside. In a long run all.
TWO_KINDS = {
    name: drive
    for name, drive in MOTORS.items()
    if name in ("lu2013", "ipm400v") or "HUBFOC_FOR_LONG" in os.environ
}
SERIES = "series_optimal"
COPPER_ONLY = {
    "motor.iron_loss_resistance_ohm": None,
    "inverter.turn_on_loss_j_per_a": 0.0,
    "inverter.turn_off_loss_j_per_a": 0.0,
    "inverter.dead_time_s": 0.0,
    "inverter.switch_resistance_ohm": 0.0,
}
POLE_PAIRS, PSI, R, RADIUS_M, WHEELS = 23, 0.0204, 0.031, 0.25, 4
OPEN_V, R_S = 53.0, 0.012


def torque_of_power_nm(power_w: float, speed_rad_s: float) -> float:
    """Return the torque of a DC power of LOSSLESS, the root nearest zero: 1.5 R i^2 + E i = P."""
    emf = 1.5 * POLE_PAIRS * PSI * speed_rad_s
    current = (-emf + math.sqrt(emf**2 + 6.0 * R * power_w)) / (3.0 * R)
    return 1.5 * POLE_PAIRS * PSI * current


def at_speed(trace: limited_stop.Trace, kmh: float) -> int:
    return int(np.argmin(np.abs(trace.speed_rad_s - kmh / 3.6 / RADIUS_M)))


def test_a_charge_limit_leaves_the_torque_of_its_power(change: Change) -> None:
    """40 A into 53 V behind 12 milliohm are (53 + 0.48) * 40 = 2139.2 W: 534.8 W a motor.

    At 40 km/h, 44.44 rad/s, that takes 534.8/44.44 = 12.03 N m and the copper loss of its 17.5 A.
    """
    drive = change({**COPPER_ONLY, "battery.max_charge_current_a": 40.0,
                    "battery.polarisation_resistance_ohm": 0.0})  # fmt: skip
    trace = limited_stop.trace_of(drive, SERIES, 40.0, 50.0, 25.0)
    k = at_speed(trace, 40.0)
    expected = torque_of_power_nm(-(OPEN_V + R_S * 40.0) * 40.0 / WHEELS, trace.speed_rad_s[k])
    assert expected == pytest.approx(-12.36, abs=0.01)
    assert trace.reason[k] == "charge_current"
    assert trace.charge_a[k] == pytest.approx(40.0, rel=1e-12)
    assert trace.bus_v[k] == pytest.approx(53.48, rel=1e-12)
    assert trace.motor_nm[k] == pytest.approx(expected, rel=1e-3)
    assert trace.hydraulic_nm[k] == pytest.approx(40.0 + expected, rel=1e-3)
    # Below the speed at which 40 N m return less the demand decides: 0.155 * 56.8^2 W of copper.
    slow = at_speed(trace, 10.0)
    assert trace.reason[slow] == "demand"
    assert trace.motor_nm[slow] == pytest.approx(-40.0, rel=1e-6)


def test_fold_back_ends_where_the_current_makes_its_own_voltage(change: Change) -> None:
    """57.5 V, all 200 A up to 57.232 V, none at 58.4 V.

    q = 200 (58.4 - 57.5 - 0.012 q) / 1.168, so q = 180/3.568 = 50.45 A at 58.105 V.
    """
    drive = change({**COPPER_ONLY, "battery.open_circuit_voltage_v": 57.5,
                    "battery.polarisation_resistance_ohm": 0.0})  # fmt: skip
    trace = limited_stop.trace_of(drive, SERIES, 40.0, 60.0, 25.0)
    k = at_speed(trace, 50.0)
    assert trace.reason[k] == "fold_back"
    assert trace.charge_a[k] == pytest.approx(180.0 / 3.568, rel=1e-9)
    assert trace.bus_v[k] == pytest.approx(57.5 + 0.012 * 180.0 / 3.568, rel=1e-9)
    expected = torque_of_power_nm(-58.1054 * 50.448 / WHEELS, trace.speed_rad_s[k])
    assert trace.motor_nm[k] == pytest.approx(expected, rel=1e-3)
    without = [name for name in STOP_LIMITS if name != "fold_back"]
    free = limited_stop.trace_of(drive, SERIES, 40.0, 60.0, 25.0, limits=without)
    assert free.reason[k] == "max_torque_or_power"
    assert free.motor_nm[k] == pytest.approx(-2094.0 / trace.speed_rad_s[k], rel=1e-6)


def test_a_full_battery_stores_no_energy(change: Change) -> None:
    """The management fades the charge current over the last 2 % of charge."""
    found = limited_stop.stop(change({}), SERIES, 20.0, 40.0, 25.0, soc=1.0)
    assert found.stored_share_of_kinetic <= 0.0
    half = limited_stop.trace_of(change({}), SERIES, 40.0, 60.0, 25.0, soc=0.995)
    assert np.max(half.charge_a) == pytest.approx(200.0 * 0.005 / 0.02, rel=1e-3)


def test_the_rate_shapes_the_demand(change: Change) -> None:
    """400 N m/s: 20 N m after 50 ms; the hydraulic brake adds nothing to a demand within limits."""
    drive = change({})
    trace = limited_stop.trace_of(drive, SERIES, 40.0, 40.0, 25.0)
    time = np.cumsum(trace.seconds) - 0.5 * trace.seconds
    rising = time < 0.1
    assert trace.motor_nm[rising] == pytest.approx(-400.0 * time[rising], abs=1e-6)
    assert trace.hydraulic_nm[rising] == pytest.approx(0.0, abs=1e-6)
    # 4 * 40/(0.25 * 660) m/s2, and half the rise's time longer.
    stopped = limited_stop.stop(drive, SERIES, 40.0, 40.0, 25.0)
    assert stopped.stop_time_s == pytest.approx(40.0 / 3.6 / 0.969697 + 0.05, rel=1e-5)


def test_blend_out_and_winding_temperature_take_their_shares() -> None:
    """Half of 115 N m in the middle between 230 and 90 r/min; half of 40 N m at 140 degC."""
    trace = limited_stop.trace_of(MOTORS["ipm400v"], SERIES, 115.0, 60.0, 25.0)
    k = int(np.argmin(np.abs(trace.speed_rad_s - 160.0 * math.pi / 30.0)))
    rpm = trace.speed_rad_s[k] * 30.0 / math.pi
    friction = 0.3 + 2e-4 * trace.speed_rad_s[k]
    assert trace.reason[k] == "blend_out"
    assert -trace.motor_nm[k] + friction == pytest.approx(115.0 * (rpm - 90.0) / 140.0, rel=1e-6)
    hot = limited_stop.trace_of(MOTORS["lu2013"], SERIES, 40.0, 40.0, 140.0)
    k = at_speed(hot, 30.0)
    assert (hot.reason[k], hot.motor_nm[k]) == (
        "winding_temperature", pytest.approx(-20.0, rel=1e-6)
    )  # fmt: skip


def test_phase_current_leaves_the_maximum_torque_per_ampere(change: Change) -> None:
    """46 A in 1.5 * 23 * 0.0204 N m/A, i_d = 0: 32.37 N m."""
    limits = {"motor.max_phase_current_a": 46.0, "control.field_weakening_current_a": 40.0}
    drive = change({**COPPER_ONLY, **limits})
    trace = limited_stop.trace_of(drive, SERIES, 40.0, 40.0, 25.0)
    k = at_speed(trace, 30.0)
    assert trace.reason[k] == "phase_current"
    assert trace.motor_nm[k] == pytest.approx(-1.5 * POLE_PAIRS * PSI * 46.0, rel=1e-4)


def test_voltage_leaves_what_a_search_over_all_currents_finds() -> None:
    """At 9000 r/min, hot: the most power returned over a grid of both currents in the limits."""
    drive = MOTORS["ipm400v"]
    trace = limited_stop.trace_of(drive, SERIES, 84.0, 210.0, 130.0, soc=0.5)
    k = int(np.argmin(np.abs(trace.speed_rad_s - 9000.0 * math.pi / 30.0)))
    assert trace.reason[k] == "voltage"
    motor, omega = models.machine(drive, 130.0), trace.speed_rad_s[k] * 3.0
    # 31/32 * 127/128 of the circle that the shortest pulse leaves, less what half a turn's share
    # of a period shortens the mean.
    limit = stop_limits.largest_voltage_v(drive, np.array([omega]), trace.bus_v[k : k + 1])[0]
    half = 0.5 * omega / 10e3
    circle = trace.bus_v[k] / math.sqrt(3.0)
    assert 0.9 * circle < limit < 0.96887 * 127.0 / 128.0 * circle * math.sin(half) / half
    angle = np.linspace(math.pi, 1.5 * math.pi, 2001)[:, np.newaxis]
    length = np.linspace(0.0, 200.0, 1001)
    state = models.evaluate(
        motor, models.bridge(drive), omega, length * np.cos(angle), length * np.sin(angle)
    )
    power = np.where(state.voltage_v <= limit, state.dc_power_w, np.inf)
    assert trace.state.voltage_v[k] <= limit * (1.0 + 1e-6)
    assert trace.state.current_a[k] <= 200.0 * (1.0 + 1e-6)
    assert trace.state.dc_power_w[k] == pytest.approx(np.min(power), rel=2e-3)
    assert trace.state.dc_power_w[k] <= np.min(power) * (1.0 - 5e-4)  # a grid is a little worse


@pytest.mark.parametrize("drive", MOTORS.values(), ids=MOTORS)
def test_without_limits_it_is_the_plain_ideal(drive: schema.Drive) -> None:
    """But for the i_d that saves iron loss, and the friction, which is part of the demand here."""
    friction = models.machine(drive, 25.0).friction_nm
    demand, speed = 0.8 * drive.motor.rated_torque_nm, 25.0
    plain = ideal.stop(drive, SERIES, demand, speed, 25.0, soc=0.5, battery="dynamic")
    found = limited_stop.stop(drive, SERIES, demand + friction, speed, 25.0, 0.5, ())
    assert found.stored_share_of_kinetic == pytest.approx(plain.stored_share_of_kinetic, abs=2e-3)
    assert found.stored_share_of_kinetic >= plain.stored_share_of_kinetic - 2e-4
    assert found.limits == ()


@pytest.mark.parametrize("drive", MOTORS.values(), ids=MOTORS)
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_energy_is_conserved(drive: schema.Drive, strategy: str) -> None:
    for share, soc, warm in itertools.product((0.2, 1.1), (0.3, 0.97), (0.0, 120.0)):
        found = limited_stop.stop(
            drive, strategy, share * drive.motor.rated_torque_nm, 20.0, warm, soc
        )
        assert abs(found.residual_relative) < 2e-5
        kept = sum(found.hydraulic_by_reason_j.values())
        assert kept == pytest.approx(found.energy_j.hydraulic, abs=1e-9 * found.kinetic_energy_j)
        assert found.impossible_s == 0.0


@pytest.mark.parametrize("drive", TWO_KINDS.values(), ids=TWO_KINDS)
def test_a_limit_never_lets_a_stop_store_more(drive: schema.Drive) -> None:
    """Speed over time is the same with and without; the torque rate alone changes it."""
    top = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    arguments = (drive, SERIES, drive.motor.rated_torque_nm, 0.9 * top)
    for soc, warm in ((0.2, 125.0), (0.96, 20.0)):
        all_of_them = limited_stop.stop(*arguments, warm, soc).stored_share_of_kinetic
        for name in STOP_LIMITS:
            if name != "torque_rate":
                others = [other for other in STOP_LIMITS if other != name]
                left = limited_stop.stop(*arguments, warm, soc, others).stored_share_of_kinetic
                assert left >= all_of_them - 2e-5, name


def test_too_little_voltage_for_the_speed_is_named() -> None:
    """640 r/min make 31.4 V a phase; 75 A take 8.8 V of it, and 40 V leave 22.2 V at most."""
    paper = MOTORS["lu2013"]
    low = paper.battery.model_copy(update={"open_circuit_voltage_v": 40.0})
    drive = paper.model_copy(update={"battery": low})
    assert limited_stop.stop(drive, SERIES, 10.0, 60.0, 25.0).impossible_s > 1.0
    assert limited_stop.stop(drive, SERIES, 10.0, 40.0, 25.0).impossible_s == 0.0
    assert limited_stop.stop(paper, SERIES, 10.0, 60.0, 25.0).impossible_s == 0.0


def test_free_travel_takes_its_rated_torque_and_no_optimum() -> None:
    trace = limited_stop.trace_of(MOTORS["lu2013"], "parallel_free_travel", 60.0, 40.0, 25.0)
    assert trace.motor_nm[at_speed(trace, 20.0)] == pytest.approx(-40.0, rel=1e-6)
    slow = at_speed(trace, 3.0)  # 32 r/min, T_opt is 15 N m
    assert trace.motor_nm[slow] == pytest.approx(-40.0, rel=1e-6)


@pytest.mark.parametrize("drive", TWO_KINDS.values(), ids=TWO_KINDS)
def test_neither_steps_nor_searches_matter(
    monkeypatch: pytest.MonkeyPatch, drive: schema.Drive
) -> None:
    """Four times the steps and a search of the argument, not of the value."""
    for soc, share in ((0.5, 1.2), (0.96, 0.5)):
        arguments = (drive, SERIES, share * drive.motor.rated_torque_nm, 24.0, 60.0, soc)
        with monkeypatch.context() as patch:
            coarse = limited_stop.stop(*arguments).stored_share_of_kinetic
            patch.setattr(limited_stop, "STEPS", 4 * limited_stop.STEPS)
            fine = limited_stop.stop(*arguments).stored_share_of_kinetic
            patch.setattr(joint, "AUDIT", joint.EXACT)
            exact = limited_stop.stop(*arguments).stored_share_of_kinetic
        assert fine == pytest.approx(coarse, abs=1e-4)
        assert exact == pytest.approx(fine, abs=1e-5)


@pytest.mark.parametrize(
    ("changes", "stored_percent"),
    [
        ((), (81.5, 82.7)),
        (("inverter.dead_time_s=1e-6",), (81.1, 74.3)),
        (("inverter.dead_time_s=1e-6", "inverter.min_pulse_s=1e-6"), (81.1, 81.4)),
    ],
)
def test_a_dead_time_costs_by_the_voltage_that_its_shortest_pulse_takes(
    changes: tuple[str, ...], stored_percent: tuple[float, float]
) -> None:
    """Figures of DERIVATIONS, Dead time: from half and 95 % of the largest speed, nearly empty."""
    drive = schema.load("m365", changes)
    top_kmh = 3.6 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    for share, percent in zip((0.5, 0.95), stored_percent, strict=True):
        at = (drive, SERIES, 0.5 * drive.motor.rated_torque_nm, share * top_kmh, 25.0, 0.1)
        stop = limited_stop.stop(*at, tuple(STOP_LIMITS))
        assert 100.0 * stop.stored_share_of_kinetic == pytest.approx(percent, abs=0.06)


@pytest.mark.parametrize("frequency_hz", [12e3, 20e3])
def test_ten_dead_times_a_period_are_the_share_of_the_voltage_that_is_missing(
    frequency_hz: float,
) -> None:
    """Two on either side of the top and half a one of compensation, in half periods."""
    for dead_s in (1e-6, 2e-6):
        drive = schema.load(
            "leaf", (f"inverter.dead_time_s={dead_s}", f"inverter.pwm_frequency_hz={frequency_hz}")
        )
        share = 10.0 * dead_s * frequency_hz
        assert 1.0 - loops.modulation_limit(drive) == pytest.approx(share, rel=0.02)
