# SPDX-License-Identifier: Apache-2.0
"""Limits, regions and strategies: how much of a braking demand the motor takes.

Braking torques here are magnitudes >= 0 of electromagnetic torque, speeds mechanical rad/s and >=
0.
"""

import enum
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from regen_table import models, optimum
from regen_table.models import Array, ArrayLike, Bridge, Machine
from regen_table.schema import Drive


class Region(enum.StrEnum):
    """The four regions of the paper's Fig. 5, for a braking demand at a speed."""

    PLUGGING = "I"  # beyond T_zero: the motor alone would take energy out of the battery
    BEYOND_OPTIMUM = "II"  # T_opt to T_zero: the motor alone would return less than it could
    MOTOR_ALONE = "III"  # up to T_opt
    MIXED = "IV"  # up to T_zero, where the motor's limits come before T_opt


def torque_limit_nm(drive: Drive, speed_rad_s: ArrayLike) -> Array:
    """Largest torque magnitude in N m by max_torque_nm and max_power_w at a mechanical speed."""
    speed = np.abs(np.asarray(speed_rad_s, dtype=np.float64))
    by_power = np.divide(
        drive.motor.max_power_w, speed, out=np.full_like(speed, np.inf), where=speed > 0.0
    )
    return np.minimum(drive.motor.max_torque_nm, by_power)


def capability_nm(drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike) -> Array:
    """Braking torque magnitude in N m of most energy, inside the torque and power limits."""
    best = optimum.closed_form(motor, inverter, np.asarray(speed_rad_s) * motor.pole_pairs)
    return np.minimum(np.abs(best.torque_optimal_nm), torque_limit_nm(drive, speed_rad_s))


def electric_torque_nm(
    drive: Drive, strategy: str, demand_nm: ArrayLike, speed_rad_s: ArrayLike, capability: ArrayLike
) -> Array:
    """Split the braking demand of one wheel: torque of the motor, magnitude in N m.

    parallel_ratio (the paper's scheme 1): a fixed share of the demand. parallel_free_travel (scheme
    2): all of it up to the rated electric torque. series_optimal: all of it up to the capability.
    The first two ignore the optimum.
    """
    demand = np.asarray(demand_nm, dtype=np.float64)
    limit = torque_limit_nm(drive, speed_rad_s)
    if strategy == "parallel_ratio":
        return np.minimum(drive.brake.parallel_electric_share * demand, limit)
    if strategy == "parallel_free_travel":
        return np.minimum(np.minimum(demand, drive.brake.electric_rated_torque_nm), limit)
    return np.minimum(demand, capability)


def region(
    drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike, demand_nm: ArrayLike
) -> np.typing.NDArray[np.str_]:
    """Classify braking demands (magnitudes in N m) by the regions of Fig. 5.

    Returns an array of "I", "II", "III" or "IV".

    Beyond T_zero a demand is in region I for any limits, down to standstill.
    """
    best = optimum.closed_form(motor, inverter, np.asarray(speed_rad_s) * motor.pole_pairs)
    limit = torque_limit_nm(drive, speed_rad_s)
    return region_of(np.abs(best.torque_optimal_nm), np.abs(best.torque_zero_nm), limit, demand_nm)


def region_of(
    optimal: ArrayLike, zero: ArrayLike, limit: ArrayLike, demand_nm: ArrayLike
) -> np.typing.NDArray[np.str_]:
    """Classify demands by the optimum, the torque of no power and the limit, all magnitudes."""
    demand = np.asarray(demand_nm)
    inside = [demand <= np.minimum(optimal, limit), demand > zero, optimal > limit]
    names = [Region.MOTOR_ALONE.value, Region.PLUGGING.value, Region.MIXED.value]
    return np.select(inside, names, Region.BEYOND_OPTIMUM.value)


def paper_optimum_nm(motor: Machine, speed_rad_s: ArrayLike) -> Array:
    """Optimum of the paper's (21) without its limits, N m, magnitude.

    No iron loss, no inverter: p omega psi^2 / (2 R).

    1.5 because psi is the peak phase flux; the printed equation needs sqrt(3/2) of it.
    """
    omega = np.abs(np.asarray(speed_rad_s)) * motor.pole_pairs
    return np.asarray(
        1.5 * motor.pole_pairs * omega * np.square(motor.flux_wb) / (2.0 * motor.resistance_ohm)
    )


def paper_zero_nm(motor: Machine, speed_rad_s: ArrayLike) -> Array:
    """Boundary to plugging of the paper's (20) without its limits.

    Twice the torque of (21), N m, magnitude.
    """
    return 2.0 * paper_optimum_nm(motor, speed_rad_s)


def state_of_torque(
    motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike, torque_nm: ArrayLike
) -> models.State:
    """Steady state at a mechanical speed of a signed electromagnetic torque made with i_d = 0."""
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    return models.evaluate(
        motor, inverter, omega, 0.0, optimum.current_at_zero_d_current(motor, omega, torque_nm)
    )


@dataclass(frozen=True)
class Production:
    """How a torque is made.

    The best one inside the limits (magnitude), and the steady state of any (signed).
    """

    capability_nm: Callable[[Drive, Machine, Bridge, ArrayLike], Array]
    state: Callable[[Machine, Bridge, ArrayLike, ArrayLike], models.State]


ZERO_D_CURRENT = Production(capability_nm, state_of_torque)
