# SPDX-License-Identifier: Apache-2.0
"""Drive cycles: speed over time, and perhaps grade, from files as they are published."""

import itertools
from dataclasses import dataclass
from pathlib import Path

from regen_table import drive_cycles
from regen_table.errors import ConfigurationError
from regen_table.suggest import suggestion

from hubsim.engine import ROOT
from hubsim.errors import HubsimError

DIRECTORY = ROOT / "host_sim" / "cycles"
KMH_PER_M_PER_S = 3.6


@dataclass(frozen=True)
class Cycle:
    """Points of a speed trace, straight lines between.

    Times in s rising from 0, speeds in km/h, >= 0; slope (rise over way) at these times, or none.
    """

    name: str
    time_s: tuple[float, ...]
    speed_kmh: tuple[float, ...]
    slope: tuple[float, ...] = ()

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
        ends_as_it_begins = self.speed_kmh[0] == self.speed_kmh[-1]
        joint, skip = (0.0, 1) if ends_as_it_begins else (1e-3, 0)
        time_s = list(self.time_s)
        for _ in range(times - 1):
            offset = time_s[-1] + joint
            time_s += [offset + t for t in self.time_s[skip:]]
        again = times - 1
        return Cycle(
            self.name,
            tuple(time_s),
            self.speed_kmh + self.speed_kmh[skip:] * again,
            self.slope + self.slope[skip:] * again,
        )


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
    try:
        found = drive_cycles.read(path)
    except ConfigurationError as error:
        raise HubsimError(str(error)) from error
    return Cycle(found.name, found.time_s, found.speed_kmh, found.slope)
