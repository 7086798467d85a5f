# SPDX-License-Identifier: Apache-2.0
"""Records a virtual vehicle from its boot on: what goes in, and every step of its controllers."""

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from queue import Queue
from threading import Thread
from typing import Any

import numpy as np
from hubsim import configuration, steps
from hubsim.engine import Steps
from regen_table import installation, layout
from regen_table.schema import Drive

from hubfoc.recording import Event, Group, Part, Writer

GROUP_MS = 1000
QUEUED_GROUPS = 4  # that wait for the disk; then the vehicle waits
MILLISECOND_S = 1e-3


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
    """The log of one vehicle (``vehicle.Log``), written by a thread of its own.

    Attributes
    ----------
    milliseconds : int
        Of the simulation until now.
    failure : str or None
        Why the file could not be written.
    """

    def __init__(self, path: Path, origin: Mapping[str, Any]) -> None:
        self.path = path
        self.milliseconds = 0
        self.failure: str | None = None
        self._wheels: dict[int, _Wheel] = {}
        self._events: list[Event] = []
        self._groups: Queue[Group | None] = Queue(QUEUED_GROUPS)
        self._writer = Writer(path, origin)
        self._thread = Thread(target=self._write, daemon=True)
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
        if wheel == 0 and millisecond > 0 and millisecond % GROUP_MS == 0:
            self._pass_on()
        self._wheels.setdefault(wheel, _Wheel(wheel)).take(millisecond, found, image)
        self.milliseconds = millisecond + 1

    def close(self, *, complete: bool = True) -> None:
        """Complete the file, or have none."""
        if complete:
            self._pass_on()
        self._groups.put(None)
        self._thread.join()
        self._writer.close(complete=complete and self.failure is None)

    def _pass_on(self) -> None:
        parts = tuple(wheel.part() for wheel in self._wheels.values())
        self._groups.put(Group(parts, tuple(self._events)))
        self._events = []

    def _write(self) -> None:
        while (group := self._groups.get()) is not None:
            if self.failure is None:
                try:
                    self._writer.write(group)
                except OSError as error:
                    self.failure = f"{self.path}: cannot be written: {error.strerror or error}"


class _Wheel:
    """What one wheel's controller did since the last part."""

    def __init__(self, wheel: int) -> None:
        self._wheel = wheel
        self._number = 0
        self._period_s = 0.0
        self._blocks: list[tuple[int, Steps]] = []
        self._images: list[bytes] = []

    def take(self, millisecond: int, found: Steps, image: bytes | None) -> None:
        self._blocks.append((millisecond, found))
        if image is not None:
            config: Any = layout.load().ffi.from_buffer("config_t *", image)
            self._period_s = 1.0 / float(config.drive.pwm_frequency_Hz)
            self._images += [image] * int(np.count_nonzero(found["kind"] == steps.BOOT))

    def part(self) -> Part:
        found = np.concatenate([block for _, block in self._blocks])
        milliseconds = np.repeat(
            np.array([number for number, _ in self._blocks], dtype=np.int32),
            [len(block) for _, block in self._blocks],
        )
        time_s = np.concatenate([self._times(number, block) for number, block in self._blocks])
        numbers = np.arange(self._number, self._number + len(found), dtype=np.int64)
        out = Part(self._wheel, numbers, milliseconds, time_s, found, tuple(self._images))
        self._number += len(found)
        self._blocks, self._images = [], []
        return out

    def _times(self, millisecond: int, block: Steps) -> Any:  # noqa: ANN401, an array
        """Return when each step was: a period after the fast step before it."""
        is_fast = block["kind"] == steps.FAST
        periods = np.cumsum(is_fast) - is_fast
        if millisecond < 0:
            periods = periods - np.count_nonzero(is_fast)
        return max(millisecond, 0) * MILLISECOND_S + periods * self._period_s
