# SPDX-License-Identifier: Apache-2.0
"""Style and output of figures.

One style, SVG and PNG of the same picture, the same bytes every time.
"""

import io
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from regen_table import generate
from regen_table.schema import Drive

BLUE, ORANGE, GREEN, RED, PURPLE, GREY = (
    "#1f5fa8",
    "#d9730d",
    "#2e8540",
    "#b3262a",
    "#6b4ea0",
    "#6e6e6e",
)
STRATEGY_COLOURS = {"parallel_ratio": GREY, "parallel_free_travel": ORANGE, "series_optimal": BLUE}
STRATEGY_NAMES = {
    "parallel_ratio": "parallel, fixed ratio",
    "parallel_free_travel": "parallel, free travel",
    "series_optimal": "series",
}
PAPER = "lu2013"
_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "axes.titlesize": 11.0,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "hubfoc",
    "svg.fonttype": "none",
}


def title(drive: Drive, number: int, text: str) -> str:
    """Return a figure's title: of the paper's drive the paper's number, of another one its name."""
    return f"Fig. {number}   {text}" if drive.name == PAPER else f"{drive.name}   {text}"


def figure(
    title: str, columns: int = 1, rows: int = 1, width: float = 7.0, height: float = 4.6
) -> tuple[Figure, list[Axes]]:
    """Make a figure of ``rows`` x ``columns`` axes (inches).

    Returns it and its axes in reading order.
    """
    with mpl.rc_context(_STYLE):
        made = Figure(figsize=(width, height))
        grid = made.subplots(rows, columns, squeeze=False)
        made.suptitle(title)
    return made, [axes for row in grid for axes in row]


def speed_colours(count: int) -> list[tuple[float, ...]]:
    """Return so many colours, from slow (blue) to fast (red)."""
    return [mpl.colormaps["turbo"](0.05 + 0.9 * k / max(count - 1, 1)) for k in range(count)]


def ticks(most: int) -> MaxNLocator:
    """Return at most so many intervals of 1, 2, 4, 5 or 10 times a power of ten."""
    return MaxNLocator(most, steps=[1, 2, 4, 5, 10])


def legend_below(made: Figure, axes: Axes, columns: int) -> None:
    """Put the legend of some axes under the picture, where no line can be."""
    with mpl.rc_context(_STYLE):
        made.legend(
            *axes.get_legend_handles_labels(), loc="outside lower center", ncols=columns, fontsize=9
        )


def vector(made: Figure) -> bytes:
    """Return a figure as SVG, for a page."""
    with mpl.rc_context(_STYLE):
        out = io.BytesIO()
        made.savefig(out, format="svg", metadata={"Date": None})
    return out.getvalue()


class Picture:
    """A figure as the last value of a notebook's cell, which would show a bare one as its name."""

    def __init__(self, made: Figure) -> None:
        self._made = made

    def _repr_svg_(self) -> str:
        return vector(self._made).decode()


def rendered(figures: dict[str, Figure]) -> dict[str, bytes]:
    """Return every figure as SVG and PNG, by the files' names."""
    files: dict[str, bytes] = {}
    for name, made in figures.items():
        with mpl.rc_context(_STYLE):
            raster = io.BytesIO()
            made.savefig(raster, format="png", dpi=110, metadata={"Software": None})
        files |= {f"{name}.svg": vector(made), f"{name}.png": raster.getvalue()}
    return files


def save(figures: dict[str, Figure], directory: Path) -> list[Path]:
    """Write every figure as SVG and PNG, all of them or none; returns the paths."""
    return generate.write_all(rendered(figures), directory)
