# SPDX-License-Identifier: Apache-2.0
"""Relations between the keys of a drive: what no single range can express.

Each refuses the drive: it could not be built, or could not brake. What describes a drive that works
is in ``shortcomings``. Those of the motor, the supply and the sensors have modules of their own;
here stand all of them in their order, and those of control, maps, brake and CAN. Plain scalar
arithmetic, so that the simulator, which reads the same files, loads nothing more for it.
"""

import math
from collections.abc import Callable, Iterator

from regen_table import derived, motor_relations, sensor_relations, supply_relations
from regen_table.section import at_most
from regen_table.sections import Drive

CAN_BASE_STEP = 32  # config.h: CONFIG_CAN_BASE_STEP
CAN_IDENTIFIERS = 160  # config.h: CONFIG_CAN_IDENTIFIERS
SERVICE_BASE_STEP = 8  # config.h: CONFIG_SERVICE_BASE_STEP


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


def _currents(drive: Drive) -> Iterator[str]:
    weakening, largest = drive.control.field_weakening_current_a, drive.motor.max_phase_current_a
    if weakening is not None and weakening > largest:
        yield (
            f"control.field_weakening_current_a: {weakening:g} A, accepted: at most"
            f" motor.max_phase_current_a = {largest:g} A"
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
    yield from at_most(drive.brake, "brake", dark, lit, "m/s2")


def _hold(drive: Drive) -> Iterator[str]:
    hold, most = drive.driver.hold_torque_nm, drive.brake.max_hydraulic_torque_nm
    if hold is not None and hold > most:
        yield (
            f"driver.hold_torque_nm: {hold:g} N m, accepted: at most "
            f"brake.max_hydraulic_torque_nm = {most:g} N m"
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


_CHECKS: tuple[Callable[[Drive], Iterator[str]], ...] = (
    supply_relations.board, supply_relations.low_pulses, motor_relations.inductances,
    motor_relations.saliency,
    motor_relations.inverse_saliency, motor_relations.magnets, motor_relations.iron,
    motor_relations.iron_at_speed, motor_relations.iron_when_slow, motor_relations.drag,
    motor_relations.emf_of_surface_magnets, motor_relations.torques, _currents,
    supply_relations.battery, supply_relations.foldback, _derating, _stop_lamp, _hold,
    sensor_relations.pedals, supply_relations.trips, supply_relations.devices, _torque_growth,
    _grid, _temperatures, sensor_relations.temperature_sensors, _handover, sensor_relations.hall,
    sensor_relations.hall_hand_over, sensor_relations.encoder, supply_relations.emf,
    motor_relations.regeneration, _identifiers,
)  # fmt: skip
