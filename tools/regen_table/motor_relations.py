# SPDX-License-Identifier: Apache-2.0
"""Relations between the numbers of a machine: what no motor is, or no number format holds.

Also what it needs of the battery and the bridge to return energy at all.
"""

import math
from collections.abc import Iterator

from regen_table import derived
from regen_table.sections import Drive

# Beyond any real drive, and where the firmware's model of the motor leaves its number formats
# (firmware/config/physics.h).
SALIENCY_MAX = 16.0
INVERSE_SALIENCY_MAX = 4.0
RELUCTANCE_MAX = 16.0
LARGEST_FLUX_WB = 2.0  # as in motor_section
IRON_RESISTANCES_MAX = 2048.0
BACK_EMF_PARTS = 32.0
LEAST_TORQUE_NM = 0.01  # that a motor can have as its rated one


def inductances(drive: Drive) -> Iterator[str]:
    """Refuse surface magnets whose inductances differ."""
    motor = drive.motor
    if motor.type == "spmsm" and not math.isclose(
        motor.d_inductance_h, motor.q_inductance_h, rel_tol=1e-9
    ):
        yield (
            f"motor.q_inductance_h: {motor.q_inductance_h:g} H, accepted: equal to d_inductance_h "
            f'({motor.d_inductance_h:g} H) when type = "spmsm"'
        )


def saliency(drive: Drive) -> Iterator[str]:
    """Refuse a ratio of inductances that the number formats do not hold."""
    d, q = drive.motor.d_inductance_h, drive.motor.q_inductance_h
    if not d / INVERSE_SALIENCY_MAX <= q <= d * SALIENCY_MAX:
        yield (
            f"motor.q_inductance_h: {q:g} H, accepted: {d / INVERSE_SALIENCY_MAX:.4g} to"
            f" {d * SALIENCY_MAX:.4g} H, a quarter of to {SALIENCY_MAX:g} times d_inductance_h ="
            f" {d:g} H"
        )


def inverse_saliency(drive: Drive) -> Iterator[str]:
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


def magnets(drive: Drive) -> Iterator[str]:
    """Refuse inductances whose torque the number formats do not hold."""
    motor = drive.motor
    reluctance = abs(motor.q_inductance_h - motor.d_inductance_h) * motor.max_phase_current_a
    if motor.type == "spmsm" or any(saliency(drive)):
        return
    if reluctance > RELUCTANCE_MAX * LARGEST_FLUX_WB:
        most = motor.max_phase_current_a * RELUCTANCE_MAX * motor.flux_linkage_wb / reluctance
        yield (
            f"motor.max_phase_current_a: {motor.max_phase_current_a:g} A, accepted: at most"
            f" {most:.6g} A, with which the inductances add {RELUCTANCE_MAX:g} times"
            f" flux_linkage_wb = {motor.flux_linkage_wb:g} Wb"
        )
    elif reluctance > RELUCTANCE_MAX * motor.flux_linkage_wb:
        yield (
            f"motor.flux_linkage_wb: {motor.flux_linkage_wb:g} Wb, accepted: at least"
            f" {reluctance / RELUCTANCE_MAX:.6g} Wb, 1/{RELUCTANCE_MAX:g} of what the inductances"
            f" add at max_phase_current_a = {motor.max_phase_current_a:g} A"
        )


def iron(drive: Drive) -> Iterator[str]:
    """Refuse an iron branch that short-circuits the motor."""
    if (
        drive.motor.iron_loss_resistance_ohm is not None
        and sum(drive.motor.iron_loss_resistance_ohm) == 0.0
    ):
        yield (
            "motor.iron_loss_resistance_ohm: [0, 0] would short-circuit the motor, accepted: a0 +"
            " a1 > 0, or no such key for no iron loss"
        )


def iron_at_speed(drive: Drive) -> Iterator[str]:
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


def iron_when_slow(drive: Drive) -> Iterator[str]:
    """At a hundredth of the largest speed: a resistance that vanishes leaves its number format."""
    motor = drive.motor
    if motor.iron_loss_resistance_ohm is None or any(iron_at_speed(drive)):
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


def drag(drive: Drive) -> Iterator[str]:
    """Refuse friction and iron loss that leave less than half of the torque."""
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


def emf_of_surface_magnets(drive: Drive) -> Iterator[str]:
    """Refuse an EMF of hot magnets that the number formats do not resolve."""
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


def torques(drive: Drive) -> Iterator[str]:
    """Refuse a rated torque above the largest, or that the current does not give."""
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


def regeneration(drive: Drive) -> Iterator[str]:
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
