# SPDX-License-Identifier: Apache-2.0
"""Least DC power, best braking and limits of torque of a motor with a flux map.

The circuit is that of ``models``, with psi_d(i_dt, i_qt) and psi_q(i_dt, i_qt) in place of L i:

    v_d = -omega psi_q        v_q = omega psi_d        u = R i + v        i = i_t + v/R_i
    T = 1.5 p (psi_d i_qt - psi_q i_dt)

Magnets that are weaker than those of the map move its d axis, as a current would: the fluxes are
those of i_dt + shift, where shift is the current at which the map has the weaker flux.

For a torque and an i_dt the map has one i_qt of the torque's sign, which is solved exactly: along
i_qt a bilinear map makes the torque a parabola in every cell. i_dt and, for the best braking, the
torque are then searched by nested scans (``joint.shrink``). At a voltage U the torque ends where
no currents are left; by the circuit's identity

    |u|^2 = k^2 omega^2 lambda^2 + 4/3 k R omega T/p + R^2 |i_t|^2        k = 1 + R/R_i

a generating motor has more flux lambda left at the same voltage than a driving one.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from regen_table import joint
from regen_table.errors import ConfigurationError
from regen_table.flux_map import FluxMap
from regen_table.models import Array, Bridge, Machine, State

_INFEASIBLE = 1e30  # a power beyond all real ones; the violation is added
_TOLERANCE = 1e-9  # of a limit
_FIRST_CURRENTS, _FIRST_TORQUES = 65, 49
_HALVINGS = 50
_SCAN = 33  # torques of either sign among which one is looked for that is possible


@dataclass(frozen=True)
class FluxMotor:
    """A motor with a map, at one winding temperature.

    Attributes
    ----------
    machine : Machine
        Resistance, iron loss and friction; its flux and inductances are not read.
    flux : FluxMap
        Symmetrical in i_q.
    shift_a : float
        d current as which the magnets' temperature acts; zero where the map was measured.
    """

    machine: Machine
    flux: FluxMap
    shift_a: float = 0.0

    @property
    def d_range_a(self) -> tuple[float, float]:
        """Return the ends of i_dt in the map."""
        axis = self.flux.i_d_a
        return float(axis[0]) - self.shift_a, float(axis[-1]) - self.shift_a

    def linked(self, i_dt: Array, i_qt: Array) -> tuple[Array, Array]:
        """Return both flux linkages in Wb; NaN outside the map."""
        return self.flux.flux_wb(i_dt + self.shift_a, i_qt)

    def quadrature(self, torque_nm: Array, i_dt: Array) -> Array:
        """Return the i_qt in A of the torque's sign that makes it together with i_dt; NaN: none."""
        torque, i_d = np.broadcast_arrays(torque_nm, i_dt)
        wanted = np.abs(torque) / (1.5 * self.machine.pole_pairs)
        axis_d, middle = self.flux.i_d_a, len(self.flux.i_q_a) // 2
        axis_q = self.flux.i_q_a[middle:]
        at = i_d + self.shift_a
        j = np.clip(np.searchsorted(axis_d, at) - 1, 0, len(axis_d) - 2)
        share = ((at - axis_d[j]) / (axis_d[j + 1] - axis_d[j]))[..., np.newaxis]
        psi_d, psi_q = (
            (1.0 - share) * psi[j, middle:] + share * psi[j + 1, middle:]
            for psi in (self.flux.psi_d_wb, self.flux.psi_q_wb)
        )
        made = psi_d * axis_q - psi_q * i_d[..., np.newaxis]
        above = made >= wanted[..., np.newaxis]
        exists = np.any(above, axis=-1) & (at >= axis_d[0]) & (at <= axis_d[-1])
        k = np.maximum(np.argmax(above, axis=-1) - 1, 0)

        def of_cell(values: Array) -> tuple[Array, Array]:
            low, high = (np.take_along_axis(values, m[..., np.newaxis], -1) for m in (k, k + 1))
            return low[..., 0], (high - low)[..., 0]

        flux_d, rise_d = of_cell(psi_d)
        _, rise_q = of_cell(psi_q)
        width = axis_q[k + 1] - axis_q[k]
        square = rise_d * width
        linear = flux_d * width + rise_d * axis_q[k] - rise_q * i_d
        missing = wanted - of_cell(made)[0]
        root = np.sqrt(np.maximum(linear * linear + 4.0 * square * missing, 0.0))
        below = linear + root
        step = np.divide(2.0 * missing, below, out=np.zeros_like(below), where=below > 0.0)
        i_q = axis_q[k] + np.clip(step, 0.0, 1.0) * width
        return np.asarray(np.where(exists, np.copysign(i_q, torque), np.nan))

    def strongest_nm(self) -> float:
        """Return a torque that none of the map's points exceeds."""
        i_d, i_q = np.meshgrid(self.flux.i_d_a - self.shift_a, self.flux.i_q_a, indexing="ij")
        made = self.flux.psi_d_wb * i_q - self.flux.psi_q_wb * i_d
        return 1.5 * self.machine.pole_pairs * float(np.max(np.abs(made)))


