# SPDX-License-Identifier: Apache-2.0
"""A measured flux map as the simulated motor's iron: one energy over both fluxes, a bicubic spline.

The spline (plant/energy_map.h) is fitted so that its slopes are the currents of the map's points.
It is the slope of one function, so what of a map is not reciprocal cannot be in it and is left over
as a residual. Between the points it is smooth, and finer than the bilinear map of a controller.

    sum over points weight^2 |i_k - grad W(psi_k)|^2
        + SMOOTHNESS^2 sum (third differences of c / step)^2

The spline's rectangle of fluxes is larger than the map, for faults. Beyond the map's currents it
follows the inductances of the map's edge, at less weight.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from regen_table import flux_constants, flux_files
from regen_table.errors import ConfigurationError
from regen_table.flux_map import FluxMap
from regen_table.models import Array
from regen_table.schema import Drive

from hubsim.errors import HubsimError

MORE_COEFFICIENTS = 3  # than cells
CELLS = 40  # of an axis
SMOOTHNESS = 3e-2
MORE_POINTS = 16  # beyond each end of the map's axes
BEYOND = 1.0  # of an axis' length, how far they go
WEIGHT_BEYOND = 0.01
MARGIN = 0.2  # of the range of a flux, how far the spline goes beyond it
LARGEST_RESIDUAL = 0.05  # of the map's largest current


@dataclass(frozen=True)
class Iron:
    """A motor's iron.

    Attributes
    ----------
    flux_linkage_wb, d_inductance_h, q_inductance_h : float
        Without current; the inductances are incremental.
    d_first_wb, d_step_wb, q_first_wb, q_step_wb : float
        Axes of the spline, over psi_d - flux_linkage_wb and psi_q.
    coefficient_j : array
        Of what the map's energy has beside that of these inductances, for 3/2 of three phases.
    residual_a : float
        Largest difference between the current of a point and that of the spline at its flux.
    """

    flux_linkage_wb: float
    d_inductance_h: float
    q_inductance_h: float
    d_first_wb: float
    d_step_wb: float
    q_first_wb: float
    q_step_wb: float
    coefficient_j: Array
    residual_a: float

    def parameters(self) -> dict[str, float]:
        """Return the parameters of the simulated motor that the map decides."""
        return {
            "motor.flux_linkage_wb": self.flux_linkage_wb,
            "motor.d_inductance_h": self.d_inductance_h,
            "motor.q_inductance_h": self.q_inductance_h,
        }


def load(path: Path) -> Iron:
    """Read a flux map of any kind that regen_table knows."""
    try:
        return _possible(str(path), flux_files.load(path)[0])
    except ConfigurationError as error:
        raise HubsimError(str(error)) from error


def of_drive(drive: Drive) -> Iron | None:
    """Return the iron that a drive's own flux map or curves say."""
    found = flux_constants.of(drive)
    return None if found is None else _possible(drive.name, found)


def _possible(source: str, found: FluxMap) -> Iron:
    iron = of(found)
    largest_a = LARGEST_RESIDUAL * found.largest_current_a
    if iron.residual_a > largest_a:
        raise HubsimError(
            f"{source}: no energy has these fluxes: its currents are up to {iron.residual_a:.3g} A"
            f" from the map's, accepted: {largest_a:.3g} A"
        )
    return iron


def of(found: FluxMap) -> Iron:
    """Return the iron of a map that is symmetrical in i_q."""
    magnets_wb, d_inductance_h, q_inductance_h = _without_current(found)
    d_range = float(np.ptp(found.psi_d_wb))
    d_first = float(np.min(found.psi_d_wb)) - magnets_wb - MARGIN * d_range
    q_most = (1.0 + 2.0 * MARGIN) * float(np.max(np.abs(found.psi_q_wb)))
    d_step, q_step = (1.0 + 2.0 * MARGIN) * d_range / CELLS, 2.0 * q_most / CELLS
    i_d, i_q, psi_d, psi_q, weight = _continued(found)
    x, y = psi_d - magnets_wb, psi_q
    inside = (np.abs((x - d_first) / d_step / CELLS - 0.5) <= 0.5) & (np.abs(y) <= q_most)
    i_d, i_q, x, y, weight = (part[inside | (weight == 1.0)] for part in (i_d, i_q, x, y, weight))
    along_d, slope_d = _splines((x - d_first) / d_step)
    along_q, slope_q = _splines((y + q_most) / q_step)
    rows = np.concatenate(
        [_products(slope_d / d_step, along_q), _products(along_d, slope_q / q_step)]
    )
    more = np.concatenate([i_d - x / d_inductance_h, i_q - y / q_inductance_h])
    weights = np.concatenate([weight, weight])
    coefficients = _least_squares(rows * weights[:, np.newaxis], more * weights, d_step, q_step)
    missed_a = (rows @ coefficients.ravel() - more).reshape(2, -1)[:, weight == 1.0]
    return Iron(
        magnets_wb,
        d_inductance_h,
        q_inductance_h,
        d_first,
        d_step,
        -q_most,
        q_step,
        coefficients,
        float(np.max(np.hypot(missed_a[0], missed_a[1]))),
    )


