# SPDX-License-Identifier: Apache-2.0
"""What works in a drive, but not as its numbers promise: its warnings."""

from regen_table import derived
from regen_table.sections import Drive


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
