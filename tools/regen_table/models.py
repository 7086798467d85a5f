# SPDX-License-Identifier: Apache-2.0
"""Steady-state losses of motor, inverter and battery as pure functions over NumPy arrays.

Peak phase quantities, electrical rad/s, motor signs (see the package). The motor is the dq circuit
with an iron-loss resistance R_i across the EMF v: only the current i_t left over from v / R_i makes
torque.

    v_d = -omega L_q i_qt            v_q = omega (L_d i_dt + psi)           u = R_a i + v
    i   = i_t + v / R_i              T   = 1.5 p [psi i_qt + (L_d - L_q) i_dt i_qt]
    P   = 1.5 (u_d i_d + u_q i_q) = 1.5 R_a |i|^2 + 1.5 |v|^2 / R_i + (omega / p) T        (exact)
"""

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from regen_table.schema import Drive

Array: TypeAlias = npt.NDArray[np.float64]
ArrayLike: TypeAlias = Array | float


@dataclass(frozen=True)
class Machine:
    """A motor at one winding temperature, or at an array of them.

    Attributes
    ----------
    winding_temperature_c : float or array
        Where the next two hold.
    resistance_ohm, flux_wb : float or array
        Phase resistance and magnet flux linkage at the winding temperature, shape of that
        temperature.
    iron_ohm, iron_ohm_s : float
        a0 and a1 of R_i = a0 + a1 |omega|; infinite a0 means no iron loss.
    """

    pole_pairs: int
    winding_temperature_c: ArrayLike
    resistance_ohm: ArrayLike
    d_inductance_h: float
    q_inductance_h: float
    flux_wb: ArrayLike
    iron_ohm: float
    iron_ohm_s: float
    friction_nm: float = 0.0
    viscous_nm_s: float = 0.0

    def iron_ratio(self, omega: ArrayLike) -> Array:
        """Return g = omega / R_i in 1/H, signed like omega and zero at standstill."""
        omega = np.asarray(omega, dtype=np.float64)
        resistance = self.iron_ohm + self.iron_ohm_s * np.abs(omega)
        return np.divide(
            omega,
            resistance,
            out=np.zeros_like(omega),
            where=(omega != 0.0) & np.isfinite(resistance),
        )


@dataclass(frozen=True)
class Bridge:
    """Inverter loss k1 I + k2 I^2 of a peak phase current I: k1 in W/A, k2 in W/A^2."""

    linear_w_per_a: float
    square_w_per_a2: float

    def loss_w(self, current_a: ArrayLike) -> Array:
        """Loss in W at a peak phase current magnitude in A."""
        current_a = np.asarray(current_a, dtype=np.float64)
        return self.linear_w_per_a * current_a + self.square_w_per_a2 * current_a * current_a


@dataclass(frozen=True)
class State:
    """A steady state; arrays of the broadcast shape of speed, currents and temperature.

    Powers in W are positive out of the battery; ``torque_nm`` is the electromagnetic torque, before
    friction.
    """

    omega_rad_s: Array
    current_d_a: Array
    current_q_a: Array
    voltage_d_v: Array
    voltage_q_v: Array
    torque_nm: Array
    loss_copper_w: Array
    loss_iron_w: Array
    loss_inverter_w: Array
    motor_power_w: Array
    dc_power_w: Array
    shaft_power_w: Array
    loss_friction_w: Array

    @property
    def current_a(self) -> Array:
        """Peak phase current in A."""
        return np.hypot(self.current_d_a, self.current_q_a)

    @property
    def voltage_v(self) -> Array:
        """Peak phase voltage in V."""
        return np.hypot(self.voltage_d_v, self.voltage_q_v)


def machine(drive: Drive, winding_temperature_c: ArrayLike) -> Machine:
    """Return the motor of a drive at a winding temperature in degC, magnets included."""
    motor = drive.motor
    rise = np.asarray(winding_temperature_c, dtype=np.float64) - motor.reference_temperature_c
    a0, a1 = motor.iron_loss_resistance_ohm or (np.inf, 0.0)
    return Machine(
        pole_pairs=motor.pole_pairs,
        winding_temperature_c=winding_temperature_c,
        resistance_ohm=motor.phase_resistance_ohm
        * (1.0 + motor.resistance_temperature_coefficient_per_k * rise),
        d_inductance_h=motor.d_inductance_h,
        q_inductance_h=motor.q_inductance_h,
        flux_wb=motor.flux_linkage_wb
        * (1.0 + (motor.flux_temperature_coefficient_per_k or 0.0) * rise),
        iron_ohm=a0,
        iron_ohm_s=a1,
        friction_nm=motor.friction_torque_nm,
        viscous_nm_s=motor.viscous_friction_nm_s,
    )


def widened(motor: Machine) -> Machine:
    """Return a motor whose temperature arrays have a trailing axis for a search's candidates."""
    temperature, resistance, flux = (
        np.asarray(values)[..., np.newaxis]
        for values in (motor.winding_temperature_c, motor.resistance_ohm, motor.flux_wb)
    )
    return replace(
        motor, winding_temperature_c=temperature, resistance_ohm=resistance, flux_wb=flux
    )


def bridge(drive: Drive) -> Bridge:
    """Return the inverter's loss coefficients, the paper's (10) to (14) with delta = 2 t_d f_s.

    The paper's text counts three switching events where six devices switch; its printed factor is
    kept, and turn_on/turn_off_loss_j_per_a are the k_on and k_off that belong to that factor.
    """
    inverter = drive.inverter
    dead_share = 2.0 * inverter.dead_time_s * inverter.pwm_frequency_hz
    switching = (
        3.0
        * (inverter.turn_on_loss_j_per_a + inverter.turn_off_loss_j_per_a)
        * inverter.pwm_frequency_hz
        / np.pi
    )
    return Bridge(
        linear_w_per_a=6.0 / np.pi * inverter.diode_forward_voltage_v * dead_share + switching,
        square_w_per_a2=1.5
        * (
            inverter.switch_resistance_ohm * (1.0 - dead_share)
            + inverter.diode_resistance_ohm * dead_share
        ),
    )


