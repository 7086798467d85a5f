# SPDX-License-Identifier: Apache-2.0
"""Scales with round ticks, the frame of a chart of two quantities, and thinned curves."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hubsim.report import markup
from hubsim.report.markup import Markup, element, join
from hubsim.report.reading import Array

_BUCKETS_PER_PX = 1.5
STANDS_OUT = 0.05
APART_PX = 26.0  # ticks of a root scale


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


@dataclass(frozen=True)
class RootScale(Scale):
    """A scale from zero on whose pixels grow with the square root of the value.

    Half of the width shows the lowest quarter.
    """

    def px(self, values: Array) -> Array:
        """Return pixels of values, same shape; those below zero are at zero."""
        share = np.sqrt(np.maximum(values, 0.0) / self.high)
        return self.low_px + share * (self.high_px - self.low_px)

    def ticks(self) -> list[float]:
        """Return zero and the round values that are far enough apart, from the largest down."""
        power = 10.0 ** math.floor(math.log10(self.high))
        rounds = [factor * power * 0.1**k for k in range(3) for factor in (5.0, 2.0, 1.0)]
        kept: list[float] = []
        for value in (self.high, *rounds):
            at = self.at(value)
            right = self.at(kept[-1]) if kept else math.inf
            if value <= self.high and at <= right - APART_PX and at >= self.low_px + APART_PX:
                kept.append(value)
        return [0.0, *reversed(kept)]


def round_step(span: float, count: float) -> float:
    """Return a round step that divides a span into about ``count`` pieces, at most 1.5 ``count``.

    Round is 1, 2 or 5 times a power of ten.
    """
    least = span / count / 1.5
    power = 10.0 ** math.floor(math.log10(least))
    return next(
        factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least * (1.0 - 1e-9)
    )


def fitted(
    low: float, high: float, least_span: float, count: float, low_px: float, high_px: float
) -> Scale:
    """Make a scale between round values that holds a range and spans ``least_span`` or more.

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
    """Return where all curves have values, as slices of at least two samples."""
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


TICK_GAP = 5.0


@dataclass(frozen=True)
class Chart:
    """Both scales; pixels rise downwards, so ``y.low_px`` is the larger one."""

    x: Scale
    y: Scale

    def frame(self, x_title: str, y_title: str, keys: Sequence[tuple[str, str]] = ()) -> Markup:
        """Draw grid, ticks and titles.

        Each title has its unit. ``keys``: names of curves with their style classes.
        """
        parts = []
        for tick in self.x.ticks():
            at = self.x.at(tick)
            parts.append(
                element("line", x1=at, x2=at, y1=self.y.high_px, y2=self.y.low_px, class_="grid")
            )
            text = markup.fixed(tick, self.x.decimals)
            parts.append(
                element(
                    "text", text, x=at, y=self.y.low_px + 13.0, text_anchor="middle", class_="tick"
                )
            )
        for tick in self.y.ticks():
            at = self.y.at(tick)
            style = "zero" if tick == 0.0 else "grid"
            parts.append(
                element("line", x1=self.x.low_px, x2=self.x.high_px, y1=at, y2=at, class_=style)
            )
            text = markup.fixed(tick, self.y.decimals)
            parts.append(
                element(
                    "text",
                    text,
                    x=self.x.low_px - TICK_GAP,
                    y=at + 3.5,
                    text_anchor="end",
                    class_="tick",
                )
            )
        parts.append(
            element(
                "text",
                x_title,
                x=self.x.high_px,
                y=self.y.low_px + 27.0,
                text_anchor="end",
                class_="tick",
            )
        )
        named = [element("tspan", name, class_=f"key {style}", dx="10") for name, style in keys]
        title = element("tspan", y_title, class_="heading")
        parts.append(element("text", title, *named, x=0.0, y=self.y.high_px - 10.0))
        return join(*parts)