def shift_a(flux: FluxMap, change_wb: float) -> float:
    """Return the d current in A as which a change of the magnets' flux acts.

    Raises
    ------
    ConfigurationError
        The map does not hold so weak magnets.
    """
    along = flux.flux_wb(flux.i_d_a, np.zeros_like(flux.i_d_a))[0]
    wanted = float(flux.flux_wb(np.array(0.0), np.array(0.0))[0]) + change_wb
    if not along[0] <= wanted <= along[-1]:
        raise ConfigurationError(
            f"magnets that change by {change_wb:.3g} Wb, accepted: a map whose psi_d at i_q = 0"
            f" holds {wanted:.4g} Wb; it has {along[0]:.4g} to {along[-1]:.4g} Wb"
        )
    return float(np.interp(wanted, along, flux.i_d_a))


def state(
    motor: FluxMotor, inverter: Bridge, omega: npt.ArrayLike, i_dt: Array, i_qt: Array
) -> State:
    """Evaluate the steady state of torque-producing currents, of the speeds' shape or broadcast."""
    machine = motor.machine
    omega = np.asarray(omega, dtype=np.float64)
    psi_d, psi_q = motor.linked(i_dt, i_qt)
    ratio = machine.iron_ratio(omega)
    i_d, i_q = i_dt - ratio * psi_q, i_qt + ratio * psi_d
    v_d, v_q = -omega * psi_q, omega * psi_d
    resistance = np.asarray(machine.resistance_ohm)
    u_d, u_q = resistance * i_d + v_d, resistance * i_q + v_q
    torque = 1.5 * machine.pole_pairs * (psi_d * i_qt - psi_q * i_dt)
    power = 1.5 * (u_d * i_d + u_q * i_q)
    of_inverter = inverter.loss_w(np.hypot(i_d, i_q))
    shaft = omega / machine.pole_pairs
    friction = machine.friction_nm * np.abs(shaft) + machine.viscous_nm_s * shaft**2
    return State(
        omega_rad_s=np.broadcast_to(omega, i_d.shape),
        current_d_a=i_d,
        current_q_a=i_q,
        voltage_d_v=u_d,
        voltage_q_v=u_q,
        torque_nm=torque,
        loss_copper_w=1.5 * resistance * (i_d * i_d + i_q * i_q),
        loss_iron_w=1.5 * ratio * omega * (psi_d * psi_d + psi_q * psi_q),
        loss_inverter_w=of_inverter,
        motor_power_w=power,
        dc_power_w=power + of_inverter,
        shaft_power_w=torque * shaft - friction,
        loss_friction_w=np.broadcast_to(friction, i_d.shape),
    )


def least_power(
    motor: FluxMotor,
    inverter: Bridge,
    omega: npt.ArrayLike,
    torque_nm: npt.ArrayLike,
    limits: joint.Limits,
) -> joint.Point:
    """Find the currents of least DC power that make torques at electrical speeds, broadcast.

    Where no currents inside the limits make a torque, ``feasible`` is false and the point is the
    one that violates the limits least.
    """
    speed, torque = np.broadcast_arrays(np.asarray(omega, np.float64), torque_nm)
    sign = np.where(speed < 0.0, -1.0, 1.0)
    i_dt, cost = _best(motor, inverter, np.abs(speed), sign * torque, limits)
    i_qt = sign * motor.quadrature(sign * torque, i_dt)
    found = state(motor, inverter, speed, i_dt, i_qt)
    return joint.Point(found, found.torque_nm, np.asarray(cost < _INFEASIBLE))


def best_braking(
    motor: FluxMotor,
    inverter: Bridge,
    omega: npt.ArrayLike,
    limits: joint.Limits,
    max_torque_nm: float = np.inf,
) -> joint.Point:
    """Find the braking torque, at most ``max_torque_nm``, and the currents that return most.

    Many speeds at once take little longer than one.
    """
    speed = np.asarray(omega, np.float64)
    strongest = min(motor.strongest_nm(), max_torque_nm)
    torque, _ = joint.shrink(
        lambda torques: _best(motor, inverter, np.abs(speed)[..., np.newaxis], torques, limits)[1],
        np.full(speed.shape, -strongest),
        np.zeros(speed.shape),
        _FIRST_TORQUES,
    )
    return least_power(motor, inverter, speed, np.where(speed < 0.0, -1.0, 1.0) * torque, limits)


