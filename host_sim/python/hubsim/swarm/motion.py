# SPDX-License-Identifier: Apache-2.0
"""What the judge computes itself: windows over rows, and the torques that physics decides."""

import numpy as np
from regen_table.schema import Drive

from hubsim.engine import Rows

SIX_STEP = 2.0 / np.pi  # amplitude of a phase's fundamental over the bus voltage: diodes conduct
LEAST_RAD_S = 0.5
LEAST_WAY_M = 1e-3


def largest_of(values: Rows, rows: int) -> Rows:
    """Return the largest of each row and the ones before it, so many in all."""
    out, span = values.copy(), 1
    while span < min(rows, len(values)):
        step = min(span, rows - span)
        later = np.maximum(out[step:], out[:-step])
        out[step:] = later
        span += step
    return out


def smallest_of(values: Rows, rows: int) -> Rows:
    """Return the smallest of each row and the ones before it."""
    return -largest_of(-values, rows)


def means_of(values: Rows, rows: int) -> Rows:
    """Return the mean of every so many rows in a row, at the last of them; zero before."""
    out = np.zeros_like(values)
    if len(values) >= rows:
        sums = np.concatenate([[0.0], np.cumsum(values)])
        out[rows - 1 :] = (sums[rows:] - sums[:-rows]) / rows
    return out


def longest(flags: np.typing.NDArray[np.bool_]) -> tuple[int, int]:
    """Return how many rows in a row are true at most, and the first of these."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    if not len(edges):
        return 0, 0
    spans = edges[1::2] - edges[::2]
    k = int(np.argmax(spans))
    return int(spans[k]), int(edges[::2][k])


def changes_in(values: Rows, rows: int) -> Rows:
    """Return how often a signal changed in each row and the ones before it, so many in all."""
    changed = np.concatenate([[0.0], (np.diff(values) != 0.0).astype(float)])
    sums = np.concatenate([np.zeros(rows), np.cumsum(changed)])
    out: Rows = sums[rows:] - sums[:-rows]
    return out


def slope_of(height_m: Rows, distance_m: Rows, rows: int) -> Rows:
    """Return how steeply each row was climbed, along the way of the rows before; 0 at rest."""
    out = np.zeros_like(height_m)
    way_m = np.abs(distance_m[rows:] - distance_m[:-rows])
    risen_m = height_m[rows:] - height_m[:-rows]
    out[rows:] = np.where(way_m > LEAST_WAY_M, risen_m / np.maximum(way_m, LEAST_WAY_M), 0.0)
    return out


def coasting_nm(drive: Drive, speed_rad_s: Rows) -> Rows:
    """Return the torque that iron and bearings take from a coasting wheel, a magnitude."""
    motor = drive.motor
    omega = motor.pole_pairs * np.abs(speed_rad_s)
    out: Rows = motor.friction_torque_nm + motor.viscous_friction_nm_s * np.abs(speed_rad_s)
    if motor.iron_loss_resistance_ohm is not None:
        a0, a1 = motor.iron_loss_resistance_ohm
        iron_w = 1.5 * (omega * motor.flux_linkage_wb) ** 2 / (a0 + a1 * omega)
        out = out + iron_w / np.maximum(np.abs(speed_rad_s), LEAST_RAD_S)
    return out


def short_nm(drive: Drive, speed_rad_s: Rows) -> Rows:
    """Return the braking torque of a settled active short circuit (physics: both axes)."""
    current_d, current_q = _short_a(drive, speed_rad_s)
    motor = drive.motor
    reluctance = (motor.d_inductance_h - motor.q_inductance_h) * current_d
    out: Rows = -1.5 * motor.pole_pairs * (motor.flux_linkage_wb + reluctance) * current_q
    return np.maximum(out, 0.0)


def short_a(drive: Drive, speed_rad_s: Rows) -> Rows:
    """Return the length of its current vector."""
    current_d, current_q = _short_a(drive, speed_rad_s)
    return np.hypot(current_d, current_q)


def _short_a(drive: Drive, speed_rad_s: Rows) -> tuple[Rows, Rows]:
    motor = drive.motor
    omega = motor.pole_pairs * np.abs(speed_rad_s)
    resistance = motor.phase_resistance_ohm + drive.inverter.switch_resistance_ohm
    below = resistance**2 + omega**2 * motor.d_inductance_h * motor.q_inductance_h
    current_q = -omega * motor.flux_linkage_wb * resistance / below
    current_d = -(omega**2) * motor.q_inductance_h * motor.flux_linkage_wb / below
    return current_d, current_q


def open_nm(drive: Drive, speed_rad_s: Rows, bus_v: Rows) -> tuple[Rows, Rows]:
    """Return braking torque and charging current of an open bridge.

    Its diodes conduct where the EMF between lines is more than bus and two diodes; then terminal
    voltage and current are in phase: (w psi)^2 = (u + R i)^2 + (w L i)^2 with the six-step u.
    """
    motor, inverter = drive.motor, drive.inverter
    omega = motor.pole_pairs * np.abs(speed_rad_s)
    resistance = motor.phase_resistance_ohm + inverter.diode_resistance_ohm
    reactance = omega * 0.5 * (motor.d_inductance_h + motor.q_inductance_h)
    drops_v = bus_v + 2.0 * inverter.diode_forward_voltage_v
    phase_v = SIX_STEP * drops_v
    emf = omega * motor.flux_linkage_wb
    square = resistance**2 + reactance**2
    under = (phase_v * resistance) ** 2 + square * (emf**2 - phase_v**2)
    conducts = (np.sqrt(3.0) * emf > drops_v) & (under > 0.0)
    root = np.sqrt(np.where(conducts, under, 0.0))
    current = np.maximum(np.where(conducts, root - phase_v * resistance, 0.0), 0.0) / square
    power_w = 1.5 * current * (phase_v + resistance * current)
    charge_a = 1.5 * current * phase_v / np.maximum(bus_v, 1.0)
    return power_w / np.maximum(np.abs(speed_rad_s), LEAST_RAD_S), charge_a


def feasible_nm(drive: Drive, speed_rad_s: Rows, bus_v: Rows, charge_a: Rows) -> Rows:
    """Return the least braking torque of a bridge that controls none, N m.

    Of open bridge and active short circuit the one that brakes less, where its current is
    admissible: the pack takes the charging current, the phases the short circuit's. Near the limit
    of that, and where neither is, the larger of the two: parts are known within a tenth.
    """
    opened_nm, opened_a = open_nm(drive, speed_rad_s, bus_v)
    shorted_nm = short_nm(drive, speed_rad_s)
    short_ok = short_a(drive, speed_rad_s) < 0.9 * drive.motor.max_phase_current_a
    open_ok = opened_a < 0.9 * charge_a
    least: Rows = np.where(
        short_ok & open_ok,
        np.minimum(opened_nm, shorted_nm),
        np.where(opened_a == 0.0, 0.0, np.maximum(opened_nm, shorted_nm)),
    )
    return least
