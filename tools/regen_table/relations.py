# SPDX-License-Identifier: Apache-2.0
"""Relations between the keys of a drive: what no single range can express.

An error refuses the drive (it could not be built or could not brake); a warning describes a drive
that
works, but not as its numbers promise. Plain scalar arithmetic, so that the simulator, which reads
the same files, loads nothing more for it.
"""

import itertools
import math
from collections.abc import Callable, Iterator

from regen_table import boards, derived
from regen_table.monitor_section import Monitor
from regen_table.plant_sections import Section
from regen_table.sections import Drive
from regen_table.suggest import suggestion

CAN_BASE_STEP = 32  # config.h: CONFIG_CAN_BASE_STEP
CAN_IDENTIFIERS = 160  # config.h: CONFIG_CAN_IDENTIFIERS
SERVICE_BASE_STEP = 8  # config.h: CONFIG_SERVICE_BASE_STEP
# Beyond any real drive, and where the firmware's model of the motor leaves its number formats
# (firmware/config/physics.h).
SALIENCY_MAX = 16.0
INVERSE_SALIENCY_MAX = 4.0
RELUCTANCE_MAX = 16.0
LARGEST_FLUX_WB = 2.0  # as in sections
IRON_RESISTANCES_MAX = 2048.0
BACK_EMF_PARTS = 32.0
LEAST_TORQUE_NM = 0.01  # that a motor can have as its rated one
FULL_SCALE_TOLERANCE = 0.05  # as boot.c
EMF_TOLERANCE = 0.01  # flux linkage and voltages are not known any better


def mistakes(drive: Drive) -> list[str]:
    """Return one line "section.key: what, accepted" for everything that does not hold together."""
    found: list[str] = []
    for check in _CHECKS:
        try:
            found += check(drive)
        except ArithmeticError:  # with values that a check before has refused
            if not found:
                raise
    return found


def warnings(drive: Drive) -> list[str]:
    """Return one line for everything that works, but not as promised."""
    found = []
    motor, battery = drive.motor, drive.battery
    reachable = derived.largest_torque_nm(drive, motor.max_phase_current_a)
    if motor.max_torque_nm > reachable:
        found.append(
            f"motor.max_torque_nm: {motor.max_torque_nm:g} N m is never reached: "
            f"max_phase_current_a = {motor.max_phase_current_a:g} A gives {reachable:.4g} N m"
        )
    emf, bus = derived.line_emf_v(drive), derived.lowest_open_circuit_v(drive)
    if emf > bus:
        found.append(
            f"motor.max_speed_rpm: the back-EMF there is {emf:.4g} V between lines, above the"
            f" battery's {bus:.4g} V: current flows into the battery when the bridge is off"
        )
    if drive.brake.electric_rated_torque_nm > motor.max_torque_nm:
        found.append(
            f"brake.electric_rated_torque_nm: {drive.brake.electric_rated_torque_nm:g} N m is more"
            f" than motor.max_torque_nm = {motor.max_torque_nm:g} N m"
        )
    if battery.max_charge_current_a == 0.0:
        found.append("battery.max_charge_current_a: 0 A leaves no regeneration at all")
    rest, foldback = derived.initial_open_circuit_v(drive), derived.foldback_voltage_v(drive)
    if rest >= foldback:
        constant = isinstance(battery.open_circuit_voltage_v, float | int)
        key = "open_circuit_voltage_v" if constant else "initial_soc"
        found.append(
            f"battery.{key}: the pack rests at {rest:.4g} V when work begins, inside the fold-back"
            f" of the charge current, {foldback:.4g} V to max_voltage_v = {battery.max_voltage_v:g}"
            " V: next to no regeneration until it is discharged"
        )
    if absent := absent_soc(drive):
        found.append(absent)
    if drive.inverter.device_voltage_v is None:
        found.append(
            "inverter.device_voltage_v: absent, taken as the over-voltage trip, "
            f"{derived.overvoltage_trip_v(drive):.4g} V: give what switches and capacitors stand"
        )
    if drive.inverter.bus_capacitance_f == 0.0:
        found.append(
            "inverter.bus_capacitance_f: absent, taken as 0: an active short circuit ends only"
            " without current"
        )
    if drive.inverter.max_switch_temperature_c is None:
        found.append(
            "inverter.max_switch_temperature_c: absent, so switches of any temperature carry up to"
            f" max_phase_current_a = {motor.max_phase_current_a:g} A and a broken sensor is not"
            f" noticed; the winding is derated up to {motor.max_winding_temperature_c:g} degC"
        )
    thermal = drive.thermal
    for part, capacity in (
        ("winding", thermal.winding_heat_capacity_j_per_k),
        ("switch", thermal.switch_heat_capacity_j_per_k),
    ):
        if capacity == 0.0:
            found.append(
                f"thermal.{part}_heat_capacity_j_per_k: absent, so the controller does not estimate"
                f" this temperature: a sensor that lags or reads low is not noticed, and a broken"
                " one ends the torque"
            )
    return found


