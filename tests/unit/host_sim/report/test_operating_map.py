# SPDX-License-Identifier: Apache-2.0
import re

import numpy as np
import pytest
from hubsim.report import operating_map

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_extras import best_map
from tests.unit.host_sim.report.ideal_vehicle import (
    OPTIMUM_NM_PER_RAD_S,
    RADIUS_M,
    STRATEGIES,
    drive,
    three,
)


def test_points_are_samples_with_a_braking_demand_and_nonzero_speed() -> None:
    run = drive("parallel_free_travel")
    found = operating_map.operating_points(run, RADIUS_M)
    assert found is not None
    speed_rpm, torque_nm = found
    assert 0 < speed_rpm.size <= operating_map.MOST_POINTS
    assert np.all(speed_rpm > 0.0)
    # The ideal vehicle's motor meets the whole demand up to 40 N m, which the cycle does not reach.
    pairs = set(zip(np.round(run.signals["driver.brake_nm"], 9).tolist(), strict=False))
    assert all((torque,) in pairs for torque in np.round(torque_nm, 9).tolist())


def test_points_of_series_optimal_lie_on_the_optimum_and_the_text_states_it() -> None:
    run = drive("series_optimal")
    found = operating_map.operating_points(run, RADIUS_M)
    assert found is not None
    rpm, torque = found
    # A torque sample is the mean of a step during which the speed falls: tolerance of half a step
    # of speed.
    assert np.all(torque <= OPTIMUM_NM_PER_RAD_S * rpm / operating_map.RPM + 1.0)
    assert "0.0 % of them beyond" in operating_map.describe(run, best_map())
    assert "0.0 % of them beyond" not in operating_map.describe(
        drive("parallel_free_travel"), best_map()
    )


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_point_is_drawn_at_its_values_inside_the_frame(strategy: str) -> None:
    runs, best = three(), best_map()
    run = next(run for run in runs if run.strategy == strategy)
    chart = operating_map.layout(runs, best)
    drawn = documents.read(operating_map.draw(run, best, chart, "p", "points"))
    dots = next(
        path for path in drawn.all("path") if path.attributes.get("class") == "dots"
    ).attributes["d"]
    at = [(float(x), float(y)) for x, y in re.findall(r"M([-\d.]+) ([-\d.]+)h0", dots)]
    found = operating_map.operating_points(run, best.wheel_radius_m)
    assert found is not None
    assert len(at) == found[0].size
    for (x, y), rpm, torque in zip(at, *found, strict=True):
        assert x == pytest.approx(chart.x.at(rpm), abs=0.01)
        assert y == pytest.approx(chart.y.at(torque), abs=0.01)
        assert operating_map.LEFT <= x <= operating_map.RIGHT
        assert operating_map.TOP <= y <= operating_map.BOTTOM


def test_the_map_shows_the_torques_used_and_the_corner_of_walking_speed() -> None:
    runs, best = three(), best_map()
    chart = operating_map.layout(runs, best)
    used = [operating_map.operating_points(run, best.wheel_radius_m) for run in runs]
    strongest = max(float(np.max(found[1])) for found in used if found is not None)
    assert strongest <= chart.y.high <= 1.6 * strongest
    # Pixels grow with the root of the speed: a sixteenth of it takes a quarter of the width.
    quarter = chart.x.low_px + 0.25 * (chart.x.high_px - chart.x.low_px)
    assert chart.x.at(chart.x.high / 16.0) == pytest.approx(quarter)
    ticks = chart.x.ticks()
    assert ticks[0] == 0.0
    assert np.all(np.diff([chart.x.at(tick) for tick in ticks]) > 20.0)


def test_axes_have_units_and_the_map_is_drawn_without_braking_points() -> None:
    run = drive()
    run.signals["driver.brake_nm"] = np.zeros(run.time_s.shape)
    best = best_map()
    drawn = documents.read(
        operating_map.draw(run, best, operating_map.layout([run], best), "p", "points")
    )
    texts = drawn.words()
    assert "r/min" in texts and "N·m" in texts
    assert "no braking" in texts
    del run.signals["wheel0.motor_torque_nm"]
    assert operating_map.operating_points(run, RADIUS_M) is None
