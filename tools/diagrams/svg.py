# SPDX-License-Identifier: Apache-2.0
"""A sheet of boxes, arrows and labels, written as SVG; lengths in pixels, y downwards."""

from dataclasses import dataclass, field
from xml.sax.saxutils import escape

Point = tuple[float, float]

INK = "#1a1a1a"
GREY = "#6a6a6a"
FONT_PX = 13
LINE_PX = 16
CHARACTER_PX = 0.56 * FONT_PX
"""Width of an average character of a sans-serif face."""


@dataclass(frozen=True)
class Box:
    """A rectangle with lines of text in its middle."""

    x: float
    y: float
    width: float
    height: float
    text: str

    @property
    def left(self) -> Point:
        """Middle of the left side."""
        return self.x, self.y + self.height / 2

    @property
    def right(self) -> Point:
        """Middle of the right side."""
        return self.x + self.width, self.y + self.height / 2

    @property
    def top(self) -> Point:
        """Middle of the upper side."""
        return self.x + self.width / 2, self.y

    @property
    def bottom(self) -> Point:
        """Middle of the lower side."""
        return self.x + self.width / 2, self.y + self.height

    def fits(self) -> bool:
        """Return whether the text stays inside."""
        lines = self.text.split("\n")
        widest = max(len(line) for line in lines) * CHARACTER_PX
        return widest <= self.width - 4 and len(lines) * LINE_PX <= self.height - 4


@dataclass
class Sheet:
    """Elements in the order in which they are drawn."""

    width: int
    height: int
    title: str
    elements: list[str] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)

    def text(
        self,
        at: Point,
        text: str,
        anchor: str = "middle",
        colour: str = INK,
        weight: str = "normal",
    ) -> None:
        """Write lines of text, the first with its baseline at a point."""
        for number, line in enumerate(text.split("\n")):
            self.elements.append(
                f'<text x="{at[0]:g}" y="{at[1] + number * LINE_PX:g}" text-anchor="{anchor}"'
                f' fill="{colour}" font-weight="{weight}">{escape(line)}</text>'
            )

    def band(self, box: Box, fill: str) -> None:
        """Draw a background with its title in the upper left corner."""
        self.elements.append(
            f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" height="{box.height:g}"'
            f' rx="6" fill="{fill}"/>'
        )
        if box.text:
            self.text((box.x + 10, box.y + 19), box.text, "start", GREY, "bold")

    def box(self, box: Box, fill: str = "#ffffff") -> Box:
        """Draw a box with its text."""
        self.boxes.append(box)
        self.elements.append(
            f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" height="{box.height:g}"'
            f' rx="3" fill="{fill}" stroke="{INK}"/>'
        )
        lines = box.text.count("\n")
        middle = box.y + box.height / 2 + 0.35 * FONT_PX - lines * LINE_PX / 2
        self.text((box.x + box.width / 2, middle), box.text)
        return box

    def line(self, *points: Point, colour: str = INK, dash: str = "", width: float = 1.2) -> None:
        """Draw a line through points."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.elements.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}"'
            f' stroke-width="{width:g}"{dashes}/>'
        )

    def arrow(self, *points: Point, colour: str = INK, dash: str = "") -> None:
        """Draw a line with straight parts and a head at its end."""
        self.line(*points, colour=colour, dash=dash)
        (x0, y0), (x, y) = points[-2:]
        length = max(abs(x - x0), abs(y - y0))
        ux, uy = (x - x0) / length, (y - y0) / length
        corners = [(x, y), (x - 8 * ux + 4 * uy, y - 8 * uy - 4 * ux)]
        corners.append((x - 8 * ux - 4 * uy, y - 8 * uy + 4 * ux))
        path = " ".join(f"{a:g},{b:g}" for a, b in corners)
        self.elements.append(f'<polygon points="{path}" fill="{colour}"/>')

    def dot(self, at: Point, colour: str = INK) -> None:
        """Draw a filled circle."""
        self.elements.append(f'<circle cx="{at[0]:g}" cy="{at[1]:g}" r="4" fill="{colour}"/>')

    def svg(self) -> str:
        """Return the file's text."""
        body = "\n".join(self.elements)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}"'
            f' width="{self.width}" height="{self.height}"'
            f' font-family="Helvetica, Arial, sans-serif" font-size="{FONT_PX}" role="img">\n'
            f"<title>{escape(self.title)}</title>\n"
            f'<rect width="{self.width}" height="{self.height}" fill="#ffffff"/>\n{body}\n</svg>\n'
        )
