# SPDX-License-Identifier: Apache-2.0
"""A vehicle with the paper's drives in front and drives of half the torque at the rear."""

import re
from pathlib import Path

from regen_table import installation

# Half the machine: as long a wire of half the area for each newton-metre, half the currents.
HALF = {
    "phase_resistance_ohm": 0.062, "d_inductance_h": 152e-6, "q_inductance_h": 152e-6,
    "iron_loss_resistance_ohm": [3.0, 0.012], "rated_torque_nm": 15.0, "max_torque_nm": 20.0,
    "max_power_w": 1047.0, "max_phase_current_a": 37.5, "current_full_scale_a": 82.5,
    "bus_capacitance_f": 2.46e-3, "electric_rated_torque_nm": 20.0,
    "field_weakening_current_a": 35.0, "torque_rate_nm_per_s": 200.0,
}  # fmt: skip


def _written(path: Path, share: float, values: dict[str, object]) -> Path:
    """Write the paper's drive with other values and a share of the pack."""
    text = installation.drive_file("lu2013").read_text(encoding="utf-8")
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = [^#\n]*", f"{key} = {value} ", text)
        assert count == 1, key
    path.write_text(text.replace("[brake]", f"pack_share = {share}\n\n[brake]"), encoding="utf-8")
    return path


def files(folder: Path, values: dict[str, object]) -> tuple[Path, Path]:
    """Write the files of both axles, which share these values; the pack is shared by torque."""
    return (
        _written(folder / "front.toml", 1 / 3, values),
        _written(folder / "rear.toml", 1 / 6, HALF | values),
    )
