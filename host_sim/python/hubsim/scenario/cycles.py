# SPDX-License-Identifier: Apache-2.0
"""Drive cycles: speed over time from CSV files with a comment about their source."""

import csv
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

from regen_table.suggest import suggestion

from hubsim import files
from hubsim.engine import ROOT
from hubsim.errors import HubsimError

DIRECTORY = ROOT / "host_sim" / "cycles"
HEADER = ["time_s", "speed_km_h"]
KMH_PER_M_PER_S = 3.6
MAX_FILE_BYTES = 16 << 20


@dataclass(frozen=True)
class Cycle:
    """Points of a speed trace, straight lines between.

    Times in s rising from 0, speeds in km/h, >= 0.
    """

    name: str
    time_s: tuple[float, ...]
    speed_kmh: tuple[float, ...]

    @property
    def duration_s(self) -> float:
        """Time of the last point."""
        return self.time_s[-1]

    @property
    def distance_m(self) -> float:
        """Distance of a vehicle that follows it exactly."""
        points = list(zip(self.time_s, self.speed_kmh, strict=True))
        pairs = itertools.pairwise(points)
        return sum((b[0] - a[0]) * (a[1] + b[1]) / 2.0 for a, b in pairs) / KMH_PER_M_PER_S

    def repeated(self, times: int) -> "Cycle":
        """Return the cycle several times in a row.

        One that does not end as it begins gets no steeper than a millisecond.
        """
        joint = 1e-3 if self.speed_kmh[0] != self.speed_kmh[-1] else 0.0
        time_s, speed_kmh = list(self.time_s), list(self.speed_kmh)
        for _ in range(times - 1):
            offset = time_s[-1] + joint
            skip = 0 if joint else 1
            time_s += [offset + t for t in self.time_s[skip:]]
            speed_kmh += list(self.speed_kmh[skip:])
        return Cycle(self.name, tuple(time_s), tuple(speed_kmh))


def names() -> list[str]:
    """Return the names of the built-in cycles."""
    return sorted(path.stem for path in DIRECTORY.glob("*.csv"))


def load(name: str, beside: Path | None = None) -> Cycle:
    """Read a built-in cycle by its name, or a CSV file (relative to ``beside``)."""
    if name in names():
        return read(DIRECTORY / f"{name}.csv")
    if not name.endswith(".csv"):
        everything = f"accepted: {', '.join(names())} or a .csv file"
        raise HubsimError(f"cycle: no cycle {name!r}, {suggestion(name, names(), everything)}")
    return read((beside or Path()) / name)


def read(path: Path) -> Cycle:
    """Read a cycle file; an error is one line with file and line number."""
    time_s: list[float] = []
    speed_kmh: list[float] = []
    expect_header = True
    for number, line in enumerate(files.read_text(path, MAX_FILE_BYTES).splitlines(), start=1):
        if line.startswith("#") or not line.strip():
            continue
        cells = next(csv.reader([line]))
        if expect_header:
            if cells != HEADER:
                raise HubsimError(
                    f"{path}:{number}: header {line.strip()[:40]!r}, accepted: {','.join(HEADER)}"
                )
            expect_header = False
            continue
        t, v = _point(path, number, cells)
        if (time_s and t <= time_s[-1]) or (not time_s and t != 0.0):
            raise HubsimError(
                f"{path}:{number}: time_s {t:g}, accepted: 0 in the first line, then rising"
            )
        time_s.append(t)
        speed_kmh.append(v)
    if len(time_s) < 2:
        raise HubsimError(f"{path}: {len(time_s)} points, accepted: at least two")
    return Cycle(path.stem, tuple(time_s), tuple(speed_kmh))


def _point(path: Path, number: int, cells: list[str]) -> tuple[float, float]:
    try:
        t, v = (float(cell) for cell in cells)
    except ValueError:
        raise HubsimError(
            f"{path}:{number}: {','.join(cells)[:40]!r}, accepted: two numbers, time_s and "
            "speed_km_h"
        ) from None
    if not (math.isfinite(t) and 0.0 <= v <= 400.0):
        raise HubsimError(f"{path}:{number}: speed_km_h {v:g} at {t:g} s, accepted: 0 to 400 km/h")
    return t, v
