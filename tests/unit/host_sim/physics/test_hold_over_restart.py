# SPDX-License-Identifier: Apache-2.0
"""A vehicle held on a slope over a restart, without a link, and when the motor is lost.

The hold is commanded again in the first millisecond. While a restart lasts longer than 50 ms the
brake system has no command and lets go, with the brake's dead time and lag: the vehicle rolls as
far as the pull of the slope lets it, g s t^2/2 until the brake has it again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hubsim import reasons, run
from hubsim.engine import Engine, Rows
from hubsim.run import stops
from hubsim.scenario import Scenario, overrides
from hubsim.sweep.faults_sweep import drive_of
from regen_table.schema import Drive

GRAVITY_M_PER_S2 = 9.80665
WITHOUT_COMMAND_S = 0.05  # until the brake system takes its own path
HOLD, PEDAL = 1.5, 3.0  # times what the slope pulls with
RELEASED_S, HAPPENS_S, END_S, ROLLS_S = 3.5, 4.5, 8.0, 12.0
STANDS_M = 1e-3
STANDSTILL_M_PER_S = 0.3 * 0.25  # monitor.standstill of lu2013
DRIVES = (("lu2013", "hall"), ("lu2013", "encoder"), ("ebike36v", "hall"),
          ("scooter48v", "hall"), ("ipm400v", "angle"))  # fmt: skip
SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "vehicle.distance_m",
    "wheel0.warning_reason",
    "wheel0.fault_reason",
)
TIME, SPEED, DISTANCE, WARNING, FAULT = range(len(SIGNALS))
Event = tuple[float, str, float]


def pull_nm(drive: Drive, slope_percent: float) -> float:
    """Return what the slope pulls with at each wheel."""
    vehicle = drive.vehicle
    weight_nm = vehicle.mass_kg * GRAVITY_M_PER_S2 * vehicle.wheel_radius_m / vehicle.driven_wheels
    return float(weight_nm * abs(slope_percent) / 100.0)


@dataclass
class OnSlope:
    """A vehicle that has stopped on a slope and is held there."""

    drive: Drive
    engine: Engine
    state: bytes
    slope_percent: float

    def happens(self, events: Sequence[Event], end_s: float = END_S) -> Rows:
        """Return the rows from HAPPENS_S on."""
        self.engine.restore(self.state)
        parts, now_s = [], HAPPENS_S
        for at_s, name, value in sorted(events):
            if HAPPENS_S + at_s > now_s:
                parts.append(self.engine.run(HAPPENS_S + at_s - now_s))
                now_s = HAPPENS_S + at_s
            self.engine.set(name, value)
        parts.append(self.engine.run(end_s - now_s))
        return np.concatenate(parts)


def on_slope(config: str, sensor: str, slope_percent: float) -> OnSlope:
    """Return the vehicle at HAPPENS_S, its brake pedal released for a second."""
    drive = drive_of(config, sensor)
    pull = pull_nm(drive, slope_percent)
    drive = overrides.changed(drive, {("driver", "hold_torque_nm"): HOLD * pull}, "the test")
    scenario = Scenario(
        initial_speed_kmh=5.0,
        stop_at_standstill=False,
        max_duration_s=60.0,
        slope_percent=slope_percent,
        record_interval_s=0.001,
    )
    capacitance_f = drive.inverter.bus_capacitance_f * drive.vehicle.driven_wheels
    engine, _ = run.prepare(drive, scenario, Path(), {"bus.capacitance_f": capacitance_f})
    stops.as_one_wheel(engine, drive)
    engine.start()
    engine.choose(SIGNALS)
    engine.set("driver.brake_demand_nm", PEDAL * pull)
    engine.run(RELEASED_S)
    engine.set("driver.brake_demand_nm", 0.0)
    rows = engine.run(HAPPENS_S - RELEASED_S)
    assert np.ptp(rows[-500:, DISTANCE]) < STANDS_M
    return OnSlope(drive, engine, engine.save(), slope_percent)


def moved_m(rows: Rows) -> float:
    return float(np.max(np.abs(rows[:, DISTANCE] - rows[0, DISTANCE])))


def named(rows: Rows) -> set[str]:
    numbers = {int(n) for n in rows[:, WARNING]} | {int(n) for n in rows[:, FAULT]}
    return {reasons.identifier(n) for n in numbers if n != 0}


def restart(at_s: float, duration_s: float, cold: bool = False) -> list[Event]:
    return [
        (at_s, "fault.restart_s", duration_s),
        (at_s, "fault.restart_cold", float(cold)),
        (at_s, "fault.restart", 1.0),
    ]


def rolls_m(vehicle: OnSlope, free_s: float) -> float:
    """Return how far it rolls: free until the brake has come, then stopped by hold less pull."""
    brake = vehicle.drive.brake
    arrives_s = brake.hydraulic_dead_time_s + 3.0 * brake.hydraulic_time_constant_s
    pull_m_per_s2 = GRAVITY_M_PER_S2 * abs(vehicle.slope_percent) / 100.0
    return 0.5 * pull_m_per_s2 * (free_s + arrives_s) ** 2 * (1.0 + 1.0 / (HOLD - 1.0))


@pytest.mark.parametrize("slope", [-20.0, -4.0, 8.0, 20.0])
@pytest.mark.parametrize(("config", "sensor"), DRIVES)
def test_a_restart_interrupts_no_hold(config: str, sensor: str, slope: float) -> None:
    vehicle = on_slope(config, sensor, slope)
    limit_m_per_s = vehicle.drive.driver.direction_change_speed_m_per_s
    for duration_s in (0.0, 0.02, 0.05, 0.2, 0.35, 0.7, 2.0):
        rows = vehicle.happens(restart(0.0, duration_s), 13.0)
        if duration_s <= WITHOUT_COMMAND_S:
            assert moved_m(rows) < STANDS_M
        elif duration_s < 0.4 or np.max(np.abs(rows[:, SPEED])) < limit_m_per_s:
            assert abs(rows[-1, SPEED]) < 1e-3
            assert moved_m(rows) < rolls_m(vehicle, duration_s - WITHOUT_COMMAND_S)
        else:
            assert "HOLD_FAILED" in named(rows), "what is not held is told"


def test_a_restart_during_a_restart_and_one_after_another_interrupt_no_hold() -> None:
    vehicle = on_slope("lu2013", "hall", 8.0)
    again = [(0.1, "fault.restart", 0.0), *restart(0.102, 0.03)]
    third = [(1.0, "fault.restart", 0.0), *restart(1.002, 0.03)]
    assert moved_m(vehicle.happens([*restart(0.0, 0.03), *again, *third])) < STANDS_M


def test_a_cold_start_holds_nothing() -> None:
    vehicle = on_slope("lu2013", "hall", 8.0)
    assert moved_m(vehicle.happens(restart(0.0, 0.02, cold=True))) > 1.0


@pytest.mark.parametrize("pedal_nm", [0.0, 200.0])
@pytest.mark.parametrize("slope", [-20.0, 8.0, 20.0])
def test_a_lost_link_interrupts_no_hold(slope: float, pedal_nm: float) -> None:
    """With the pedal pressed when it is lost, and released afterwards."""
    vehicle = on_slope("lu2013", "hall", slope)
    rows = vehicle.happens(
        [
            (0.0, "driver.brake_demand_nm", pedal_nm),
            (0.5, "driver.silent", 1.0),
            (2.0, "driver.brake_demand_nm", 0.0),
        ]
    )
    assert moved_m(rows) < STANDS_M
    assert named(rows) == {"DEMAND_TIMEOUT"}


@pytest.mark.parametrize(
    "lost",
    [
        ("driver.silent", 1.0),
        ("bus.contactor_open", 1.0),
        ("driver.enable", 0.0),
        ("sensors.hall_stuck_high", 7.0),
        ("fault.restart", 1.0),
    ],
)
@pytest.mark.parametrize("slope", [8.0, 15.0])
def test_a_motor_that_is_lost_while_it_drives_off_leaves_a_held_vehicle(
    slope: float, lost: tuple[str, float]
) -> None:
    """From 5 ms after the pedal on until it has moved.

    It rolls back free until halls, two edges of them after a restart, show standstill's speed.
    """
    vehicle = on_slope("lu2013", "hall", slope)
    motor, radius_m = vehicle.drive.motor, vehicle.drive.vehicle.wheel_radius_m
    edges_m = 2.0 * 2.0 * np.pi * radius_m / (6.0 * motor.pole_pairs)
    pull_m_per_s2 = GRAVITY_M_PER_S2 * slope / 100.0
    seen_s = np.sqrt(2.0 * edges_m / pull_m_per_s2) + STANDSTILL_M_PER_S / pull_m_per_s2
    drive_nm = 1.2 * pull_nm(vehicle.drive, slope)
    for after_s in (0.005, 0.025, 0.1, 0.3):
        rows = vehicle.happens([(0.0, "driver.drive_demand_nm", drive_nm), (after_s, *lost)])
        back_m = float(np.max(np.maximum.accumulate(rows[:, DISTANCE]) - rows[:, DISTANCE]))
        assert back_m < rolls_m(vehicle, seen_s), (lost, after_s)
        assert abs(rows[-1, SPEED]) < 1e-3, (lost, after_s)


@pytest.mark.parametrize(("config", "sensor"), DRIVES)
def test_a_restart_on_a_rolling_vehicle_begins_no_hold(config: str, sensor: str) -> None:
    vehicle = on_slope(config, sensor, 2.0)
    drive_nm = 3.0 * pull_nm(vehicle.drive, 2.0)
    rolling = vehicle.happens([(0.0, "driver.drive_demand_nm", drive_nm)], ROLLS_S)
    assert rolling[-1, SPEED] > 1.2 * vehicle.drive.driver.direction_change_speed_m_per_s
    rows = vehicle.happens(
        [
            (0.0, "driver.drive_demand_nm", drive_nm),
            (ROLLS_S - HAPPENS_S, "driver.drive_demand_nm", 0.0),
            *restart(ROLLS_S - HAPPENS_S + 0.01, 0.02),
        ],
        ROLLS_S + 1.0,
    )
    coasts = rows[rows[:, TIME] > ROLLS_S + 0.05]
    assert np.all(np.diff(coasts[:, SPEED]) > -2.0 * 0.001 * GRAVITY_M_PER_S2 * 0.06)
    assert named(coasts) <= {"OFFSETS_STORED"}
