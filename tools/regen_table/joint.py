# SPDX-License-Identifier: Apache-2.0
"""Least DC power for a torque, and the best braking torque, over both currents at once.

For a torque T the currents that make it lie on one curve: with i_dt free, i_qt = T / (1.5 p (psi +
(L_d - L_q) i_dt)). Along it the DC power is minimised inside the current circle |i| <= I_max and
the voltage circle |u| <= U. The best braking torque then minimises that least power over T. Both
searches are nested scans that shrink around the best point, without derivatives, because the power
is a quadratic form that turns indefinite at about omega |L_d - L_q| > 2 (R_a + k2 / 1.5), where the
limits decide.

All arrays broadcast; a negative speed is the mirror image (i_d kept, i_q and torque negated).
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
import numpy.typing as npt

from regen_table import models
from regen_table.models import Array, ArrayLike, Bridge, Machine, State

# a power beyond all real ones; the violation is added, so that searches approach the limits
_INFEASIBLE = 1e30
EXACT = 12  # scans of a search whose argument matters
AUDIT = 5  # scans of a search whose value matters, as in an audit of losses
_FIRST = {EXACT: 33, AUDIT: 17}  # points of the first scan for i_d
_BLOCK = 1000  # points searched at a time, so that their candidates stay in the cache
_TOLERANCE = 1e-9  # of a limit: rounding must not turn a point on a limit into one outside


@dataclass(frozen=True)
class Limits:
    """What bounds the search.

    Peak phase current in A and peak phase voltage in V (infinite: no limit).
    """

    current_a: ArrayLike
    voltage_v: ArrayLike = np.inf


@dataclass(frozen=True)
class Point:
    """Result of a search: the state, its electromagnetic torque (N m), and whether it is legal."""

    state: State
    torque_nm: Array
    feasible: npt.NDArray[np.bool_]


def least_power(
    motor: Machine,
    inverter: Bridge,
    omega: ArrayLike,
    torque_nm: ArrayLike,
    limits: Limits,
    scans: int = EXACT,
) -> Point:
    """Find the currents of least DC power that make a torque at an electrical speed.

    Where no currents inside the limits make the torque, ``feasible`` is false and the point is the
    one that violates the limits least. ``scans``: EXACT, or AUDIT where only the power matters.
    """
    sign = _sign(omega)
    forward = _Problem(motor, inverter, omega, limits, np.shape(torque_nm))
    torque = np.broadcast_to(sign * np.asarray(torque_nm, dtype=np.float64), forward.shape)
    i_dt, cost = forward.best_direct_current(torque, scans)
    i_d, i_q = models.terminal_currents(
        motor, forward.omega, i_dt, forward.quadrature(torque, i_dt)
    )
    state = models.evaluate(motor, inverter, omega, i_d, sign * i_q)
    return Point(state, state.torque_nm, np.asarray(cost < _INFEASIBLE))


def best_braking(
    motor: Machine,
    inverter: Bridge,
    omega: ArrayLike,
    limits: Limits,
    max_torque_nm: ArrayLike = np.inf,
    scans: int = EXACT,
) -> Point:
    """Find the braking torque and the currents that return the most DC power.

    At most ``max_torque_nm`` strong.

    Where no torque returns energy this is the torque that wastes least (no current, if the voltage
    limit allows it).
    """
    forward = _Problem(motor, inverter, omega, limits, np.shape(max_torque_nm))
    strongest = np.minimum(forward.torque_bound(), max_torque_nm)
    torque, _ = shrink(
        lambda t: forward.best_direct_current(t, scans)[1],
        -strongest,
        np.zeros(forward.shape),
        first=49,
        scans=scans,
    )
    return least_power(motor, inverter, omega, _sign(omega) * torque, limits, scans)


def zero_power_torque(
    motor: Machine, inverter: Bridge, omega: ArrayLike, limits: Limits, best: Point
) -> Array:
    """Return the torque in N m beyond the best one at which the least DC power is back at zero.

    Where the limits end before that, this is the strongest braking torque inside them.
    """
    sign = _sign(omega)
    forward = _Problem(motor, inverter, omega, limits, np.shape(best.torque_nm))
    inner = sign * best.torque_nm
    outer = -forward.torque_bound()
    for _ in range(
        45
    ):  # bisection, to rounding: the strong side consumes power or is outside the limits
        middle = 0.5 * (inner + outer)
        returns = forward.best_direct_current(middle)[1] <= 0.0
        inner, outer = np.where(returns, middle, inner), np.where(returns, outer, middle)
    return np.asarray(sign * inner)


class _Problem:
    """The search at one or many forward speeds, all of one shape.

    Candidates stand on trailing axes.
    """

    def __init__(
        self,
        motor: Machine,
        inverter: Bridge,
        omega: ArrayLike,
        limits: Limits,
        shape: tuple[int, ...],
    ) -> None:
        inputs = (
            np.abs(omega),
            motor.iron_ratio(np.abs(omega)),
            motor.resistance_ohm,
            motor.flux_wb,
            limits.current_a,
            limits.voltage_v,
        )
        arrays = np.broadcast_arrays(*inputs, np.zeros(shape))
        (
            self.omega,
            self.iron,
            self.resistance,
            self.flux,
            self.current_limit,
            self.voltage_limit,
        ) = (np.asarray(a) for a in arrays[:6])
        self.shape = self.omega.shape
        self.motor, self.inverter = motor, inverter
        self.saliency = motor.q_inductance_h - motor.d_inductance_h
        self.voltage_is_limited = bool(np.any(np.isfinite(self.voltage_limit)))

    def torque_bound(self) -> Array:
        """Torque in N m that no current inside the circle exceeds."""
        x, y = self._current_bounds()
        return np.asarray(1.5 * self.motor.pole_pairs * y * (self.flux + abs(self.saliency) * x))

    def quadrature(self, torque: Array, i_dt: Array) -> Array:
        """Return i_qt in A that makes a torque together with i_dt."""
        return torque / (
            1.5 * self.motor.pole_pairs * (_like(self.flux, i_dt) - self.saliency * i_dt)
        )

    def best_direct_current(self, torque: Array, scans: int = EXACT) -> tuple[Array, Array]:
        """Return i_dt in A of least DC power for each torque, and that power.

        Where limits are violated, the violation above _INFEASIBLE.
        """
        # Torques per point; a search over the torque has several.
        torques = torque.reshape(self.omega.size, -1)
        rows = max(_BLOCK // max(torques.shape[1], 1), 1)
        if len(torques) > rows:
            parts = [
                self._part(block).best_direct_current(torques[block], scans)
                for block in (slice(k, k + rows) for k in range(0, len(torques), rows))
            ]
            i_dt, power = (
                np.concatenate(values).reshape(torque.shape) for values in zip(*parts, strict=True)
            )
            return i_dt, power
        x, _ = self._current_bounds()
        low, high = -x, x
        # The torque per ampere of i_qt must stay positive: stay on one side of its pole.
        if self.saliency > 0.0:
            high = np.minimum(high, 0.999 * self.flux / self.saliency)
        elif self.saliency < 0.0:
            low = np.maximum(low, 0.999 * self.flux / self.saliency)
        low, high = (np.broadcast_to(_like(bound, torque), torque.shape) for bound in (low, high))
        return shrink(
            lambda i_dt: self.cost(torque[..., np.newaxis], i_dt), low, high, _FIRST[scans], scans
        )

    def _part(self, block: slice) -> Self:
        """Return the problem at some of its points, in one row."""
        part = copy.copy(self)
        for name in ("omega", "iron", "resistance", "flux", "current_limit", "voltage_limit"):
            setattr(part, name, getattr(self, name).ravel()[block])
        part.shape = part.omega.shape
        return part

    def cost(self, torque: Array, i_dt: Array) -> Array:
        """DC power in W of candidates, or how far outside the limits they are."""
        omega, iron, resistance, flux = (
            _like(a, i_dt) for a in (self.omega, self.iron, self.resistance, self.flux)
        )
        # In place where an intermediate result is not needed any more: half the time is memory's.
        i_q = self.quadrature(torque, i_dt)
        linked_d = self.motor.d_inductance_h * i_dt
        linked_d += flux
        linked_q = self.motor.q_inductance_h * i_q
        i_d = iron * linked_q
        np.subtract(i_dt, i_d, out=i_d)
        product = iron * linked_d
        i_q += product
        linked_d *= omega
        linked_q *= omega
        np.multiply(resistance, i_d, out=product)
        u_d = np.subtract(product, linked_q, out=linked_q)
        np.multiply(resistance, i_q, out=product)
        u_q = np.add(product, linked_d, out=linked_d)
        square = i_q * i_q
        np.multiply(i_d, i_d, out=product)
        square += product
        power = np.multiply(u_d, i_d, out=i_d)
        np.multiply(u_q, i_q, out=product)
        power += product
        power *= 1.5
        current = np.sqrt(square, out=i_q)
        np.multiply(self.inverter.linear_w_per_a, current, out=product)
        power += product
        square *= self.inverter.square_w_per_a2
        power += square
        current /= _like(self.current_limit, i_dt)
        violation = np.subtract(current, 1.0, out=current)
        if self.voltage_is_limited:
            u_d *= u_d
            u_q *= u_q
            u_d += u_q
            voltage = np.sqrt(u_d, out=u_d)
            voltage /= _like(self.voltage_limit, i_dt)
            voltage -= 1.0
            np.maximum(violation, voltage, out=violation)
        outside = ~(violation <= _TOLERANCE)
        if np.any(outside):
            power[outside] = _INFEASIBLE * (1.0 + violation[outside])
        return power

    def _current_bounds(self) -> tuple[Array, Array]:
        """Return bounds in A of |i_dt| and |i_qt| that the current circle implies."""
        g, l_d, l_q = self.iron, self.motor.d_inductance_h, self.motor.q_inductance_h
        y = (self.current_limit * (1.0 + g * l_d) + g * self.flux) / (1.0 + g * g * l_d * l_q)
        return np.asarray(self.current_limit + g * l_q * y), np.asarray(y)


def _sign(omega: ArrayLike) -> Array:
    return np.where(np.asarray(omega) < 0.0, -1.0, 1.0)


def _like(value: Array, candidates: Array) -> Array:
    """Give an array of the problem's shape as many trailing axes as the candidates have more."""
    return value.reshape(value.shape + (1,) * (candidates.ndim - value.ndim))


