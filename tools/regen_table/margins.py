# SPDX-License-Identifier: Apache-2.0
"""Margins, bandwidth and step response of the current loop.

As it really runs: sampled, delayed, with a cold and a hot winding.

The currents are sampled once per PWM period T; the voltage computed from them takes effect one
period later and is held for one: on average 1.5 periods of delay. In the z domain, per axis and
volt per volt,

    C(z) = k_p + k_i / (z - 1)        G(z) = z^-1 (1 - a) / (R (z - a)),   a = exp(-R T / L)

With the gains of loops.axis_gains() the winding's pole is cancelled and about K / (z (z - 1)) is
left, K = a (1 - a), a = exp(-omega_c T): a crossover near K / T, a phase margin of 90 deg - 1.5
omega T there, a gain margin of 1 / K. The reference is shaped before it (reference_shape()), which
no margin sees.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from regen_table import loops, models
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

PHASE_MARGIN_MIN_DEG = 45.0
GAIN_MARGIN_MIN = 2.0
FASTEST_POLE = (
    0.5  # omega_c T: up to here a = exp(-omega_c T) is well apart from the loop's other pole, 1 - a
)
DELAY_PERIODS = 1.5


@dataclass(frozen=True)
class Margins:
    """Margins of one axis at one winding temperature."""

    axis: str
    winding_temperature_c: float
    crossover_hz: float
    phase_margin_deg: float
    gain_margin: float
    bandwidth_hz: float  # where the closed loop has lost 3 dB
    step_deviation: float  # from the designed response, share of the step, at the worst sample


@dataclass(frozen=True)
class Loop:
    """One axis of the sampled loop.

    Winding, gains in V/A and V/A per period, and the period in s.
    """

    resistance_ohm: float
    inductance_h: float
    proportional: float
    integral: float
    period_s: float
    shape: tuple[float, float, float] = (
        1.0,
        0.0,
        0.0,
    )  # of the reference: shares of it, of the one before and of the one before that

    @property
    def pole(self) -> float:
        """Pole of the winding under a held voltage."""
        return math.exp(-self.resistance_ohm * self.period_s / self.inductance_h)


def reference_shape(bandwidth_hz: float, period_s: float) -> tuple[float, float, float]:
    """Return the prefilter's coefficients b0, b1, b2, as in foc/reference_prefilter.h.

    They weigh a reference and the two before it.

    The design divided by the loop, in the z domain, with b = exp(-omega_c T / 2), a = b^2. The
    samples 1 - b, 1 - a b, 1 - a^2 b .. of the designed step response belong to

        design   z^-2 (1 - b + (b - a) / z) / (1 - a / z)
        loop     z^-2 K / ((1 - a / z) (1 - (1 - a) / z))
    """
    b = math.exp(-math.pi * bandwidth_hz * period_s)
    a = b * b
    first, then = (1.0 - b) / (a * (1.0 - a)), (b - a) / (a * (1.0 - a))
    return first, then - first * (1.0 - a), -then * (1.0 - a)


def frequency_response(loop: Loop) -> dict[str, float]:
    """Margins of one loop: crossover, bandwidth in Hz; phase in degrees, gain as a factor."""
    frequency = np.geomspace(1e-5 / loop.period_s, 0.5 / loop.period_s, 40_001)[:-1]
    z = np.exp(2j * np.pi * frequency * loop.period_s)
    winding = (1.0 - loop.pole) / (loop.resistance_ohm * z * (z - loop.pole))
    open_loop = (loop.proportional + loop.integral / (z - 1.0)) * winding
    gain, phase = np.abs(open_loop), np.unwrap(np.angle(open_loop))
    phase -= (
        2.0 * np.pi * np.round((phase[0] + 0.5 * np.pi) / (2.0 * np.pi))
    )  # starts between 0 and -180 deg
    crossover = _first_crossing(frequency, np.log(gain))
    reversal = _first_crossing(frequency, phase + np.pi)
    closed = np.abs(
        open_loop / (1.0 + open_loop) * (loop.shape[0] + loop.shape[1] / z + loop.shape[2] / z**2)
    )
    return {
        "crossover_hz": crossover,
        "phase_margin_deg": 180.0 + math.degrees(float(np.interp(crossover, frequency, phase))),
        "gain_margin": 1.0 / float(np.interp(reversal, frequency, gain)),
        "bandwidth_hz": _first_crossing(frequency, np.log(closed) + 0.5 * math.log(2.0)),
    }


def _first_crossing(frequency: models.Array, values: models.Array) -> float:
    """Return the frequency where values first fall through zero (the last one if they do not)."""
    below = np.flatnonzero(values <= 0.0)
    if below.size == 0 or below[0] == 0:
        return float(frequency[-1] if below.size == 0 else frequency[0])
    k = int(below[0])
    share = values[k - 1] / (values[k - 1] - values[k])
    return float(frequency[k - 1] + share * (frequency[k] - frequency[k - 1]))


def step_response(loop: Loop, samples: int) -> models.Array:
    """Return the current in A at each sample after a step of one ampere, shape (samples,).

    The step is in the reference, from standstill.
    """
    current = np.zeros(samples)
    applied, integrator, gain = 0.0, 0.0, (1.0 - loop.pole) / loop.resistance_ohm
    for k in range(samples - 1):
        error = sum(loop.shape[: k + 1]) - current[k]
        current[k + 1] = (
            loop.pole * current[k] + gain * applied
        )  # of the voltage worked out one sample before
        applied = loop.proportional * error + integrator
        integrator += loop.integral * error
    return current


def designed_step(bandwidth_hz: float, period_s: float, samples: int) -> models.Array:
    """Return what the gains are designed for.

    A first-order pole at the bandwidth after 1.5 periods; A at each sample.
    """
    late = np.maximum(np.arange(samples) - DELAY_PERIODS, 0.0)
    return np.asarray(1.0 - np.exp(-2.0 * np.pi * bandwidth_hz * period_s * late))


@lru_cache(maxsize=8)
def current_loop(drive: Drive) -> list[Margins]:
    """Margins of both axes with a cold, a reference and a hot winding.

    The integral gain follows their temperature.
    """
    period, bandwidth = 1.0 / drive.inverter.pwm_frequency_hz, drive.control.current_bandwidth_hz
    temperatures = (
        drive.table.temperature_range_c[0],
        drive.motor.reference_temperature_c,
        drive.motor.max_winding_temperature_c,
    )
    samples = min(4000, 10 + math.ceil(1.0 / (bandwidth * period)))  # six time constants
    shape = reference_shape(bandwidth, period)
    found: list[Margins] = []
    for axis, inductance in (("d", drive.motor.d_inductance_h), ("q", drive.motor.q_inductance_h)):
        if found and inductance == drive.motor.d_inductance_h:
            found += [replace(other, axis=axis) for other in found]
            break
        gains = loops.axis_gains(drive, inductance)
        for temperature in temperatures:
            resistance = (
                float(np.asarray(models.machine(drive, temperature).resistance_ohm))
                + drive.inverter.switch_resistance_ohm
            )
            integral = gains.integral * loops.resistance_ratio(drive, temperature)
            loop = Loop(resistance, inductance, gains.proportional, integral, period, shape)
            deviation = np.abs(
                step_response(loop, samples) - designed_step(bandwidth, period, samples)
            )
            found.append(
                Margins(
                    axis,
                    temperature,
                    **frequency_response(loop),
                    step_deviation=float(np.max(deviation)),
                )
            )
    return found


def refuse_thin_margins(drive: Drive, found: list[Margins]) -> None:
    """Raise ConfigurationError if no gain gives the requested loop.

    Or when it is too near to instability.

    The first is reached first: K = a (1 - a) is at most a quarter, at omega_c T = 0.69, and the
    loop
    answers no faster than that.
    """
    wanted, largest = (
        drive.control.current_bandwidth_hz,
        FASTEST_POLE / (2.0 * math.pi) * drive.inverter.pwm_frequency_hz,
    )
    if wanted > largest:
        raise ConfigurationError(
            f"control.current_bandwidth_hz: {wanted:g} Hz, accepted: at most {math.floor(largest)}"
            " Hz, a twelfth of inverter.pwm_frequency_hz: faster poles meet those that the delay"
            " of 1.5 periods makes"
        )
    worst = min(found, key=lambda m: m.phase_margin_deg)
    if (
        worst.phase_margin_deg < PHASE_MARGIN_MIN_DEG
        or min(m.gain_margin for m in found) < GAIN_MARGIN_MIN
    ):
        raise ConfigurationError(
            f"control.current_bandwidth_hz: leaves a phase margin of {worst.phase_margin_deg:.1f}"
            f" deg and a gain margin of {min(m.gain_margin for m in found):.2f}, accepted: at least"
            f" {PHASE_MARGIN_MIN_DEG:g} deg and {GAIN_MARGIN_MIN:g}"
        )
