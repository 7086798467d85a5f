# SPDX-License-Identifier: Apache-2.0
"""What absent keys of a drive stand for, and single numbers that follow from several keys.

Plain scalar arithmetic, so that the simulator, which reads the same files, loads nothing more.
"""

import itertools
import math

from regen_table import defaults
from regen_table.section import DEMANDED_BRAKE_NM
from regen_table.sections import Drive

AIR_DENSITY_KG_M3 = 1.2041  # 20 degC, 101 325 Pa
FOLDBACK_SHARE = 0.98  # of max_voltage_v, where the charge current begins to fold back
DEMAND_MARGIN = 1.25  # above what motor, brakes or pedals make, for a demand by CAN
DERATING_K = 20.0  # below the largest temperature, where derating begins


def foldback_voltage_v(drive: Drive) -> float:
    """Bus voltage in V from which on the charge current folds back, to zero at max_voltage_v."""
    wanted = drive.battery.charge_foldback_voltage_v
    return FOLDBACK_SHARE * drive.battery.max_voltage_v if wanted is None else wanted


def discharge_foldback_voltage_v(drive: Drive) -> float:
    """Bus voltage in V below which the discharge current folds back, to zero at min_voltage_v."""
    battery = drive.battery
    wanted = battery.discharge_foldback_voltage_v
    width = battery.max_voltage_v - foldback_voltage_v(drive)
    return battery.min_voltage_v + width if wanted is None else wanted


def derate_winding_temperature_c(drive: Drive) -> float:
    """Winding temperature in degC where derating starts, to zero torque at the largest one."""
    wanted = drive.motor.derate_winding_temperature_c
    return drive.motor.max_winding_temperature_c - DERATING_K if wanted is None else wanted


def derate_switch_temperature_c(drive: Drive) -> float | None:
    """Switch temperature in degC where derating starts; None where switches are not watched."""
    inverter = drive.inverter
    hottest, wanted = inverter.max_switch_temperature_c, inverter.derate_switch_temperature_c
    return hottest - DERATING_K if wanted is None and hottest is not None else wanted


def omega_max(drive: Drive) -> float:
    """Largest electrical speed in rad/s."""
    return drive.motor.max_speed_rpm * math.pi / 30.0 * drive.motor.pole_pairs


def observer_speed_rad_s(drive: Drive) -> float:
    """Mechanical speed in rad/s from which the EMF observer's angle counts.

    Absent: where the EMF equals the resistive drop of the rated torque's current and what a phase
    loses by dead time, t_d f (v_max + 2 V_f).
    """
    motor, inverter = drive.motor, drive.inverter
    wanted = drive.rotor.observer_speed_rpm
    if wanted is not None:
        return wanted * math.pi / 30.0
    rated_a = motor.rated_torque_nm / (1.5 * motor.pole_pairs * motor.flux_linkage_wb)
    lost_v = (
        inverter.dead_time_s
        * inverter.pwm_frequency_hz
        * (drive.battery.max_voltage_v + 2.0 * inverter.diode_forward_voltage_v)
    )
    uncertain_v = motor.phase_resistance_ohm * rated_a + lost_v
    return uncertain_v / (motor.flux_linkage_wb * motor.pole_pairs)


def iron_drag_nm(drive: Drive) -> float:
    """Torque in N m of the iron loss at the largest speed, without current."""
    motor, omega = drive.motor, omega_max(drive)
    if motor.iron_loss_resistance_ohm is None:
        return 0.0
    a0, a1 = motor.iron_loss_resistance_ohm
    current_a = omega * motor.flux_linkage_wb / max(a0 + a1 * omega, 1e-9)
    return 1.5 * motor.pole_pairs * motor.flux_linkage_wb * current_a


def line_emf_v(drive: Drive) -> float:
    """Peak line-to-line back-EMF at the largest speed in V.

    What a bridge that is off rectifies onto the bus.
    """
    return math.sqrt(3.0) * drive.motor.flux_linkage_wb * omega_max(drive)


def towing_speed_m_per_s(drive: Drive) -> float:
    """Return the speed below which a bridge that is off takes nothing from a wheel that is turned.

    There the line-to-line EMF of the coldest magnets peaks at the voltage of an empty pack; beyond
    it the diodes charge the pack, or the bus alone.
    """
    motor = drive.motor
    colder_k = drive.table.temperature_range_c[0] - motor.reference_temperature_c
    share = 1.0 + (motor.flux_temperature_coefficient_per_k or 0.0) * min(colder_k, 0.0)
    electrical = drive.battery.min_voltage_v / (math.sqrt(3.0) * motor.flux_linkage_wb * share)
    return electrical / motor.pole_pairs * drive.vehicle.wheel_radius_m