def shrink(
    cost: Callable[[Array], Array],
    low: Array,
    high: Array,
    first: int,
    scans: int = EXACT,
) -> tuple[Array, Array]:
    """Minimise a function of one variable in [low, high], elementwise; (argument, value).

    A scan with ``first`` points, then scans of 9 points between the neighbours of the best one so
    far, each four times finer. With ``scans`` = EXACT the interval ends below a few parts in 1e8 of
    the first one. With fewer, the vertex of the parabola through the last three points follows,
    which finds a smooth minimum as well as the value needs it.
    """
    shape, rows = low.shape, np.arange(low.size)
    low, high, points = low.ravel(), high.ravel(), first
    for _ in range(scans):
        candidates = low[:, np.newaxis] + (high - low)[:, np.newaxis] * _shares(points)
        values = cost(candidates.reshape(*shape, points)).reshape(-1, points)
        index = np.argmin(values, axis=1)
        best, value = candidates[rows, index], values[rows, index]
        step = (high - low) / (points - 1)
        low, high = np.maximum(low, best - step), np.minimum(high, best + step)
        points = 9
    if scans == EXACT:
        return best.reshape(shape), value.reshape(shape)
    inside = np.clip(index, 1, values.shape[1] - 2)
    before, middle, after = (values[rows, inside + k] for k in (-1, 0, 1))
    bend = before - 2.0 * middle + after
    smooth = (index == inside) & (bend > 0.0) & (np.maximum(before, after) < _INFEASIBLE)
    offset = np.divide(0.5 * (before - after), bend, out=np.zeros_like(bend), where=smooth)
    vertex = (best + step * offset).reshape(shape)
    best, value = best.reshape(shape), value.reshape(shape)
    there = cost(vertex[..., np.newaxis])[..., 0]
    return np.where(there < value, vertex, best), np.minimum(there, value)


@cache
def _shares(points: int) -> Array:
    """Return so many numbers from 0 to 1."""
    return np.linspace(0.0, 1.0, points)
