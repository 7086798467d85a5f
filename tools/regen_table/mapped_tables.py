# SPDX-License-Identifier: Apache-2.0
"""The two tables of a motor with a flux map: i_d of least loss, and T_opt.

Their grids are those that ``current_audit`` chooses with the constants; their entries are those of
the map. A torque that the map has no currents for inside the current circle has the i_d of the
largest one that it has. T_opt is stored unclamped: where the map's ends on the current circle, or
is next to none, it is the constants'.
"""

from dataclasses import replace

import numpy as np

from regen_table import flux_constants, flux_optimum, joint, models, stored_flux, torque_map
from regen_table.current_map import CurrentMap
from regen_table.models import Array
from regen_table.schema import Drive
from regen_table.torque_map import RegenMap

_ON_CIRCLE = 0.99  # of the largest phase current
_NEXT_TO_NONE = 0.02  # of max_torque_nm


def currents(drive: Drive, table: CurrentMap) -> CurrentMap:
    """Return i_d on the grid of a table; the table itself where the constants are exact."""
    if stored_flux.of(drive) is None:
        return table
    omega = drive.motor.pole_pairs * table.speeds_rad_s
    rows = [
        _rows(drive, motor, omega, table.torques_nm)
        for motor in _motors(drive, table.temperatures_c)
    ]
    current, lsb_log2 = torque_map.resolved("current_map", 1000.0 * np.array(rows))
    return replace(table, current_d_mA=current, lsb_log2=lsb_log2)


def braking(drive: Drive, table: RegenMap) -> RegenMap:
    """Return T_opt on the grid of a table; the table itself where the constants are exact."""
    if stored_flux.of(drive) is None:
        return table
    torque = table.torque_mNm.astype(np.float64)
    for row, motor in zip(torque, _motors(drive, table.temperatures_c), strict=True):
        best = flux_optimum.best_braking(
            motor, models.bridge(drive), drive.motor.pole_pairs * table.speeds_rad_s, _limits(drive)
        )
        inside = best.state.current_a < _ON_CIRCLE * drive.motor.max_phase_current_a
        taken = inside & (-best.torque_nm > _NEXT_TO_NONE * drive.motor.max_torque_nm)
        row[taken] = -1000.0 * best.torque_nm[taken]
    return torque_map.filled(table, torque)


def _motors(drive: Drive, temperatures_c: Array) -> list[flux_optimum.FluxMotor]:
    found = [flux_constants.measured(drive, float(winding_c)) for winding_c in temperatures_c]
    return [motor for motor in found if motor is not None]


def _limits(drive: Drive) -> joint.Limits:
    return joint.Limits(drive.motor.max_phase_current_a)


def _rows(drive: Drive, motor: flux_optimum.FluxMotor, omega: Array, torque: Array) -> Array:
    """Return i_d in A of speeds (rows) and torques, the middle one zero."""
    best = flux_optimum.least_power(
        motor, models.bridge(drive), omega[:, np.newaxis], torque, _limits(drive)
    )
    rows = np.where(best.feasible, best.state.current_d_a, np.nan)
    middle = len(torque) // 2
    for row in rows:
        for side in (row[middle:], row[middle::-1]):
            last = 0.0
            for k, value in enumerate(side):
                side[k] = last = last if np.isnan(value) else value
    return np.asarray(rows)
