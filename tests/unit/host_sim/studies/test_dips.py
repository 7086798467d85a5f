# SPDX-License-Identifier: Apache-2.0
"""Dips where the motor must give up its torque at once, derived by hand and simulated."""

import math
from dataclasses import replace

import pytest
from hubsim.sweep.drives import drive_named
from studies.dips import study as dips


def test_derived_dip_by_hand() -> None:
    """40 N m of lu2013, 8 of them kept, 400 N m/s: the motor is there after 80 ms.

    By then the hydraulic brake has had 40 ms of its lag of 60 ms: 32 N m e^(-2/3) are missing. A
    motor that leaves at once leaves 32 N m to a dead time of 40 ms and the lag.
    """
    drive = drive_named("lu2013")
    ramp = dips.derived(drive, 40.0, 40.0, 8.0, 400.0)
    assert ramp.share == pytest.approx(0.8 * math.exp(-2.0 / 3.0), abs=2e-3)
    at_once = dips.derived(drive, 40.0, 40.0, 8.0, 1e9)
    assert at_once.share == pytest.approx(0.8, abs=1e-6)
    assert at_once.seconds == pytest.approx(0.04 + 0.06 * math.log(8.0), abs=5e-4)
    # All of it may be kept.
    assert dips.derived(drive, 40.0, 40.0, 50.0, 400.0) == dips.Dip(0.0, 0.0)


def test_braking_without_returned_power_by_hand() -> None:
    """lu2013 at 40 km/h, 75 A: (260 W of copper + 47 + 45)/(44.4 rad/s) = 7.9 N m."""
    found = dips.lossy_braking_nm(drive_named("lu2013"), 44.4, 53.0)
    assert found == pytest.approx(7.9, rel=0.03)


@pytest.mark.parametrize(
    ("name", "share"), [("lu2013", 1.0), ("scooter48v", 1.0), ("ipm400v", 2.0)]
)
@pytest.mark.parametrize("event", dips.EVENTS)
def test_dips_are_those_that_physics_leaves(name: str, event: str, share: float) -> None:
    found = dips.measure(0, dips.Case(name, event, share))
    assert found.derived_share > 0.2, "an event that takes little shows nothing"
    assert found.within


def test_a_dip_that_is_larger_or_longer_than_the_derived_one_is_found() -> None:
    good = dips.Outcome(0, "lu2013", dips.CONTACTOR, 30.0, 0.5, 0.1, 0.5, 0.1, 8.0)
    assert good.within
    assert not replace(good, measured_share=0.53).within
    assert not replace(good, measured_s=0.12).within
