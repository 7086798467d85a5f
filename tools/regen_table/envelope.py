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
from regen_table.sections import Drive

SPEED_RESERVE = 1.05
INTEGRAL_STEPS_MIN = 50  # half a step in 50 is 1 %
PROPORTIONAL_STEPS_MIN = 32
CROSS_COUPLING_MAX = 16.0  # w L I_base over the circle's radius, Q11 in 16 bits
FASTER_PWM = "raise inverter.pwm_frequency_hz"
SLOWER_PWM = "lower inverter.pwm_frequency_hz"
SLOWER_MOTOR = "lower motor.max_speed_rpm"
HIGHER_VOLTAGE = "raise battery.min_voltage_v"
SMALLER_GAIN = (
    "lower control.current_bandwidth_hz",
    "lower inverter.current_full_scale_a",
    "raise inverter.voltage_full_scale_v",
    HIGHER_VOLTAGE,
)
LARGER_GAIN = (
    "raise control.current_bandwidth_hz",
    "raise inverter.current_full_scale_a",
    "lower inverter.voltage_full_scale_v",
)


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
    """A quantity, its interval, what its format holds, and what to change where it is outside.

    A change is "lower" or "raise" and a key of the TOML file; the first are the likelier ones.
    """

    quantity: str
    consequence: str
    found: Interval
    allowed: Interval
    too_large: tuple[str, ...]
    too_small: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether the interval lies inside the format (its upper end excluded)."""
        return self.allowed.low <= self.found.low and self.found.high < self.allowed.high

    @property
    def remedy(self) -> tuple[str, ...]:
        """What to change."""
        small = self.found.low < self.allowed.low and bool(self.too_small)
        return self.too_small if small else self.too_large


def proofs(drive: Drive) -> list[Proof]:
    """Compute the interval of every scaled quantity of the fast loop."""
    base, limit = loops.bases(drive), loops.modulation_limit(drive)
    window = Interval(0.0, 4.0 * loops.min_pulse_counts(drive) / loops.pwm_period_counts(drive))
    shorter = ("lower inverter.min_pulse_s", "lower inverter.dead_time_s", SLOWER_PWM)
    found = [
        Proof(
            "modulation.lowest_counts",
            "the shortest pulses fill the PWM period",
            window,
            Interval(0.0, 1.0 + 1e-12),
            shorter,
        ),
        Proof(
            "modulation.limit",
            "pulses, dead time and sampling leave less than a quarter of the voltage",
            Interval(limit, limit),
            Interval(0.25, 1.0),
            shorter,
            shorter,
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
    found.append(
        Proof(
            "rotor.speed_pu",
            "the rotor turns more than a sixteenth of an electrical turn in a PWM period",
            speed,
            both_signs(1.0),
            (FASTER_PWM, SLOWER_MOTOR),
        )
    )
    found.append(
        Proof(
            "current_loop.w_psi",
            "the back-EMF exceeds eight times what the bridge makes of the lowest bus voltage",
            gains.flux * per_volt * speed,
            both_signs(8.0),
            (SLOWER_MOTOR, HIGHER_VOLTAGE, "lower motor.flux_linkage_wb"),
        )
    )
    temperatures = (drive.table.temperature_range_c[0], drive.motor.max_winding_temperature_c)
    warmth = Interval(
        *sorted(loops.resistance_ratio(drive, temperature) for temperature in temperatures)
    )
    found.append(
        Proof(
            "current_loop.integral",
            "the integral gain of the current loop leaves its number format",
            gains.integral * warmth * per_volt,
            Interval(INTEGRAL_STEPS_MIN / 32768.0, 0.5),
            SMALLER_GAIN,
            LARGER_GAIN,
        )
    )
    for axis in ("d", "q"):
        found += _axis(drive, axis, gains, per_volt, speed, warmth)
    zone = Interval(loops.dead_time_zone_pu(drive), loops.dead_time_zone_pu(drive))
    found.append(
        Proof(
            "dead_time.zone",
            "the zone of the dead-time compensation leaves its number format",
            zone,
            Interval(loops.DEAD_TIME_ZONE_MIN, 1.0 + 1e-12),
            ("lower control.dead_time_zone_a", "raise inverter.current_full_scale_a"),
            ("raise control.dead_time_zone_a", "lower inverter.current_full_scale_a"),
        )
    )
    return found


def _axis(
    drive: Drive,
    axis: str,
    gains: loops.PerUnitGains,
    per_volt: Interval,
    speed: Interval,
    warmth: Interval,
) -> list[Proof]:
    """Return what depends on the inductance of an axis."""
    proportional = gains.proportional[axis] * per_volt
    reactance = gains.inductance[axis] * per_volt * speed
    ratio = gains.integral / gains.proportional[axis] * warmth
    output = proportional * both_signs(1.0) + both_signs(1.0)
    field = Interval(1.0 / 65536.0, 16.0)
    stored = Interval(gains.proportional[axis], gains.proportional[axis])
    inductance = Interval(gains.inductance[axis], gains.inductance[axis])
    gain = "gain of the current loop leaves its number format"
    return [
        Proof(
            f"current_loop.proportional_{axis}",
            f"the proportional {gain}",
            proportional,
            Interval(PROPORTIONAL_STEPS_MIN / 2048.0, 16.0),
            SMALLER_GAIN,
            LARGER_GAIN,
        ),
        Proof(
            f"current_loop.w_l_{axis}",
            "the cross-coupling of the axes leaves its number format",
            reactance,
            both_signs(CROSS_COUPLING_MAX),
            (*SMALLER_GAIN, SLOWER_MOTOR),
        ),
        Proof(
            f"current_loop.anti_windup_{axis}",
            "the winding's time constant L / R is not within four to 8192 PWM periods",
            ratio,
            Interval(4.0 / 32768.0, 0.25),
            (FASTER_PWM, f"raise motor.{axis}_inductance_h", "lower motor.phase_resistance_ohm"),
            (SLOWER_PWM, f"lower motor.{axis}_inductance_h", "raise motor.phase_resistance_ohm"),
        ),
        Proof(
            f"current_loop.pi_output_{axis}",
            "the output of the current controller leaves its number format",
            output,
            both_signs(18.0),
            SMALLER_GAIN,
        ),
        Proof(
            f"current_loop.proportional_{axis}_pu",
            f"the proportional {gain}",
            stored,
            field,
            SMALLER_GAIN,
            LARGER_GAIN,
        ),
        Proof(
            f"current_loop.inductance_{axis}_pu",
            "the per-unit inductance leaves its number format",
            inductance,
            field,
            (f"lower motor.{axis}_inductance_h", *SMALLER_GAIN[1:]),
            (f"raise motor.{axis}_inductance_h", *LARGER_GAIN[1:]),
        ),
    ]
