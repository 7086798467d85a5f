# SPDX-License-Identifier: Apache-2.0
"""Figures of the paper: positions of knees and corners, legends of all lines."""

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from regen_table import figures, figures_vehicle, schema
from regen_table.models import Array

MOTORS = Path(__file__).resolve().parents[4] / "tools" / "motors"
CORNER_RPM = 2094.0 / 40.0 * 30.0 / math.pi  # where 40 N m take the largest power
DRAWN = {
    "fig03": figures.power_over_current,
    "fig04": figures.current_over_speed,
    "fig05": figures.regions,
    "fig07": figures_vehicle.electric_share,
    "fig08": figures_vehicle.pedal,
    "fig11": figures.efficiency_map,
    "fig12": figures.torque_ramp,
    "fig13": figures.boundary_lines,
    "fig14": figures_vehicle.stored_share,
}


def contours(axes: Axes, filled: bool) -> list[QuadContourSet]:
    return [c for c in axes.collections if isinstance(c, QuadContourSet) and c.filled is filled]


def corners(found: QuadContourSet) -> Array:
    return np.concatenate([np.asarray(path.vertices).reshape(-1, 2) for path in found.get_paths()])


def explained(made: Figure) -> set[tuple[str, str]]:
    """Colour and style of every line that some legend of a figure explains."""
    legends = [*made.legends, *(axes.get_legend() for axes in made.axes)]
    lines = [line for legend in legends if legend for line in legend.get_lines()]
    return {(str(line.get_color()), str(line.get_linestyle())) for line in lines}


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("vehicle", ["lu2013", "ebike36v"])
def test_every_dashed_line_has_a_legend_entry(vehicle: str, name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = DRAWN[name](schema.load(MOTORS / f"{vehicle}.toml"))
    known = explained(made)
    shown = [line for axes in made.axes for line in axes.get_lines() if np.size(line.get_xdata())]
    assert shown or name in {"fig07"}
    for line in shown:
        if line.get_linestyle() not in {"-", "None"}:
            colour, style = str(line.get_color()), str(line.get_linestyle())
            by_style = {("black", style)}  # one black sample may stand for a style in many colours
            assert {(colour, style)} & known or by_style & known, (colour, style)


def test_the_knee_of_figure_14_is_at_the_rated_braking_torque(paper: schema.Drive) -> None:
    (axes,) = figures_vehicle.stored_share(paper).axes
    (series,) = (line for line in axes.get_lines() if line.get_label() == "series")
    demand, stored = (np.asarray(values, dtype=float) for values in series.get_data())
    beyond = demand > 20.0  # beyond the steep rise of light demands
    slope = np.diff(stored[beyond]) / np.diff(demand[beyond])
    assert demand[beyond][int(np.argmin(np.diff(slope))) + 1] == 40.0
    assert 40.0 in axes.get_xticks()


def test_bands_of_figure_7_begin_at_torque_and_speed_of_the_limits(
    paper: schema.Drive,
) -> None:
    _, free_travel, series, _ = figures_vehicle.electric_share(paper).axes
    for axes in (free_travel, series):
        bands = contours(axes, filled=True)[0].levels
        assert np.all(np.diff(np.asarray(bands)) <= 1.0 + 1e-9)
        edge = corners(contours(axes, filled=False)[-1])
        assert np.min(edge[:, 1]) == pytest.approx(40.0, abs=0.1)
        assert np.max(edge[:, 0]) == pytest.approx(CORNER_RPM, rel=2e-3)


def test_figure_11_ends_on_the_hyperbola_and_has_a_40_percent_contour(
    paper: schema.Drive,
) -> None:
    axes = figures.efficiency_map(paper).axes[0]
    assert 40.0 in contours(axes, filled=False)[0].levels
    points = corners(contours(axes, filled=True)[0])
    limit = np.minimum(40.0, 2094.0 * 30.0 / math.pi / np.maximum(points[:, 0], 1.0))
    assert np.max(points[:, 1] - limit) <= 1e-9
    for speed in np.linspace(CORNER_RPM, 640.0, 50):  # and approaches it everywhere
        near = points[np.abs(points[:, 0] - speed) < 3.0]
        power = np.max(near[:, 1] * near[:, 0]) * math.pi / 30.0
        assert power == pytest.approx(2094.0, rel=1e-9)


def test_regions_of_figure_5_are_contiguous_and_region_i_begins_at_standstill(
    paper: schema.Drive,
) -> None:
    (axes,) = figures.regions(paper).axes
    areas = [path for area in axes.collections for path in area.get_paths()]
    for speed in np.linspace(0.01, 639.0, 40):
        for torque in (0.3, 17.0, 39.0, 41.0, 60.0, 79.0, 99.0):
            assert sum(path.contains_point((speed, torque)) for path in areas) == 1, (speed, torque)
