# SPDX-License-Identifier: Apache-2.0
"""Readings of the hall sensors that show a neighbouring sector for one PWM period, twenty a second:
the torque stays within 10 % but for a millisecond, and no torque is taken away."""

import os
from pathlib import Path

import numpy as np
import pytest
from hubsim import run
from hubsim.engine import Engine, Rows
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep.drives import drive_named
from regen_table.schema import Drive

FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
SPEED_SHARES = (0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9) if FOR_LONG else (0.1, 0.3, 0.9)
TORQUE_SHARES = (0.2, 0.5, 1.0) if FOR_LONG else (0.2, 1.0)  # of the rated torque
DISTURBANCES = 100 if FOR_LONG else 10
EACH_S = 0.05  # on average
SETTLED_S = 0.6  # after the demand has begun
HEAVY_KG = 1e6  # the speed stays
SECTOR_DEG = 60.0  # electrical
WITHIN, LONGEST_S = 0.1, 1e-3
SIGNALS = ("wheel0.motor_torque_nm", "wheel0.mode", "wheel0.fault_reason")
TORQUE, MODE, FAULT = range(len(SIGNALS))


def braking(drive: Drive, speed_share: float, torque_share: float) -> Engine:
    """Return a wheel that brakes at a constant speed, a row recorded in every PWM period."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=round(3.6 * speed_share * top, 3),
        stop_at_standstill=False,
        max_duration_s=300.0,
        record_interval_s=1.0 / drive.inverter.pwm_frequency_hz,
        drag=False,
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    stops.as_one_wheel(engine, drive)
    engine.set("vehicle.mass_kg", HEAVY_KG)
    engine.set("driver.brake_demand_nm", torque_share * drive.motor.rated_torque_nm)
    engine.start()
    engine.choose(SIGNALS)
    engine.run(SETTLED_S)
    return engine


def disturbed(engine: Engine, period_s: float, seed: int) -> Rows:
    """Run with single readings of the sector before or behind, at random instants."""
    random = np.random.default_rng(seed)
    most = 2.0 * EACH_S / period_s
    parts = []
    for _ in range(DISTURBANCES):
        parts.append(engine.run(period_s * int(random.integers(1, int(most)))))
        engine.set("fault.rotor_jump_deg", float(random.choice([-SECTOR_DEG, SECTOR_DEG])))
        parts.append(engine.run(period_s))
        engine.set("fault.rotor_jump_deg", 0.0)
    parts.append(engine.run(EACH_S))
    return np.concatenate(parts)


def longest_s(apart: np.ndarray[tuple[int], np.dtype[np.bool_]], period_s: float) -> float:
    edges = np.flatnonzero(np.diff([0, *apart.astype(int), 0]))
    return period_s * float(np.max(edges[1::2] - edges[::2], initial=0))


@pytest.mark.parametrize("torque_share", TORQUE_SHARES)
@pytest.mark.parametrize("speed_share", SPEED_SHARES)
@pytest.mark.parametrize("config", ["lu2013", "ebike36v", "scooter48v"])
def test_a_reading_of_one_period_changes_the_torque_for_less_than_a_millisecond(
    config: str, speed_share: float, torque_share: float
) -> None:
    drive = drive_named(config)
    period_s = 1.0 / drive.inverter.pwm_frequency_hz
    with braking(drive, speed_share, torque_share) as engine:
        steady = float(np.mean(engine.run(EACH_S)[:, TORQUE]))
        rows = disturbed(engine, period_s, seed=1)
        modes = {engine.mode_text(mode) for mode in np.unique(rows[:, MODE])}
    assert steady < 0.0
    apart = np.abs(rows[:, TORQUE] - steady) > WITHIN * abs(steady)
    assert longest_s(apart, period_s) <= LONGEST_S
    assert modes == {"RUN"}
    assert not np.any(rows[:, FAULT])
