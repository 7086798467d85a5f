# SPDX-License-Identifier: Apache-2.0
"""A battery that takes nothing is not charged, and pays next to nothing for braking."""

from typing import Any

import hubsim
import numpy as np
import pytest
from hubsim.engine import ROOT
from regen_table import schema
from regen_table.schema import Drive

DRIVES = ("lu2013", "ebike36v", "scooter48v", "ipm400v")
SPEED_SHARES = (0.05, 0.3, 0.6, 0.9, 1.1)  # of the highest speed
MOST_CHARGE_A = 0.2
DRAWN_SHARE = 0.01  # of what the battery gives
WINDOW_ROWS = 100  # 100 ms
ANGLE_S = 0.3  # hall sensors' edges have found their places
TRIMMED_S = 1.0
RELEASED_S = 2.0  # what is charged no longer is let go with 0.5 s
SIGNALS = ("time_s", "battery.current_a", "wheel0.reason", "wheel0.fault_reason")
# A motor's parameters beside the configured ones: resistance, flux, both inductances, switching.
MOTORS: tuple[dict[str, float], ...] = (
    {"motor.phase_resistance_ohm": 0.85},
    {"motor.phase_resistance_ohm": 1.2},
    {"motor.flux_linkage_wb": 1.05},
    {"motor.flux_linkage_wb": 0.95},
    {"motor.d_inductance_h": 1.1, "motor.q_inductance_h": 1.1},
)


def read(name: str) -> Drive:
    return schema.load(ROOT / "tools" / "motors" / f"{name}.toml")


def means(name: str, speed_share: float, plant: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of windows of 100 ms, s, and the battery's mean current in each, A.

    The vehicle weighs as much as a bench permits, so that its speed is constant.
    """
    drive = read(name)
    top_kmh = 3.6 * drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m
    with hubsim.Bench(
        hubsim.load_configuration(ROOT / "tools" / "motors" / f"{name}.toml"),
        record=SIGNALS,
        plant={"vehicle.mass_kg": 1e6, "battery.max_charge_current_a": 0.0, **plant},
        initial_speed_kmh=speed_share * top_kmh,
        drag=False,
        noise=False,
        record_interval_s=0.001,
        demand_nm=drive.motor.max_torque_nm,
    ) as bench:
        rows = bench.run(2.3)
    assert not np.any(rows["wheel0.fault_reason"])
    window = np.ones(WINDOW_ROWS) / WINDOW_ROWS
    mean_a = np.convolve(rows["battery.current_a"], window, "valid")
    return rows["time_s"][WINDOW_ROWS - 1 :], mean_a


def most_drawn_a(name: str) -> float:
    return DRAWN_SHARE * read(name).battery.max_discharge_current_a


@pytest.mark.parametrize("name", DRIVES)
def test_a_battery_that_takes_nothing_is_not_charged(name: str) -> None:
    for speed in SPEED_SHARES:
        time_s, mean_a = means(name, speed, {})
        settled_a = mean_a[time_s > ANGLE_S]
        assert np.min(settled_a) > -MOST_CHARGE_A, speed
        assert np.max(settled_a) < most_drawn_a(name), speed


@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize("wrong", MOTORS)
def test_nor_by_a_motor_that_is_not_as_configured(name: str, wrong: dict[str, float]) -> None:
    """The power at its terminals shows it, without a message of the battery."""
    motor = read(name).motor
    plant = {key: getattr(motor, key.removeprefix("motor.")) * by for key, by in wrong.items()}
    for speed in (0.3, 0.6, 0.9):
        time_s, mean_a = means(name, speed, {**plant, "bms.current_silent": 1.0})
        assert np.min(mean_a[time_s > TRIMMED_S]) > -MOST_CHARGE_A, speed
        assert np.max(mean_a[time_s > RELEASED_S]) < most_drawn_a(name), speed


@pytest.mark.parametrize("filter_s", [0.0, 0.2, 2.0])
@pytest.mark.parametrize("name", ["scooter48v", "ipm400v"])
def test_nor_with_switches_that_lose_nothing_where_the_battery_shows_its_current(
    name: str, filter_s: float
) -> None:
    """A battery's filter delays it: what it has shown after a second is allowed for."""
    plant = {
        "inverter.turn_on_loss_j_per_a": 0.0,
        "inverter.turn_off_loss_j_per_a": 0.0,
        "bms.current_filter_s": filter_s,
    }
    shown = 1.0 - np.exp(-TRIMMED_S / filter_s) if filter_s > 0.0 else 1.0
    _, unseen_a = means(name, 0.6, {**plant, "bms.current_silent": 1.0})
    time_s, mean_a = means(name, 0.6, plant)
    left_a = float(np.min(mean_a[time_s > TRIMMED_S]))
    assert left_a > (1.0 - shown) * float(np.min(unseen_a[time_s > TRIMMED_S])) - 0.02