def absent_soc(drive: Drive) -> str | None:
    """Return the warning of a drive whose file says no state of charge; None where it does."""
    if "initial_soc" in drive.battery.model_fields_set:
        return None
    return (
        f"battery.initial_soc: absent, work begins at {drive.battery.initial_soc:g}; the state of"
        " charge decides what the pack takes"
    )


def _at_most(keys: Section, section: str, lower: str, upper: str, unit: str) -> Iterator[str]:
    """Of two keys of a section the one that the file gives is named; the lower if it gives both."""
    low, high = getattr(keys, lower), getattr(keys, upper)
    if low <= high:
        return
    if lower in keys.model_fields_set:
        yield f"{section}.{lower}: {low:g} {unit}, accepted: at most {upper} = {high:g} {unit}"
    else:
        yield f"{section}.{upper}: {high:g} {unit}, accepted: at least {lower} = {low:g} {unit}"


def _temperature_sensors(drive: Drive) -> Iterator[str]:
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
    yield from _at_most(monitor, "monitor", "coldest_ambient_c", "warmest_ambient_c", "degC")
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


def _identifiers(drive: Drive) -> Iterator[str]:
    base = drive.vehicle.can_base
    if base % CAN_BASE_STEP:
        yield f"vehicle.can_base: {base}, accepted: a multiple of {CAN_BASE_STEP}"
    service = drive.service.can_base
    if service and (service % SERVICE_BASE_STEP or service < base + CAN_IDENTIFIERS):
        yield (
            f"service.can_base: {service}, accepted: 0, or a multiple of {SERVICE_BASE_STEP} of at"
            f" least {base + CAN_IDENTIFIERS}"
        )


def _board(drive: Drive) -> Iterator[str]:
    """Refuse another board's full scales, as the start of its firmware does."""
    inverter, named = drive.inverter, drive.inverter.board
    if named is None:
        return
    board = boards.known().get(named)
    if board is None:
        yield f"inverter.board: no {named!r}, {suggestion(named, boards.known())}"
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


def _inductances(drive: Drive) -> Iterator[str]:
    motor = drive.motor
    if motor.type == "spmsm" and not math.isclose(
        motor.d_inductance_h, motor.q_inductance_h, rel_tol=1e-9
    ):
        yield (
            f"motor.q_inductance_h: {motor.q_inductance_h:g} H, accepted: equal to d_inductance_h "
            f'({motor.d_inductance_h:g} H) when type = "spmsm"'
        )


def _iron(drive: Drive) -> Iterator[str]:
    if (
        drive.motor.iron_loss_resistance_ohm is not None
        and sum(drive.motor.iron_loss_resistance_ohm) == 0.0
    ):
        yield (
            "motor.iron_loss_resistance_ohm: [0, 0] would short-circuit the motor, accepted: a0 +"
            " a1 > 0, or no such key for no iron loss"
        )


def _saliency(drive: Drive) -> Iterator[str]:
    d, q = drive.motor.d_inductance_h, drive.motor.q_inductance_h
    if not d / INVERSE_SALIENCY_MAX <= q <= d * SALIENCY_MAX:
        yield (
            f"motor.q_inductance_h: {q:g} H, accepted: {d / INVERSE_SALIENCY_MAX:.4g} to"
            f" {d * SALIENCY_MAX:.4g} H, a quarter of to {SALIENCY_MAX:g} times d_inductance_h ="
            f" {d:g} H"
        )


