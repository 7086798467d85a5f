# SPDX-License-Identifier: Apache-2.0
"""Proof by interval arithmetic: no quantity of the fast loop saturates in the envelope.

The envelope: bus voltage from undervoltage to overvoltage trip, electrical speed up to 5 % above
the largest, currents and current errors up to the converter's range. Every quantity below is the
firmware's own (foc/current_controller, foc/modulation); the bound is what its number
format holds, voltages being shares of the voltage circle.
"""

import math
from dataclasses import dataclass

from regen_table import derived, loops
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

SPEED_RESERVE = 1.05
INTEGRAL_STEPS_MIN = 50  # half a step in 50 is 1 %
PROPORTIONAL_STEPS_MIN = 32
CROSS_COUPLING_MAX = 16.0  # w L I_base over the circle's radius, Q11 in 16 bits


@dataclass(frozen=True)
class Interval:
    """A closed interval of real numbers.

    The operators return intervals that hold every possible result.
    """

    low: float
    high: float

    def __mul__(self, other: "Interval | float") -> "Interval":
        other = _interval(other)
        products = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return Interval(min(products), max(products))

    __rmul__ = __mul__

    def __add__(self, other: "Interval | float") -> "Interval":
        other = _interval(other)
        return Interval(self.low + other.low, self.high + other.high)

    def reciprocal(self) -> "Interval":
        """Return 1/x; the interval must not hold zero."""
        if self.low <= 0.0 <= self.high:
            raise ZeroDivisionError("interval holds zero")
        return Interval(1.0 / self.high, 1.0 / self.low)


def _interval(value: Interval | float) -> Interval:
    return value if isinstance(value, Interval) else Interval(value, value)


def both_signs(magnitude: float) -> Interval:
    """Return [-magnitude, magnitude]."""
    return Interval(-magnitude, magnitude)


@dataclass(frozen=True)
class Proof:
    """A quantity, its interval, what its format holds, and what to change where it is outside."""

    quantity: str
    found: Interval
    allowed: Interval
    too_large: str
    too_small: str = ""

    @property
    def holds(self) -> bool:
        """Whether the interval lies inside the format (its upper end excluded)."""
        return self.allowed.low <= self.found.low and self.found.high < self.allowed.high


def proofs(drive: Drive) -> list[Proof]:
    """Compute the interval of every scaled quantity of the fast loop."""
    base, limit = loops.bases(drive), loops.modulation_limit(drive)
    window = Interval(0.0, 4.0 * loops.min_pulse_counts(drive) / loops.pwm_period_counts(drive))
    found = [
        Proof(
            "modulation.lowest_counts",
            window,
            Interval(0.0, 1.0 + 1e-12),
            "lower inverter.min_pulse_s or inverter.pwm_frequency_hz",
        ),
        Proof(
            "modulation.limit",
            Interval(limit, limit),
            Interval(0.25, 1.0),
            "",
            "lower inverter.min_pulse_s or dead_time_s",
        ),
    ]
    if not found[-1].holds:
        return found
    bus = Interval(loops.undervoltage_trip_v(drive), derived.overvoltage_trip_v(drive))
    per_volt = bus.reciprocal() * (
        drive.inverter.voltage_full_scale_v * math.sqrt(3.0) / limit
    )  # volts per unit to shares of the circle
    speed = both_signs(SPEED_RESERVE * derived.omega_max(drive) / base.speed_rad_s)
    gains = loops.per_unit_gains(drive)
    smaller = (
        "lower control.current_bandwidth_hz or inverter.current_full_scale_a /"
        " voltage_full_scale_v, or raise battery.min_voltage_v"
    )
    larger = (
        "raise control.current_bandwidth_hz or inverter.current_full_scale_a / voltage_full_scale_v"
    )
    slower = "raise inverter.pwm_frequency_hz or lower motor.max_speed_rpm"
    found.append(Proof("rotor.speed_pu", speed, both_signs(1.0), slower))
    found.append(
        Proof(
            "current_loop.w_psi",
            gains.flux * per_volt * speed,
            both_signs(8.0),
            "raise battery.min_voltage_v",
        )
    )
    temperatures = (drive.table.temperature_range_c[0], drive.motor.max_winding_temperature_c)
    warmth = Interval(
        *sorted(loops.resistance_ratio(drive, temperature) for temperature in temperatures)
    )
    found.append(
        Proof(
            "current_loop.integral",
            gains.integral * warmth * per_volt,
            Interval(INTEGRAL_STEPS_MIN / 32768.0, 0.5),
            smaller,
            larger,
        )
    )
    for axis in ("d", "q"):
        proportional = gains.proportional[axis] * per_volt
        reactance = gains.inductance[axis] * per_volt * speed
        ratio = gains.integral / gains.proportional[axis] * warmth
        output = proportional * both_signs(1.0) + both_signs(1.0)
        found.append(
            Proof(
                f"current_loop.proportional_{axis}",
                proportional,
                Interval(PROPORTIONAL_STEPS_MIN / 2048.0, 16.0),
                smaller,
                larger,
            )
        )
        found.append(
            Proof(
                f"current_loop.w_l_{axis}",
                reactance,
                both_signs(CROSS_COUPLING_MAX),
                f"{smaller}, or lower motor.max_speed_rpm",
            )
        )
        found.append(
            Proof(
                f"current_loop.anti_windup_{axis}",
                ratio,
                Interval(4.0 / 32768.0, 0.25),
                slower,
                slower,
            )
        )
        found.append(Proof(f"current_loop.pi_output_{axis}", output, both_signs(18.0), smaller))
    zone = Interval(loops.dead_time_zone_pu(drive), loops.dead_time_zone_pu(drive))
    found.append(
        Proof(
            "dead_time.zone",
            zone,
            Interval(loops.DEAD_TIME_ZONE_MIN, 1.0 + 1e-12),
            "lower control.dead_time_zone_a",
            "raise control.dead_time_zone_a",
        )
    )
    return found


def refuse_overflow(found: list[Proof]) -> None:
    """Raise ConfigurationError that names the first quantity which leaves its format."""
    for proof in found:
        if not proof.holds:
            remedy = (
                proof.too_small
                if proof.found.low < proof.allowed.low and proof.too_small
                else proof.too_large
            )
            raise ConfigurationError(
                f"{proof.quantity}: {proof.found.low:.4g} to {proof.found.high:.4g} inside the"
                f" operating envelope, accepted: {proof.allowed.low:.4g} to"
                f" {proof.allowed.high:.4g} ({remedy})"
            )
