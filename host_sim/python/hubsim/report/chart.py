# SPDX-License-Identifier: Apache-2.0
"""A chart of two quantities.

A frame with round ticks on both axes, names and units at their ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from hubsim.report import words
from hubsim.report.markup import Markup, element, join
from hubsim.report.scale import Scale

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
            text = words.fixed(tick, self.x.decimals)
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
            text = words.fixed(tick, self.y.decimals)
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