def _magnets(drive: Drive) -> Iterator[str]:
    motor = drive.motor
    saliency = abs(motor.q_inductance_h - motor.d_inductance_h) * motor.max_phase_current_a
    if motor.type == "spmsm" or any(_saliency(drive)):
        return
    if saliency > RELUCTANCE_MAX * LARGEST_FLUX_WB:
        most = motor.max_phase_current_a * RELUCTANCE_MAX * motor.flux_linkage_wb / saliency
        yield (
            f"motor.max_phase_current_a: {motor.max_phase_current_a:g} A, accepted: at most"
            f" {most:.6g} A, with which the inductances add {RELUCTANCE_MAX:g} times"
            f" flux_linkage_wb = {motor.flux_linkage_wb:g} Wb"
        )
    elif saliency > RELUCTANCE_MAX * motor.flux_linkage_wb:
        yield (
            f"motor.flux_linkage_wb: {motor.flux_linkage_wb:g} Wb, accepted: at least"
            f" {saliency / RELUCTANCE_MAX:.6g} Wb, 1/{RELUCTANCE_MAX:g} of what the inductances"
            f" add at max_phase_current_a = {motor.max_phase_current_a:g} A"
        )


def _inverse_saliency(drive: Drive) -> Iterator[str]:
    """Where L_d exceeds L_q, a negative i_d takes torque away: a quarter of the flux stays."""
    motor = drive.motor
    inverse = motor.d_inductance_h - motor.q_inductance_h
    if 4.0 * inverse * motor.max_phase_current_a > 3.0 * motor.flux_linkage_wb:
        most = motor.q_inductance_h + 0.75 * motor.flux_linkage_wb / motor.max_phase_current_a
        yield (
            f"motor.d_inductance_h: {motor.d_inductance_h:g} H, accepted: at most {most:.6g} H,"
            " with which a quarter of flux_linkage_wb is left for torque at any i_d up to"
            f" max_phase_current_a = {motor.max_phase_current_a:g} A"
        )


def _iron_at_speed(drive: Drive) -> Iterator[str]:
    """At the largest speed, where the iron branch takes most.

    A part of the current only, and a resistance that the firmware's number format holds.
    """
    motor = drive.motor
    if motor.iron_loss_resistance_ohm is None or sum(motor.iron_loss_resistance_ohm) == 0.0:
        return
    omega = derived.omega_max(drive)
    a0, a1 = motor.iron_loss_resistance_ohm
    found = a0 + a1 * omega
    reactance = omega * max(motor.d_inductance_h, motor.q_inductance_h)
    emf = omega * motor.flux_linkage_wb
    lowest = max(2.0 * reactance, 2.0 * emf / motor.max_phase_current_a)
    highest = IRON_RESISTANCES_MAX * drive.battery.max_voltage_v / motor.max_phase_current_a
    if lowest > highest:
        yield (
            f"motor.iron_loss_resistance_ohm: [{a0:g}, {a1:g}], accepted: no such key, for no iron"
            f" loss: with reactances of up to {reactance:.4g} ohm and a back-EMF of {emf:.4g} V at"
            f" max_speed_rpm = {motor.max_speed_rpm:g} r/min no resistance is possible"
        )
    elif not lowest <= found <= highest:
        yield (
            f"motor.iron_loss_resistance_ohm: [{a0:g}, {a1:g}] make {found:.4g} ohm at"
            f" max_speed_rpm = {motor.max_speed_rpm:g} r/min, accepted: {lowest:.4g} to"
            f" {highest:.4g} ohm there, or no such key for no iron loss"
        )


