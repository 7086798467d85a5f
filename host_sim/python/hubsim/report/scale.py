# SPDX-License-Identifier: Apache-2.0
"""Straight scales with round ticks, and curves with no more points than a screen can show."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hubsim.report.reading import Array

_BUCKETS_PER_PX = 1.5
STANDS_OUT = 0.05


@dataclass(frozen=True)
class Scale:
    """Maps values to pixels: ``low`` to ``low_px``, ``high`` to ``high_px``."""

    low: float
    high: float
    low_px: float
    high_px: float
    step: float

    def px(self, values: Array) -> Array:
        """Return pixels of values, same shape; NaN stays NaN."""
        return self.low_px + (values - self.low) * (
            (self.high_px - self.low_px) / (self.high - self.low)
        )

    def at(self, value: float) -> float:
        """Return the pixel of one value."""
        return float(self.px(np.array(value)))

    def ticks(self) -> list[float]:
        """Return the round values inside the scale."""
        first, last = (
            math.ceil(self.low / self.step - 1e-9),
            math.floor(self.high / self.step + 1e-9),
        )
        return [place * self.step for place in range(first, last + 1)]

    @property
    def decimals(self) -> int:
        """Decimals its ticks need."""
        return max(0, -math.floor(math.log10(self.step) + 1e-9))


def round_step(span: float, count: float) -> float:
    """Return the 1, 2 or 5 times a power of ten that divides a span into about ``count`` pieces, at most 1.5 ``count``."""
    least = span / count / 1.5
    power = 10.0 ** math.floor(math.log10(least))
    return next(
        factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least * (1.0 - 1e-9)
    )


def fitted(
    low: float, high: float, least_span: float, count: float, low_px: float, high_px: float
) -> Scale:
    """Make a scale from round value to round value that holds a range and spans at least ``least_span``.

    A curve may stand out by a twentieth of a step: rounding at an end must not cost a whole step.
    """
    lacking = max(least_span - (high - low), 0.0)
    low, high = low - 0.5 * lacking, high + 0.5 * lacking
    step = round_step(high - low, count)
    return Scale(
        math.floor(low / step + STANDS_OUT) * step,
        math.ceil(high / step - STANDS_OUT) * step,
        low_px,
        high_px,
        step,
    )


def tight(low: float, high: float, count: float, low_px: float, high_px: float) -> Scale:
    """Make a scale that ends where its range ends, for time."""
    high = max(high, low + 1e-9)
    return Scale(low, high, low_px, high_px, round_step(high - low, count))


def thinned(x_px: Array, y_px: Array) -> list[tuple[float, float]]:
    """Return the points of one unbroken curve that matter.

    Of every piece of a pixel first, lowest, highest and last.
    """
    bucket = np.floor(x_px * _BUCKETS_PER_PX).astype(np.int64)
    edges = np.concatenate(([0], np.flatnonzero(np.diff(bucket)) + 1, [x_px.size]))
    kept: list[int] = []
    for begin, end in pairwise(edges.tolist()):
        piece = y_px[begin:end]
        kept += sorted(
            {begin, begin + int(np.argmin(piece)), begin + int(np.argmax(piece)), end - 1}
        )
    points = list(
        zip(np.round(x_px[kept], 1).tolist(), np.round(y_px[kept], 1).tolist(), strict=True)
    )
    flat = {
        place
        for place in range(1, len(points) - 1)
        if points[place - 1][1] == points[place][1] == points[place + 1][1]
    }
    return [point for place, point in enumerate(points) if place not in flat]


def pieces(*curves: Array) -> list[slice]:
    """Return where all curves of shape (samples,) have values, as slices of at least two samples."""
    valid = np.logical_and.reduce([np.isfinite(curve) for curve in curves])
    edges = np.flatnonzero(np.diff(np.concatenate(([False], valid, [False])).astype(np.int8)))
    return [slice(int(begin), int(end)) for begin, end in edges.reshape(-1, 2) if end - begin > 1]


def line(x_px: Array, y_px: Array) -> str:
    """Return the path data of a curve, broken where it has no value."""
    return " ".join(_run(thinned(x_px[piece], y_px[piece])) for piece in pieces(x_px, y_px))


def band(x_px: Array, upper_px: Array, lower_px: Array) -> str:
    """Return the path data of the area between two curves."""
    drawn = []
    for piece in pieces(x_px, upper_px, lower_px):
        there = _run(thinned(x_px[piece], upper_px[piece]))
        back = _run(thinned(x_px[piece], lower_px[piece])[::-1])
        drawn.append(f"{there} L{back[1:]}Z")
    return " ".join(drawn)


def _run(points: list[tuple[float, float]]) -> str:
    return "M" + " ".join(f"{x:g} {y:g}" for x, y in points)
