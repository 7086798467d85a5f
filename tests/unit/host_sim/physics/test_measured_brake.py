# SPDX-License-Identifier: Apache-2.0
"""A hydraulic brake that reports its torque and dies in a stop: what is found of it stays found.

The motor makes up for it, so the brake gets smaller commands. Were it found healthy by these, the
motor would leave to its share and come back every quarter of a second.
"""

import math

import numpy as np
import pytest
from hubsim import Bench, reasons
from hubsim.engine import ROOT
from hubsim.sweep.drives import DRIVES, drive_named

SHARES = (1.5, 2.5)  # of the rated torque: the motor can make the first alone
FITTED = {"brake_sensor.fitted": 1.0}
COAST_S, SOUND_S, DEAD_S = 0.7, 1.0, 1.2
SLOWEST_M_PER_S = 0.5
SPEED_SHARE = 0.9  # of the largest


def warnings_of(name: str, share: float, dead_s: float) -> list[str]:
    """Return the warnings, one by one, of a stop in which the brake is dead for a time."""
    drive = drive_named(name)
    top_kmh = 3.6 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    with Bench(
        ROOT / "tools" / "motors" / f"{name}.toml",
        initial_speed_kmh=round(SPEED_SHARE * top_kmh, 1),
        stop_at_standstill=True,
        plant=FITTED,
        record=("wheel0.warning_reason", "vehicle.speed_m_per_s"),
        record_interval_s=0.001,
    ) as bench:
        bench.step(COAST_S)
        bench.set("driver.brake_demand_nm", share * drive.motor.rated_torque_nm)
        bench.step(SOUND_S)
        bench.set("brake.torque_loss", 1.0)
        bench.step(dead_s)
        bench.set("brake.torque_loss", 0.0)
        found = bench.run(60.0)
    moves = found["vehicle.speed_m_per_s"] > SLOWEST_M_PER_S
    codes = found["wheel0.warning_reason"][moves]
    changes = np.flatnonzero(np.diff(codes, prepend=0.0))
    names = [reasons.shown(code) for code in codes[changes]]
    # A torque that falls faster than the brake's lag is at first that of a wrong report.
    return [name for name in names if name != "HYDRAULIC_FEEDBACK"]


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", DRIVES)
def test_a_brake_that_is_dead_is_found_once(name: str, share: float) -> None:
    found = warnings_of(name, share, dead_s=60.0)
    assert found in ([], ["HYDRAULIC_WEAK"], ["HYDRAULIC_WEAK", "HYDRAULIC_DEAD"])
    if share == SHARES[-1]:
        assert found == ["HYDRAULIC_WEAK", "HYDRAULIC_DEAD"]


@pytest.mark.parametrize("name", DRIVES)
def test_the_finding_ends_when_the_brake_makes_its_torque_again(name: str) -> None:
    found = warnings_of(name, SHARES[-1], DEAD_S)
    assert found in (
        ["HYDRAULIC_WEAK", "HYDRAULIC_DEAD", ""],
        ["HYDRAULIC_WEAK", "HYDRAULIC_DEAD", "HYDRAULIC_LATE"],
        ["HYDRAULIC_WEAK", "HYDRAULIC_DEAD", "HYDRAULIC_LATE", ""],
    )