def _iron_when_slow(drive: Drive) -> Iterator[str]:
    """At a hundredth of the largest speed: a resistance that vanishes leaves its number format."""
    motor = drive.motor
    if motor.iron_loss_resistance_ohm is None or any(_iron_at_speed(drive)):
        return
    a0, a1 = motor.iron_loss_resistance_ohm
    slow = a1 * derived.omega_max(drive) / 100.0
    needed = drive.battery.max_voltage_v / motor.max_phase_current_a / 2.0
    if a0 + slow < needed:
        yield (
            f"motor.iron_loss_resistance_ohm: [{a0:g}, {a1:g}] make {a0 + slow:.4g} ohm at a"
            f" hundredth of max_speed_rpm = {motor.max_speed_rpm:g} r/min, accepted: {needed:.4g}"
            f" ohm there, such as [{needed:.4g}, {a1:g}]"
        )


def _drag(drive: Drive) -> Iterator[str]:
    motor, shaft = drive.motor, drive.motor.max_speed_rpm * math.pi / 30.0
    friction = motor.friction_torque_nm + motor.viscous_friction_nm_s * shaft
    iron = derived.iron_drag_nm(drive)
    made = min(motor.max_torque_nm, derived.largest_torque_nm(drive, motor.max_phase_current_a))
    if 2.0 * (friction + iron) > made:
        key = "friction_torque_nm" if friction >= iron else "iron_loss_resistance_ohm"
        yield (
            f"motor.{key}: friction of {friction:.4g} N m and iron loss of {iron:.4g} N m at"
            f" max_speed_rpm = {motor.max_speed_rpm:g} r/min, accepted: together at most"
            f" {made / 2.0:.4g} N m, half of what max_torque_nm and max_phase_current_a allow"
        )


def _emf_of_surface_magnets(drive: Drive) -> Iterator[str]:
    motor, omega = drive.motor, derived.omega_max(drive)
    if motor.type != "spmsm":
        return
    hot = 1.0 + (motor.flux_temperature_coefficient_per_k or 0.0) * (
        motor.max_winding_temperature_c - motor.reference_temperature_c
    )
    if hot < 0.1:
        yield (
            "motor.flux_temperature_coefficient_per_k:"
            f" {motor.flux_temperature_coefficient_per_k:g} 1/K leaves {hot:.2g} of the flux at"
            f" max_winding_temperature_c = {motor.max_winding_temperature_c:g} degC, accepted: one"
            " that leaves 0.1"
        )
        return
    impedance = max(omega * motor.d_inductance_h, motor.phase_resistance_ohm)
    emf = omega * motor.flux_linkage_wb * hot
    where = (
        f"the back-EMF at max_speed_rpm = {motor.max_speed_rpm:g} r/min is {emf:.4g} V with hot"
        " magnets"
    )
    if BACK_EMF_PARTS * emf < drive.battery.max_voltage_v:
        needed = motor.flux_linkage_wb * drive.battery.max_voltage_v / (BACK_EMF_PARTS * emf)
        yield (
            f"motor.flux_linkage_wb: {motor.flux_linkage_wb:g} Wb, accepted: at least"
            f" {needed:.6g} Wb: {where}, less than 1/{BACK_EMF_PARTS:g} of battery.max_voltage_v"
        )
    if BACK_EMF_PARTS * emf < impedance * motor.max_phase_current_a:
        most = BACK_EMF_PARTS * emf / impedance
        yield (
            f"motor.max_phase_current_a: {motor.max_phase_current_a:g} A, accepted: at most"
            f" {most:.6g} A: {where}, less than 1/{BACK_EMF_PARTS:g} of the drop at this current"
        )


def _torques(drive: Drive) -> Iterator[str]:
    motor = drive.motor
    if motor.rated_torque_nm > motor.max_torque_nm:
        yield (
            f"motor.rated_torque_nm: {motor.rated_torque_nm:g} N m, accepted: at most max_torque_nm"
            f" = {motor.max_torque_nm:g} N m"
        )
    reachable = derived.largest_torque_nm(drive, motor.max_phase_current_a)
    if motor.rated_torque_nm > reachable and reachable < LEAST_TORQUE_NM:
        yield (
            f"motor.flux_linkage_wb: {motor.flux_linkage_wb:g} Wb, accepted: enough for"
            f" rated_torque_nm = {motor.rated_torque_nm:g} N m at max_phase_current_a ="
            f" {motor.max_phase_current_a:g} A, which gives {reachable:.4g} N m"
        )
    elif motor.rated_torque_nm > reachable:
        yield (
            f"motor.rated_torque_nm: {motor.rated_torque_nm:g} N m, accepted: at most"
            f" {reachable:.4g} N m, which is what max_phase_current_a ="
            f" {motor.max_phase_current_a:g} A gives"
        )


