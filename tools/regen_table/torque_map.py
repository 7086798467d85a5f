# SPDX-License-Identifier: Apache-2.0
"""The optimal regenerative torque map: T_opt over mechanical speed and temperature.

Unclamped; temperature is the winding's.

Both axes have steps that are powers of two.
"""

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from regen_table import layout, models, optimum
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

SPEED_STEP_LOG2 = (6, 20)  # smallest and largest, as in config.h
TEMPERATURE_STEP_LOG2 = (6, 15)


@dataclass(frozen=True)
class RegenMap:
    """The table as the firmware keeps it.

    ``torque_mNm`` has the shape (temperature points, speed points); its entries are whole multiples
    of 2^``lsb_log2``.
    """

    speed_step_log2: int
    temperature_step_log2: int
    temperature_origin_cC: int  # noqa: N815, units keep their letters
    torque_mNm: npt.NDArray[np.int32]  # noqa: N815
    lsb_log2: int = 0

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


def regen_map(drive: Drive, points: tuple[int, int] | None = None) -> RegenMap:
    """Compute the table of a drive: the closed form at every point, unclamped.

    ``points``: numbers of speeds and temperatures, which must be given if the drive has "auto".

    Below the speed where regeneration begins the formula's current changes sign. Its torque is
    stored all the same, negative at standstill, because the curve is then straight through the
    threshold and interpolates well; the firmware reads what is below zero as zero.
    """
    speeds, temperatures = points or (drive.table.speed_points, drive.table.temperature_points)
    assert speeds != "auto" and temperatures != "auto"
    empty = _grid(drive, speeds, temperatures)
    return filled(empty, closed_form_mnm(drive, empty))


def closed_form_mnm(drive: Drive, grid: RegenMap) -> models.Array:
    """Return the closed form's torque in mN m at every point of a grid."""
    motor = models.machine(drive, grid.temperatures_c[:, np.newaxis])
    best = optimum.closed_form(
        motor, models.bridge(drive), grid.speeds_rad_s * drive.motor.pole_pairs
    )
    torque = -optimum.torque_at_zero_d_current(
        motor, grid.speeds_rad_s * drive.motor.pole_pairs, best.current_extended_a
    )
    return np.asarray(torque * 1000.0)


def filled(grid: RegenMap, torque_mnm: models.Array) -> RegenMap:
    """Return a table with these torques, as far as its entries resolve them."""
    torque, lsb_log2 = resolved("regen_map", torque_mnm)
    return replace(grid, torque_mNm=torque, lsb_log2=lsb_log2)


def resolved(section: str, values: models.Array) -> tuple[npt.NDArray[np.int32], int]:
    """Round the values of a map to what its 16-bit entries can say, all in one power of two.

    It is the smallest in which the largest value fits. What is beyond the largest of them becomes
    the end of the range.

    Returns
    -------
    tuple
        The values as whole multiples of the power of two, and its exponent.
    """
    known = layout.load().sections[section]
    largest = next(info.highest for info in known.values() if info.count > 0)
    lsb_log2 = 0
    while np.max(np.abs(values)) >= (largest + 0.5) * 2.0**lsb_log2:
        if lsb_log2 == known["lsb_log2"].highest:
            break
        lsb_log2 += 1
    entries = np.clip(np.rint(values / 2.0**lsb_log2), -largest, largest)
    return entries.astype(np.int32) << lsb_log2, lsb_log2


def _grid(drive: Drive, speed_points: int, temperature_points: int) -> RegenMap:
    """Return an empty table over the speeds and temperatures of a drive."""
    speed_span, (lowest, highest) = _speed_span(drive), drive.table.temperature_range_c
    steps = []
    for key, points, span, (smallest, largest), reaches in (
        ("speed_points", speed_points, speed_span, SPEED_STEP_LOG2, "motor.max_speed_rpm"),
        (
            "temperature_points",
            temperature_points,
            100.0 * (highest - lowest),
            TEMPERATURE_STEP_LOG2,
            "the end of table.temperature_range_c",
        ),
    ):
        steps.append(step_log2(span, points, smallest))
        if steps[-1] > largest:
            raise ConfigurationError(
                f"table.{key}: {points}, accepted: at least {points_over(span, largest)} up to"
                f" {reaches}"
            )
    capacity = _capacity()
    if speed_points * temperature_points > capacity:
        raise ConfigurationError(
            f"table.speed_points, table.temperature_points: {speed_points} x {temperature_points},"
            f" accepted: at most {capacity} points in all"
        )
    zeros = np.zeros((temperature_points, speed_points), np.int32)
    return RegenMap(steps[0], steps[1], round(lowest * 100.0), zeros)


def _speed_span(drive: Drive) -> float:
    return drive.motor.max_speed_rpm * math.pi / 30.0 * 1000.0


def _capacity() -> int:
    """Return how many points the firmware's table holds."""
    return layout.load().constants["CONFIG_REGEN_POINTS_MAX"]


def grids(drive: Drive, further_speed_points: Iterable[int] = ()) -> list[tuple[int, int]]:
    """Return numbers of speeds and temperatures worth trying, the smallest grids first.

    A step is a power of two, so a few numbers of points make all the grids there are: the least
    that reach the end of the axis with each step. A number that the drive names is the only one.
    """
    lowest, highest = drive.table.temperature_range_c
    speeds = _numbers_of_points(
        drive.table.speed_points, _speed_span(drive), SPEED_STEP_LOG2, 65, further_speed_points
    )
    temperatures = _numbers_of_points(
        drive.table.temperature_points, 100.0 * (highest - lowest), TEMPERATURE_STEP_LOG2, 17, ()
    )
    capacity = _capacity()
    return sorted(
        (pair for pair in itertools.product(speeds, temperatures) if math.prod(pair) <= capacity),
        key=lambda pair: (math.prod(pair), pair),
    )


def _numbers_of_points(
    given: int | str, span: float, steps_log2: tuple[int, int], most: int, further: Iterable[int]
) -> list[int]:
    """Return the numbers of points of one axis that are worth trying."""
    if isinstance(given, int):
        return [given]
    smallest, largest = steps_log2
    reaching = {points_over(span, step) for step in range(smallest, largest + 1)}
    least = points_over(span, largest)
    return [points for points in reaching | set(further) if least <= points <= most]


def points_over(span: float, step_log2: int) -> int:
    """Points that reach the end of an axis with a step."""
    return max(2, math.ceil(span / 2.0**step_log2 - 1e-12) + 1)


def step_log2(span: float, points: int, smallest: int) -> int:
    """Smallest exponent whose power of two, times the number of intervals, covers the span."""
    return max(smallest, math.ceil(math.log2(span / (points - 1)) - 1e-12))
