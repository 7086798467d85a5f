# SPDX-License-Identifier: Apache-2.0
"""The flux map as the controller holds it: few points, 16 bits each.

The points reach from the lowest d current (the current circle, and the current as which the hottest
magnets act beyond it) over zero to the highest, and from i_q = 0 to the current circle. Of all
shapes that the image has space for the one is taken whose torque is nearest to the map's.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from regen_table import flux_constants, flux_map, flux_optimum, layout
from regen_table.errors import ConfigurationError
from regen_table.flux_map import FluxMap
from regen_table.models import Array
from regen_table.schema import Drive

COLDEST_C = -40.0  # of the magnets
STRAIGHT = 1e-4  # of the largest torque: so little beside the map, and constants are stored
LEAST_Q_POINTS, MOST_Q_POINTS = 5, 33
_RADII, _ANGLES = 24, 49  # of the circle in which torques are compared
_LARGEST = 32767  # of an entry


@dataclass(frozen=True)
class StoredFlux:
    """Points of a map, as the image holds them.

    Attributes
    ----------
    d_negative_points : int
        Points below i_d = 0.
    d_step_mA, q_step_mA : int
        Distances of the points.
    psi_d_nWb, psi_q_nWb : array
        Of the shape (i_d, i_q), whole multiples of 2^``lsb_log2``.
    """

    d_negative_points: int
    d_step_mA: int  # noqa: N815, units keep their letters
    q_step_mA: int  # noqa: N815
    psi_d_nWb: npt.NDArray[np.int64]  # noqa: N815
    psi_q_nWb: npt.NDArray[np.int64]  # noqa: N815
    lsb_log2: int

    @property
    def flux(self) -> FluxMap:
        """Return what the controller takes the map to be, of both signs of i_q."""
        rows, columns = self.psi_d_nWb.shape
        i_d = _axis_a(-self.d_negative_points, rows, self.d_step_mA)
        i_q = _axis_a(1 - columns, 2 * columns - 1, self.q_step_mA)
        psi_d, psi_q = self.psi_d_nWb * 1e-9, self.psi_q_nWb * 1e-9
        return FluxMap(
            i_d,
            i_q,
            np.concatenate([psi_d[:, :0:-1], psi_d], axis=1),
            np.concatenate([-psi_q[:, :0:-1], psi_q], axis=1),
        )

    def fields(self) -> dict[str, int | list[int]]:
        """Return the fields of config_t.flux_map."""
        rows, columns = self.psi_d_nWb.shape
        return {
            "d_points": rows,
            "d_negative_points": self.d_negative_points,
            "d_step_mA": self.d_step_mA,
            "q_points": columns,
            "q_step_mA": self.q_step_mA,
            "lsb_log2": self.lsb_log2,
            "psi_d_lsb": [int(value) >> self.lsb_log2 for value in self.psi_d_nWb.ravel()],
            "psi_q_lsb": [int(value) >> self.lsb_log2 for value in self.psi_q_nWb.ravel()],
        }


NONE: dict[str, int | list[int]] = {
    "d_points": 0,
    "d_negative_points": 0,
    "d_step_mA": 0,
    "q_points": 0,
    "q_step_mA": 0,
    "lsb_log2": 0,
    "psi_d_lsb": [],
    "psi_q_lsb": [],
}


def of(drive: Drive) -> StoredFlux | None:
    """Return the stored map of a drive that has a map or curves; None: the constants are exact."""
    found = flux_constants.of(drive)
    if found is None:
        return None
    fitted = flux_constants.fit(drive.motor.model_dump(exclude_none=True), found)
    straight = abs(fitted.error_nm) <= STRAIGHT * fitted.largest_nm
    return None if straight else choose(drive, found)


def bounding(drive: Drive) -> Drive:
    """Return a drive with the constants that the image holds of it beside a map."""
    found = flux_constants.of(drive)
    if found is None or of(drive) is None:
        return drive
    bounds = flux_constants.bounds(drive.motor.model_dump(exclude_none=True), found)
    constants = {**dataclasses.asdict(bounds), "type": "ipmsm"}
    return drive.model_copy(update={"motor": drive.motor.model_copy(update=constants)})


def choose(drive: Drive, found: FluxMap) -> StoredFlux:
    """Return the shape whose torque is nearest to the map's inside the current circle."""
    capacity = layout.load().constants["CONFIG_FLUX_MAP_POINTS_MAX"]
    lowest_a, highest_a, quadrature_a = _ends_a(drive, found)
    stored = [
        _sampled(found, lowest_a, highest_a, quadrature_a, capacity // columns, columns)
        for columns in range(LEAST_Q_POINTS, MOST_Q_POINTS + 1)
    ]
    return min(stored, key=lambda one: torque_error(drive, found, one)[0])


def torque_error(drive: Drive, found: FluxMap, stored: StoredFlux) -> tuple[float, float, float]:
    """Return the largest error of torque in N m inside the current circle, and its currents."""
    radius = drive.motor.max_phase_current_a * np.sqrt((np.arange(_RADII) + 1.0) / _RADII)
    angle = np.linspace(0.0, np.pi, _ANGLES)
    i_d, i_q = (np.outer(radius, part(angle)).ravel() for part in (np.cos, np.sin))
    pairs = drive.motor.pole_pairs
    made = stored.flux.torque_nm(pairs, i_d, i_q)
    error = np.abs(made - found.torque_nm(pairs, i_d, i_q))
    error[np.isnan(error)] = 0.0  # beyond the map, where no torque is
    k = int(np.argmax(error))
    return float(error[k]), float(i_d[k]), float(i_q[k])


def _ends_a(drive: Drive, found: FluxMap) -> tuple[float, float, float]:
    """Return the lowest and the highest i_d and the highest i_q of the points."""
    motor = drive.motor
    most_a = motor.max_phase_current_a
    magnets = float(found.flux_wb(np.array(0.0), np.array(0.0))[0])

    def shift_a(temperature_c: float) -> float:
        per_k = motor.flux_temperature_coefficient_per_k or 0.0
        change_wb = per_k * (temperature_c - motor.reference_temperature_c) * magnets
        try:
            return flux_optimum.shift_a(found, change_wb)
        except ConfigurationError:
            return float(found.i_d_a[-1])  # colder magnets than the map holds

    lowest_a = -most_a + min(shift_a(motor.max_winding_temperature_c), 0.0)
    positive_a = most_a if motor.d_inductance_h > motor.q_inductance_h else 0.0
    highest_a = min(positive_a + max(shift_a(COLDEST_C), 0.0), float(found.i_d_a[-1]))
    return lowest_a, highest_a, most_a


def _sampled(
    found: FluxMap, lowest_a: float, highest_a: float, quadrature_a: float, rows: int, columns: int
) -> StoredFlux:
    """Return the map at evenly spaced points, with zero among them."""
    # One point above zero at least, so that the change of flux is that of both sides.
    above = max(1, round((rows - 1) * highest_a / (highest_a - lowest_a)))
    below = rows - 1 - above
    d_step = int(np.ceil(max(-lowest_a / below, highest_a / above) * 1e3))
    q_step = int(np.ceil(quadrature_a / (columns - 1) * 1e3))
    i_d, i_q = _axis_a(-below, rows, d_step), _axis_a(0, columns, q_step)
    psi_d, psi_q = flux_map.extended_wb(found, i_d[:, np.newaxis], i_q[np.newaxis, :])
    largest = 1e9 * max(float(np.max(np.abs(psi_d))), float(np.max(np.abs(psi_q))))
    lsb_log2 = 0
    while largest / 2**lsb_log2 > _LARGEST:
        lsb_log2 += 1

    def rounded(psi_wb: Array) -> npt.NDArray[np.int64]:
        return np.asarray(np.rint(psi_wb * 1e9 / 2**lsb_log2).astype(np.int64) << lsb_log2)

    return StoredFlux(below, d_step, q_step, rounded(psi_d), rounded(psi_q), lsb_log2)


def _axis_a(first: int, points: int, step_mA: int) -> Array:
    return np.arange(first, first + points, dtype=np.float64) * (step_mA * 1e-3)
