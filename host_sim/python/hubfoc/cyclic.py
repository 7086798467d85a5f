# SPDX-License-Identifier: Apache-2.0
"""Messages that are sent in their cycle, whatever the rest of a program does."""

import time
from collections.abc import Callable, Mapping, Sequence
from threading import Event, Thread

import can
from hubsim import can_protocol

from hubfoc.bus import Bus
from hubfoc.errors import HubfocError

Values = Mapping[str, float]


def check(message: str, values: Values) -> None:
    """Refuse values that do not fit into a message, with the range that does."""
    try:
        can_protocol.encode(message, values)
    except ValueError as error:
        raise HubfocError(str(error)) from error


class Cyclic:
    """One message of one sender, end-to-end protected, for some wheels or for all in one frame.

    Parameters
    ----------
    bus : Bus
        Where it is sent.
    message : str
        Its name in hubfoc.dbc; its cycle and protection are there.
    base : int
        Lowest identifier of the vehicle.
    values : callable
        Asked in each cycle: the signals for each wheel in the order of their addresses, or of the
        one frame for all; None: nothing is sent in this cycle.

    A bus that takes no frame is no error here: the receivers notice by themselves.
    """

    def __init__(
        self, bus: Bus, message: str, base: int, values: Callable[[], Sequence[Values] | None]
    ) -> None:
        self._bus, self._message, self._base, self._values = bus, message, base, values
        self._ends = Event()
        self._counter = 0
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Send no more."""
        self._ends.set()
        self._thread.join()

    def _run(self) -> None:
        step_s = cycle_s(self._message)
        due_s = time.monotonic()
        while not self._ends.wait(max(due_s - time.monotonic(), 0.0)):
            values = self._values()
            if values is not None:
                self._send(values)
            due_s = max(due_s + step_s, time.monotonic() - step_s)

    def _send(self, values: Sequence[Values]) -> None:
        for wheel, own in enumerate(values):
            frame = can_protocol.encode(
                self._message, own, wheel=wheel, counter=self._counter, base=self._base
            )
            try:
                self._bus.send(*frame)
            except (can.CanError, OSError):
                break
        self._counter += 1


def cycle_s(message: str) -> float:
    """Return the cycle of a message in s."""
    return 1e-3 * can_protocol.MESSAGES[message].cycle_ms
