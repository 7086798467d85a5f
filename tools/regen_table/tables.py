# SPDX-License-Identifier: Apache-2.0
"""The stored optimum: unclamped T_opt over mechanical speed and winding temperature, on grids of powers of two."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from regen_table import models, optimum
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

SPEED_STEP_LOG2_MIN, SPEED_STEP_LOG2_MAX = 6, 20
TEMPERATURE_STEP_LOG2 = (6, 15)


@dataclass(frozen=True)
class RegenMap:
    """The table as the firmware keeps it.

    ``torque_mNm`` has the shape (temperature points, speed points).
    """

    speed_step_log2: int
    temperature_step_log2: int
    temperature_origin_cC: int  # noqa: N815, units keep their letters
    torque_mNm: npt.NDArray[np.int32]  # noqa: N815

    @property
    def speeds_rad_s(self) -> models.Array:
        """Mechanical speed of each column in rad/s."""
        return np.arange(self.torque_mNm.shape[1], dtype=np.float64) * (
            2.0**self.speed_step_log2 / 1000.0
        )

    @property
    def temperatures_c(self) -> models.Array:
        """Winding temperature of each row in degC."""
        return (
            self.temperature_origin_cC
            + np.arange(self.torque_mNm.shape[0], dtype=np.float64)
            * 2.0**self.temperature_step_log2
        ) / 100.0


def regen_map(drive: Drive) -> RegenMap:
    """Compute the table of a drive: the closed form at every point, unclamped.

    Below the speed where regeneration begins the formula's current changes sign. Its torque is
    stored all the same, negative at standstill, because the curve is then straight through the
    threshold and interpolates well; the firmware reads what is below zero as zero.
    """
    table = drive.table
    speed_step = step_log2(
        drive.motor.max_speed_rpm * math.pi / 30.0 * 1000.0, table.speed_points, SPEED_STEP_LOG2_MIN
    )
    if speed_step > SPEED_STEP_LOG2_MAX:
        needed = (
            math.ceil(
                drive.motor.max_speed_rpm * math.pi / 30.0 * 1000.0 / (1 << SPEED_STEP_LOG2_MAX)
            )
            + 1
        )
        raise ConfigurationError(
            f"table.speed_points: {table.speed_points}, accepted: at least {needed} up to motor.max_speed_rpm"
        )
    lowest, highest = table.temperature_range_c
    temperature_step = step_log2(
        (highest - lowest) * 100.0, table.temperature_points, TEMPERATURE_STEP_LOG2[0]
    )
    empty = RegenMap(
        speed_step,
        temperature_step,
        round(lowest * 100.0),
        np.zeros((table.temperature_points, table.speed_points), np.int32),
    )
    motor = models.machine(drive, empty.temperatures_c[:, np.newaxis])
    best = optimum.closed_form(
        motor, models.bridge(drive), empty.speeds_rad_s * drive.motor.pole_pairs
    )
    torque = -optimum.torque_at_zero_d_current(
        motor, empty.speeds_rad_s * drive.motor.pole_pairs, best.current_extended_a
    )
    return RegenMap(
        speed_step,
        temperature_step,
        empty.temperature_origin_cC,
        np.rint(torque * 1000.0).astype(np.int32),
    )


def step_log2(span: float, points: int, smallest: int) -> int:
    """Smallest exponent whose power of two, times the number of intervals, covers the span."""
    return max(smallest, math.ceil(math.log2(span / (points - 1)) - 1e-12))
