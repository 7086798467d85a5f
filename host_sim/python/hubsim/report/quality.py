# SPDX-License-Identifier: Apache-2.0
"""How well a vehicle brakes.

How far motor and hydraulic brake together are from the demand, and how much it jerks.
"""

import math

import numpy as np

from hubsim.report import reading
from hubsim.report.reading import Array, RunLike

STANDING_M_PER_S = 0.3  # a brake that holds a stationary vehicle does no work


def torque_error_nm(run: RunLike) -> Array | None:
    """Return the torque at a wheel less the demand, mean of the wheels, signed by the motion.

    Shape (samples,), NaN at standstill. Positive: too much drive, or too little braking, forwards
    and backwards.
    """
    motor, hydraulic = (
        _mean_of_wheels(run, "motor_torque_nm"),
        _mean_of_wheels(run, "hydraulic_torque_nm"),
    )
    brake, speed = (
        reading.signal(run, "driver.brake_nm"),
        reading.signal(run, "vehicle.speed_m_per_s"),
    )
    drive = reading.signal(run, "driver.drive_nm")
    if motor is None or hydraulic is None or brake is None or speed is None:
        return None
    forward = np.sign(speed)
    wanted = np.where(brake > 0.0, -brake, forward * drive if drive is not None else 0.0)
    error = forward * (motor - hydraulic) - wanted
    return np.where(np.abs(speed) > STANDING_M_PER_S, error, np.nan)


def _mean_of_wheels(run: RunLike, name: str) -> Array | None:
    found = [reading.signal(run, f"wheel{k}.{name}") for k in range(reading.wheels(run))]
    known = [values for values in found if values is not None]
    return np.mean(known, axis=0) if known else None


def jerk_m_per_s3(run: RunLike) -> Array | None:
    """Return jerk, shape (samples,), from means between samples."""
    acceleration = reading.signal(run, "vehicle.acceleration_m_per_s2")
    if acceleration is None:
        return None
    times = np.asarray(run.time_s, dtype=np.float64)
    steps = np.diff(times)
    found = np.full(times.shape, np.nan)
    # The first sample has no time before it to be the mean of.
    found[2:] = np.where(
        steps[1:] > 0.0,
        np.diff(acceleration[1:]) / np.where(steps[1:] > 0.0, steps[1:], 1.0),
        np.nan,
    )
    return found


def while_braking(run: RunLike, values: Array | None) -> Array | None:
    """Return those of the values at which the driver brakes and the vehicle moves.

    None without any.
    """
    brake, speed = (
        reading.signal(run, "driver.brake_nm"),
        reading.signal(run, "vehicle.speed_m_per_s"),
    )
    if values is None or brake is None or speed is None:
        return None
    kept = values[(brake > 0.0) & (np.abs(speed) > STANDING_M_PER_S) & np.isfinite(values)]
    return kept if kept.size else None


def root_mean_square(values: Array | None) -> float:
    """Return the root of the mean square, NaN of nothing."""
    return math.nan if values is None else float(np.sqrt(np.mean(np.square(values))))


def largest(values: Array | None) -> float:
    """Return the largest magnitude, NaN of nothing."""
    return math.nan if values is None else float(np.max(np.abs(values)))
