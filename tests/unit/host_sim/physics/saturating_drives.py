# SPDX-License-Identifier: Apache-2.0
"""Drives that come along or are drawn, with a saturating flux map in place of their constants."""

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
from hubsim import configuration
from hubsim.configuration import Configuration
from hubsim.engine import ROOT
from hubsim.swarm import drives
from regen_table import schema
from regen_table.flux_files import COLUMNS

Array = npt.NDArray[np.float64]
MOTORS = ROOT / "tools" / "motors"

# psi, L_d and L_q in Wb and H without current, the knee of psi_q in A, the share of L_q i_q that
# the full current takes out of psi_d, and the map's ends of i_d, in shares of the largest current:
# L_q at that current is 0.50 and 0.52 of the one without.
LAWS = {
    "leaf": (0.0713, 0.15e-3, 0.62e-3, 262.0, 0.06, (-1.5, 0.5)),
    "lu2013": (0.0204, 76e-6, 150e-6, 45.0, 0.06, (-2.0, 1.0)),
}


def fluxes(name: str, most_a: float) -> tuple[Array, Array, Array, Array]:
    """Return currents and the slopes of a co-energy of them, so that the map is reciprocal."""
    magnets, d_inductance, q_inductance, knee_a, cross, (low, high) = LAWS[name]
    i_d, i_q = np.meshgrid(
        np.linspace(low, high, 41) * most_a, np.linspace(-1.1, 1.1, 45) * most_a, indexing="ij"
    )
    taken = cross * q_inductance / most_a
    bend = 1.0 + (i_q / most_a) ** 2
    place = (i_d + 0.5 * most_a) / most_a
    psi_d = magnets + d_inductance * i_d - taken / np.cosh(place) ** 2 * 0.5 * i_q**2 / bend
    psi_q = q_inductance * i_q / np.hypot(1.0, i_q / knee_a)
    return i_d, i_q, psi_d, psi_q - taken * most_a * np.tanh(place) * i_q / bend**2


def saturating(source: Path, folder: Path) -> Configuration:
    """Return a drive with a map in the place of its constants."""
    text = source.read_text(encoding="utf-8")
    most_a = float(re.search(r"max_phase_current_a = ([\d.]+)", text)[1])  # type: ignore[index]
    rows = np.stack([part.ravel() for part in fluxes(source.stem, most_a)], axis=1)
    table = f"{source.stem}.csv"
    np.savetxt(folder / table, rows, "%.12g", ",", header=",".join(COLUMNS), comments="")
    text = re.sub(r"^[dq]_inductance_h.*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"^flux_linkage_wb.*", f'flux_map = "{table}"', text, flags=re.MULTILINE)
    text = text.replace('type = "spmsm"', 'type = "ipmsm"')
    path = folder / f"{source.stem}_map.toml"
    path.write_text(text, encoding="utf-8")
    return configuration.load(path)


def drawn(number: int, folder: Path) -> Configuration:
    """Return a drawn drive of the swarm with iron that saturates, or raise what refuses it.

    At full current 0.5 to 0.85 of L_q is left; up to 6 % of the smaller inductance is mutual.
    """
    base, rng = drives.numbered(number).drive, np.random.default_rng([34, number])
    motor = base.motor
    most_a, magnets = motor.max_phase_current_a, motor.flux_linkage_wb
    left, mutual = rng.uniform(0.5, 0.85), rng.uniform(0.0, 0.06)
    taken = mutual * min(motor.d_inductance_h, motor.q_inductance_h) / most_a
    i_d, i_q = np.meshgrid(
        np.linspace(-2.0, 1.0, 41) * most_a, np.linspace(-1.1, 1.1, 45) * most_a, indexing="ij"
    )
    bend, place = 1.0 + (i_q / most_a) ** 2, (i_d + 0.5 * most_a) / most_a
    psi_d = magnets + motor.d_inductance_h * i_d
    psi_d = psi_d - taken / np.cosh(place) ** 2 * 0.5 * i_q**2 / bend
    psi_q = motor.q_inductance_h * i_q / np.hypot(1.0, i_q / most_a * np.sqrt(left**-2 - 1.0))
    psi_q = psi_q - taken * most_a * np.tanh(place) * i_q / bend**2
    rows = np.stack([part.ravel() for part in (i_d, i_q, psi_d, psi_q)], axis=1)
    table = f"drawn{number}.csv"
    np.savetxt(folder / table, rows, "%.12g", ",", header=",".join(COLUMNS), comments="")
    keys = base.model_dump(exclude_none=True, exclude_unset=True)
    tree = {section: found for section, found in keys.items() if isinstance(found, dict)}
    for key in ("d_inductance_h", "q_inductance_h", "flux_linkage_wb"):
        del tree["motor"][key]
    tree["motor"] |= {"flux_map": table, "type": "ipmsm"}
    tree["rotor"] = {"sensor": "angle"}
    drive = schema.parse(tree, f"drawn{number}", f"drawn{number}.toml", beside=folder)
    return Configuration(drive.name, configuration.image_of(drive), drive)
