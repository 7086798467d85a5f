# SPDX-License-Identifier: Apache-2.0
"""Losses of a motor with its inverter over shaft speed and torque, as parameters.

Shaft quantities; T_e is the torque in the air gap, Omega the shaft speed (DERIVATIONS, Losses as
measured):

    d   = constant + slope Omega / (1 + bend Omega)         drag of iron and friction
    T_e = T + d                                             zero with the bridge open
    P   = copper T_e^2 + growth T_e^4 + inverter |T_e| + d Omega

All parameters are at least zero. Where the current was measured, the torque that it would make
without saturation (``load_nm``) stands in the place of T_e, and there is no growth.
"""

from dataclasses import dataclass

import numpy as np

from regen_table.models import Array

COPPER, INVERTER, CONSTANT, SLOPE, BEND, GROWTH = range(6)
NAMES = (
    "copper_w_per_nm2",
    "inverter_w_per_nm",
    "drag_constant_nm",
    "drag_slope_nm_s",
    "drag_bend_s",
    "copper_growth_w_per_nm4",
)


@dataclass(frozen=True)
class Rows:
    """Points of operation; arrays of one shape.

    Attributes
    ----------
    speed, torque : array
        Of the shaft, rad/s and N m; speed positive, torque negative where it brakes.
    switching : array
        1 where the bridge works, 0 where it is open.
    load_nm : array
        Current times torque per ampere, NaN where the current is not known.
    warmth : array
        Resistance of the winding over that at the reference temperature.
    """

    speed: Array
    torque: Array
    switching: Array  # 1 or 0
    load_nm: Array
    warmth: Array  # resistance over that at the reference temperature


def rows_at(speed_rad_s: Array, torque_nm: Array) -> Rows:
    """Return points with the bridge working, unknown currents, at the parameters' temperature."""
    speed, torque = np.broadcast_arrays(
        np.asarray(speed_rad_s, np.float64), np.asarray(torque_nm, np.float64)
    )
    one = np.ones(speed.shape)
    return Rows(speed, torque, one, np.nan * one, one)


def drag_nm(values: Array, speed_rad_s: Array) -> Array:
    """Return the drag of iron and friction at shaft speeds."""
    return np.asarray(
        values[CONSTANT] + values[SLOPE] * speed_rad_s / (1.0 + values[BEND] * speed_rad_s)
    )


def evaluate(values: Array, rows: Rows) -> tuple[Array, Array]:
    """Return the losses and their derivatives by the parameters."""
    speed = rows.speed
    drag = drag_nm(values, speed)
    bent = 1.0 + values[BEND] * speed
    drag_slopes = np.stack(
        [np.ones_like(speed), speed / bent, -values[SLOPE] * np.square(speed / bent)], axis=-1
    )
    known = np.isfinite(rows.load_nm)
    air_gap = (rows.torque + drag) * rows.switching
    load = np.where(known, rows.load_nm, np.abs(air_gap))
    square = rows.warmth * load * load
    fourth = np.where(known, 0.0, rows.warmth * load**4)
    loss = (
        values[COPPER] * square + values[GROWTH] * fourth + values[INVERTER] * load + drag * speed
    )
    by_load = rows.warmth * (2.0 * values[COPPER] * load + 4.0 * values[GROWTH] * load**3)
    through_load = np.where(
        known, 0.0, rows.switching * np.sign(air_gap) * (by_load + values[INVERTER])
    )
    jacobian = np.zeros((*speed.shape, len(NAMES)))
    jacobian[..., COPPER], jacobian[..., INVERTER], jacobian[..., GROWTH] = (square, load, fourth)
    jacobian[..., [CONSTANT, SLOPE, BEND]] = drag_slopes * (speed + through_load)[..., np.newaxis]
    return loss, jacobian
