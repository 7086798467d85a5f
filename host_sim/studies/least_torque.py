# SPDX-License-Identifier: Apache-2.0
"""The least torque of a motor of which none is wanted: PWM, freewheel or active short circuit.

Steady states in double precision; nothing of the firmware. Peak phase quantities; iron loss apart.
PWM has the circle of the phase current and the ellipse of the voltage that the firmware uses in
steady state (``control.modulation_target`` less its reserve). A rectifier's phase voltage lies
between v/sqrt(3), where the current is about to begin, and the six-step wave's 2/pi v.
"""

import math
from dataclasses import dataclass

import numpy as np
from hubsim.engine import Rows
from regen_table import models, stop_limits
from regen_table.schema import Drive

PWM, FREEWHEEL, SHORT = "PWM", "freewheel", "short"
POINTS = 400
STEPS = 50


@dataclass(frozen=True)
class State:
    """Speed of the wheel, and what holds the bus.

    ``source_v``: of the battery behind its series resistance. ``charge_a``: that it takes of this
    vehicle, as it reports it.
    """

    speed_rad_s: float
    source_v: float
    bus_v: float
    winding_c: float
    charge_a: float
    connected: bool


@dataclass(frozen=True)
class Least:
    """The least admissible |torque|, N m >= 0, without iron loss, and how."""

    torque_nm: float
    way: str


def iron_drag_nm(drive: Drive, speed_rad_s: Rows) -> Rows:
    """Return the torque that turning the magnets takes without any current, N m >= 0."""
    machine = models.machine(drive, drive.motor.reference_temperature_c)
    omega = machine.pole_pairs * np.abs(speed_rad_s)
    emf = omega * machine.flux_wb
    return (
        1.5
        * machine.pole_pairs
        * machine.flux_wb
        * emf
        * machine.iron_ratio(omega)
        / np.where(omega > 0.0, omega, 1.0)
    )


def least(drive: Drive, at: State) -> Least:
    """Return the least torque of all admissible ways.

    Without any, freewheel as long as it keeps the bus below the devices' rating.
    """
    motor, inverter = drive.motor, drive.inverter
    found: list[tuple[float, str]] = []
    pwm = pwm_nm(drive, at) if at.connected else None
    if pwm is not None:
        found.append((pwm, PWM))
    torque, current, charging, bus = freewheel(drive, at)
    rating_v = inverter.device_voltage_v
    below_rating = rating_v is None or bus < rating_v
    fits = current <= motor.max_phase_current_a and charging <= _charge_a(drive, at)
    if fits and below_rating:
        found.append((torque, FREEWHEEL))
    shorted, current = short(drive, at)
    if current <= motor.max_phase_current_a:
        found.append((shorted, SHORT))
    otherwise = (torque, FREEWHEEL) if below_rating else (shorted, SHORT)
    return Least(*min(found, default=otherwise))


def _charge_a(drive: Drive, at: State) -> float:
    return min(at.charge_a / drive.vehicle.driven_wheels, drive.battery.max_charge_current_a)


def _machine(drive: Drive, at: State) -> tuple[models.Machine, float, float, float]:
    """Return the motor, its electrical speed, resistance with the bridge's, and EMF."""
    machine = models.machine(drive, at.winding_c)
    omega = machine.pole_pairs * at.speed_rad_s
    ohm = float(machine.resistance_ohm) + drive.inverter.switch_resistance_ohm
    return machine, omega, ohm, omega * float(machine.flux_wb)


def _torque(machine: models.Machine, i_d: Rows, i_q: Rows) -> Rows:
    saliency = machine.d_inductance_h - machine.q_inductance_h
    return 1.5 * machine.pole_pairs * (machine.flux_wb + saliency * i_d) * i_q


def pwm_nm(drive: Drive, at: State) -> float | None:
    """Return the least |torque| inside current and voltage, none where they have no common point.

    At every i_d the squared voltage is a parabola over i_q.
    """
    machine, omega, ohm, emf = _machine(drive, at)
    most = drive.motor.max_phase_current_a
    voltage = float(stop_limits.largest_voltage_v(drive, np.array(omega), np.array(at.source_v)))
    i_d = -most * np.linspace(0.0, 1.0, POINTS)
    x_d, x_q = omega * machine.d_inductance_h, omega * machine.q_inductance_h
    # u_d = R i_d - x_q i_q, u_q = R i_q + x_d i_d + E
    back = x_d * i_d + emf
    squared, half = ohm**2 + x_q**2, ohm * back - ohm * i_d * x_q
    rest = (ohm * i_d) ** 2 + back**2 - voltage**2
    under = half**2 - squared * rest
    root = np.sqrt(np.maximum(under, 0.0))
    circle = np.sqrt(most**2 - i_d**2)
    low = np.maximum((-half - root) / squared, -circle)
    high = np.minimum((-half + root) / squared, circle)
    possible = (under >= 0.0) & (low <= high)
    if not np.any(possible):
        return None
    i_q = np.clip(0.0, low, high)
    return float(np.min(np.abs(_torque(machine, i_d, i_q))[possible]))


def short(drive: Drive, at: State) -> tuple[float, float]:
    """Return |torque| and current of the steady short circuit."""
    machine, omega, ohm, emf = _machine(drive, at)
    x_d, x_q = omega * machine.d_inductance_h, omega * machine.q_inductance_h
    squared = ohm**2 + x_d * x_q
    i_d, i_q = -x_q * emf / squared, -ohm * emf / squared
    torque = _torque(machine, np.array(i_d), np.array(i_q))
    return float(abs(torque)), math.hypot(i_d, i_q)


def freewheel(drive: Drive, at: State) -> tuple[float, float, float, float]:
    """Return |torque|, phase and charging current and the bus voltage of conducting diodes."""
    machine, omega, ohm, emf = _machine(drive, at)
    drop_v = 2.0 * drive.inverter.diode_forward_voltage_v
    if not at.connected:
        return 0.0, 0.0, 0.0, max(at.bus_v, math.sqrt(3.0) * emf - drop_v)
    series = drive.battery.series_resistance_ohm + drive.bus.cable_resistance_ohm
    each = series * drive.vehicle.driven_wheels
    # The diodes oppose the current: a resistance z, such that z |i| is the phase voltage.
    x_d, x_q = omega * machine.d_inductance_h, omega * machine.q_inductance_h
    found = (0.0, 0.0, 0.0, at.source_v)
    for share in (1.0 / math.sqrt(3.0), 2.0 / math.pi):
        low, high = -12.0, 6.0  # of log10 of z
        for _ in range(STEPS):
            z = 10.0 ** (0.5 * (low + high)) + ohm
            squared = z**2 + x_d * x_q
            i_d, i_q = -x_q * emf / squared, -z * emf / squared
            current = math.hypot(i_d, i_q)
            charging = 1.5 * share * current
            bus = at.source_v + each * charging
            if (z - ohm) * current > share * (bus + drop_v):
                high = math.log10(max(z - ohm, 1e-12))
            else:
                low = math.log10(max(z - ohm, 1e-12))
        torque = float(abs(_torque(machine, np.array(i_d), np.array(i_q))))
        # About to conduct: z without bound.
        if share * (at.source_v + drop_v) < emf and torque > found[0]:
            found = (torque, current, charging, bus)
    return found
