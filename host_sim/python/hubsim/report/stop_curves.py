# SPDX-License-Identifier: Apache-2.0
"""Stops at constant demand.

The stored share of the kinetic energy over the demand, simulated over ideal.
"""

from collections.abc import Sequence

import numpy as np

from hubsim.report import markup, reading, scale
from hubsim.report.markup import Markup, element, join, number, picture
from hubsim.report.reading import CurveLike
from hubsim.report.scale import Chart

WIDTH, HEIGHT = 400.0, 262.0
LEFT, RIGHT, TOP, BOTTOM = 38.0, 392.0, 25.0, 222.0
PERCENT = 100.0
LABEL_PITCH = 14.0


def draw(curves: Sequence[CurveLike], identity: str) -> Markup:
    """Draw all strategies in one chart: lines are ideal, rings simulated."""
    chart = _fit(curves)
    parts: list[Markup] = [chart.frame("demand at each wheel, N·m", "Kinetic energy stored, %")]
    for curve in curves:
        x, y = (
            chart.x.px(np.array(curve.ideal_demand_nm)),
            chart.y.px(PERCENT * np.array(curve.ideal)),
        )
        outline = "M" + " ".join(
            f"{number(px)} {number(py)}" for px, py in zip(x.tolist(), y.tolist(), strict=True)
        )
        parts.append(element("path", d=outline, class_=f"curve {accent(curve.strategy)}"))
        rings = [
            element(
                "circle",
                _tooltip(curve, place),
                cx=chart.x.at(demand),
                cy=chart.y.at(PERCENT * stored),
                r=3.4,
            )
            for place, (demand, stored) in enumerate(
                zip(curve.demand_nm, curve.stored, strict=True)
            )
        ]
        parts.append(element("g", *rings, class_=f"rings {accent(curve.strategy)}"))
    parts += _labels(curves, TOP + 16.0)
    title = "Stored share of the kinetic energy over the braking demand"
    return picture(identity, title, describe(curves), WIDTH, HEIGHT, *parts, class_="traces chart")


def accent(strategy: str) -> str:
    """Return the style class of a strategy's own colour."""
    return f"accent-{strategy}" if strategy in reading.STRATEGIES else "accent-other"


def differences(curve: CurveLike) -> list[float]:
    """Return simulated less ideal share (1) for every demand, the ideal read off its curve."""
    ideal = np.interp(
        np.array(curve.demand_nm), np.array(curve.ideal_demand_nm), np.array(curve.ideal)
    )
    return [float(difference) for difference in np.array(curve.stored) - ideal]


def unsettled(curves: Sequence[CurveLike]) -> float:
    """Return how much more of the kinetic energy (1) an ideal stop stores than a settled one.

    Its battery has no time to settle.
    """
    gaps = []
    for curve in curves:
        ideal = np.interp(
            np.array(curve.demand_nm), np.array(curve.ideal_demand_nm), np.array(curve.ideal)
        )
        gaps.append(float(np.max(ideal - np.array(curve.settled))))
    return max(gaps)


def describe(curves: Sequence[CurveLike]) -> str:
    """Say every simulated point in words."""
    sentences = []
    for curve in curves:
        points = ", ".join(
            f"{markup.significant(demand)} N·m {markup.percent(stored)}"
            for demand, stored in zip(curve.demand_nm, curve.stored, strict=True)
        )
        sentences.append(f"{_title(curve.strategy)}: {points}.")
    return " ".join(sentences)


def table(curves: Sequence[CurveLike]) -> Markup:
    """List the simulated shares, and how far each is from the ideal."""
    demands = sorted({demand for curve in curves for demand in curve.demand_nm})
    head = [element("th", "Demand, N·m", scope="col")]
    head += [element("th", _title(curve.strategy), scope="col") for curve in curves]
    rows = []
    for demand in demands:
        cells = [element("td", _cell(curve, demand)) for curve in curves]
        rows.append(element("tr", element("th", f"{demand:g}", scope="row"), *cells))
    caption = (
        "Simulated: stored share of the kinetic energy in %, in brackets by how many percentage"
        " points it lies above the ideal"
    )
    drawn = element(
        "table",
        element("caption", caption),
        element("thead", element("tr", *head)),
        element("tbody", *rows),
    )
    return element(
        "div", drawn, class_="scroll stops", role="region", aria_label=caption, tabindex="0"
    )


def _cell(curve: CurveLike, demand: float) -> str:
    if demand not in list(curve.demand_nm):
        return markup.UNKNOWN
    place = list(curve.demand_nm).index(demand)
    beyond = PERCENT * differences(curve)[place]
    sign = "+" if beyond > 0.0 else ""
    return f"{markup.fixed(PERCENT * curve.stored[place], 1)} ({sign}{markup.fixed(beyond, 1)})"


def _title(strategy: str) -> str:
    return reading.STRATEGIES[strategy].title if strategy in reading.STRATEGIES else strategy


def _tooltip(curve: CurveLike, place: int) -> Markup:
    text = (
        f"{_title(curve.strategy)}, {markup.significant(curve.demand_nm[place])} N·m:"
        f" {markup.percent(curve.stored[place])}"
    )
    return element("title", text)


def _fit(curves: Sequence[CurveLike]) -> Chart:
    shares = [PERCENT * value for curve in curves for value in (*curve.stored, *curve.ideal)]
    demands = [demand for curve in curves for demand in (*curve.demand_nm, *curve.ideal_demand_nm)]
    x = scale.fitted(0.0, max(demands), 10.0, 6.0, LEFT, RIGHT)
    return Chart(x, scale.fitted(min(shares), max(shares), 10.0, 8.0, BOTTOM, TOP))


def _labels(curves: Sequence[CurveLike], y: float) -> list[Markup]:
    """Name the curves in the order of their values at the largest demand."""
    ranked = sorted(curves, key=lambda curve: curve.ideal[-1], reverse=True)
    return [
        element("text", f"— {_title(curve.strategy)}", x=RIGHT - 6.0, y=y + LABEL_PITCH * place,
                text_anchor="end",
                class_=f"key {accent(curve.strategy)}")
        for place, curve in enumerate(ranked)
    ]  # fmt: skip


def legend() -> Markup:
    """Say what lines and rings are."""
    return join(
        element("strong", "Lines"),
        " are the ideal: steady state of the motor at every speed, no delay, no hand-over, a "
        "battery at rest before the stop; ",
        element("strong", "rings"),
        " the simulated controllers.",
    )
