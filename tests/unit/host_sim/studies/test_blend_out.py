# SPDX-License-Identifier: Apache-2.0
"""Stops through the blend-out: jerk, direction of the motor torque, standing still on slopes."""

import numpy as np
import pytest
from hubsim.sweep import cases
from hubsim.sweep.drives import DRIVES, drive_named
from studies.blend_out import study as blend_out
from studies.blend_out.study import Case

COUNT, SEED = 20, 5  # the whole study, with --full, has more


def test_stops_are_smooth_and_stand_on_slopes() -> None:
    found = cases.measured(blend_out.measure, blend_out.draw(DRIVES, COUNT, SEED), workers=1)
    # The hardest: all the brakes are asked for, up a slope that helps.
    found += [blend_out.measure(COUNT, Case(name, 3.0, 10.0)) for name in DRIVES]
    assert [o for o in found if not o.within] == []
    assert {o.drive for o in found} == set(DRIVES)
    assert sum(o.holds for o in found) >= COUNT // 2
    assert any(o.slope_percent < -2.0 for o in found)


@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize(("slope", "share"), [(10.0, 0.3), (10.0, 0.1), (6.0, 0.1)])
def test_hill_hold_begins_where_the_demand_does_not_hold_the_slope(
    name: str, slope: float, share: float
) -> None:
    """Without a hold before standstill 3.5 to 9.3 cm with wheels of hall sensors."""
    found = blend_out.measure(0, blend_out.hill_case(name, slope, share))
    assert found.holds
    assert found.moved_m <= blend_out.MOVED_MAX_M


def test_jerk_is_the_slope_of_the_torque_by_mass_and_radius() -> None:
    """100 N m/s on 50 kg m are 2 m/s3; a step of 5 N m within 50 ms as well."""
    ramp = 0.1 * np.arange(1000.0)
    inside = slice(50, 800)  # the means need rows on both sides
    assert blend_out.jerks(ramp, 50.0)[inside] == pytest.approx(2.0)
    step = np.where(np.arange(1000) < 500, 0.0, 5.0)
    assert np.max(blend_out.jerks(step, 50.0)[inside]) == pytest.approx(2.0)


def test_a_slope_that_the_demand_cannot_stop_on_goes_up() -> None:
    """lu2013 on 10 %: 660 kg / 4 * 9.80665 * 0.0995 * 0.25 m = 40.3 N m a wheel."""
    assert blend_out.pull_nm(drive_named("lu2013"), 10.0) == pytest.approx(40.3, abs=0.1)
    for case in blend_out.draw(("lu2013",), 200, 3):
        if case.slope_percent < 0.0:
            pull = blend_out.pull_nm(drive_named("lu2013"), case.slope_percent)
            assert 30.0 * case.demand_share + pull > 0.0
