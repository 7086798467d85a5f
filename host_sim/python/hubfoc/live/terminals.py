# SPDX-License-Identifier: Apache-2.0
"""A pseudo terminal a wheel: its firmware's shell, as a serial line of a board."""

import contextlib
import os
import tty
from typing import Self

from hubfoc.live.limits import Inquiry
from hubfoc.live.vehicle import LiveVehicle

TYPED_BYTES = 1024


class Terminals:
    """The shells of all wheels; ``names`` are their devices."""

    def __init__(self, wheels: int) -> None:
        self._ends: list[tuple[int, int]] = []
        for _ in range(wheels):
            ours, theirs = os.openpty()
            tty.setraw(theirs)
            os.set_blocking(ours, False)
            self._ends.append((ours, theirs))
        self.names = [os.ttyname(theirs) for _, theirs in self._ends]

    def __enter__(self) -> Self:
        """Return the terminals themselves."""
        return self

    def __exit__(self, *_: object) -> None:
        """Take them away."""
        for end in self._ends:
            for number in end:
                os.close(number)

    def exchange(self, vehicle: LiveVehicle, inquiry: Inquiry | None = None) -> None:
        """Carry what was written on either side; what nobody reads is lost when a line is full.

        An inquiry takes the answers to its own questions.
        """
        for wheel, (ours, _) in enumerate(self._ends):
            with contextlib.suppress(BlockingIOError):
                vehicle.serial_type(wheel, os.read(ours, TYPED_BYTES))
                if inquiry is not None:
                    inquiry.typed(wheel, vehicle.time_s)
            written = vehicle.serial_take(wheel)
            if inquiry is not None:
                written = inquiry.received(wheel, written, vehicle.time_s)
            if written:
                with contextlib.suppress(BlockingIOError):
                    os.write(ours, written)
