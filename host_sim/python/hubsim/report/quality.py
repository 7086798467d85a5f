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


def _stops(run: RunLike) -> list[int] | None:
    """Return the first samples at standstill after motion; None where no speed was recorded."""
    speed = reading.signal(run, "vehicle.speed_m_per_s")
    if speed is None:
        return None
    moving = np.abs(speed) > 0.0
    return [int(k) + 1 for k in np.flatnonzero(moving[:-1] & ~moving[1:])]


def at_the_stop(run: RunLike, values: Array | None) -> Array | None:
    """Return those of the values at which a vehicle comes to rest.

    The last 0.3 m/s, and the two samples in which the deceleration has ended. None without any.
    """
    speed, stops = reading.signal(run, "vehicle.speed_m_per_s"), _stops(run)
    if values is None or speed is None or not stops:
        return None
    came = np.zeros(speed.shape, dtype=bool)
    for stop in stops:
        first = stop
        while first > 0 and 0.0 < np.abs(speed[first - 1]) <= STANDING_M_PER_S:
            first -= 1
        came[first : stop + 2] = True
    kept = values[came & np.isfinite(values)]
    return kept if kept.size else None


def left_at_the_stop_m_per_s2(run: RunLike) -> Array | None:
    """Return the decelerations that end with the motion at once, one for each stop."""
    acceleration, stops = reading.signal(run, "vehicle.acceleration_m_per_s2"), _stops(run)
    if acceleration is None or not stops:
        return None
    return np.abs(acceleration[[stop - 1 for stop in stops]])


def root_mean_square(values: Array | None) -> float:
    """Return the root of the mean square, NaN of nothing."""
    return math.nan if values is None else float(np.sqrt(np.mean(np.square(values))))


def largest(values: Array | None) -> float:
    """Return the largest magnitude, NaN of nothing."""
    return math.nan if values is None else float(np.max(np.abs(values)))
