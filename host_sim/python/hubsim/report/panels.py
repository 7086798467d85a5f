# SPDX-License-Identifier: Apache-2.0
"""What is drawn over time.

Which quantities share a panel, and how each comes from the recorded signals.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hubsim.report import quality, reading
from hubsim.report.reading import Array, RunLike

KMH = 3.6


@dataclass(frozen=True)
class Curve:
    """One quantity. ``of`` returns it with shape (samples,).

    ``style`` is its CSS class; an area extends to ``base``.
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
    group: int = 0  # motion, electric, or thermal: pictures of their own where a page shows one run


def _plain(name: str, factor: float = 1.0, short: bool = True) -> Callable[[RunLike], Array | None]:
    def read(run: RunLike) -> Array | None:
        found = reading.signal(run, name, short)
        return None if found is None else factor * found

    return read


def demand_nm(run: RunLike) -> Array | None:
    """Torque demand of one wheel, shape (samples,).

    The drive pedal, or negative for the brake pedal.
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


MOTION, ELECTRIC, THERMAL = range(3)
RPM = 30.0 / np.pi

_SPEED = Panel(
    "Speed", "km/h", 76.0, 10.0,
    (
        Curve("target", "target", _plain("driver.reference_m_per_s", KMH)),
        Curve("actual", "vehicle", _plain("vehicle.speed_m_per_s", KMH)),
    ),
)  # fmt: skip
_ONE_WHEEL = Panel(
    "Torque at one wheel", "N·m", 120.0, 10.0,
    (
        Curve("motor", "motor", _motor, zero),
        Curve("hydraulic", "hydraulic", _both, _under_motor, _hydraulic),
        Curve("demand", "demand", demand_nm),
    ),
)  # fmt: skip
_QUALITY = (
    Panel(
        "Total torque error", "N·m", 50.0, 4.0,
        (Curve("motor and brake less the demand", "demand", quality.torque_error_nm),),
    ),
    Panel(
        "Jerk", "m/s³", 50.0, 2.0, (Curve("of the vehicle", "vehicle", quality.jerk_m_per_s3),), 2
    ),
)  # fmt: skip
_ONE_MOTOR = Panel(
    "Motor current", "A", 84.0, 10.0,
    (
        Curve("torque-producing", "motor", _plain("wheel0.current_q_a")),
        Curve("field", "field", _plain("wheel0.current_d_a")),
    ),
    group=ELECTRIC,
)  # fmt: skip
_BATTERY = (
    Panel(
        "Battery current", "A", 84.0, 10.0,
        (Curve("positive out of the battery", "battery", _plain("battery.current_a"), zero),),
        group=ELECTRIC,
    ),
    Panel(
        "Voltage", "V", 60.0, 2.0,
        (
            Curve("battery terminals", "battery", _plain("battery.voltage_v")),
            Curve("DC bus", "bus", _plain("bus.voltage_v", short=False)),
        ),
        2, ELECTRIC,
    ),
)  # fmt: skip
_ONE_TEMPERATURE = Panel(
    "Temperature", "°C", 76.0, 5.0,
    (
        Curve("winding", "losses", _plain("wheel0.winding_temperature_c")),
        Curve("inverter", "demand", _plain("wheel0.switch_temperature_c")),
    ),
    group=THERMAL,
)  # fmt: skip


def _by_wheel(
    wheels: int, title: str, unit: str, signal: str, group: int = MOTION,
    factor: float = 1.0, least_span: float = 10.0,
) -> Panel:  # fmt: skip
    """Make a panel with one curve for each wheel."""
    curves = tuple(
        Curve(f"wheel {k}", f"wheel-{k % 4}", _plain(f"wheel{k}.{signal}", factor, short=False))
        for k in range(wheels)
    )
    return Panel(title, unit, 90.0, least_span, curves, group=group)


def panels_of(runs: Sequence[RunLike]) -> tuple[Panel, ...]:
    """Return the panels for runs: one wheel stands for all unless the wheels differ."""
    if not reading.wheels_differ(runs):
        return (_SPEED, _ONE_WHEEL, *_QUALITY, _ONE_MOTOR, *_BATTERY, _ONE_TEMPERATURE)
    n = max(reading.wheels(run) for run in runs)
    return (
        _SPEED,
        _by_wheel(n, "Wheel speed", "r/min", "speed_rad_per_s", factor=RPM, least_span=20.0),
        _by_wheel(n, "Motor torque", "N·m", "motor_torque_nm"),
        _by_wheel(n, "Hydraulic torque", "N·m", "hydraulic_torque_nm"),
        *_QUALITY,
        _by_wheel(n, "Current i_q", "A", "current_q_a", ELECTRIC),
        _by_wheel(n, "Current i_d", "A", "current_d_a", ELECTRIC),
        *_BATTERY,
        _by_wheel(n, "Winding temperature", "°C", "winding_temperature_c", THERMAL, 1.0, 5.0),
        _by_wheel(n, "Inverter temperature", "°C", "switch_temperature_c", THERMAL, 1.0, 5.0),
    )
