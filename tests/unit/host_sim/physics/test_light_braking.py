# SPDX-License-Identifier: Apache-2.0
"""A light brake adds to what coasting does, and the battery does not pay for it."""

import os
from pathlib import Path

import hubsim
import numpy as np
import pytest
from hubsim.engine import ROOT
from regen_table import schema
from regen_table.schema import Drive

DRIVES = ("lu2013", "ebike36v", "scooter48v", "ipm400v")
# Of the highest speed; an open bridge coasts at all of them.
SPEED_SHARES = (0.02, 0.1, 0.3, 0.7)
DEMANDS = (0.0005, 0.002, 0.005, 0.01, 0.02, 0.04, 0.07, 0.2)  # of the rated torque
DEMAND_SHARES = DEMANDS if "HUBFOC_FOR_LONG" in os.environ else DEMANDS[1::2]
TOLERANCE = 1e-3  # of the rated torque, and of the largest power
SETTLED_S = 0.6
SIGNALS = (
    "time_s", "wheel0.motor_torque_nm", "wheel0.hydraulic_torque_nm", "wheel0.dc_w",
    "wheel0.speed_rad_per_s",
)  # fmt: skip


def path_of(name: str) -> Path:
    return ROOT / "tools" / "motors" / f"{name}.toml"


def read(name: str) -> Drive:
    return schema.load(path_of(name))


def settled(
    name: str, speed_share: float, demand_nm: float = 0.0, drive_nm: float = 0.0
) -> tuple[float, float]:
    """Return braking torque of motor, bearings and hydraulic brake, and power out of the bus.

    Of one wheel at constant speed: the vehicle weighs as much as a bench permits.
    """
    drive = read(name)
    motor = drive.motor
    radius_m = drive.vehicle.wheel_radius_m
    top_kmh = 3.6 * motor.max_speed_rpm * np.pi / 30.0 * radius_m
    with hubsim.Bench(
        hubsim.load_configuration(path_of(name)),
        record=SIGNALS,
        plant={"vehicle.mass_kg": 1e6},
        initial_speed_kmh=speed_share * top_kmh,
        drag=False,
        noise=False,
        record_interval_s=0.001,
        demand_nm=demand_nm,
        drive_nm=drive_nm,
    ) as bench:
        rows = bench.run(SETTLED_S + 0.2)
    late = rows["time_s"] > SETTLED_S
    bearings_nm = (
        motor.friction_torque_nm + motor.viscous_friction_nm_s * rows["wheel0.speed_rad_per_s"]
    )
    braking_nm = bearings_nm - rows["wheel0.motor_torque_nm"] + rows["wheel0.hydraulic_torque_nm"]
    return float(np.mean(braking_nm[late])), float(np.mean(rows["wheel0.dc_w"][late]))


@pytest.mark.parametrize("pedal", ["brake", "accelerator"])
@pytest.mark.parametrize("name", DRIVES)
def test_a_light_brake_adds_to_coasting_and_draws_no_power(name: str, pedal: str) -> None:
    drive = read(name)
    rated_nm, most_w = drive.motor.rated_torque_nm, drive.motor.max_power_w
    for speed in SPEED_SHARES:
        before_nm, _ = settled(name, speed)
        for share in DEMAND_SHARES:
            demand_nm = share * rated_nm
            braking_nm, drawn_w = (
                settled(name, speed, demand_nm=demand_nm)
                if pedal == "brake"
                else settled(name, speed, drive_nm=-demand_nm)
            )
            where = f"{speed} of the highest speed, {demand_nm} N m"
            assert braking_nm > before_nm - TOLERANCE * rated_nm, where
            assert braking_nm > demand_nm - TOLERANCE * rated_nm, where
            assert drawn_w < TOLERANCE * most_w, where
            before_nm = braking_nm


@pytest.mark.parametrize("name", DRIVES)
def test_lift_off_braking_goes_no_further_than_the_battery_pays_for_nothing(
    name: str,
) -> None:
    """Slowly enough all torques but small ones cost energy; the hydraulic brake has the rest."""
    drive = read(name)
    for speed in (0.05, 0.1, 0.2):
        demand_nm = drive.motor.rated_torque_nm
        braking_nm, drawn_w = settled(name, speed, drive_nm=-demand_nm)
        assert drawn_w < TOLERANCE * drive.motor.max_power_w, speed
        assert braking_nm == pytest.approx(demand_nm, rel=0.02), speed
