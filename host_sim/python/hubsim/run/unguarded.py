# SPDX-License-Identifier: Apache-2.0
"""What the firmware's braking keeps of an ideal that nothing but physics bounds.

The ideal (``regen_table.unguarded``) brakes at the speeds, demands, temperatures and voltages of
the run itself. Its motor and battery are those of the drive's file, whatever the plant was set to.
"""

from collections.abc import Mapping

import numpy as np
from regen_table import unguarded
from regen_table.schema import Drive

from hubsim.engine import Rows

STEP_S = 0.1  # between two instants of the ideal
SIGNALS = (
    "time_s",
    "driver.brake_nm",
    "wheel0.speed_rad_per_s",
    "wheel0.winding_temperature_c",
    "bus.voltage_v",
    "battery.polarisation_v",
    "battery.soc",
)


def kept_share(drive: Drive, signals: Mapping[str, Rows], returned_j: float, wheels: int) -> float:
    """Return the returned energy of a run of so many wheels over that of the ideal.

    ``signals`` are SIGNALS as recorded. NaN where the ideal returns nothing.
    """
    time_s = signals["time_s"]
    brakes = np.flatnonzero(signals["driver.brake_nm"] > 0.0)
    seconds = np.diff(time_s, append=time_s[-1:])[brakes]
    # Means of the braking rows of each step of STEP_S.
    _, group = np.unique(np.floor(time_s[brakes] / STEP_S), return_inverse=True)
    weight: Rows = np.bincount(group, seconds).astype(np.float64)
    some = weight > 0.0
    values = (
        np.bincount(group, seconds * signals[name][brakes])[some] / weight[some]
        for name in SIGNALS[1:]
    )
    at = unguarded.Instants(weight[some], *values)
    ideal_j = unguarded.returned_j(drive, at)
    share = wheels / drive.vehicle.driven_wheels
    return returned_j / (share * ideal_j) if ideal_j > 0.0 else float("nan")