def pack_share(drive: Drive) -> float:
    """Return the share of the pack's limits that this motor may use."""
    share = drive.vehicle.pack_share
    return 1.0 / drive.vehicle.driven_wheels if share is None else share


def overvoltage_trip_v(drive: Drive) -> float:
    """Bus voltage in V at which the bridge must leave.

    What battery and board stand, and the board can still see.
    """
    wanted = drive.monitor.overvoltage_v
    stands = min(1.05 * drive.battery.max_voltage_v, 0.98 * drive.inverter.voltage_full_scale_v)
    return stands if wanted is None else wanted


def device_voltage_v(drive: Drive) -> float:
    """Rating in V of switches and bus capacitors; the over-voltage trip where it is not given."""
    wanted = drive.inverter.device_voltage_v
    return overvoltage_trip_v(drive) if wanted is None else wanted


def bridging_time_s(drive: Drive) -> float:
    """Time in s in which the motor hands a torque over; absent: nine tenths of the hydraulic."""
    brake = drive.brake
    if brake.bridging_time_s is not None:
        return brake.bridging_time_s
    return brake.hydraulic_dead_time_s + 2.3 * brake.hydraulic_time_constant_s


def hydraulic_tolerance_nm(drive: Drive) -> float:
    """Noise in N m of a report of the hydraulic torque."""
    wanted = drive.brake.hydraulic_tolerance_nm
    return 0.0125 * drive.brake.max_hydraulic_torque_nm if wanted is None else wanted


def pedal_drive_torque_nm(drive: Drive) -> float:
    """Driving torque in N m of the whole accelerator at a wheel of share 1."""
    wanted = drive.pedals.drive_torque_nm
    return drive.motor.max_torque_nm if wanted is None else wanted


def pedal_brake_torque_nm(drive: Drive) -> float:
    """Braking torque in N m of the whole brake pedal at a wheel of share 1."""
    wanted = drive.pedals.brake_torque_nm
    both = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    return min(both, DEMANDED_BRAKE_NM) if wanted is None else wanted


def largest_drive_torque_nm(drive: Drive) -> float:
    """Driving torque in N m beyond which a demand by CAN is refused."""
    wanted = drive.driver.largest_drive_torque_nm
    made = max(drive.motor.max_torque_nm, pedal_drive_torque_nm(drive))
    return DEMAND_MARGIN * made if wanted is None else wanted


def largest_brake_torque_nm(drive: Drive) -> float:
    """Braking torque in N m beyond which a demand by CAN is refused."""
    wanted = drive.driver.largest_brake_torque_nm
    both = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    return DEMAND_MARGIN * max(both, pedal_brake_torque_nm(drive)) if wanted is None else wanted


def free_travel_torque_nm(drive: Drive) -> float:
    """Braking torque in N m at the end of the friction brake's free travel."""
    wanted = drive.pedals.free_travel_torque_nm
    rated = min(drive.brake.electric_rated_torque_nm, pedal_brake_torque_nm(drive))
    return rated if wanted is None else wanted


def lowest_open_circuit_v(drive: Drive) -> float:
    """Open-circuit voltage in V, at the lowest listed state of charge where it depends on it."""
    voltage = drive.battery.open_circuit_voltage_v
    return voltage if isinstance(voltage, float | int) else voltage[0][1]


def initial_open_circuit_v(drive: Drive) -> float:
    """Open-circuit voltage in V where work begins, clamped."""
    voltage, wanted_soc = drive.battery.open_circuit_voltage_v, drive.battery.initial_soc
    if isinstance(voltage, float | int):
        return voltage
    for (soc, volts), (next_soc, next_volts) in itertools.pairwise(voltage):
        if soc <= wanted_soc <= next_soc:
            return volts + (next_volts - volts) * (wanted_soc - soc) / (next_soc - soc)
    return voltage[0][1] if voltage[0][0] > wanted_soc else voltage[-1][1]


def largest_torque_nm(drive: Drive, current_a: float) -> float:
    """Largest torque in N m of a peak phase current at standstill, without iron loss."""
    motor = drive.motor
    return defaults.largest_torque_nm(
        motor.pole_pairs,
        motor.flux_linkage_wb,
        motor.d_inductance_h,
        motor.q_inductance_h,
        current_a,
    )
