# SPDX-License-Identifier: Apache-2.0
"""The constants that stand for a drive's flux map or saturation curves beside it.

The controller takes torque, limits and estimate from the map (``stored_flux``). Its monitor and
safe state hold one flux linkage and two inductances that contain the motor, ``bounds``. Questions
and grids that know constants only take those that fit the map's fluxes over the circle of
max_phase_current_a best, by least squares: all braking and driving currents with i_d <= 0, evenly
by area, and those with i_d > 0 too where L_d > L_q.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from regen_table import flux_files, flux_map, flux_optimum, models
from regen_table.errors import ConfigurationError
from regen_table.flux_map import FluxMap
from regen_table.models import Array
from regen_table.schema import Drive

_RADII, _ANGLES = 24, 49  # of the circle
_SHORT_RADII = 600
_SHORTED_FLUX = 0.9  # of the open circuit's
_DIGITS = 6  # of the constants, so that they are those of any processor
_CURVE_POINTS = 33  # of an axis of the map that curves make


@dataclass(frozen=True)
class Fitted:
    """Constants, and the largest error of the torque that they leave.

    Attributes
    ----------
    error_nm : float
        Of the constants' torque, signed, where it is largest; i_d_a and i_q_a say where.
    largest_nm : float
        Torque of the map inside the circle.
    """

    flux_linkage_wb: float
    d_inductance_h: float
    q_inductance_h: float
    error_nm: float
    i_d_a: float
    i_q_a: float
    largest_nm: float


@dataclass(frozen=True)
class Bounds:
    """Constants which the open and the shorted motor does not exceed."""

    flux_linkage_wb: float
    d_inductance_h: float
    q_inductance_h: float


def completed(tree: Mapping[str, Any], beside: Path) -> dict[str, Any]:
    """Return a drive's sections with the constants of its [motor]'s map or curves.

    Raises
    ------
    ConfigurationError
        One line a mistake, beginning with the key.
    """
    motor = dict(tree["motor"])
    if isinstance(motor.get("flux_map"), str):
        motor["flux_map"] = str(beside / motor["flux_map"])
    fitted = fit(motor, _map_of(motor))
    motor["d_inductance_h"] = fitted.d_inductance_h
    motor["q_inductance_h"] = fitted.q_inductance_h
    motor["flux_linkage_wb"] = fitted.flux_linkage_wb
    return {**tree, "motor": motor}


def of(drive: Drive) -> FluxMap | None:
    """Return the map of a drive, if it has one or curves."""
    motor = drive.motor
    if not motor.has_map:
        return None
    return _map_of(motor.model_dump(exclude_none=True))


def measured(drive: Drive, winding_temperature_c: float) -> flux_optimum.FluxMotor | None:
    """Return the motor of a drive that has a map, at a winding temperature."""
    found = of(drive)
    if found is None:
        return None
    machine = models.machine(drive, winding_temperature_c)
    share = float(np.asarray(machine.flux_wb)) / drive.motor.flux_linkage_wb
    return flux_optimum.motor_of(machine, found, share)


def _map_of(motor: Mapping[str, Any]) -> FluxMap:
    """Return the checked map of the keys of [motor]."""
    most = motor["max_phase_current_a"]
    if motor.get("flux_map") is None:
        return _of_curves(motor)
    key = "motor.flux_map"
    try:
        path = Path(motor["flux_map"])
        found = _loaded(path, content_of(path))
        flux_map.refuse_short(found, most)
        _refuse_warm(found, motor)
    except ConfigurationError as error:
        raise ConfigurationError(f"{key}: {error}") from error
    return found


def content_of(path: Path) -> bytes:
    """Return what a map's file holds; nothing of one that cannot be read, which its reader says."""
    try:
        return path.read_bytes()
    except OSError:
        return b""


@lru_cache(maxsize=4)
def _loaded(path: Path, _content: bytes) -> FluxMap:
    """Return the map of a file, which an image needs some forty times."""
    return flux_files.load(path)[0]


def _refuse_warm(found: FluxMap, motor: Mapping[str, Any]) -> None:
    """Refuse a map that ends before the current circle of the hottest magnets does."""
    rise_k = motor["max_winding_temperature_c"] - motor["reference_temperature_c"]
    share = (motor.get("flux_temperature_coefficient_per_k") or 0.0) * rise_k
    magnets = float(found.flux_wb(np.array(0.0), np.array(0.0))[0])
    shift = flux_optimum.shift_a(found, share * magnets)
    if -float(found.i_d_a[0]) < (motor["max_phase_current_a"] - shift) * (1.0 - flux_map.SAME_A):
        raise ConfigurationError(
            f"-i_d up to {-found.i_d_a[0]:g} A, accepted: a map up to the largest phase current and"
            f" the {-shift:.4g} A as which the hottest magnets act,"
            f" {motor['max_phase_current_a'] - shift:.4g} A"
        )


