# SPDX-License-Identifier: Apache-2.0
"""The least bus capacitor: the bus after the battery has left (DERIVATIONS, Bus capacitor).

When a contactor opens, the bridge opens soon after it, and what the windings' currents hold and the
EMF adds while they decay goes into the capacitor. Peak phase quantities, motor signs, SI units, no
part of the firmware.
"""

import math
from dataclasses import dataclass

import numpy as np

from regen_table import derived, loops, models
from regen_table.models import Array
from regen_table.schema import Drive

OVERSPEED = 1.1  # of the largest speed, up to which a vehicle is let go
LEFT_SHARE = 0.8  # of the capacitance: electrolytic capacitors, IEC 60384-4: -20 % when new
TRIP_PERIODS = 2.0  # from the trip's crossing: at most one to the sample, one to the open bridge
# Phase voltage over v + 2 V_f against the current that the diodes rectify: where they begin to
# conduct, and the six-step wave of a current that does not stop.
BEGINNING, SIX_STEP = 1.0 / math.sqrt(3.0), 2.0 / math.pi
LEAST_F, LARGEST_F = 1e-6, 0.1  # searched
SEARCH_FACTOR, SEARCH_STEPS = 4.0, 14  # halvings of its logarithm: to 0.01 %
SPEEDS, ANGLES = 16, 37
STEPS = 150
HALVINGS = 40


@dataclass(frozen=True)
class Starts:
    """States in which the bridge opens without a battery, one array element each.

    Attributes
    ----------
    speed_rad_s : array
        Electrical, rad/s.
    d_a, q_a : array
        Currents, A.
    bus_v : array
        Bus voltage in V.
    """

    speed_rad_s: Array
    d_a: Array
    q_a: Array
    bus_v: Array


def coldest(drive: Drive) -> models.Machine:
    """Return the motor with the coldest winding of its table: least resistance, most flux."""
    return models.machine(drive, drive.table.temperature_range_c[0])


def highest_bus_v(drive: Drive, capacitance_f: float, starts: Starts) -> Array:
    """Return the voltage in V to which the diodes of an open bridge charge the bus.

    Parameters
    ----------
    capacitance_f : float
        Of one inverter, F, more than zero.
    """
    machine, inverter = coldest(drive), drive.inverter
    l_d, l_q, psi = machine.d_inductance_h, machine.q_inductance_h, float(machine.flux_wb)
    ohm = float(machine.resistance_ohm) + inverter.diode_resistance_ohm
    drops = 2.0 * inverter.diode_forward_voltage_v
    w, d, q, v = starts.speed_rad_s, starts.d_a, starts.q_a, starts.bus_v
    ringing_s = 2.0 * math.pi * math.sqrt(max(l_d, l_q) * capacitance_f / (1.5 * BEGINNING**2))
    step_s = min(0.1 / float(np.max(w)), 0.65 * ringing_s / STEPS)

    def slopes(d: Array, q: Array, v: Array) -> tuple[Array, Array, Array]:
        current = np.hypot(d, q)
        z = BEGINNING * (v + drops) / np.maximum(current, 1e-9) + ohm
        d_slope = (w * l_q * q - z * d) / l_d
        q_slope = (-w * (l_d * d + psi) - z * q) / l_q
        return d_slope, q_slope, 1.5 * BEGINNING * current / capacitance_f

    flowing = np.hypot(d, q) > 0.0
    for _ in range(math.ceil(0.65 * ringing_s / step_s)):
        half = slopes(d, q, v)
        whole = slopes(*(x + 0.5 * step_s * s for x, s in zip((d, q, v), half, strict=True)))
        next_d, next_q, next_v = (x + step_s * s for x, s in zip((d, q, v), whole, strict=True))
        # What is left when the current ends within the next step is added as energy.
        last = np.hypot(next_d, next_q) < step_s * BEGINNING * v / min(l_d, l_q)
        last |= d * next_d + q * next_q <= 0.0
        last &= flowing & (BEGINNING * (v + drops) > w * psi)
        left_v2 = 1.5 * (l_d * d**2 + l_q * q**2) / capacitance_f
        v = np.where(last, np.sqrt(v**2 + left_v2), np.where(flowing, next_v, v))
        flowing &= ~last
        d, q = np.where(flowing, next_d, 0.0), np.where(flowing, next_q, 0.0)
        if not np.any(flowing):
            break
    return np.asarray(np.maximum(v, w * psi / BEGINNING - drops))  # where diodes cease to conduct


def worst_bus_v(drive: Drive, capacitance_f: float) -> float:
    """Return the highest voltage in V on the bus of all the ways in which a battery leaves."""
    ways = (braking_starts(drive, capacitance_f), falling_starts(drive), conducting_starts(drive))
    return max(
        float(np.max(highest_bus_v(drive, capacitance_f, starts)))
        for starts in ways
        if len(starts.bus_v)
    )


def least_capacitance_f(drive: Drive) -> float | None:
    """Return the least capacitance in F that keeps the devices' rating; None where none does."""
    rating_v = derived.device_voltage_v(drive)
    high = LEAST_F
    while worst_bus_v(drive, high) >= rating_v:
        high *= SEARCH_FACTOR
        if high > LARGEST_F:
            return None
    low = high / SEARCH_FACTOR
    for _ in range(SEARCH_STEPS):
        middle = math.sqrt(low * high)
        if worst_bus_v(drive, middle) < rating_v:
            high = middle
        else:
            low = middle
    return high


