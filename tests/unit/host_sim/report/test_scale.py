# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hubsim.report import scale


@pytest.mark.parametrize("count", [2.0, 3.0, 5.0, 8.0])
def test_tick_steps_are_round_and_their_number_is_close_to_the_requested_one(count: float) -> None:
    for span in np.geomspace(1e-6, 1e9, 400):
        step = scale.round_step(float(span), count)
        mantissa = step / 10.0 ** np.floor(np.log10(step) + 1e-9)
        assert min(abs(mantissa - round_) for round_ in (1.0, 2.0, 5.0)) < 1e-6
        # Neighbouring round numbers are at most 2.5 apart.
        assert count / 1.5 * 0.9 <= span / step <= 1.5 * count * (1.0 + 1e-6)


def test_a_fitted_scale_covers_its_range_within_5_percent_of_a_step() -> None:
    random = np.random.default_rng(7)
    for _ in range(300):
        low, span = float(random.uniform(-300.0, 300.0)), float(10.0 ** random.uniform(-3.0, 3.0))
        axis = scale.fitted(low, low + span, 0.0, 4.0, 100.0, 0.0)
        assert axis.low <= low + 0.05001 * axis.step
        assert axis.high >= low + span - 0.05001 * axis.step
        assert axis.ticks()[0] == pytest.approx(axis.low, abs=1e-6 * axis.step)
        assert axis.ticks()[-1] == pytest.approx(axis.high, abs=1e-6 * axis.step)


def test_a_scale_of_a_constant_has_a_nonzero_span() -> None:
    axis = scale.fitted(25.0, 25.0, 5.0, 3.0, 60.0, 0.0)
    assert axis.low < 25.0 < axis.high
    assert axis.high - axis.low >= 5.0


def test_decimation_keeps_every_peak_with_four_points_per_column() -> None:
    random = np.random.default_rng(3)
    x = np.linspace(38.0, 392.0, 20_000)
    y = random.uniform(0.0, 100.0, x.size)
    peak = 12_345
    y[peak] = 250.0
    points = scale.thinned(x, y)
    assert len(points) <= 4 * (1.5 * (392.0 - 38.0) + 1.0)
    assert (round(float(x[peak]), 1), 250.0) in points
    # Decimated pixels keep their true extremes; rounding moves points by up to 0.05.
    drawn_x, drawn_y = np.array(points).T
    for left in range(40, 390, 25):
        inside, around = (x >= left) & (x < left + 2), (x >= left - 0.1) & (x < left + 2.1)
        drawn = drawn_y[(drawn_x >= left - 0.06) & (drawn_x < left + 2.06)]
        assert y[inside].max() - 0.06 <= drawn.max() <= y[around].max() + 0.06
        assert y[around].min() - 0.06 <= drawn.min() <= y[inside].min() + 0.06


def test_a_constant_curve_is_drawn_with_two_points() -> None:
    x = np.linspace(0.0, 300.0, 4000)
    assert scale.thinned(x, np.full(x.size, 12.0)) == [(0.0, 12.0), (300.0, 12.0)]


def test_a_curve_has_gaps_at_missing_values_and_omits_isolated_samples() -> None:
    x = np.arange(12, dtype=np.float64)
    y = np.array([1, 2, 3, np.nan, 5, np.nan, 7, 8, np.nan, np.nan, 9, 4], dtype=np.float64)
    assert [(piece.start, piece.stop) for piece in scale.pieces(x, y)] == [(0, 3), (6, 8), (10, 12)]
    assert scale.line(x, y).count("M") == 3


def test_no_values_give_an_empty_path() -> None:
    x = np.arange(5, dtype=np.float64)
    assert scale.line(x, np.full(5, np.nan)) == ""
    assert scale.band(x, np.full(5, np.nan), np.zeros(5)) == ""


def test_a_band_is_the_polygon_between_two_curves() -> None:
    x = np.array([0.0, 10.0, 20.0])
    data = scale.band(x, np.array([5.0, 3.0, 5.0]), np.array([9.0, 9.0, 9.0]))
    assert data.startswith("M") and data.endswith("Z")
    assert data == "M0 5 10 3 20 5 L20 9 0 9Z"
