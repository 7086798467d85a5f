# SPDX-License-Identifier: Apache-2.0
"""Other people's measurements, from the files that they publish.

None of the files is part of this repository: those of the solar car motors have no licence, and
figures alone are taken from them. Each source is named with repository, commit and path.
"""

from dataclasses import dataclass
from pathlib import Path

from hubsim.errors import HubsimError
from regen_table import inputs, measured
from regen_table.errors import ConfigurationError
from regen_table.measured import RPM, Losses

WHAT = "rows of r/min, N m and efficiency in %, without a heading"
HEADING = ("speed_rpm", "torque_nm", "efficiency_percent")
MOST_BYTES = 1 << 20


@dataclass(frozen=True)
class Source:
    """A published file.

    Attributes
    ----------
    path : str
        Below the folder of ``--data``.
    origin : str
        Repository, commit and path there.
    """

    path: str
    origin: str

    def under(self, data: Path) -> Path:
        """Return where the file is, refusing where it is not."""
        found = data / self.path
        if not found.is_file():
            raise HubsimError(f"{found}: missing, accepted: {self.origin}")
        return found


_HELIOS = "of UCSolarCarTeam/Helios-Motor-Efficiency at commit 857ec0a, data/"
DRIVING = Source(
    "helios_gem/GEM 1.3 Solaride Efficiency.csv", f"GEM 1.3 Solaride Efficiency.csv {_HELIOS}"
)
BRAKING = Source(
    "helios_gem/GEM 1.3 Solaride Regen Efficiency.csv",
    f"GEM 1.3 Solaride Regen Efficiency.csv {_HELIOS}",
)
OTHER_DRIVING = Source(
    "helios_gem/GEM 2.6 General Efficiency.csv", f"GEM 2.6 General Efficiency.csv {_HELIOS}"
)
FLUX_MAP = Source(
    "baldor_400rpm_map.npz",
    "baldor_400rpm_map.npz of Aalto-Electric-Drives/motulator at commit 808d1df,"
    " examples/drive/flux_vector/",
)
SOURCES = (DRIVING, BRAKING, OTHER_DRIVING, FLUX_MAP)


def efficiency_map(path: Path, brakes: bool, max_speed_rpm: float) -> Losses:
    """Read an efficiency map without a heading, up to a speed."""
    lines = inputs.read_text(path, MOST_BYTES, WHAT).splitlines()
    sign = "-" if brakes else ""
    rows = []
    for number, line in enumerate(lines, start=1):
        cells = [cell.strip() for cell in line.split(",")]
        if len(cells) != len(HEADING):
            raise ConfigurationError(f"{path}:{number}: {line!r}, accepted: {WHAT}")
        rows.append([cells[0], sign + cells[1], cells[2]])
    points = measured.from_text(
        path,
        {name: [row[k] for row in rows] for k, name in enumerate(HEADING)},
        list(range(1, len(rows) + 1)),
    )
    return points.where(points.speed_rad_s <= RPM * max_speed_rpm * (1.0 + 1e-9))