def _currents(drive: Drive) -> Iterator[str]:
    weakening, largest = drive.control.field_weakening_current_a, drive.motor.max_phase_current_a
    if weakening is not None and weakening > largest:
        yield (
            f"control.field_weakening_current_a: {weakening:g} A, accepted: at most"
            f" motor.max_phase_current_a = {largest:g} A"
        )


def _battery(drive: Drive) -> Iterator[str]:
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


def _foldback(drive: Drive) -> Iterator[str]:
    battery = drive.battery
    lowest, highest = battery.min_voltage_v, battery.max_voltage_v
    for key in ("charge_foldback_voltage_v", "discharge_foldback_voltage_v"):
        value = getattr(battery, key)
        if value is not None and not lowest < value < highest:
            yield (
                f"battery.{key}: {value:g} V, accepted: more than min_voltage_v = {lowest:g} V "
                f"and less than max_voltage_v = {highest:g} V"
            )


def _derating(drive: Drive) -> Iterator[str]:
    motor, inverter = drive.motor, drive.inverter
    if derived.derate_winding_temperature_c(drive) >= motor.max_winding_temperature_c:
        yield (
            f"motor.derate_winding_temperature_c: {motor.derate_winding_temperature_c:g} degC,"
            f" accepted: less than max_winding_temperature_c = {motor.max_winding_temperature_c:g}"
            " degC"
        )
    start, hottest = derived.derate_switch_temperature_c(drive), inverter.max_switch_temperature_c
    if start is None:
        return
    if hottest is None:
        yield (
            "inverter.max_switch_temperature_c: missing, accepted with derate_switch_temperature_c:"
            " where torque ends"
        )
    elif start >= hottest:
        yield (
            f"inverter.derate_switch_temperature_c: {start:g} degC, accepted: "
            f"less than max_switch_temperature_c = {hottest:g} degC"
        )


def _stop_lamp(drive: Drive) -> Iterator[str]:
    lit, dark = "stop_lamp_on_m_per_s2", "stop_lamp_off_m_per_s2"
    yield from _at_most(drive.brake, "brake", dark, lit, "m/s2")


def _hold(drive: Drive) -> Iterator[str]:
    hold, most = drive.driver.hold_torque_nm, drive.brake.max_hydraulic_torque_nm
    if hold is not None and hold > most:
        yield (
            f"driver.hold_torque_nm: {hold:g} N m, accepted: at most "
            f"brake.max_hydraulic_torque_nm = {most:g} N m"
        )


def _pedals(drive: Drive) -> Iterator[str]:
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


def _trips(drive: Drive) -> Iterator[str]:
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
    yield from _at_most(monitor, "monitor", "coasting_m_per_s2", "tyre_grip_m_per_s2", "m/s2")


def _devices(drive: Drive) -> Iterator[str]:
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


def _torque_growth(drive: Drive) -> Iterator[str]:
    start, end = drive.control.torque_growth_voltage_use
    if not (end >= 0.5 and end - start >= 0.01):
        yield (
            f"control.torque_growth_voltage_use: [{start:g}, {end:g}], accepted: [whole rate,"
            " none], at least 0.01 apart, the second at least 0.5"
        )
    target = drive.control.modulation_target
    given = "torque_growth_voltage_use" in drive.control.model_fields_set
    if end <= target**2 + 0.001 and not given:
        yield (
            f"control.modulation_target: {target:g}, accepted: at most"
            f" {math.sqrt(end - 0.001) - 1e-6:.5g}, below torque_growth_voltage_use = [{start:g},"
            f" {end:g}]"
        )
    elif end <= target**2 + 0.001:
        yield (
            f"control.torque_growth_voltage_use: no growth from {end:g} on, accepted: beyond the "
            f"square {target**2:.4g} of modulation_target = {target:g}, which the voltage is "
            "regulated to"
        )


