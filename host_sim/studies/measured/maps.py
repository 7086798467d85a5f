# SPDX-License-Identifier: Apache-2.0
"""Other people's measurements, from the files that they publish.

None of the files is part of this repository: those of the solar car motors have no licence, and
figures alone are taken from them. Each source is named with repository, commit and path.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hubsim.engine import Rows
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


@dataclass(frozen=True)
class FluxMap:
    """A measured flux map, peak phase; arrays over (i_d, i_q), the magnets on the d axis."""

    i_d: Rows
    i_q: Rows
    psi_d: Rows
    psi_q: Rows

    def flux(self, i_d: float, i_q: float) -> tuple[float, float]:
        """Return both flux linkages, bilinear between the points."""
        j = int(np.clip(np.searchsorted(self.i_d, i_d) - 1, 0, len(self.i_d) - 2))
        k = int(np.clip(np.searchsorted(self.i_q, i_q) - 1, 0, len(self.i_q) - 2))
        u = (i_d - self.i_d[j]) / (self.i_d[j + 1] - self.i_d[j])
        v = (i_q - self.i_q[k]) / (self.i_q[k + 1] - self.i_q[k])
        d, q = (
            (1.0 - u) * ((1.0 - v) * psi[j, k] + v * psi[j, k + 1])
            + u * ((1.0 - v) * psi[j + 1, k] + v * psi[j + 1, k + 1])
            for psi in (self.psi_d, self.psi_q)
        )
        return float(d), float(q)

    def reciprocity(self) -> float:
        """Return the largest difference of the cross inductances over the largest inductance.

        d psi_d/d i_q = d psi_q/d i_d in a winding without loss.
        """
        by_q = np.gradient(self.psi_d, self.i_q, axis=1)
        by_d = np.gradient(self.psi_q, self.i_d, axis=0)
        largest = np.max(np.gradient(self.psi_q, self.i_q, axis=1))
        return float(np.max(np.abs(by_q - by_d)) / largest)


def flux_map(path: Path) -> FluxMap:
    """Read a map as motulator writes it: complex i_s_dq and psi_s_dq on a grid."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            current, flux = stored["i_s_dq"], stored["psi_s_dq"]
    except (OSError, ValueError, KeyError) as error:
        raise ConfigurationError(
            f"{path}: accepted: an NPZ file with complex i_s_dq and psi_s_dq"
        ) from error
    return FluxMap(current.real[:, 0], current.imag[0], flux.real, flux.imag)
