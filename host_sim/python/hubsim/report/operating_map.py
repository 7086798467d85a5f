# SPDX-License-Identifier: Apache-2.0
"""Operating points of one motor while the driver brakes, on the map of the optimal torque."""

from collections.abc import Sequence

import numpy as np

from hubsim.report import markup, reading, scale
from hubsim.report.markup import Markup, element, number, picture
from hubsim.report.reading import Array, MapLike, RunLike
from hubsim.report.scale import Chart, RootScale

WIDTH, HEIGHT = 400.0, 262.0
LEFT, RIGHT, TOP, BOTTOM = 38.0, 392.0, 25.0, 222.0
RPM = 30.0 / np.pi
MOST_POINTS = 700
CURVE_POINTS = 160
HEADROOM = 1.15  # over the largest torque that was used
NO_LESS = 0.25  # of the motor's largest torque, in which a gentle ride is drawn
_KEYS = (("— most energy", "best-line"), ("┄ no energy", "zero-line"), ("— limit", "limit-line"))


def operating_points(run: RunLike, wheel_radius_m: float) -> tuple[Array, Array] | None:
    """Return wheel speed (r/min) and the motor's braking torque (N m) while the driver brakes.

    Thinned out evenly to what a picture can show; None where a signal was not recorded or there is
    no braking.
    """
    speed, torque = (
        reading.signal(run, "vehicle.speed_m_per_s"),
        reading.signal(run, "wheel0.motor_torque_nm"),
    )
    brake = reading.signal(run, "driver.brake_nm")
    if speed is None or torque is None or brake is None:
        return None
    which = np.flatnonzero((brake > 0.0) & (speed > 0.0) & np.isfinite(torque) & np.isfinite(speed))
    if not which.size:
        return None
    kept = which[:: -(-which.size // MOST_POINTS)]
    return RPM / wheel_radius_m * speed[kept], -torque[kept]


def layout(runs: Sequence[RunLike], best: MapLike) -> Chart:
    """Fit one chart for all runs: torques and speeds that were driven.

    The axis of the speed is that of its root: what decides happens at walking speed.
    """
    found = [
        points
        for run in runs
        for points in (operating_points(run, best.wheel_radius_m),)
        if points is not None
    ]
    fastest = max(
        (float(np.max(speed)) for speed, _ in found), default=RPM * float(best.speed_rad_s[-1])
    )
    strongest = max(
        NO_LESS * float(np.max(best.limit_nm)), *(float(np.max(torque)) for _, torque in found), 1.0
    )
    x = scale.fitted(
        0.0, min(1.1 * fastest, RPM * float(best.speed_rad_s[-1])), 10.0, 6.0, LEFT, RIGHT
    )
    y = scale.fitted(0.0, HEADROOM * strongest, 5.0, 6.0, BOTTOM, TOP)
    return Chart(RootScale(x.low, x.high, x.low_px, x.high_px, x.step), y)


def draw(run: RunLike, best: MapLike, chart: Chart, identity: str, title: str) -> Markup:
    """Draw the points of one run over the map. ``identity`` is unique in the page."""
    clip = f"{identity}-inside"
    # The curves leave zero steeply: points as dense in the root of the speed as the axis is.
    rpm = chart.x.high * np.linspace(0.0, 1.0, CURVE_POINTS) ** 2
    x = chart.x.px(rpm)
    optimal, zero, limit = (
        np.interp(rpm, RPM * best.speed_rad_s, torque)
        for torque in (best.optimal_nm, best.zero_nm, best.limit_nm)
    )
    inside = element(
        "clipPath",
        element("rect", x=LEFT, y=TOP, width=RIGHT - LEFT, height=BOTTOM - TOP),
        id=clip,
        clipPathUnits="userSpaceOnUse",
    )
    ceiling = np.full(x.shape, chart.y.px(np.array(chart.y.high)))
    curves = [
        element(
            "path",
            d=scale.band(x, ceiling, chart.y.px(np.minimum(zero, limit))),
            class_="region",
        ),
        element("path", d=scale.line(x, chart.y.px(limit)), class_="curve limit-line"),
        element("path", d=scale.line(x, chart.y.px(zero)), class_="curve zero-line"),
        element("path", d=scale.line(x, chart.y.px(optimal)), class_="curve best-line"),
    ]
    found = operating_points(run, best.wheel_radius_m)
    marks = Markup("")
    if found is not None:
        dots = " ".join(
            f"M{number(px)} {number(py)}h0"
            for px, py in zip(
                chart.x.px(found[0]), chart.y.px(np.maximum(found[1], 0.0)), strict=True
            )
        )
        marks = element("path", d=dots, class_="dots")
    caption = element(
        "text",
        "no braking",
        x=0.5 * (LEFT + RIGHT),
        y=0.5 * (TOP + BOTTOM),
        text_anchor="middle",
        class_="tick",
    )
    return picture(
        identity, title, describe(run, best), WIDTH, HEIGHT,
        element("defs", inside),
        chart.frame("wheel speed, r/min (root scale)", "Motor's braking torque, N·m", _KEYS),
        element("g", *curves, marks, clip_path=f"url(#{clip})"),
        caption if found is None else "",
        class_="traces chart",
    )  # fmt: skip


def describe(run: RunLike, best: MapLike) -> str:
    """Say in words how the points lie to the curve."""
    found = operating_points(run, best.wheel_radius_m)
    if found is None:
        return "No braking, or not recorded."
    speed, torque = found
    optimal = np.interp(speed, RPM * best.speed_rad_s, best.optimal_nm)
    beyond = float(np.mean(torque > 1.02 * optimal + 0.2))
    largest, fastest = (markup.significant(float(np.max(x))) for x in (torque, speed))
    return (
        f"{speed.size} moments of braking, up to {largest} N·m and {fastest} r/min; "
        f"{markup.percent(beyond)} of them beyond the torque that returns the most energy."
    )