def _continued(found: FluxMap) -> tuple[Array, Array, Array, Array, Array]:
    """Return i_d, i_q, psi_d, psi_q and weight of the map's points and of those beyond its axes."""

    def more(axis: Array) -> Array:
        far = BEYOND * (axis[-1] - axis[0]) * np.arange(1, MORE_POINTS + 1) / MORE_POINTS
        return np.concatenate([axis[0] - far[::-1], axis, axis[-1] + far])

    def along(axis: Array, values: Array, at: Array) -> Array:
        """Continue rows beyond both ends with the slope of the last interval."""
        j = np.clip(np.searchsorted(axis, at) - 1, 0, len(axis) - 2)
        share = ((at - axis[j]) / (axis[j + 1] - axis[j]))[:, np.newaxis]
        return np.asarray((1.0 - share) * values[j] + share * values[j + 1])

    d_axis, q_axis = more(found.i_d_a), more(found.i_q_a)
    d_edge = np.clip(d_axis, found.i_d_a[0], found.i_d_a[-1])
    q_edge = np.clip(q_axis, found.i_q_a[0], found.i_q_a[-1])
    i_d, i_q = np.meshgrid(d_axis, q_axis, indexing="ij")

    def both(psi: Array) -> Array:
        """Continue along each axis by itself: the edge's inductances, whatever the other does."""
        of_d, at_edge = (along(found.i_d_a, psi, at) for at in (d_axis, d_edge))
        parts = ((of_d, q_edge), (at_edge, q_axis), (-at_edge, q_edge))
        return np.asarray(sum(along(found.i_q_a, part.T, at).T for part, at in parts))

    psi_d, psi_q = both(found.psi_d_wb), both(found.psi_q_wb)
    measured = (
        (i_d >= found.i_d_a[0])
        & (i_d <= found.i_d_a[-1])
        & (i_q >= found.i_q_a[0])
        & (i_q <= found.i_q_a[-1])
    )
    weight = np.where(measured, 1.0, WEIGHT_BEYOND)
    return i_d.ravel(), i_q.ravel(), psi_d.ravel(), psi_q.ravel(), weight.ravel()


def _without_current(found: FluxMap) -> tuple[float, float, float]:
    """Return the magnets' flux and both inductances: parabolas through the points around zero."""
    zero = np.array(0.0)
    at_d = found.flux_wb(found.i_d_a, np.zeros_like(found.i_d_a))[0]
    at_q = found.flux_wb(np.zeros_like(found.i_q_a), found.i_q_a)[1]
    magnets_wb = float(found.flux_wb(zero, zero)[0])
    return magnets_wb, _slope_at_zero(found.i_d_a, at_d), _slope_at_zero(found.i_q_a, at_q)


def _slope_at_zero(current_a: Array, flux_wb: Array) -> float:
    nearest = np.argsort(np.abs(current_a), kind="stable")[:3]
    return float(np.polyfit(current_a[nearest], flux_wb[nearest], 2)[1])


def _splines(place: Array) -> tuple[Array, Array]:
    """Return the values and slopes of all B-splines at places, in cells from the first point."""
    cell = np.clip(np.floor(place), 0, CELLS - 1)
    t = place - cell
    s = 1.0 - t
    values = np.zeros((len(place), CELLS + MORE_COEFFICIENTS))
    slopes = np.zeros_like(values)
    rows = np.arange(len(place))
    parts = (
        (s**3 / 6.0, -0.5 * s**2),
        ((3.0 * t**3 - 6.0 * t**2 + 4.0) / 6.0, 1.5 * t**2 - 2.0 * t),
        ((3.0 * s**3 - 6.0 * s**2 + 4.0) / 6.0, 2.0 * s - 1.5 * s**2),
        (t**3 / 6.0, 0.5 * t**2),
    )
    for n, (value, slope) in enumerate(parts):
        values[rows, cell.astype(int) + n] = value
        slopes[rows, cell.astype(int) + n] = slope
    return values, slopes


def _products(of_d: Array, of_q: Array) -> Array:
    """Return all products of two bases, row by row."""
    return np.asarray((of_d[:, :, np.newaxis] * of_q[:, np.newaxis, :]).reshape(len(of_d), -1))


def _least_squares(rows: Array, wanted: Array, d_step: float, q_step: float) -> Array:
    """Return the coefficients, their sum zero (an energy has no zero of its own), even in q."""
    count = CELLS + MORE_COEFFICIENTS
    third = np.diff(np.eye(count), n=3, axis=0) * SMOOTHNESS
    bend, identity = third.T @ third, np.eye(count)
    normal = rows.T @ rows
    normal += np.kron(bend / d_step**2, identity) + np.kron(identity, bend / q_step**2)
    normal += np.trace(normal) / normal.size
    found = np.linalg.solve(normal, rows.T @ wanted).reshape(count, count)
    return np.asarray(0.5 * (found + found[:, ::-1]))