def _grid(drive: Drive) -> Iterator[str]:
    lowest, highest = drive.table.temperature_range_c
    if highest - lowest < 1.0:
        yield (
            f"table.temperature_range_c: [{lowest:g}, {highest:g}], accepted: [lowest, highest], at"
            " least 1 degC apart"
        )


def _temperatures(drive: Drive) -> Iterator[str]:
    motor, (lowest, highest) = drive.motor, drive.table.temperature_range_c
    resistance = 1.0 + motor.resistance_temperature_coefficient_per_k * (
        lowest - motor.reference_temperature_c
    )
    flux = 1.0 + (motor.flux_temperature_coefficient_per_k or 0.0) * (
        highest - motor.reference_temperature_c
    )
    if resistance < 0.1:
        yield (
            f"table.temperature_range_c: {lowest:g} degC leave {resistance:.2g} of the resistance,"
            " accepted: a lowest that leaves 0.1"
        )
    if flux < 0.1:
        yield (
            f"table.temperature_range_c: {highest:g} degC leave {flux:.2g} of the flux, accepted: a"
            " highest that leaves 0.1"
        )


def _handover(drive: Drive) -> Iterator[str]:
    control = drive.control
    if control.handover_end_rpm >= control.handover_start_rpm:
        yield (
            f"control.handover_end_rpm: {control.handover_end_rpm:g} r/min, accepted: less than "
            f"handover_start_rpm = {control.handover_start_rpm:g} r/min"
        )


def _hall(drive: Drive) -> Iterator[str]:
    edges = drive.rotor.hall_edges_deg
    widths = [(b - a) % 360.0 for a, b in zip(edges, (*edges[1:], edges[0]), strict=True)]
    if not math.isclose(sum(widths), 360.0) or not all(30.0 <= width <= 90.0 for width in widths):
        yield (
            "rotor.hall_edges_deg: accepted: six edges in forward order, 30 to 90 deg apart, once"
            " around"
        )


def _hall_hand_over(drive: Drive) -> Iterator[str]:
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


def _encoder(drive: Drive) -> Iterator[str]:
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


def _emf(drive: Drive) -> Iterator[str]:
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


def _regeneration(drive: Drive) -> Iterator[str]:
    """B > 2 c1 / 3 must hold somewhere (peak quantities).

    Else braking costs battery energy at any torque.
    """
    motor, inverter = drive.motor, drive.inverter
    dead_share = 2.0 * inverter.dead_time_s * inverter.pwm_frequency_hz
    switching = (
        3.0
        * (inverter.turn_on_loss_j_per_a + inverter.turn_off_loss_j_per_a)
        * inverter.pwm_frequency_hz
        / math.pi
    )
    threshold = (2.0 / 3.0) * (
        6.0 / math.pi * inverter.diode_forward_voltage_v * dead_share + switching
    )
    a0, a1 = motor.iron_loss_resistance_ohm or (math.inf, 0.0)
    best = 0.0
    for step in range(1, 257):
        omega = derived.omega_max(drive) * step / 256
        iron = omega / (a0 + a1 * omega)
        best = max(
            best,
            omega
            * motor.flux_linkage_wb
            / (1.0 + iron * iron * motor.d_inductance_h * motor.q_inductance_h),
        )
    if best <= threshold:
        yield (
            f"motor.max_speed_rpm: no regeneration at any speed up to {motor.max_speed_rpm:g}"
            f" r/min: the back-EMF stays below {best:.3g} V and the bridge's own drop is"
            f" {threshold:.3g} V, accepted: a drive that can return energy somewhere"
        )


_CHECKS: tuple[Callable[[Drive], Iterator[str]], ...] = (
    _board, _inductances, _saliency, _inverse_saliency, _magnets, _iron, _iron_at_speed,
    _iron_when_slow,
    _drag, _emf_of_surface_magnets, _torques, _currents, _battery, _foldback, _derating, _stop_lamp,
    _hold, _pedals, _trips, _devices, _torque_growth, _grid, _temperatures, _temperature_sensors,
    _handover, _hall, _hall_hand_over, _encoder, _emf, _regeneration, _identifiers,
)  # fmt: skip
