# SPDX-License-Identifier: Apache-2.0
"""The last minute of a vehicle's signals, a row each millisecond, and its accounts since then."""

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from hubsim.engine import Rows

from hubfoc.live.vehicle import STEP_S, LiveVehicle

SECONDS = 60
ROWS = round(SECONDS / STEP_S)
CODES = 256  # of reasons
# Of a wheel whose controller is the whole application these are not known, or constant.
NOT_SHOWN = re.compile(r"\.limit_|_used_c$|theta_estimate|^braking\.|^driver\.|first_fault")
DRAWN, RETURNED = "battery.drawn_j", "battery.returned_j"
OWN = {
    DRAWN: ("J", "taken out of the battery since the start"),
    RETURNED: ("J", "returned to the battery since the start"),
}

Columns = npt.NDArray[np.float32]


class History:
    """Rows of all signals that are known; one thread writes, others may read.

    Attributes
    ----------
    names : list of str
        The columns.
    count : int
        Rows since the vehicle began; row k is of the time (k + 1) ms.
    row : array, shape (columns,)
        The last row, in double precision, for the thread that writes.
    cost_j : array, shape (wheels, codes of reasons)
        Heat of each wheel's hydraulic brake while this reason limited its motor.
    """

    def __init__(self, vehicle: LiveVehicle) -> None:
        known = {
            name: meaning
            for name, meaning in vehicle.meanings().items()
            if not NOT_SHOWN.search(name)
        }
        self.meanings = known | OWN
        self.names = list(self.meanings)
        self.count = 0
        self.row: Rows = np.zeros(len(self.names))
        self._sampled = self.row[: len(known)]
        self._rows: Columns = np.zeros((ROWS, len(self.names)), dtype=np.float32)
        self._place = {name: k for k, name in enumerate(self.names)}
        vehicle.choose(list(known))
        self.cost_j = np.zeros((vehicle.wheels, CODES))
        wheels = range(vehicle.wheels)
        self._wheels = np.arange(vehicle.wheels)
        self._hydraulic = self.places([f"wheel{k}.hydraulic_torque_nm" for k in wheels])
        self._speed = self.places([f"wheel{k}.speed_rad_per_s" for k in wheels])
        self._reason = self.places([f"wheel{k}.reason" for k in wheels])
        self._battery = self.places(["battery.voltage_v", "battery.current_a"])

    def places(self, names: Sequence[str]) -> npt.NDArray[np.intp]:
        """Return the columns of these names; those that are not known are left out."""
        return np.array([self._place[name] for name in names if name in self._place], np.intp)

    def record(self, vehicle: LiveVehicle) -> Rows:
        """Take a row of the vehicle now, and return it."""
        row = self.row
        vehicle.sample(self._sampled)
        known = np.nan_to_num(row)  # of a real wheel that says nothing
        work_j = float(np.prod(known[self._battery])) * STEP_S
        row[self._place[DRAWN if work_j > 0.0 else RETURNED]] += abs(work_j)
        heat_j = np.abs(known[self._hydraulic] * known[self._speed]) * STEP_S
        codes = np.clip(known[self._reason], 0, CODES - 1).astype(np.intp)
        self.cost_j[self._wheels, codes] += heat_j
        self._rows[self.count % ROWS] = row
        self.count += 1
        return row

    def rows(self, first: int, places: npt.NDArray[np.intp]) -> tuple[int, Columns]:
        """Return the rows from ``first`` on that are still there, and the number of the first."""
        end = self.count
        begin = max(first, end - ROWS + 1, 0)
        taken = np.arange(begin, end) % ROWS
        return begin, self._rows[taken[:, None], places[None, :]]

    def columns(self, names: Sequence[str], first: int, end: int) -> dict[str, Columns]:
        """Return the time and known signals of the rows from ``first`` to before ``end``."""
        known = [name for name in names if name in self._place]
        begin, rows = self.rows(first, self.places(known))
        count = min(len(rows), max(end - begin, 0))
        time_s = ((begin + 1 + np.arange(count)) * STEP_S).round(6)
        return {"time_s": time_s, **{name: rows[:count, k] for k, name in enumerate(known)}}

    def latest(self, places: npt.NDArray[np.intp]) -> Columns:
        """Return the last row."""
        row: Columns = self._rows[(self.count - 1) % ROWS, places]
        return row
