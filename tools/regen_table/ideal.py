# SPDX-License-Identifier: Apache-2.0
"""How an ideal controller makes torque: with i_d = 0 as in the paper, or of least loss.

Surface magnets: i_d = 0, the paper's closed form. Salient motors: both currents, because i_d = 0
would waste most of what the motor can do. Points inside the drive's limits then take the i_d that
the firmware has stored (current_map), which is within a fiftieth of a per cent of the least loss;
the lines without limits are searched for.
"""

from dataclasses import dataclass

import numpy as np

from regen_table import braking, current_audit, current_map, joint, models, optimum
from regen_table.models import Array, ArrayLike, Bridge, Machine
from regen_table.schema import Drive


def salient(drive: Drive) -> bool:
    """Whether i_d matters for the torque."""
    return drive.motor.type == "ipmsm"


def production(drive: Drive) -> braking.Production:
    """Return how the drive makes torque inside its limits."""
    return (
        current_map.production(current_audit.choose(drive))
        if salient(drive)
        else braking.ZERO_D_CURRENT
    )


@dataclass(frozen=True)
class Lines:
    """Best braking without limits over speed.

    Torques are magnitudes in N m, currents peak phase magnitudes in A.

    NaN where there is none within three times the drive's phase current.
    """

    optimal_nm: Array
    zero_nm: Array
    optimal_a: Array
    zero_a: Array


def lines(drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike) -> Lines:
    """Return the torque of most returned power, and the larger one of zero power.

    At mechanical speeds in rad/s.
    """
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    if not salient(drive):
        best = optimum.closed_form(motor, inverter, omega)
        current = np.abs(best.current_q_a)
        return Lines(
            np.abs(best.torque_optimal_nm), np.abs(best.torque_zero_nm), current, 2.0 * current
        )
    bounds = current_audit.relaxed(drive)
    best_point = joint.best_braking(motor, inverter, omega, bounds)
    returns = best_point.state.dc_power_w < 0.0  # else no torque returns energy: both are zero
    inside = best_point.state.current_a < 0.999 * np.asarray(bounds.current_a)
    zero = joint.zero_power_torque(motor, inverter, omega, bounds, best_point)
    at_zero = joint.least_power(motor, inverter, omega, zero, bounds).state
    ends = inside & (np.abs(at_zero.dc_power_w) < 1e-3 * np.abs(best_point.state.dc_power_w))
    return Lines(
        optimal_nm=np.where(returns, np.where(inside, np.abs(best_point.torque_nm), np.nan), 0.0),
        zero_nm=np.where(returns, np.where(ends, np.abs(zero), np.nan), 0.0),
        optimal_a=np.where(returns, np.where(inside, best_point.state.current_a, np.nan), 0.0),
        zero_a=np.where(returns, np.where(ends, at_zero.current_a, np.nan), 0.0),
    )


def state(
    drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike, torque_nm: ArrayLike
) -> models.State:
    """Steady state of a signed torque at a mechanical speed, also beyond the drive's limits."""
    if not salient(drive):
        return braking.state_of_torque(motor, inverter, speed_rad_s, torque_nm)
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    return joint.least_power(
        motor, inverter, omega, torque_nm, joint.Limits(10.0 * drive.motor.max_phase_current_a)
    ).state


def meeting_rad_s(drive: Drive, motor: Machine, inverter: Bridge) -> float:
    """Mechanical speed above which the limits, not the optimum, bound the motor's braking."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    made = production(drive)
    low, high = 0.0, top
    for _ in range(30):
        middle = 0.5 * (low + high)
        limited = made.capability_nm(drive, motor, inverter, np.array([middle]))[
            0
        ] >= 0.999 * braking.torque_limit_nm(drive, middle)
        low, high = (low, middle) if limited else (middle, high)
    return high