def torque_currents(
    motor: Machine, omega: ArrayLike, i_d: ArrayLike, i_q: ArrayLike
) -> tuple[Array, Array]:
    """Return (i_dt, i_qt) in A, the terminal currents less those of the iron-loss branch."""
    g = motor.iron_ratio(omega)
    i_qt = (i_q - g * motor.flux_wb - g * motor.d_inductance_h * i_d) / (
        1.0 + g * g * motor.d_inductance_h * motor.q_inductance_h
    )
    return np.asarray(i_d + g * motor.q_inductance_h * i_qt), np.asarray(i_qt)


def terminal_currents(
    motor: Machine, omega: ArrayLike, i_dt: ArrayLike, i_qt: ArrayLike
) -> tuple[Array, Array]:
    """Return (i_d, i_q) in A, torque currents plus what the iron-loss branch takes."""
    g = motor.iron_ratio(omega)
    return np.asarray(i_dt - g * motor.q_inductance_h * i_qt), np.asarray(
        i_qt + g * (motor.d_inductance_h * i_dt + motor.flux_wb)
    )


def dc_power_w(
    motor: Machine, inverter: Bridge, omega: ArrayLike, i_d: ArrayLike, i_q: ArrayLike
) -> Array:
    """Return evaluate()'s DC power in W alone, for searches."""
    i_dt, i_qt = torque_currents(motor, omega, i_d, i_q)
    u_d = motor.resistance_ohm * i_d - omega * motor.q_inductance_h * i_qt
    u_q = motor.resistance_ohm * i_q + omega * (motor.d_inductance_h * i_dt + motor.flux_wb)
    return np.asarray(1.5 * (u_d * i_d + u_q * i_q) + inverter.loss_w(np.hypot(i_d, i_q)))


def evaluate(
    motor: Machine, inverter: Bridge, omega: ArrayLike, i_d: ArrayLike, i_q: ArrayLike
) -> State:
    """Evaluate the steady state of terminal currents (A, peak) at an electrical speed (rad/s)."""
    i_dt, i_qt = torque_currents(motor, omega, i_d, i_q)
    omega, i_d, i_q, i_dt, i_qt, *_ = np.broadcast_arrays(
        omega, i_d, i_q, i_dt, i_qt, motor.resistance_ohm
    )
    v_d = -omega * motor.q_inductance_h * i_qt
    v_q = omega * (motor.d_inductance_h * i_dt + motor.flux_wb)
    u_d = motor.resistance_ohm * i_d + v_d
    u_q = motor.resistance_ohm * i_q + v_q
    torque = (
        1.5
        * motor.pole_pairs
        * i_qt
        * (motor.flux_wb + (motor.d_inductance_h - motor.q_inductance_h) * i_dt)
    )
    motor_power = 1.5 * (u_d * i_d + u_q * i_q)
    inverter_loss = inverter.loss_w(np.hypot(i_d, i_q))
    shaft_speed = omega / motor.pole_pairs
    friction = motor.friction_nm * np.abs(shaft_speed) + motor.viscous_nm_s * shaft_speed**2
    return State(
        omega_rad_s=omega,
        current_d_a=i_d,
        current_q_a=i_q,
        voltage_d_v=u_d,
        voltage_q_v=u_q,
        torque_nm=torque,
        loss_copper_w=1.5 * motor.resistance_ohm * (i_d * i_d + i_q * i_q),
        loss_iron_w=1.5 * (v_d * (i_d - i_dt) + v_q * (i_q - i_qt)),
        loss_inverter_w=inverter_loss,
        motor_power_w=motor_power,
        dc_power_w=motor_power + inverter_loss,
        shaft_power_w=torque * shaft_speed - friction,
        loss_friction_w=friction,
    )


@dataclass(frozen=True)
class BatteryState:
    """Steady state of the pack.

    Current and powers positive when discharging, arrays of the power's shape.
    """

    current_a: Array
    terminal_voltage_v: Array
    loss_w: Array
    chemical_power_w: Array


def battery_steady(
    open_circuit_v: ArrayLike, resistance_ohm: float, power_w: ArrayLike
) -> BatteryState:
    """Solve u_b i_b = power for a battery with R = R_s + R_t in series.

    NaN beyond the largest power u_oc^2 / (4 R).

    i_b = 2 P / (u_oc + sqrt(u_oc^2 - 4 R P)) is the root without cancellation, right for R = 0 too.
    """
    power_w = np.asarray(power_w, dtype=np.float64)
    square = open_circuit_v**2 - 4.0 * resistance_ohm * power_w
    current = 2.0 * power_w / (open_circuit_v + np.sqrt(np.where(square >= 0.0, square, np.nan)))
    return BatteryState(
        current_a=current,
        terminal_voltage_v=open_circuit_v - resistance_ohm * current,
        loss_w=resistance_ohm * current * current,
        chemical_power_w=open_circuit_v * current,
    )


def open_circuit_voltage_v(drive: Drive, soc: float | None = None) -> float:
    """Return u_oc in V at a state of charge (0 to 1); None: where work begins."""
    curve = drive.battery.open_circuit_voltage_v
    if isinstance(curve, float | int):
        return float(curve)
    soc = drive.battery.initial_soc if soc is None else soc
    return float(np.interp(soc, [point[0] for point in curve], [point[1] for point in curve]))
