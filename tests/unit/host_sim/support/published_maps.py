# SPDX-License-Identifier: Apache-2.0
"""Files as their producers publish them, of motors whose losses are known.

In the layout of what the study ``measured`` takes by --data, without any of its numbers.
"""

import math
from pathlib import Path

import numpy as np

RPM = math.pi / 30.0
COPPER, INVERTER, DRAG_NM = 0.07, 0.3, 1.0  # W/(N m)^2, W/(N m); a drag of hysteresis alone
WARMER = 1.12  # copper loss while braking over driving
DRIVING_RPM = (5.0, 80.0, 155.0, 230.0, 305.0, 380.0, 455.0, 530.0, 605.0, 680.0, 755.0)
BRAKING_RPM = DRIVING_RPM[1:]
OTHER_RPM = (100.0, 200.0, 300.0, 400.0, 500.0, 600.0)
LARGEST_NM = 130.0
FLUX_WB, D_H, Q_H = 0.4441, 0.017, 0.1012


def loss_w(speed_rad_s: float, torque_nm: float, warmer: float = 1.0) -> float:
    """Return the loss; torque at the shaft, negative while braking."""
    air_gap = abs(torque_nm + DRAG_NM)
    return warmer * COPPER * air_gap**2 + INVERTER * air_gap + DRAG_NM * speed_rad_s


def write_all(folder: Path) -> Path:
    """Write every file and return the folder."""
    helios = folder / "helios_gem"
    helios.mkdir(parents=True)
    torques = [4.0, 7.0, *np.linspace(14.0, LARGEST_NM, 10).round(1)]
    _write(helios / "GEM 1.3 Solaride Efficiency.csv", DRIVING_RPM, torques)
    braking = [-torque for torque in torques]
    _write(helios / "GEM 1.3 Solaride Regen Efficiency.csv", BRAKING_RPM, braking, WARMER)
    _write(helios / "GEM 2.6 General Efficiency.csv", OTHER_RPM, torques)
    i_d, i_q = np.meshgrid(np.arange(-20.0, 21.0, 2.0), np.arange(-26.0, 27.0, 2.0), indexing="ij")
    flux = FLUX_WB + D_H * i_d + 1j * Q_H * i_q
    np.savez(folder / "baldor_400rpm_map.npz", i_s_dq=i_d + 1j * i_q, psi_s_dq=flux)
    return folder


def _write(
    path: Path, speeds_rpm: tuple[float, ...], torques: list[float], warm: float = 1.0
) -> None:
    """Write the points at which power passes the way of the torque, magnitudes and efficiency."""
    lines = []
    for rpm in speeds_rpm:
        for torque in torques:
            shaft = RPM * rpm * torque
            electrical = shaft + loss_w(RPM * rpm, torque, warm)
            if shaft * electrical > 0.0:
                share = shaft / electrical if torque > 0.0 else electrical / shaft
                lines.append(f"{rpm:g},{abs(torque):.1f},{100.0 * share:.4f}")
    path.write_text("\ufeff" + "\n".join(lines) + "\n", encoding="utf-8")
