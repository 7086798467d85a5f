# SPDX-License-Identifier: Apache-2.0
"""Relations between the keys of sensors: of temperature, of the rotor's angle, of the pedals."""

import itertools
import math
from collections.abc import Iterator

from regen_table import derived
from regen_table.monitor_section import Monitor
from regen_table.section import at_most
from regen_table.sections import Drive


def temperature_sensors(drive: Drive) -> Iterator[str]:
    """Refuse a temperature that limits, but is neither measured nor estimated."""
    monitor, thermal = drive.monitor, drive.thermal
    hottest = drive.inverter.max_switch_temperature_c
    if monitor.winding_sensor == "none" and thermal.winding_heat_capacity_j_per_k == 0.0:
        yield (
            'monitor.winding_sensor: "none", accepted: a sensor, or an estimate by'
            " thermal.winding_heat_capacity_j_per_k and its kin"
        )
    if (
        monitor.switch_sensor == "none"
        and hottest is not None
        and thermal.switch_heat_capacity_j_per_k == 0.0
    ):
        yield (
            'monitor.switch_sensor: "none", accepted: a sensor, an estimate by'
            " thermal.switch_heat_capacity_j_per_k and its kin, or no"
            " inverter.max_switch_temperature_c"
        )
    yield from at_most(monitor, "monitor", "coldest_ambient_c", "warmest_ambient_c", "degC")
    for which in ("winding", "switch"):
        yield from _sensor_points(monitor, which)


def _sensor_points(monitor: Monitor, which: str) -> Iterator[str]:
    """Refuse a table whose temperature does not rise, or whose resistance turns back."""
    kind, points = getattr(monitor, f"{which}_sensor"), getattr(monitor, f"{which}_sensor_points")
    if (kind == "table") != (points is not None):
        yield f'monitor.{which}_sensor_points: accepted: with {which}_sensor = "table", and only so'
    if points is None:
        return
    pairs = list(itertools.pairwise(points))
    rises = all(after[0] > before[0] for before, after in pairs)
    ways = {after[1] > before[1] for before, after in pairs if after[1] != before[1]}
    if not rises or len(ways) != 1 or any(after[1] == before[1] for before, after in pairs):
        yield (
            f"monitor.{which}_sensor_points: accepted: rising temperatures, and resistances that"
            " all rise or all fall"
        )


def hall(drive: Drive) -> Iterator[str]:
    """Refuse edges that are not six, in order, once around."""
    edges = drive.rotor.hall_edges_deg
    widths = [(b - a) % 360.0 for a, b in zip(edges, (*edges[1:], edges[0]), strict=True)]
    if not math.isclose(sum(widths), 360.0) or not all(30.0 <= width <= 90.0 for width in widths):
        yield (
            "rotor.hall_edges_deg: accepted: six edges in forward order, 30 to 90 deg apart, once"
            " around"
        )


def hall_hand_over(drive: Drive) -> Iterator[str]:
    """Below a turn a second, halls take a sector of 90 deg (a quarter second) for standstill."""
    slowest, control = 60.0 / drive.motor.pole_pairs, drive.control
    if drive.rotor.sensor == "hall" and control.handover_start_rpm <= slowest:
        yield (
            f"control.handover_start_rpm: {control.handover_start_rpm:g} r/min, accepted: more"
            f" than {slowest:.6g} r/min, where electric braking ends at the latest with halls"
        )
    if drive.rotor.sensor == "hall" and drive.control.handover_end_rpm < slowest:
        yield (
            f"control.handover_end_rpm: {drive.control.handover_end_rpm:g} r/min, accepted: at"
            f" least {slowest:.6g} r/min, down to which hall sensors measure the speed of a motor"
            f" with {drive.motor.pole_pairs} pole pairs"
        )


def encoder(drive: Drive) -> Iterator[str]:
    """Refuse an encoder without counts or index, too coarse, or of too wide an index."""
    rotor, pole_pairs = drive.rotor, drive.motor.pole_pairs
    if rotor.sensor != "encoder":
        return
    if rotor.encoder_counts is None:
        yield (
            'rotor.encoder_counts: missing, accepted with sensor = "encoder": counts in a'
            " mechanical turn, four to a line"
        )
        return
    if rotor.encoder_index_deg is None:
        yield (
            'rotor.encoder_index_deg: missing, accepted with sensor = "encoder": the electrical'
            " angle at the index, 0 to 360 deg"
        )
    if rotor.encoder_counts < 32 * pole_pairs:
        yield (
            f"rotor.encoder_counts: {rotor.encoder_counts}, accepted: at least {32 * pole_pairs},"
            f" 32 for each of {pole_pairs} pole pairs"
        )
    widest = rotor.encoder_counts // (12 * pole_pairs)
    if rotor.encoder_index_tolerance_counts > widest:
        yield (
            f"rotor.encoder_index_tolerance_counts: {rotor.encoder_index_tolerance_counts},"
            f" accepted: at most {widest}, 30 deg electrical"
        )


def pedals(drive: Drive) -> Iterator[str]:
    """Refuse channels whose ends do not enclose released and pressed, well apart."""
    pedals = drive.pedals
    wired = [
        *range(pedals.accelerator_channels),
        *range(2, 2 + pedals.brake_channels),
    ]
    for k in wired:
        low, high = sorted((pedals.released[k], pedals.pressed[k]))
        if not (pedals.lowest[k] < low and high < pedals.highest[k] and high - low >= 0.1001):
            yield (
                f"pedals.released: channel {k} goes from {pedals.released[k]:g} to"
                f" {pedals.pressed[k]:g}, accepted: at least 0.1001 apart and between lowest ="
                f" {pedals.lowest[k]:g} and highest = {pedals.highest[k]:g}"
            )
    end, full = derived.free_travel_torque_nm(drive), derived.pedal_brake_torque_nm(drive)
    if end > full:
        yield (
            f"pedals.free_travel_torque_nm: {end:g} N m, accepted: at most brake_torque_nm ="
            f" {full:g} N m"
        )
