# SPDX-License-Identifier: Apache-2.0
"""A vehicle without another brake is kept on a slope after the last demand, hydraulic brake or not.

Without one it creeps as fast as its short-circuited motors brake the pull of the slope:
T = 3/2 p psi^2 w_e R / (R^2 + w_e^2 L^2).
"""

from pathlib import Path

import hubsim
import numpy as np
import pytest
from hubsim.engine import ROOT
from regen_table import schema
from regen_table.schema import Drive
from scipy.optimize import brentq

DRIVES = ("lu2013", "ebike36v", "scooter48v", "ipm400v")
GRAVITY_M_PER_S2 = 9.80665
SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "wheel0.hydraulic_valid",
    "wheel0.fault_reason",
)


def path_of(name: str) -> Path:
    return ROOT / "tools" / "motors" / f"{name}.toml"


def read(name: str) -> Drive:
    return schema.load(path_of(name))


def pull_nm(drive: Drive, slope: float) -> float:
    """Return what the slope pulls with at each wheel, beyond the friction of tyres and bearings."""
    vehicle = drive.vehicle
    weight_nm = vehicle.mass_kg * GRAVITY_M_PER_S2 * vehicle.wheel_radius_m / vehicle.driven_wheels
    resisted = (slope - vehicle.rolling_resistance) / np.hypot(1.0, slope)
    return float(weight_nm * resisted) - drive.motor.friction_torque_nm


def creep_m_per_s(drive: Drive, slope: float) -> float:
    """Return the speed at which short-circuited motors hold a vehicle on a slope, cold winding."""
    motor = drive.motor
    p, psi = motor.pole_pairs, motor.flux_linkage_wb
    r = motor.phase_resistance_ohm + drive.inverter.switch_resistance_ohm
    l_d, l_q = motor.d_inductance_h, motor.q_inductance_h

    def short_nm(w: float) -> float:
        i_q = psi * w * r / (r * r + w * w * l_d * l_q)
        i_d = psi * w * w * l_q / (r * r + w * w * l_d * l_q)
        return 1.5 * p * (psi * i_q - (l_d - l_q) * i_d * i_q)

    pull = pull_nm(drive, slope)

    peak = r / np.sqrt(l_d * l_q)
    return float(brentq(lambda w: short_nm(w) - pull, 0.0, peak)) / p * drive.vehicle.wheel_radius_m


def stopped_uphill(name: str, slope_percent: float, settings: dict[str, float]) -> hubsim.Recording:
    """Return the ride of a vehicle whose link is lost while it brakes to standstill uphill."""
    drive = read(name)
    silence = {"at_s": 0.2, "inject": "can_silence", "until_s": 20.0}
    config = hubsim.load_configuration(path_of(name), {"driver.no_other_brake": True, **settings})
    with hubsim.Bench(
        config,
        record=SIGNALS,
        slope_percent=slope_percent,
        initial_speed_kmh=8.0,
        max_duration_s=20.0,
        demand_nm=1.5 * pull_nm(drive, 0.01 * slope_percent),
        record_interval_s=0.01,
        events={"silence": silence},
    ) as bench:
        return bench.run(20.0)


@pytest.mark.parametrize("name", DRIVES)
def test_the_hydraulic_command_stays_at_standstill(name: str) -> None:
    rows = stopped_uphill(name, 3.0, {})
    assert np.min(rows["vehicle.speed_m_per_s"]) > -1e-3
    assert np.min(rows["wheel0.hydraulic_valid"]) == 1.0
    assert np.max(rows["wheel0.fault_reason"]) == 0.0


@pytest.mark.parametrize(
    ("name", "slope"),
    [("lu2013", 0.08), ("lu2013", 0.04), ("ebike36v", 0.03), ("scooter48v", 0.03),
     ("ipm400v", 0.02)],
)  # fmt: skip
def test_without_a_hydraulic_brake_it_creeps_as_a_short_circuit_allows(
    name: str, slope: float
) -> None:
    rows = stopped_uphill(name, 100.0 * slope, {"brake.max_hydraulic_torque_nm": 0.0})
    back_m_per_s = -rows["vehicle.speed_m_per_s"]
    creep = creep_m_per_s(read(name), slope)
    assert np.max(back_m_per_s) < 1.05 * creep
    assert back_m_per_s[-1] > 0.8 * creep  # of which a light vehicle takes half a minute
    assert np.max(rows["wheel0.fault_reason"]) == 0.0