def _of_curves(motor: Mapping[str, Any]) -> FluxMap:
    """Return psi_d = psi + L_d(i_d) i_d, psi_q = L_q(|i_q|) i_q as a map of twice the circle."""
    most = motor["max_phase_current_a"]
    axis_d, axis_q = (np.linspace(-2.0, 2.0, 2 * _CURVE_POINTS - 1) * most for _ in range(2))
    flux = []
    for name, axis, looked_up in (("d", axis_d, axis_d), ("q", axis_q, np.abs(axis_q))):
        key = f"{name}_inductance_curve_h"
        points = motor.get(key) or ((0.0, motor.get(f"{name}_inductance_h", 0.0)),)
        current, inductance = (
            np.array(part, dtype=np.float64) for part in zip(*points, strict=True)
        )
        if np.any(np.diff(current) <= 0.0):
            raise ConfigurationError(
                f"motor.{key}: accepted: currents that rise from point to point"
            )
        furthest = -current[0] if name == "d" else current[-1]
        if motor.get(key) and furthest < most * (1.0 - flux_map.SAME_A):
            raise ConfigurationError(
                f"motor.{key}: up to {furthest:g} A, accepted: a curve up to"
                f" {'-' if name == 'd' else ''}max_phase_current_a = {most:g} A"
            )
        flux.append(np.interp(looked_up, current, inductance) * axis)
    psi_d = motor["flux_linkage_wb"] + flux[0][:, np.newaxis] + 0.0 * axis_q
    psi_q = flux[1][np.newaxis, :] + 0.0 * axis_d[:, np.newaxis]
    try:
        return flux_map.checked(FluxMap(axis_d, axis_q, psi_d, psi_q))[0]
    except ConfigurationError as error:
        raise ConfigurationError(f"motor.{_falling(error)}_inductance_curve_h: {error}") from error


def _falling(error: ConfigurationError) -> str:
    return "q" if str(error).startswith("psi_q") else "d"


def fit(motor: Mapping[str, Any], found: FluxMap) -> Fitted:
    """Return the constants of a map, and their largest error of torque over the circle."""
    i_d, i_q = _circle(motor["max_phase_current_a"], found.i_d_a[0])
    chosen = _least_squares(motor, found, i_d, i_q)
    if chosen[1] > chosen[2]:
        i_d, i_q = np.concatenate([i_d, -i_d]), np.concatenate([i_q, i_q])
        inside = ~np.isnan(found.flux_wb(i_d, i_q)[0])
        i_d, i_q = i_d[inside], i_q[inside]
        chosen = _least_squares(motor, found, i_d, i_q)
    psi, d_h, q_h = chosen
    pairs = motor["pole_pairs"]
    made = found.torque_nm(pairs, i_d, i_q)
    error = 1.5 * pairs * (psi + (d_h - q_h) * i_d) * i_q - made
    k = int(np.argmax(np.abs(error)))
    largest = float(np.max(np.abs(made)))
    return Fitted(psi, d_h, q_h, float(error[k]), float(i_d[k]), float(i_q[k]), largest)


def bounds(motor: Mapping[str, Any], found: FluxMap) -> Bounds:
    """Return the constants that monitor and safe state hold: DERIVATIONS.md, Flux maps."""
    i_d, i_q = _circle(motor["max_phase_current_a"], found.i_d_a[0])
    psi = float(found.flux_wb(np.array(0.0), np.array(0.0))[0])
    psi_q = found.flux_wb(i_d, i_q)[1]
    q_h = float(np.sum(psi_q * i_q) / np.sum(i_q * i_q))
    rounded = (float(f"{value:.{_DIGITS}g}") for value in (psi, _shorted_h(found, psi, q_h), q_h))
    return Bounds(*rounded)


