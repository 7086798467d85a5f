# SPDX-License-Identifier: Apache-2.0
"""Signals over time.

One column per run, panels below each other with a shared time axis, equal scales in all columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hubsim.report import markup, reading, scale
from hubsim.report.markup import Markup, element, join, number, picture
from hubsim.report.panels import THERMAL, Curve, Panel, panels_of, zero
from hubsim.report.reading import Array, RunLike
from hubsim.report.scale import Scale

WIDTH = 400.0
LEFT, RIGHT = 38.0, 392.0
HEADING = 25.0
SPACE = 12.0
LANE = 9.0
LANE_PITCH = 27.0
AXIS = 32.0
DENSE_S = 400.0  # longer runs are drawn with finer lines
CONSTANT = 1e-6  # a quantity that varies less, relative, is described in words instead of drawn
FIRST_FAULT = 64  # reason codes from here on are faults


@dataclass(frozen=True)
class Layout:
    """What the columns of one cycle have in common."""

    time: Scale
    panels: tuple[tuple[Panel, Scale, float], ...]  # with the top of each
    reasons: tuple[tuple[int, str, float], ...]  # code, words, top
    bottom: float  # of the lowest panel
    height: float


def layout(runs: Sequence[RunLike], group: int | None = None) -> Layout | None:
    """Fit scales over all runs of a cycle; None when nothing was recorded.

    With a group: its panels alone; the limits of the torque belong to the last one.
    """
    longest = [
        float(run.time_s[-1])
        for run in runs
        if np.size(run.time_s) > 1 and np.isfinite(run.time_s[-1])
    ]
    if not longest:
        return None
    time = scale.tight(0.0, max(longest), 5.0, LEFT, RIGHT)
    placed: list[tuple[Panel, Scale, float]] = []
    y = 0.0
    for panel in panels_of(runs):
        if group is not None and panel.group != group:
            continue
        drawn = [
            values
            for run in runs
            for curve in panel.curves
            for values in (curve.of(run),)
            if values is not None
        ]
        if drawn:
            y += HEADING
            low, high = (
                min(float(np.nanmin(values)) for values in drawn),
                max(float(np.nanmax(values)) for values in drawn),
            )
            based = any(curve.base is zero for curve in panel.curves)
            low, high = (min(low, 0.0), max(high, 0.0)) if based else (low, high)
            height = panel.height if high - low > CONSTANT * max(abs(low), abs(high)) else 0.0
            placed.append(
                (
                    panel,
                    scale.fitted(low, high, panel.least_span, panel.height / 26.0, y + height, y),
                    y,
                )
            )
            y += height + SPACE
    shows_reasons = group is None or group == THERMAL
    codes = sorted({code for run in runs for code in _codes(run)}) if shows_reasons else []
    texts = {
        code: next(reading.reason_text(run, code) for run in runs if code in _codes(run))
        for code in codes
    }
    reasons = []
    y += HEADING if codes else 0.0
    for code in codes:
        reasons.append((code, texts[code], y + LANE_PITCH - LANE - 6.0))
        y += LANE_PITCH
    if not placed and not reasons:
        return None
    return Layout(time, tuple(placed), tuple(reasons), y, y + AXIS)


def draw(run: RunLike, shared: Layout, identity: str, title: str) -> Markup:
    """Draw the column of one run. ``identity`` is unique in the page."""
    parts: list[Markup] = [_braking(run, shared), _time_axis(shared)]
    x = shared.time.px(np.asarray(run.time_s, dtype=np.float64))
    for panel, axis, top in shared.panels:
        parts.append(_panel(run, panel, axis, top, x))
    if shared.reasons:
        first = shared.reasons[0][2] - (LANE_PITCH - LANE - 6.0)
        parts.append(
            element("text", "What limited the torque", x=0.0, y=first - 10.0, class_="heading")
        )
        parts += [_lane(run, shared, code, text, top) for code, text, top in shared.reasons]
    style = "traces dense" if shared.time.high > DENSE_S else "traces"
    return picture(
        identity, title, describe(run, shared), WIDTH, shared.height, *parts, class_=style
    )


def describe(run: RunLike, shared: Layout) -> str:
    """Say the extremes of every curve in words."""
    sentences = []
    for panel, _, _ in shared.panels:
        for curve in panel.curves:
            values = (curve.value or curve.of)(run)
            if values is not None:
                low, high = float(np.nanmin(values)), float(np.nanmax(values))
                name = f"{panel.title}, {curve.name}" if len(panel.curves) > 1 else panel.title
                sentences.append(
                    f"{name}: {markup.significant(low)} to {markup.significant(high)} {panel.unit}."
                )
    for code, text, _ in shared.reasons:
        sentences.append(
            f"Torque limited by: {text}, for {markup.significant(_lasting(run, code))} s."
        )
    return " ".join(sentences)


def readout(run: RunLike, shared: Layout, samples: int = 400) -> dict[str, object] | None:
    """Return what the pointer reads.

    Rounded values at equally spaced times, and where in the picture these are.
    """
    times = np.asarray(run.time_s, dtype=np.float64)
    if times.size < 2 or not np.all(np.isfinite(times)):
        return None
    grid = np.linspace(times[0], times[-1], samples)
    nearest = np.clip(np.searchsorted(times, grid), 0, times.size - 1)
    series: list[dict[str, object]] = []
    for panel, axis, top in shared.panels:
        if axis.low_px == axis.high_px:
            continue
        for place, curve in enumerate(panel.curves):
            values = (curve.value or curve.of)(run)
            if values is not None:
                listed = [
                    round(value, panel.decimals) + 0.0 if np.isfinite(value) else None
                    for value in values[nearest].tolist()
                ]
                name = curve.name if len(panel.curves) > 1 else ""
                y = top + 10.0 + 12.0 * place
                series.append(
                    {
                        "name": name,
                        "unit": panel.unit,
                        "decimals": panel.decimals,
                        "style": curve.style,
                        "y": y,
                        "values": listed,
                    }
                )
    left, right = shared.time.at(float(grid[0])), shared.time.at(float(grid[-1]))
    return {
        "from": float(grid[0]),
        "to": float(grid[-1]),
        "left": left,
        "right": right,
        "bottom": shared.bottom,
        "series": series,
    }


def _time_axis(shared: Layout) -> Markup:
    """Lines through all panels, numbers below."""
    parts = []
    for tick in shared.time.ticks():
        x = shared.time.at(tick)
        parts.append(element("line", x1=x, x2=x, y1=HEADING, y2=shared.bottom, class_="grid"))
        parts.append(
            element(
                "text",
                markup.fixed(tick, shared.time.decimals),
                x=x,
                y=shared.bottom + 13.0,
                text_anchor="middle",
                class_="tick",
            )
        )
    parts.append(
        element(
            "text", "time, s", x=RIGHT, y=shared.bottom + 27.0, text_anchor="end", class_="tick"
        )
    )
    return join(*parts)


def _spans(
    active: np.ndarray[tuple[int], np.dtype[np.bool_]], times: Array
) -> list[tuple[float, float]]:
    """Return begin and end in s of every stretch in which a flag of shape (samples,) is true.

    A sample lasts to the next.
    """
    edges = np.flatnonzero(
        np.diff(np.concatenate(([False], active, [False])).astype(np.int8))
    ).reshape(-1, 2)
    last = times.size - 1
    return [(float(times[begin]), float(times[min(int(end), last)])) for begin, end in edges]


def _braking(run: RunLike, shared: Layout) -> Markup:
    """Shade where the driver brakes."""
    brake = reading.signal(run, "driver.brake_nm")
    if brake is None:
        return Markup("")
    spans = [
        (shared.time.at(begin), shared.time.at(end))
        for begin, end in _spans(brake > 0.0, run.time_s)
    ]
    outline = " ".join(
        f"M{number(a)} {number(HEADING)}H{number(b)}V{number(shared.bottom)}H{number(a)}Z"
        for a, b in spans
        if b > a
    )
    return element("path", d=outline, class_="braking") if outline else Markup("")


def _panel(run: RunLike, panel: Panel, axis: Scale, top: float, x: Array) -> Markup:
    if axis.low_px == axis.high_px:
        return _constant(run, panel, top)
    parts: list[Markup] = [_heading(panel, top)]
    for tick in axis.ticks():
        y = axis.at(tick)
        parts.append(
            element("line", x1=LEFT, x2=RIGHT, y1=y, y2=y, class_="zero" if tick == 0.0 else "grid")
        )
        parts.append(
            element(
                "text",
                markup.fixed(tick, axis.decimals),
                x=LEFT - 5.0,
                y=y + 3.5,
                text_anchor="end",
                class_="tick",
            )
        )
    recorded = False
    for curve in panel.curves:
        values = curve.of(run)
        base = curve.base(run) if curve.base is not None else None
        if values is not None:
            recorded = True
            y_px = axis.px(values)
            if base is not None:
                parts.append(
                    element(
                        "path", d=scale.band(x, y_px, axis.px(base)), class_=f"area {curve.style}"
                    )
                )
            if base is None or len(panel.curves) == 1:
                parts.append(element("path", d=scale.line(x, y_px), class_=f"curve {curve.style}"))
    if not recorded:
        parts.append(
            element(
                "text",
                "not recorded",
                x=0.5 * (LEFT + RIGHT),
                y=top + 0.5 * panel.height,
                text_anchor="middle",
                class_="tick",
            )
        )
    return join(*parts)


def _constant(run: RunLike, panel: Panel, top: float) -> Markup:
    """Say what does not change."""
    title = element("tspan", panel.title, class_="heading")
    levels: dict[str, list[Curve]] = {}
    for curve in panel.curves:
        values = curve.of(run)
        level = (
            "not recorded"
            if values is None
            else f"{markup.significant(float(np.nanmean(values)))} {panel.unit} throughout"
        )
        levels.setdefault(level, []).append(curve)
    if len(levels) == 1 and len(panel.curves) > 1:
        sentences = [element("tspan", next(iter(levels)), class_="key", dx="10")]
    else:
        sentences = [
            element("tspan", f"{curve.name} {level}", class_=f"key {curve.style}", dx="10")
            for level, curves in levels.items()
            for curve in curves
        ]
    return element("text", title, *sentences, x=0.0, y=top - 10.0)


def _heading(panel: Panel, top: float) -> Markup:
    """Title and unit, then the names of the curves in their own colours."""
    spans: list[Markup] = [element("tspan", f"{panel.title}, {panel.unit}", class_="heading")]
    for place, curve in enumerate(panel.curves):
        mark = "" if len(panel.curves) == 1 else "■ " if curve.base is not None else "— "
        name = curve.name.removeprefix("wheel ") if place > 0 else curve.name
        spans.append(element("tspan", mark + name, class_=f"key {curve.style}", dx="10"))
    return element("text", *spans, x=0.0, y=top - 10.0)


def _reasons(run: RunLike) -> Array | None:
    """Return the reason codes of all recorded wheels, shape (wheels, samples)."""
    found = [reading.signal(run, f"wheel{k}.reason") for k in range(reading.wheels(run))]
    known = [codes for codes in found if codes is not None]
    return np.stack(known) if known else None


def _codes(run: RunLike) -> set[int]:
    codes = _reasons(run)
    if codes is None:
        return set()
    return {int(code) for code in np.unique(codes[np.isfinite(codes)]).tolist() if code >= 1.0}


def _lasting(run: RunLike, code: int) -> float:
    return sum(end - begin for begin, end in _active(run, code))


def _active(run: RunLike, code: int) -> list[tuple[float, float]]:
    """Return when a reason limited the torque of any wheel."""
    codes = _reasons(run)
    return [] if codes is None else _spans(np.any(codes == float(code), axis=0), run.time_s)


def _lane(run: RunLike, shared: Layout, code: int, text: str, top: float) -> Markup:
    """One reason: its words, how long it held in this run, and a strip of when."""
    spans = _active(run, code)
    drawn = [
        (shared.time.at(begin), max(shared.time.at(end), shared.time.at(begin) + 0.4))
        for begin, end in spans
    ]
    outline = " ".join(
        f"M{number(a)} {number(top)}H{number(b)}V{number(top + LANE)}H{number(a)}Z"
        for a, b in drawn
    )
    seconds = sum(end - begin for begin, end in spans)
    lasting = (
        "not recorded"
        if _reasons(run) is None
        else f"{markup.significant(seconds, 2)} s"
        if spans
        else "never"
    )
    kind = "fault" if code >= FIRST_FAULT else "limit"
    return join(
        element("rect", x=LEFT, y=top, width=RIGHT - LEFT, height=LANE, class_="lane"),
        element("path", element("title", f"{text}: {lasting}"), d=outline, class_=kind)
        if outline
        else "",
        element("text", text, x=LEFT, y=top - 4.0, class_=f"key {kind}" if spans else "key never"),
        element("text", lasting, x=RIGHT, y=top - 4.0, text_anchor="end", class_="tick"),
    )
