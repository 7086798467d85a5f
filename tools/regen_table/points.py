# SPDX-License-Identifier: Apache-2.0
"""Answers of ``solve`` and ``evaluate``.

Operating points as flat records, the keys being names with units.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from regen_table import braking, flux_constants, flux_optimum, joint, models, optimum
from regen_table.models import Bridge, Machine, State
from regen_table.schema import Drive

Record = dict[str, Any]


@dataclass(frozen=True)
class Setting:
    """What both commands share.

    Open-circuit voltage and resistance of the pack, and whether i_d is free.
    """

    open_circuit_v: float
    pack_resistance_ohm: float
    free_d_current: bool

    @property
    def phase_voltage_v(self) -> float:
        """Largest peak phase voltage in V, u_dc / sqrt(3)."""
        return self.open_circuit_v / math.sqrt(3.0)


def setting(drive: Drive, free_d_current: bool = False, soc: float | None = None) -> Setting:
    """Collect the battery's side of a drive.

    ``soc`` matters only where the voltage depends on it. With a flux map i_d is always free.
    """
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    voltage = models.open_circuit_voltage_v(drive, soc)
    return Setting(voltage, resistance, free_d_current or drive.motor.has_map)


def solve(drive: Drive, speed_rpm: float, winding_temperature_c: float, how: Setting) -> Record:
    """Best braking at one speed and winding temperature.

    The unsuffixed point is bounded by nothing when i_d = 0, and by phase current and voltage when
    i_d is free (the power has no minimum of its own then). The point with ``_limited`` is also
    clamped by max_torque_nm and max_power_w. Currents are peak phase; powers and losses are one
    motor's, but the battery's are those of all driven_wheels motors at the same point on one
    battery.
    """
    motor, inverter = models.machine(drive, winding_temperature_c), models.bridge(drive)
    omega = speed_rpm * math.pi / 30.0 * drive.motor.pole_pairs
    limit = float(braking.torque_limit_nm(drive, speed_rpm * math.pi / 30.0))
    closed = optimum.closed_form(motor, inverter, omega)
    zero, possible = float(closed.torque_zero_nm), bool(closed.possible)
    idle = float(closed.torque_idle_nm)
    bounds = joint.Limits(drive.motor.max_phase_current_a, how.phase_voltage_v)
    mapped = flux_constants.measured(drive, winding_temperature_c)
    if mapped is not None:
        best = flux_optimum.best_braking(mapped, inverter, omega, bounds)
        zero = flux_optimum.zero_power_torque_nm(mapped, inverter, omega, bounds, best)
        idle = flux_optimum.idle_torque_nm(mapped, omega)
        possible = bool(best.feasible & (best.state.dc_power_w < 0.0))
        free = best.state
        clamped = flux_optimum.best_braking(mapped, inverter, omega, bounds, limit).state
    elif how.free_d_current:
        best = joint.best_braking(motor, inverter, omega, bounds)
        zero = float(joint.zero_power_torque(motor, inverter, omega, bounds, best))
        possible = bool(best.feasible & (best.state.dc_power_w < 0.0))
        free, clamped = best.state, joint.best_braking(motor, inverter, omega, bounds, limit).state
    else:
        free = models.evaluate(motor, inverter, omega, 0.0, closed.current_q_a)
        magnitude = min(abs(float(closed.torque_optimal_nm)), limit)
        clamped = _at_torque(
            motor, inverter, omega, math.copysign(magnitude, float(closed.torque_optimal_nm))
        )
    record: Record = {
        "speed_rpm": speed_rpm,
        "winding_temperature_c": winding_temperature_c,
        "regeneration_possible": possible,
        "torque_optimal_nm": float(free.torque_nm),
        "torque_zero_nm": zero,
        "torque_idle_nm": idle,
        "torque_optimal_limited_nm": float(clamped.torque_nm),
    }
    record |= _breakdown(drive, free, how)
    return record | {
        f"{key}_limited": value for key, value in _breakdown(drive, clamped, how).items()
    }


def evaluate(
    drive: Drive, speed_rpm: float, torque_nm: float, winding_temperature_c: float, how: Setting
) -> Record:
    """Break down one operating point of either sign; null where no current makes the torque.

    ``torque_nm`` is electromagnetic; ``torque_shaft_nm`` is what friction leaves of it.
    ``limits_exceeded`` names the limits of the drive that the point lies outside of; nothing is
    clamped.
    """
    motor, inverter = models.machine(drive, winding_temperature_c), models.bridge(drive)
    omega = speed_rpm * math.pi / 30.0 * drive.motor.pole_pairs
    shaft_speed = speed_rpm * math.pi / 30.0
    bounds = joint.Limits(drive.motor.max_phase_current_a, how.phase_voltage_v)
    mapped = flux_constants.measured(drive, winding_temperature_c)
    if mapped is not None:
        state = flux_optimum.least_power(mapped, inverter, omega, torque_nm, bounds).state
    elif how.free_d_current:
        state = joint.least_power(motor, inverter, omega, torque_nm, bounds).state
    else:
        state = _at_torque(motor, inverter, omega, torque_nm)
    pack = models.battery_steady(
        how.open_circuit_v, how.pack_resistance_ohm, drive.vehicle.driven_wheels * state.dc_power_w
    )
    losses = state.loss_copper_w + state.loss_iron_w
    turning = math.copysign(1.0, shaft_speed) if shaft_speed else 0.0
    record: Record = {
        "speed_rpm": speed_rpm,
        "torque_nm": torque_nm,
        "winding_temperature_c": winding_temperature_c,
        "torque_shaft_nm": _finite(
            state.torque_nm - turning * motor.friction_nm - motor.viscous_nm_s * shaft_speed
        ),
        "voltage_d_v": _finite(state.voltage_d_v),
        "voltage_q_v": _finite(state.voltage_q_v),
        "motor_power_w": _finite(state.motor_power_w),
        "shaft_power_w": _finite(state.shaft_power_w),
        "loss_friction_w": _finite(state.loss_friction_w),
    }
    record |= _breakdown(drive, state, how)
    record |= {
        "battery_current_a": _finite(pack.current_a),
        "battery_voltage_v": _finite(pack.terminal_voltage_v),
        "residual_w": _finite(
            state.dc_power_w - state.loss_inverter_w - losses - state.torque_nm * shaft_speed
        ),
        "region": _region(drive, mapped or motor, inverter, shaft_speed, torque_nm, bounds),
        "limits_exceeded": _exceeded(drive, state, pack, how, torque_nm, shaft_speed),
    }
    return record


def _at_torque(motor: Machine, inverter: Bridge, omega: float, torque_nm: float) -> State:
    """Steady state of a torque with i_d = 0."""
    return models.evaluate(
        motor, inverter, omega, 0.0, optimum.current_at_zero_d_current(motor, omega, torque_nm)
    )


def _breakdown(drive: Drive, state: State, how: Setting) -> Record:
    """Currents, powers and losses of a point."""
    pack = models.battery_steady(
        how.open_circuit_v, how.pack_resistance_ohm, drive.vehicle.driven_wheels * state.dc_power_w
    )
    return {
        "current_d_a": _finite(state.current_d_a),
        "current_q_a": _finite(state.current_q_a),
        "dc_power_w": _finite(state.dc_power_w),
        "battery_power_w": _finite(pack.chemical_power_w),
        "loss_copper_w": _finite(state.loss_copper_w),
        "loss_iron_w": _finite(state.loss_iron_w),
        "loss_inverter_w": _finite(state.loss_inverter_w),
        "loss_battery_w": _finite(pack.loss_w),
    }


def _region(
    drive: Drive,
    motor: Machine | flux_optimum.FluxMotor,
    inverter: Bridge,
    shaft_speed: float,
    torque_nm: float,
    bounds: joint.Limits,
) -> str:
    """Name what the motor does: a region of the paper's Fig. 5, or driving."""
    if torque_nm * shaft_speed >= 0.0:
        return "driving"
    speed, demand = abs(shaft_speed), abs(torque_nm)
    if isinstance(motor, Machine):
        return str(braking.region(drive, motor, inverter, speed, demand))
    omega = speed * motor.machine.pole_pairs
    best = flux_optimum.best_braking(motor, inverter, omega, bounds)
    zero = abs(flux_optimum.zero_power_torque_nm(motor, inverter, omega, bounds, best))
    limit = braking.torque_limit_nm(drive, speed)
    return str(braking.region_of(abs(best.torque_nm), zero, limit, demand))


