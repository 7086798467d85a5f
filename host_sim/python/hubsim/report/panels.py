# SPDX-License-Identifier: Apache-2.0
"""What is drawn over time.

Which quantities share a panel, and how each comes from the recorded signals.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hubsim.report import quality, reading
from hubsim.report.reading import Array, RunLike

KMH = 3.6


@dataclass(frozen=True)
class Curve:
    """One quantity. ``of`` returns it with shape (samples,).

    ``style`` is its CSS class; an area reaches to ``base``.
    """

    name: str
    style: str
    of: Callable[[RunLike], Array | None]
    base: Callable[[RunLike], Array | None] | None = None
    value: Callable[[RunLike], Array | None] | None = (
        None  # for the read-out, where it is not what is drawn
    )


@dataclass(frozen=True)
class Panel:
    """Curves with one scale. ``decimals`` are those of the read-out."""

    title: str
    unit: str
    height: float
    least_span: float
    curves: tuple[Curve, ...]
    decimals: int = 1


def _plain(name: str, factor: float = 1.0) -> Callable[[RunLike], Array | None]:
    def read(run: RunLike) -> Array | None:
        found = reading.signal(run, name)
        return None if found is None else factor * found

    return read


def demand_nm(run: RunLike) -> Array | None:
    """Torque the driver asks of one wheel, shape (samples,).

    The drive pedal, or less than nothing for the brake pedal.
    """
    drive, brake = reading.signal(run, "driver.drive_nm"), reading.signal(run, "driver.brake_nm")
    if brake is None:
        return drive
    return -brake if drive is None else np.where(brake > 0.0, -brake, drive)


def zero(run: RunLike) -> Array:
    """Return the line that areas stand on, shape (samples,)."""
    return np.zeros(np.shape(run.time_s))


_motor = _plain("wheel0.motor_torque_nm")
_hydraulic = _plain("wheel0.hydraulic_torque_nm")


def _under_motor(run: RunLike) -> Array | None:
    motor = _motor(run)
    return None if motor is None else np.minimum(motor, 0.0)


def _both(run: RunLike) -> Array | None:
    motor, hydraulic = _under_motor(run), _hydraulic(run)
    return None if motor is None or hydraulic is None else motor - hydraulic


PANELS = (
    Panel(
        "Speed", "km/h", 76.0, 10.0,
        (
            Curve("target", "target", _plain("driver.reference_m_per_s", KMH)),
            Curve("actual", "vehicle", _plain("vehicle.speed_m_per_s", KMH)),
        ),
    ),
    Panel(
        "Torque at one wheel", "N·m", 120.0, 10.0,
        (
            Curve("motor", "motor", _motor, zero),
            Curve("hydraulic", "hydraulic", _both, _under_motor, _hydraulic),
            Curve("demand", "demand", demand_nm),
        ),
    ),
    Panel("Total torque error", "N·m", 50.0, 4.0, (Curve("motor and brake less the demand", "demand", quality.torque_error_nm),)),
    Panel("Jerk", "m/s³", 50.0, 2.0, (Curve("of the vehicle", "vehicle", quality.jerk_m_per_s3),), 2),
    Panel(
        "Motor current", "A", 84.0, 10.0,
        (
            Curve("torque-making", "motor", _plain("wheel0.current_q_a")),
            Curve("field", "field", _plain("wheel0.current_d_a")),
        ),
    ),
    Panel("Battery current", "A", 84.0, 10.0, (Curve("positive out of the battery", "battery", _plain("battery.current_a"), zero),)),
    Panel("Battery voltage", "V", 60.0, 2.0, (Curve("at the terminals", "battery", _plain("battery.voltage_v")),), 2),
    Panel(
        "Temperature", "°C", 60.0, 5.0,
        (
            Curve("winding", "losses", _plain("wheel0.winding_temperature_c")),
            Curve("inverter", "demand", _plain("wheel0.switch_temperature_c")),
        ),
    ),
)  # fmt: skip
