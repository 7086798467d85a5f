# SPDX-License-Identifier: Apache-2.0
"""Rows that come in parts: few stay in memory, many go to a file that has no name."""

import tempfile
from typing import BinaryIO

import numpy as np

from hubsim.engine import Rows

MOST_BYTES = 1 << 26  # in memory


class Spool:
    """Collects rows of one width in the order in which they come."""

    def __init__(self, width: int) -> None:
        self._width = width
        self._parts: list[Rows] = []
        self._bytes = 0
        self._file: BinaryIO | None = None

    def add(self, rows: Rows) -> None:
        """Take further rows."""
        self._parts.append(rows)
        self._bytes += rows.nbytes
        if self._bytes > MOST_BYTES:
            self._spill()

    def rows(self) -> Rows:
        """Return all rows, shape (rows, width): an array, or a file's content looked at as one."""
        if self._file is None:
            return np.concatenate([np.empty((0, self._width)), *self._parts])
        self._spill()
        self._file.flush()
        return np.memmap(self._file, np.float64, "r").reshape(-1, self._width)

    def _spill(self) -> None:
        if self._file is None:
            self._file = tempfile.TemporaryFile()  # noqa: SIM115, goes with its last user
        for part in self._parts:
            np.ascontiguousarray(part).tofile(self._file)
        self._parts.clear()
        self._bytes = 0