def _shorted_h(found: FluxMap, psi_wb: float, q_h: float) -> float:
    """Return the largest L_d whose short circuit carries no less current than the map's.

    In a short circuit i is across psi(i), and omega/R is |i|/|psi|; the points of all angles, the
    last one that of high speed. Beyond the map's ends by the straight lines of its last cells, as
    the controller's copy.
    """
    ends = np.array([found.i_d_a[0], 0.0]), np.array([0.0, found.i_q_a[-1]])
    psi_d, psi_q = flux_map.extended_wb(found, *ends)
    slowest = -ends[0][0] / max(psi_wb - float(psi_d[0]), 1e-9), ends[1][1] / float(psi_q[1])
    angle = np.linspace(0.5, 1.0, _ANGLES)[1:, np.newaxis] * np.pi
    radius = np.linspace(0.0, 2.0 * psi_wb * max(slowest), _SHORT_RADII)[1:]
    i_d, i_q = radius * np.cos(angle), radius * np.sin(angle)
    psi_d, psi_q = flux_map.extended_wb(found, i_d, i_q)
    across = i_d * psi_d + i_q * psi_q
    row, column = np.nonzero((across[:, :-1] < 0.0) & (across[:, 1:] >= 0.0))
    amount = np.hypot(i_d, i_q)[row, column + 1]
    linked = np.hypot(psi_d, psi_q)[row, column + 1]
    per_ohm = amount / np.maximum(linked, 1e-9 * psi_wb)
    # Before, resistance and saliency decide, for which no L_d makes up.
    seen = (per_ohm * q_h > 1.0) & (linked < _SHORTED_FLUX * psi_wb)
    amount, per_ohm = amount[seen], per_ohm[seen]
    loaded = psi_wb / amount * per_ohm * np.hypot(1.0, per_ohm * q_h)
    largest = (loaded - 1.0) / (per_ohm**2 * q_h)
    return float(np.min(largest))


def _circle(current_a: float, lowest_a: float) -> tuple[Array, Array]:
    """Return currents inside the half of the circle with i_d <= 0, evenly by area."""
    radius = current_a * np.sqrt((np.arange(_RADII) + 1.0) / _RADII)
    angle = np.linspace(0.5 * np.pi, 1.5 * np.pi, _ANGLES)
    i_d = np.minimum(np.outer(radius, np.cos(angle)).ravel(), 0.0)
    return np.maximum(i_d, lowest_a), np.outer(radius, np.sin(angle)).ravel()


def _least_squares(
    motor: Mapping[str, Any], found: FluxMap, i_d: Array, i_q: Array
) -> tuple[float, float, float]:
    """Return psi, L_d and L_q; one inductance of surface magnets, psi as given with curves."""
    psi_d, psi_q = found.flux_wb(i_d, i_q)
    none, one = np.zeros_like(i_d), np.ones_like(i_d)
    given = motor.get("flux_linkage_wb") if motor.get("flux_map") is None else None
    columns = [np.concatenate([i_d, none]), np.concatenate([none, i_q])]
    if motor.get("type") == "spmsm":
        columns = [columns[0] + columns[1]]
    if given is None:
        columns.append(np.concatenate([one, none]))
    wanted = np.concatenate([psi_d - (given or 0.0), psi_q])
    solved = np.linalg.lstsq(np.stack(columns, axis=1), wanted, rcond=None)[0]
    solved = np.array([float(f"{value:.{_DIGITS}g}") for value in solved])
    psi = float(solved[-1]) if given is None else float(given)
    inductances = solved if given is not None else solved[:-1]
    return psi, float(inductances[0]), float(inductances[-1])


def warning(drive: Drive) -> str | None:
    """Return what of a controller of a drive with a map is that of constants, in one line."""
    found = of(drive)
    if found is None:
        return None
    key = "flux_map" if drive.motor.flux_map is not None else "d_inductance_curve_h"
    if key not in drive.motor.model_fields_set:
        key = "q_inductance_curve_h"
    keys = drive.motor.model_dump(exclude_none=True)
    fitted, bounding = fit(keys, found), bounds(keys, found)
    return (
        f"motor.{key}: the controller's torque, tables, current loop and observer are the map's,"
        " its monitor, safe state and exit of a short circuit are those of constants that the open"
        f" and the shorted motor does not exceed: flux_linkage_wb {bounding.flux_linkage_wb:.4g},"
        f" d_inductance_h {bounding.d_inductance_h:.4g}, q_inductance_h"
        f" {bounding.q_inductance_h:.4g};"
        " stop, cycle and figures are those of constants fitted over the current circle, whose"
        " torque is"
        f" up to {abs(fitted.error_nm):.3g} N m"
        f" ({abs(fitted.error_nm) / fitted.largest_nm:.1%} of the largest) beside the map's, at"
        f" i_d {fitted.i_d_a:.4g} A, i_q {fitted.i_q_a:.4g} A"
    )