def zero_power_torque_nm(
    motor: FluxMotor, inverter: Bridge, omega: float, limits: joint.Limits, best: joint.Point
) -> float:
    """Return the torque beyond the best one at which the least DC power is back at zero.

    Where the limits end before that, this is the strongest braking torque inside them.
    """
    sign = -1.0 if omega < 0.0 else 1.0
    inner, outer = np.array([sign * float(best.torque_nm)]), np.array([-motor.strongest_nm()])
    for _ in range(_HALVINGS):
        middle = 0.5 * (inner + outer)
        returns = _best(motor, inverter, abs(omega), middle, limits)[1] <= 0.0
        inner, outer = np.where(returns, middle, inner), np.where(returns, outer, middle)
    return sign * float(inner[0])


def idle_torque_nm(motor: FluxMotor, omega: float) -> float:
    """Return the drag of the iron in N m, without current in the wires: i_t = -v/R_i."""
    ratio = float(motor.machine.iron_ratio(omega))
    i_dt = i_qt = np.array(0.0)
    for _ in range(_HALVINGS):
        psi_d, psi_q = motor.linked(i_dt, i_qt)
        i_dt, i_qt = ratio * psi_q, -ratio * psi_d
    psi_d, psi_q = motor.linked(i_dt, i_qt)
    return float(1.5 * motor.machine.pole_pairs * (psi_d * i_qt - psi_q * i_dt))


def torque_limits_nm(
    motor: FluxMotor, inverter: Bridge, omega: float, limits: joint.Limits
) -> tuple[float, float]:
    """Return the least and the largest torque at a speed >= 0 inside current and voltage limits.

    Largest torque per ampere at low speed, per voltage at high speed; NaN where nothing is left.
    """
    most = motor.strongest_nm()
    torques = most * np.linspace(-1.0, 1.0, 2 * _SCAN + 1)

    def possible(some: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(_best(motor, inverter, omega, some, limits)[1] < _INFEASIBLE)

    inside = np.flatnonzero(possible(torques))
    if len(inside) == 0:
        return np.nan, np.nan
    within = torques[inside[[0, -1]]]
    outside = within + np.array([-1.0, 1.0]) * most / _SCAN
    for _ in range(_HALVINGS):
        middle = 0.5 * (within + outside)
        is_inside = possible(middle)
        within, outside = np.where(is_inside, middle, within), np.where(is_inside, outside, middle)
    return float(within[0]), float(within[1])


def _best(
    motor: FluxMotor, inverter: Bridge, omega: npt.ArrayLike, torque: Array, limits: joint.Limits
) -> tuple[Array, Array]:
    """Return i_dt in A of least DC power for each torque at speeds >= 0, and that power."""
    largest = np.hypot(np.max(np.abs(motor.flux.psi_d_wb)), np.max(np.abs(motor.flux.psi_q_wb)))
    speed = np.broadcast_to(np.asarray(omega, np.float64), torque.shape)
    most_a = float(limits.current_a) + motor.machine.iron_ratio(speed) * float(largest)
    low, high = motor.d_range_a
    return joint.shrink(
        lambda i_dt: _cost(
            motor, inverter, speed[..., np.newaxis], torque[..., np.newaxis], i_dt, limits
        ),
        np.maximum(low, -most_a),
        np.minimum(high, most_a),
        _FIRST_CURRENTS,
    )


def _cost(
    motor: FluxMotor,
    inverter: Bridge,
    omega: Array,
    torque: Array,
    i_dt: Array,
    limits: joint.Limits,
) -> Array:
    """DC power in W of candidates, or how far outside the limits they are."""
    i_qt = motor.quadrature(torque, i_dt)
    made = state(motor, inverter, omega, i_dt, i_qt)
    violation = (
        np.maximum(made.current_a / limits.current_a, made.voltage_v / limits.voltage_v) - 1.0
    )
    outside = ~(violation <= _TOLERANCE)
    # Beyond the map: farther than all that is in it.
    far = np.where(np.isnan(violation), 1e3, violation)
    return np.where(outside, _INFEASIBLE * (1.0 + far), made.dc_power_w)


def motor_of(machine: Machine, flux: FluxMap, flux_share: float) -> FluxMotor:
    """Return a motor whose magnets have a share of the flux that the map has without current."""
    magnets = float(flux.flux_wb(np.array(0.0), np.array(0.0))[0])
    return FluxMotor(machine, flux, shift_a(flux, (flux_share - 1.0) * magnets))
