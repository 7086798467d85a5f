# SPDX-License-Identifier: Apache-2.0
"""Records a virtual vehicle from its boot on: what goes in, and every step of its controllers."""

import os
import pickle
import subprocess
import sys
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from queue import Queue
from threading import Thread
from typing import Any

from hubsim import configuration
from hubsim.engine import Steps
from regen_table import installation, layout
from regen_table.schema import Drive

from hubfoc.live.writing import Piece, WheelSteps
from hubfoc.recording import Event, check_ready, part_of

PIECE_MS = 10  # handed over at once
QUEUED_MS = 16_000  # that wait for the disk; then the vehicle waits
LESS_URGENT = 5  # nice, than the vehicle
WRITER = "hubfoc.live.writing"


def axle(drive: Drive, file: Path) -> dict[str, Any]:
    """Return what the wheels of an axle, or all, are made of."""
    return {
        "drive": drive.name,
        "config_crc32": f"{crc32_of(configuration.image_of(drive)):08x}",
        "folder": str(drive.folder.resolve()),
        "toml": installation.drive_file(file).read_text(encoding="utf-8"),
    }


def provenance(axles: Sequence[Mapping[str, Any]], scenario: str | None) -> dict[str, Any]:
    """Return where a recording comes from; of two axles the front one is the first."""
    return {
        "hubfoc": installation.version(),
        "commit": installation.commit(),
        "start": "boot",
        "scenario": scenario,
        "axles": list(axles),
    }


def crc32_of(image: bytes) -> int:
    """Return the checksum of an image, which its key does not change."""
    return zlib.crc32(image[: layout.load().ffi.offsetof("config_t", "crc32")])


class Recorder:
    """The log of one vehicle (``vehicle.Log``), which a process of its own writes.

    A thread hands over what has come, in pieces so small that the vehicle does not wait for Python
    to make bytes of them.

    Attributes
    ----------
    milliseconds : int
        Of the simulation until now.
    failure : str or None
        Why the file could not be written.
    """

    def __init__(self, path: Path, origin: Mapping[str, Any]) -> None:
        check_ready(path)
        self.path = path
        self.milliseconds = 0
        self.failure: str | None = None
        self._complete = True
        self._steps: list[WheelSteps] = []
        self._events: list[Event] = []
        self._pieces: Queue[Piece | None] = Queue(QUEUED_MS // PIECE_MS)
        self._writer = subprocess.Popen(
            [sys.executable, "-m", WRITER], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C ends the recording, not its file
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )  # fmt: skip
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, self._writer.pid, LESS_URGENT)
        self._thread = Thread(target=self._hand_over, args=(path, origin), daemon=True)
        self._thread.start()

    def frame(self, millisecond: int, identifier: int, data: bytes) -> None:
        """Take a frame from outside."""
        self._events.append(Event(millisecond, "frame", identifier=identifier, data=data))

    def changed(self, millisecond: int, parameter: str, value: float) -> None:
        """Take a parameter of the simulated world."""
        self._events.append(Event(millisecond, "changed", parameter=parameter, value=value))

    def typed(self, millisecond: int, wheel: int, text: bytes) -> None:
        """Take what was typed into a wheel's shell."""
        self._events.append(Event(millisecond, "typed", wheel=wheel, data=text))

    def stepped(self, millisecond: int, wheel: int, found: Steps, image: bytes | None) -> None:
        """Take the steps of a wheel's controller; ``image`` with a boot among them."""
        if wheel == 0 and millisecond > 0 and millisecond % PIECE_MS == 0:
            self._pass_on()
        self._steps.append((millisecond, wheel, found.tobytes(), image))
        self.milliseconds = millisecond + 1

    def end(self, *, complete: bool = True) -> None:
        """Take nothing more; the file is completed meanwhile, or there is none."""
        self._complete = complete
        if complete:
            self._pass_on()
        self._pieces.put(None)

    @property
    def pid(self) -> int:
        """Return the number of the process that writes."""
        return self._writer.pid

    def wait(self) -> None:
        """Wait for the end of the file."""
        self._thread.join()

    @property
    def has_ended(self) -> bool:
        """Whether the file is complete, or cannot be."""
        return not self._thread.is_alive()

    def _pass_on(self) -> None:
        self._pieces.put((self._steps, self._events))
        self._steps, self._events = [], []

    def _hand_over(self, path: Path, origin: Mapping[str, Any]) -> None:
        """Give the process everything until the end, and take what it says of the file."""
        assert self._writer.stdin is not None
        assert self._writer.stdout is not None
        ended = False
        try:
            pickle.dump((path, dict(origin)), self._writer.stdin)
            while (piece := self._pieces.get()) is not None:
                pickle.dump(piece, self._writer.stdin, pickle.HIGHEST_PROTOCOL)
            ended = True
            pickle.dump(self._complete, self._writer.stdin)
            self._writer.stdin.close()
            self.failure = pickle.load(self._writer.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            self.failure = f"{path}: the process that writes it has ended"
            while not ended:
                ended = self._pieces.get() is None
            self._writer.kill()
            part_of(path).unlink(missing_ok=True)
        self._writer.wait()
        self._writer.stdout.close()
