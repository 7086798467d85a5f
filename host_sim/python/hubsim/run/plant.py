# SPDX-License-Identifier: Apache-2.0
"""From a drive's TOML file to the parameters of the simulated world.

The plant's parameters, not the controller's configuration.
"""

from regen_table import halls
from regen_table.schema import Drive

STANDARD_AIR_KG_PER_M3 = 1.204  # dry, 20 degC, 1013 hPa
STANDARD_GRAVITY_M_PER_S2 = 9.80665
SWITCH_REFERENCE_C = 25.0
# The pack's current sensor: gain error, noise as a share of the largest current, time constant.
BATTERY_CURRENT_ERROR = 0.02
BATTERY_CURRENT_NOISE = 0.002
BATTERY_CURRENT_FILTER_S = 0.02
PEDAL_CHANNELS = ("accelerator_a", "accelerator_b", "brake_a", "brake_b")
# What can happen to a vehicle under way, by how the names begin.
EVENTS = (
    "encoder.lost_counts",
    "bus.contactor_open",
    "brake.torque_loss",
    "brake_sensor.gain_error",
    "brake_sensor.noise_nm",
    "brake_sensor.offset_nm",
    "brake_sensor.stuck",
    "brake_sensor.invalid",
    "brake_sensor.silent",
    "sensors.hall_stuck_low",
    "sensors.hall_stuck_high",
    "sensors.current_drift_a_per_s",
    "winding_sensor.open",
    "winding_sensor.shorted",
    "winding_sensor.stuck",
    "switch_sensor.",
    "fault.",
    "wheel_speed.dead",
    *(f"pedal_sensors.{channel}_offset" for channel in PEDAL_CHANNELS),
    *(f"pedal_sensors.{channel}_broken" for channel in PEDAL_CHANNELS),
    *(f"wheel{k}." for k in range(16)),
)
# Effects that are not in a drive file; a scenario or --set plant.… switches them on. All are
# off as they stand here, and what else a model needs has the value it will have then.
EFFECTS = {
    "motor.d_saturation_current_a": 0.0,
    "motor.q_saturation_current_a": 0.0,
    "motor.cross_saturation": 0.0,
    "motor.magnet_bias_current_a": 0.0,
    "motor.cogging_torque_nm": 0.0,
    "motor.cogging_per_turn": 0.0,
    "motor.cogging_deg": 0.0,
    "sensors.sampling_delay_s": 0.0,
    "sensors.shunt_settling_s": 0.0,
    "sensors.current_a_gain_error": 0.0,
    "sensors.current_b_gain_error": 0.0,
    "sensors.current_c_gain_error": 0.0,
    "sensors.bus_gain_error": 0.0,
    "sensors.angle_offset_deg": 0.0,
    "sensors.angle_error_deg": 0.0,
    "winding_sensor.lag_s": 0.0,
    "winding_sensor.offset_k": 0.0,
    "winding_sensor.gain_error": 0.0,
    "winding_sensor.kind": 0.0,
    "winding_sensor.ohm_25c": 10e3,
    "winding_sensor.beta_k": 3380.0,
    "winding_sensor.linear_per_k": 0.0,
    "winding_sensor.square_per_k2": 0.0,
    "winding_sensor.divider_ohm": 10e3,
    "winding_sensor.to_supply": 0.0,
    "wheel_speed.teeth": 0.0,
    "wheel_speed.clock_s": 0.0,
    "wheel_speed.lowest_rad_per_s": 0.0,
    "anti_lock.active": 0.0,
    "brake_sensor.fitted": 0.0,
    "brake_sensor.period_s": 0.02,
    "brake_sensor.delay_s": 0.01,
    "bms.peak_charge_a": 0.0,
    # about half and about all of the slip of greatest force on ice; see the scenario mu_split
    "anti_lock.slip_hold": 0.06,
    "anti_lock.slip_dump": 0.12,
    "anti_lock.rim_deceleration_m_per_s2": 15.0,  # half as much again as dry road allows
    "anti_lock.build_rate_nm_per_s": 500.0,
    "anti_lock.dump_rate_nm_per_s": 800.0,
    "anti_lock.margin_m_per_s2": 0.1,
    "anti_lock.lowest_speed_m_per_s": 1.5,
    "anti_lock.release_s": 0.2,
}


