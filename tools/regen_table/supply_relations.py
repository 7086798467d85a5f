# SPDX-License-Identifier: Apache-2.0
"""Relations between board, battery, bus and bridge: voltages and currents that each stands."""

import itertools
from collections.abc import Iterator

from regen_table import boards, derived, loops
from regen_table.section import at_most
from regen_table.sections import Drive
from regen_table.suggest import suggestion

FULL_SCALE_TOLERANCE = 0.05  # as boot.c
LONGEST_PULSE_SHARE = 0.1  # of the PWM period, as validate.c


def board(drive: Drive) -> Iterator[str]:
    """Refuse another board's full scales and window, as the start of its firmware does."""
    inverter, named = drive.inverter, drive.inverter.board
    if named is None:
        return
    yield from unknown_board(named)
    board = boards.known().get(named)
    if board is None:
        return
    for key, unit in (("current_full_scale_a", "A"), ("voltage_full_scale_v", "V")):
        value, of_board = getattr(inverter, key), getattr(board, key)
        if abs(value - of_board) > FULL_SCALE_TOLERANCE * of_board:
            yield (
                f"inverter.{key}: {value:g} {unit}, accepted: {of_board:.4g} {unit} within 5 %,"
                f" which is what {named} measures"
            )
    if inverter.dead_time_s < board.dead_time_s * (1.0 - 1e-9):
        yield (
            f"inverter.dead_time_s: {inverter.dead_time_s:g} s, accepted: at least"
            f" {board.dead_time_s:g} s, the least of {named}"
        )
    window_s = board.window_s(inverter.dead_time_s)
    if window_s is not None and loops.min_pulse_s(drive) < window_s * (1.0 - 1e-9):
        yield (
            f"inverter.min_pulse_s: {loops.min_pulse_s(drive):g} s, accepted: at least"
            f" {window_s:.4g} s, in which the low-side shunts of {named} settle and are sampled"
            f" with dead_time_s = {inverter.dead_time_s:g} s"
        )
    if drive.battery.max_voltage_v > board.voltage_most_v:
        yield (
            f"battery.max_voltage_v: {drive.battery.max_voltage_v:g} V, accepted: at most"
            f" {board.voltage_most_v:g} V, which {named} stands"
        )
    if drive.motor.max_phase_current_a > board.current_most_a:
        yield (
            f"motor.max_phase_current_a: {drive.motor.max_phase_current_a:g} A, accepted: at most"
            f" {board.current_most_a:g} A, which {named} carries"
        )


def low_pulses(drive: Drive) -> Iterator[str]:
    """Refuse shortest pulses beyond a tenth of the PWM period, as the firmware does."""
    inverter, pulse_s = drive.inverter, loops.min_pulse_s(drive)
    most_s = LONGEST_PULSE_SHARE / inverter.pwm_frequency_hz
    if pulse_s <= most_s * (1.0 + 1e-9):
        return
    key, value, most = "min_pulse_s", pulse_s, most_s
    if inverter.min_pulse_s is None:
        key, value, most = "dead_time_s", inverter.dead_time_s, most_s / 2.0
    yield (
        f"inverter.{key}: {value:g} s, accepted: at most {most:.4g} s; beyond, the shortest pulse"
        " takes more than a tenth of the PWM period"
    )


def unknown_board(named: str) -> Iterator[str]:
    """Refuse a board without a header."""
    if named not in boards.known():
        yield f"inverter.board: no {named!r}, {suggestion(named, boards.known())}"


def battery(drive: Drive) -> Iterator[str]:
    """Refuse voltages out of order, and a curve of the charge outside them."""
    battery = drive.battery
    lowest, highest, voltage = (
        battery.min_voltage_v,
        battery.max_voltage_v,
        battery.open_circuit_voltage_v,
    )
    if lowest >= highest:
        yield (
            f"battery.min_voltage_v: {lowest:g} V, accepted: less than max_voltage_v ="
            f" {highest:g} V"
        )
    if isinstance(voltage, float | int):
        if not lowest <= voltage <= highest:
            yield (
                f"battery.open_circuit_voltage_v: {voltage:g} V, accepted: from min_voltage_v ="
                f" {lowest:g} V to max_voltage_v = {highest:g} V"
            )
        return
    if len(voltage) < 2:
        yield (
            "battery.open_circuit_voltage_v: one point, accepted: at least two [soc, V] points, or"
            " one number"
        )
        return
    pairs = list(itertools.pairwise(voltage))
    if any(b[0] <= a[0] or b[1] < a[1] for a, b in pairs):
        yield (
            "battery.open_circuit_voltage_v: accepted: soc rising and voltage not falling from"
            " point to point"
        )
    if voltage[0][1] > highest or voltage[-1][1] < lowest:
        yield (
            "battery.open_circuit_voltage_v: accepted: a curve that meets min_voltage_v ="
            f" {lowest:g} V to max_voltage_v = {highest:g} V"
        )
    rest = derived.initial_open_circuit_v(drive)
    if not lowest <= rest <= highest:
        yield (
            f"battery.initial_soc: {battery.initial_soc:g}, where the pack rests at {rest:.4g} V,"
            f" accepted: a charge that rests from min_voltage_v = {lowest:g} V to max_voltage_v ="
            f" {highest:g} V"
        )


