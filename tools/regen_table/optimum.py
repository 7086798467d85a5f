# SPDX-License-Identifier: Apache-2.0
"""The braking torque that returns the most energy, closed form for i_d = 0.

With i_d = 0 the DC power is 1.5 (A i_q^2 + B i_q) + k1 |i_q| (peak quantities, any L_d and L_q):

    a^2 = omega^2 L_d L_q / R_i^2
    A = R_a + R_i a^2 / (1 + a^2) + k2 / 1.5
    B = omega psi / (1 + a^2)
    B > k1 / 1.5:  i_opt = -(B - k1/1.5) / (2 A)
                   i_zero = 2 i_opt
                   P_dc,min = -1.5 (B - k1/1.5)^2 / (4 A)
    otherwise no torque returns energy.

The battery's loss grows strictly with the DC power, so its voltage and resistance move neither
current.
"""

from dataclasses import dataclass

import numpy as np

from regen_table.models import Array, ArrayLike, Bridge, Machine, terminal_currents, torque_currents


@dataclass(frozen=True)
class Optimum:
    """Optimum with i_d = 0 and its neighbours; arrays over speed and temperature, broadcast.

    Torques are signed like the motor's (braking a forward rotation is negative) and
    electromagnetic.

    Attributes
    ----------
    possible : bool array
        Whether any torque returns energy.
    current_q_a : array
        i_opt in A; where regeneration is impossible, the current 0, which wastes least.
    current_extended_a : array
        The formula of i_opt without that condition: smooth through the threshold, driving (of the
        wrong sign) below it.
    torque_optimal_nm, torque_zero_nm, torque_idle_nm : array
        At i_opt; at i_zero, the boundary to plugging; at zero current (the iron's drag).
    """

    possible: np.typing.NDArray[np.bool_]
    current_q_a: Array
    current_extended_a: Array
    torque_optimal_nm: Array
    torque_zero_nm: Array
    torque_idle_nm: Array


def torque_at_zero_d_current(motor: Machine, omega: ArrayLike, i_q: ArrayLike) -> Array:
    """Torque in N m of a terminal current i_q (A) with i_d = 0."""
    i_dt, i_qt = torque_currents(motor, omega, 0.0, i_q)
    return np.asarray(
        1.5
        * motor.pole_pairs
        * i_qt
        * (motor.flux_wb + (motor.d_inductance_h - motor.q_inductance_h) * i_dt)
    )


def current_at_zero_d_current(motor: Machine, omega: ArrayLike, torque_nm: ArrayLike) -> Array:
    """Terminal current i_q in A that makes a torque with i_d = 0; NaN where no current does.

    With i_d = 0, i_dt = b i_qt, b = omega L_q / R_i, so the torque is 1.5 p (psi i_qt + (L_d - L_q)
    b i_qt^2): the root next to zero, in the form without cancellation (and right for L_d = L_q).
    """
    b = motor.iron_ratio(omega) * motor.q_inductance_h
    per_flux = np.asarray(torque_nm) / (1.5 * motor.pole_pairs)
    square = (
        np.square(motor.flux_wb)
        + 4.0 * (motor.d_inductance_h - motor.q_inductance_h) * b * per_flux
    )
    i_qt = 2.0 * per_flux / (motor.flux_wb + np.sqrt(np.where(square >= 0.0, square, np.nan)))
    return terminal_currents(motor, omega, b * i_qt, i_qt)[1]


def quadratic(motor: Machine, inverter: Bridge, omega: ArrayLike) -> tuple[Array, Array, float]:
    """Return (A, B, C) of P_dc = 1.5 (A i_q^2 + B i_q + C |i_q|).

    Ohm, V, V; B is signed like the speed.
    """
    g = motor.iron_ratio(omega)
    a_square = g * g * motor.d_inductance_h * motor.q_inductance_h
    # R_i a^2 = omega g L_d L_q, which needs no R_i and so holds without iron loss and at
    # standstill.
    a = (
        motor.resistance_ohm
        + omega * g * motor.d_inductance_h * motor.q_inductance_h / (1.0 + a_square)
        + inverter.square_w_per_a2 / 1.5
    )
    b = omega * motor.flux_wb / (1.0 + a_square)
    return np.asarray(a), np.asarray(b), inverter.linear_w_per_a / 1.5


def closed_form(motor: Machine, inverter: Bridge, omega: ArrayLike) -> Optimum:
    """Optimum of braking with i_d = 0 at electrical speeds of either sign."""
    a, b, c = quadratic(motor, inverter, omega)
    forward = np.where(np.asarray(omega) < 0.0, -1.0, 1.0)
    possible = np.abs(b) > c
    extended = -forward * (np.abs(b) - c) / (2.0 * a)
    current = np.where(possible, extended, 0.0)
    return Optimum(
        possible=possible,
        current_q_a=current,
        current_extended_a=extended,
        torque_optimal_nm=torque_at_zero_d_current(motor, omega, current),
        torque_zero_nm=torque_at_zero_d_current(motor, omega, 2.0 * current),
        torque_idle_nm=torque_at_zero_d_current(motor, omega, 0.0 * current),
    )