def parameters(drive: Drive) -> dict[str, float]:
    """Return every parameter that a drive's file decides, by the engine's names.

    What belongs to one run (temperatures, road, driver, seed) is the scenario's and comes on top;
    so do the EVENTS, which are 0 in a healthy vehicle.
    """
    motor, inverter, battery, vehicle, brake = (
        drive.motor,
        drive.inverter,
        drive.battery,
        drive.vehicle,
        drive.brake,
    )
    a0, a1 = motor.iron_loss_resistance_ohm or (0.0, 0.0)
    found = {
        "motor.pole_pairs": motor.pole_pairs,
        "motor.phase_resistance_ohm": motor.phase_resistance_ohm,
        "motor.reference_temperature_c": motor.reference_temperature_c,
        "motor.resistance_temperature_coefficient_per_k": (
            motor.resistance_temperature_coefficient_per_k
        ),
        "motor.d_inductance_h": motor.d_inductance_h,
        "motor.q_inductance_h": motor.q_inductance_h,
        "motor.flux_linkage_wb": motor.flux_linkage_wb,
        "motor.flux_temperature_coefficient_per_k": motor.flux_temperature_coefficient_per_k or 0.0,
        "motor.iron_loss_resistance_ohm": a0,
        "motor.iron_loss_resistance_slope_ohm_s": a1,
        "motor.friction_torque_nm": motor.friction_torque_nm,
        "motor.viscous_friction_nm_s": motor.viscous_friction_nm_s,
        "inverter.switch_resistance_ohm": inverter.switch_resistance_ohm,
        "inverter.diode_forward_voltage_v": inverter.diode_forward_voltage_v,
        "inverter.diode_resistance_ohm": inverter.diode_resistance_ohm,
        "inverter.dead_time_s": inverter.dead_time_s,
        "inverter.pwm_frequency_hz": inverter.pwm_frequency_hz,
        "inverter.turn_on_loss_j_per_a": inverter.turn_on_loss_j_per_a,
        "inverter.turn_off_loss_j_per_a": inverter.turn_off_loss_j_per_a,
        "inverter.switching": 0.0,
        "battery.series_resistance_ohm": battery.series_resistance_ohm,
        "battery.polarisation_resistance_ohm": battery.polarisation_resistance_ohm,
        "battery.polarisation_capacitance_f": battery.polarisation_capacitance_f,
        "battery.capacity_ah": battery.capacity_ah,
        "battery.initial_soc": battery.initial_soc,
        "battery.max_charge_current_a": battery.max_charge_current_a,
        "battery.max_discharge_current_a": battery.max_discharge_current_a,
        "vehicle.mass_kg": vehicle.mass_kg,
        "vehicle.wheel_radius_m": vehicle.wheel_radius_m,
        "vehicle.frontal_area_m2": vehicle.frontal_area_m2,
        "vehicle.drag_coefficient": vehicle.drag_coefficient,
        "vehicle.rolling_resistance": vehicle.rolling_resistance,
        "vehicle.driven_wheels": vehicle.driven_wheels,
        "brake.hydraulic_dead_time_s": brake.hydraulic_dead_time_s,
        "brake.hydraulic_time_constant_s": brake.hydraulic_time_constant_s,
        "brake.hydraulic_rate_nm_per_s": brake.hydraulic_rate_nm_per_s,
        "brake.max_hydraulic_torque_nm": brake.max_hydraulic_torque_nm,
        "brake.knee_torque_nm": brake.hydraulic_knee_torque_nm,
        "brake.knee_rate_nm_per_s": brake.hydraulic_knee_rate_nm_per_s,
        "bus.capacitance_f": drive.bus.capacitance_f,
        "bus.cable_resistance_ohm": drive.bus.cable_resistance_ohm,
        "sensors.current_full_scale_a": inverter.current_full_scale_a,
        "sensors.voltage_full_scale_v": inverter.voltage_full_scale_v,
        "sensors.current_noise_a": drive.sensors.current_noise_a,
        "sensors.bus_voltage_noise_v": drive.sensors.bus_voltage_noise_v,
        "sensors.current_offset_a": drive.sensors.current_offset_a,
        "sensors.hall_edge_error_deg": drive.sensors.hall_edge_error_deg,
        "sensors.adc_bits": drive.sensors.adc_bits,
    }
    found |= {
        "encoder.counts": drive.rotor.encoder_counts or 0,
        "encoder.index_deg": drive.rotor.encoder_index_deg or 0.0,
        "encoder.index_width_counts": min(1, drive.rotor.encoder_index_tolerance_counts),
        "encoder.reversed": drive.rotor.encoder_reversed,
    }
    for channel, name in enumerate(PEDAL_CHANNELS):
        found[f"pedal_sensors.{name}_released"] = drive.pedals.released[channel]
        found[f"pedal_sensors.{name}_pressed"] = drive.pedals.pressed[channel]
    found |= _bms(drive)
    for name in ("thermal", "chassis", "tyre"):
        section = getattr(drive, name)
        found |= {f"{name}.{key}": getattr(section, key) for key in type(section).model_fields}
    found["inverter.switch_resistance_temperature_coefficient_per_k"] = found.pop(
        "thermal.switch_resistance_temperature_coefficient_per_k"
    )
    found["inverter.switch_reference_temperature_c"] = SWITCH_REFERENCE_C
    found |= EFFECTS
    wiring = halls.wiring(drive.rotor)
    found["sensors.hall_lines"] = wiring.lines
    found |= {f"sensors.hall_edge_{k}_deg": edge for k, edge in enumerate(wiring.edges_deg)}
    return {name: float(value) for name, value in found.items()}


def _bms(drive: Drive) -> dict[str, float]:
    """Return what decides the current limits that the battery management sends."""
    bms, battery = drive.bms, drive.battery
    coldest_c, full_c = bms.cold_charge_c or (0.0, 0.0)
    return {
        "bms.fade_soc": bms.fade_soc,
        "bms.max_voltage_v": battery.max_voltage_v if bms.keep_voltage else 0.0,
        "bms.min_voltage_v": battery.min_voltage_v if bms.keep_voltage else 0.0,
        "bms.temperature_c": bms.temperature_c,
        "bms.coldest_charge_c": coldest_c,
        "bms.full_charge_c": full_c,
        "bms.period_s": bms.period_s,
        "bms.current_step_a": bms.current_step_a,
        "bms.contactor_silent": 0.0,
        "bms.voltage_silent": 0.0,
        "bms.current_silent": 0.0,
        "bms.current_error": BATTERY_CURRENT_ERROR,
        "bms.current_offset_a": 0.0,
        "bms.current_noise_a": BATTERY_CURRENT_NOISE * battery.max_discharge_current_a,
        "bms.current_filter_s": BATTERY_CURRENT_FILTER_S,
    }


def voltage_curve(drive: Drive) -> tuple[list[float], list[float]]:
    """Return the open-circuit voltage (V) over state of charge; one point: constant."""
    voltage = drive.battery.open_circuit_voltage_v
    if isinstance(voltage, float | int):
        return [0.0], [float(voltage)]
    return [point[0] for point in voltage], [point[1] for point in voltage]
