# SPDX-License-Identifier: Apache-2.0
"""Drive cycles as they are published: speed over time, perhaps with the road's grade.

A table with a heading that names units, as in ``time_s,speed_km_h``, ``Time [s];Speed [km/h]``,
``Test Time, secs<tab>Target Speed, mph`` or ``cycSecs,cycMps,grade_percent``. Separated by commas,
semicolons (then with decimal commas too) or tabs; lines before the heading are titles, # begins a
comment, other columns are not read. Standard library only.
"""

import csv
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from regen_table import inputs
from regen_table.errors import ConfigurationError

MAX_FILE_BYTES = 16 << 20
TITLE_LINES = 20  # at most, before the heading
ACCEPTED = "a heading as in time_s,speed_km_h or time_s,speed_mph,grade_percent"

Convert = Callable[[float], float]


@dataclass(frozen=True)
class DriveCycle:
    """Points of a speed trace, straight lines between.

    Attributes
    ----------
    time_s : tuple of float
        Rising from 0.
    speed_kmh : tuple of float
        Not negative.
    slope : tuple of float
        Rise over way of the road at these times, positive uphill; empty where the file has none.
    """

    name: str
    time_s: tuple[float, ...]
    speed_kmh: tuple[float, ...]
    slope: tuple[float, ...] = ()


@dataclass(frozen=True)
class _Quantity:
    """A column: how its heading is recognised, its units, the first that fits counts, its range."""

    name: str
    heading: re.Pattern[str]
    units: tuple[tuple[str, Convert], ...]
    example: str
    lowest: float
    highest: float
    accepted: str

    def convert(self, heading: str) -> Convert | None:
        """Return the conversion to the quantity's own unit; None where the heading has no unit."""
        return next((by for unit, by in self.units if re.search(unit, heading)), None)


def _times(factor: float) -> Convert:
    return lambda value: value * factor


# In a heading, a unit is a word of its own: what stands between letters and digits parts words.
_TIME = _Quantity(
    "time",
    re.compile(r"time|\bt\b|secs|seconds"),
    ((r"\bmin(utes)?\b", _times(60.0)), (r"\bms\b", _times(1e-3)), ("", _times(1.0))),
    "time_s",
    -1e9,
    1e9,
    "a number",
)
_SPEED = _Quantity(
    "speed",
    re.compile(r"speed|velocity|^v( k?m| mi|$)|mps\b|mph\b|kmh\b|kph\b"),
    (
        (r"mph\b|\bmi / h\b|\bmi h\b|miles", _times(1.609344)),
        (r"kmp?h\b|kph\b|\bkm / h\b|\bkm h\b|\bkm per h", _times(1.0)),
        (r"mps\b|\bm / s\b|\bm s\b|\bm per s", _times(3.6)),
    ),
    "speed_km_h, speed_mph or speed_m_per_s",
    0.0,
    400.0,
    "0 to 400 km/h",
)
_GRADE = _Quantity(
    "grade",
    re.compile(r"grade|slope|gradient|incline"),
    (
        (r"%|percent|\bpct\b", _times(0.01)),
        (r"\bdeg", lambda value: math.tan(math.radians(value))),
        (r"\brad", math.tan),
        (r"\b1\b|\bm / m\b|\bm per m\b|fraction", _times(1.0)),
    ),
    "grade_percent, grade_deg or grade_1",
    -1.0,
    1.0,
    "-100 to 100 %",
)


def read(path: Path) -> DriveCycle:
    """Read a cycle; an error is one line with file, line number and what is accepted."""
    lines = inputs.read_text(path, MAX_FILE_BYTES, "a table of speed over time").splitlines()
    numbered = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.startswith("#")
    ]
    first, separator, columns = _heading(path, numbered)
    rows: list[list[float]] = []
    for number, line in numbered[first:]:
        values = _values(path, number, line, separator, columns)
        if rows and values[0] <= rows[-1][0]:
            raise ConfigurationError(f"{path}:{number}: time {values[0]:g} s, accepted: rising")
        rows.append(values)
    if len(rows) < 2:
        raise ConfigurationError(f"{path}: fewer than two points, accepted: at least two")
    begin_s = rows[0][0]
    time_s, speed_kmh, *slope = zip(*rows, strict=True)
    return DriveCycle(path.stem, tuple(t - begin_s for t in time_s), speed_kmh, *slope)


_Columns = list[tuple[int, _Quantity, Convert]]


def _heading(path: Path, numbered: Sequence[tuple[int, str]]) -> tuple[int, str, _Columns]:
    """Return after how many lines the points begin, what parts cells, and the columns."""
    for k, (number, line) in enumerate(numbered[:TITLE_LINES]):
        separator = next((mark for mark in "\t;" if mark in line), ",")
        cells = next(csv.reader([line], delimiter=separator))
        found = [_columns_of(quantity, cells) for quantity in (_TIME, _SPEED, _GRADE)]
        if not found[0] or not found[1]:
            if re.fullmatch(r"[-+\d.,;\s]+", line):
                break
            continue
        columns: _Columns = []
        for quantity, places in zip((_TIME, _SPEED, _GRADE), found, strict=True):
            if len(places) > 1:
                names = " and ".join(repr(cells[place].strip()) for place in places[:2])
                raise ConfigurationError(
                    f"{path}:{number}: {names}, accepted: one column of {quantity.name}"
                )
            for place in places:
                by = quantity.convert(_words(cells[place]))
                if by is None:
                    raise ConfigurationError(
                        f"{path}:{number}: {cells[place].strip()!r} has no unit, accepted:"
                        f" {quantity.example}"
                    )
                columns.append((place, quantity, by))
        return k + 1, separator, columns
    raise ConfigurationError(f"{path}: no heading with time and speed, accepted: {ACCEPTED}")


def _columns_of(quantity: _Quantity, cells: Sequence[str]) -> list[int]:
    """Return the places of the columns that a heading has of a quantity."""
    return [k for k, cell in enumerate(cells) if quantity.heading.search(_words(cell))]


def _words(heading: str) -> str:
    """Return a heading in words: ``Vehicle_speed [km/h]`` is ``vehicle speed km / h``."""
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", heading)  # cycMps
    return " ".join(re.findall(r"[a-z0-9]+|[/%]", parted.lower()))


def _values(path: Path, number: int, line: str, separator: str, columns: _Columns) -> list[float]:
    """Return time, speed and perhaps slope of a row."""
    cells = next(csv.reader([line], delimiter=separator))
    values = []
    for place, quantity, by in columns:
        cell = cells[place].strip() if place < len(cells) else ""
        try:
            value = by(float(cell if separator == "," else cell.replace(",", ".")))
        except ValueError:
            value = math.nan
        if not quantity.lowest <= value <= quantity.highest:
            raise ConfigurationError(
                f"{path}:{number}: {quantity.name} {cell[:40]!r}, accepted: {quantity.accepted}"
            )
        values.append(value)
    return values