def warning(drive: Drive) -> str | None:
    """Return one line where the capacitor, less tolerance and age, is too small; otherwise None.

    None also where the capacitance or the devices' rating is not known (shortcomings.warnings).
    """
    given_f, rating_v = drive.inverter.bus_capacitance_f, drive.inverter.device_voltage_v
    if given_f == 0.0 or rating_v is None:
        return None
    reached_v = worst_bus_v(drive, LEFT_SHARE * given_f)
    if reached_v < rating_v:
        return None
    least_f = least_capacitance_f(drive)
    needed = "no value" if least_f is None else f"at least {least_f / LEFT_SHARE:.4g} F"
    return (
        f"inverter.bus_capacitance_f: {given_f:g} F, of which {LEFT_SHARE:g} count: a battery that"
        f" leaves raises the bus to {reached_v:.4g} V, above device_voltage_v = {rating_v:g} V;"
        f" {needed} keeps below it, unless other means protect the devices"
    )


def braking_starts(drive: Drive, capacitance_f: float) -> Starts:
    """Regeneration goes on until the over-voltage trip has opened the bridge."""
    machine = coldest(drive)
    w, d, q = _regulated(drive, machine)
    saliency = machine.q_inductance_h - machine.d_inductance_h
    shaft_w = -1.5 * w * (float(machine.flux_wb) - saliency * d) * q
    returned_w = shaft_w - 1.5 * float(machine.resistance_ohm) * (d**2 + q**2)
    late_s = TRIP_PERIODS / drive.inverter.pwm_frequency_hz
    trip_v = derived.overvoltage_trip_v(drive)
    beyond_v2 = 2.0 * np.maximum(returned_w, 0.0) * late_s / capacitance_f
    return Starts(w, d, q, np.sqrt(trip_v**2 + beyond_v2))


def falling_starts(drive: Drive) -> Starts:
    """Driving or field weakening empties the bus until the under-voltage trip."""
    w, d, q = _regulated(drive, coldest(drive))
    return Starts(w, d, -q, np.full_like(w, loops.undervoltage_trip_v(drive)))


def conducting_starts(drive: Drive) -> Starts:
    """Above the EMF limit of an empty battery the diodes of an open bridge already conduct."""
    machine, inverter, battery = coldest(drive), drive.inverter, drive.battery
    w = np.linspace(0.0, OVERSPEED, 4 * SPEEDS + 1)[1:] * derived.omega_max(drive)
    drops = 2.0 * inverter.diode_forward_voltage_v
    emf = w * float(machine.flux_wb)
    conducts = emf > SIX_STEP * (battery.min_voltage_v + drops)
    w, emf = w[conducts], emf[conducts]
    ohm = float(machine.resistance_ohm) + inverter.diode_resistance_ohm
    battery_ohm = battery.series_resistance_ohm * drive.vehicle.driven_wheels
    x_d, x_q = w * machine.d_inductance_h, w * machine.q_inductance_h
    # The diodes oppose the current: a resistance z in the phases with z |i| = SIX_STEP (v + 2 V_f).
    low, high = np.full_like(w, -6.0), np.full_like(w, 4.0)  # of its logarithm
    d, q, bus_v = np.zeros_like(w), np.zeros_like(w), np.zeros_like(w)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        z = 10.0**middle + ohm
        d, q = -x_q * emf / (z**2 + x_d * x_q), -z * emf / (z**2 + x_d * x_q)
        current = np.hypot(d, q)
        bus_v = battery.min_voltage_v + battery_ohm * 1.5 * SIX_STEP * current
        over = (z - ohm) * current > SIX_STEP * (bus_v + drops)
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return Starts(w, d, q, bus_v)


def _regulated(drive: Drive, machine: models.Machine) -> tuple[Array, Array, Array]:
    """Return speeds and braking currents at the first bound on the way out from zero current.

    Bounds: phase current, largest torque and power, the voltage of a full battery. i_d is at least
    that of most torque per current: the least loss lies beyond it.
    """
    motor = drive.motor
    l_d, l_q, psi = machine.d_inductance_h, machine.q_inductance_h, float(machine.flux_wb)
    saliency = l_q - l_d
    speeds = np.linspace(0.0, OVERSPEED, SPEEDS + 1)[1:] * derived.omega_max(drive)
    angles = np.linspace(0.0, 0.5 * math.pi, ANGLES)
    w, angle = (x.ravel() for x in np.meshgrid(speeds, angles, indexing="ij"))
    d, q = -np.cos(angle), -np.sin(angle)  # of one ampere
    # Torque (psi - saliency m d) m |q| over 1.5 p.
    most = np.minimum(motor.max_torque_nm, motor.max_power_w * motor.pole_pairs / w)
    most /= 1.5 * motor.pole_pairs
    linear, square = psi * -q, saliency * d * q
    root = np.sqrt(np.maximum(linear**2 + 4.0 * square * most, 0.0))
    by_torque = 2.0 * most / np.maximum(linear + root, 1e-12)
    # Voltage: |omega (L_d m d + psi)|^2 + |omega L_q m q|^2 = (v / sqrt 3)^2.
    a = (l_d * d) ** 2 + (l_q * q) ** 2
    b, c = psi * l_d * d, psi**2 - (drive.battery.max_voltage_v / (math.sqrt(3.0) * w)) ** 2
    under = b**2 - a * c
    spread = np.sqrt(np.maximum(under, 0.0))
    largest = np.minimum(np.minimum(by_torque, motor.max_phase_current_a), (spread - b) / a)
    root = np.sqrt(psi**2 + 8.0 * (saliency * largest) ** 2)
    best_d = -2.0 * saliency * largest**2 / (psi + root)
    inside = (under >= 0.0) & (largest > 0.0) & (largest >= (-spread - b) / a)
    inside &= (largest * d <= best_d + 0.02 * largest) | (saliency <= 0.0)
    return w[inside], (largest * d)[inside], (largest * q)[inside]