def foldback(drive: Drive) -> Iterator[str]:
    """Refuse a fold-back that begins outside the voltages."""
    battery = drive.battery
    lowest, highest = battery.min_voltage_v, battery.max_voltage_v
    for key in ("charge_foldback_voltage_v", "discharge_foldback_voltage_v"):
        value = getattr(battery, key)
        if value is not None and not lowest < value < highest:
            yield (
                f"battery.{key}: {value:g} V, accepted: more than min_voltage_v = {lowest:g} V "
                f"and less than max_voltage_v = {highest:g} V"
            )


def trips(drive: Drive) -> Iterator[str]:
    """Refuse trips inside the voltages, and beyond what is measured."""
    battery, monitor, inverter = drive.battery, drive.monitor, drive.inverter
    seen = 0.999 * inverter.voltage_full_scale_v
    high, low = monitor.overvoltage_v, monitor.undervoltage_v
    if high is not None and not battery.max_voltage_v < high <= seen:
        yield (
            f"monitor.overvoltage_v: {high:g} V, accepted: more than battery.max_voltage_v ="
            f" {battery.max_voltage_v:g} V, at most {seen:.4g} V of inverter.voltage_full_scale_v ="
            f" {inverter.voltage_full_scale_v:g} V"
        )
    if low is not None and low >= battery.min_voltage_v:
        yield (
            f"monitor.undervoltage_v: {low:g} V, accepted: "
            f"less than battery.min_voltage_v = {battery.min_voltage_v:g} V"
        )
    yield from at_most(monitor, "monitor", "coasting_m_per_s2", "tyre_grip_m_per_s2", "m/s2")


def devices(drive: Drive) -> Iterator[str]:
    """Refuse devices that do not stand the trip, and offsets beyond their tolerance."""
    inverter, trip = drive.inverter, derived.overvoltage_trip_v(drive)
    rating = inverter.device_voltage_v
    if rating is not None and rating < trip:
        yield (
            f"inverter.device_voltage_v: {rating:g} V, accepted: at least {trip:.4g} V, where the"
            " over-voltage trip lies"
        )
    tolerance = drive.monitor.offset_tolerance_codes
    worst = max(inverter.current_offset_codes, key=lambda code: abs(code - 2048.0))
    if abs(worst - 2048.0) > tolerance:
        yield (
            f"inverter.current_offset_codes: {worst:g}, accepted: {2048 - tolerance} to"
            f" {2048 + tolerance}, within monitor.offset_tolerance_codes of the middle"
        )


def emf(drive: Drive) -> Iterator[str]:
    """Refuse an EMF above the trip, unless field weakening brings it to the least voltage."""
    emf, trip = derived.line_emf_v(drive), derived.overvoltage_trip_v(drive)
    if emf <= trip:
        return
    where = (
        f"motor.max_speed_rpm: the back-EMF at {drive.motor.max_speed_rpm:g} r/min is {emf:.4g} V"
        " between lines"
    )
    per_volt = emf / drive.motor.flux_linkage_wb
    weakening = drive.control.field_weakening_current_a or 0.0
    if weakening == 0.0:
        allowed = drive.motor.max_speed_rpm * trip / emf
        yield (
            f"{where}, accepted: at most the bus limit of {trip:.4g} V ({allowed:.4g} r/min), or"
            " control.field_weakening_current_a > 0"
        )
        return
    weakened = per_volt * max(
        drive.motor.flux_linkage_wb - drive.motor.d_inductance_h * weakening, 0.0
    )
    lowest = drive.battery.min_voltage_v
    if weakened > lowest:
        needed = (drive.motor.flux_linkage_wb - lowest / per_volt) / drive.motor.d_inductance_h
        yield (
            f"{where}, above the bus limit of {trip:.4g} V; control.field_weakening_current_a ="
            f" {weakening:g} A weakens it to {weakened:.4g} V, accepted: at most"
            f" battery.min_voltage_v = {lowest:g} V, which takes {needed:.4g} A"
        )