def _exceeded(
    drive: Drive,
    state: State,
    pack: models.BatteryState,
    how: Setting,
    torque_nm: float,
    shaft_speed: float,
) -> list[str]:
    """List the limits that a point does not respect.

    A point that does not exist exceeds all that are unknown.
    """
    within = {
        "torque": abs(torque_nm) <= drive.motor.max_torque_nm,
        "power": abs(torque_nm * shaft_speed) <= drive.motor.max_power_w * (1.0 + 1e-9),
        "speed": abs(shaft_speed) <= drive.motor.max_speed_rpm * math.pi / 30.0 * (1.0 + 1e-9),
        "phase_current": bool(state.current_a <= drive.motor.max_phase_current_a * (1.0 + 1e-6)),
        "phase_voltage": bool(state.voltage_v <= how.phase_voltage_v * (1.0 + 1e-6)),
        "charge_current": bool(-pack.current_a <= drive.battery.max_charge_current_a),
        "discharge_current": bool(pack.current_a <= drive.battery.max_discharge_current_a),
        "max_voltage": bool(pack.terminal_voltage_v <= drive.battery.max_voltage_v),
        "min_voltage": bool(pack.terminal_voltage_v >= drive.battery.min_voltage_v),
    }
    return [name for name, inside in within.items() if not inside]


def _finite(value: models.ArrayLike) -> float | None:
    """Turn an array of no dimension into a number, and what does not exist into null."""
    number = float(np.asarray(value))
    return number if math.isfinite(number) else None
