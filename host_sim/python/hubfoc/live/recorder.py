# SPDX-License-Identifier: Apache-2.0
"""Records a virtual vehicle from its boot on: what goes in, and every step of its controllers."""

import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import Queue
from threading import Thread
from typing import Any

import numpy as np
from hubsim import configuration, steps
from hubsim.engine import STEP, Steps
from regen_table import installation, layout
from regen_table.schema import Drive

from hubfoc.recording import Event, Group, Part, Writer

GROUP_MS = 200  # at once: Python converts them, and the vehicle waits for no more than that
QUEUED_GROUPS = 80  # that wait for the disk; then the vehicle waits
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
        self._complete = True
        self._wheels: dict[int, _Wheel] = {}
        self._events: list[Event] = []
        self._groups: Queue[tuple[list[_Taken], list[Event]] | None] = Queue(QUEUED_GROUPS)
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

    def end(self, *, complete: bool = True) -> None:
        """Take nothing more; the file is completed meanwhile, or there is none."""
        self._complete = complete
        if complete:
            self._pass_on()
        self._groups.put(None)

    def wait(self) -> None:
        """Wait for the end of the file."""
        self._thread.join()

    @property
    def has_ended(self) -> bool:
        """Whether the file is complete, or cannot be."""
        return not self._thread.is_alive()

    def _pass_on(self) -> None:
        taken = [wheel.taken() for wheel in self._wheels.values()]
        self._groups.put((taken, self._events))
        self._events = []

    def _write(self) -> None:
        """Write until the end; after a failure take what comes and write no more."""
        while (found := self._groups.get()) is not None:
            if self.failure is None:
                parts = tuple(taken.part() for taken in found[0])
                with self._noted():
                    self._writer.write(Group(parts, tuple(found[1])))
        with self._noted():
            self._writer.close(complete=self._complete and self.failure is None)

    @contextmanager
    def _noted(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failure = f"{self.path}: cannot be written: {error.strerror or error}"


@dataclass(frozen=True)
class _Taken:
    """The steps of one wheel in some milliseconds, as they came."""

    wheel: int
    first: int  # number of the first step
    period_s: float
    blocks: list[tuple[int, Steps]]  # with their milliseconds
    images: list[bytes]

    def part(self) -> Part:
        """Return them as one, each with its time: a period after the fast step before it."""
        blocks = [(number, block) for number, block in self.blocks if len(block)]
        found = np.concatenate([np.empty(0, STEP), *(block for _, block in blocks)])
        lengths = np.array([len(block) for _, block in blocks], dtype=np.int64)
        milliseconds = np.repeat([number for number, _ in blocks], lengths).astype(np.int32)
        is_fast = found["kind"] == steps.FAST
        before = np.cumsum(is_fast) - is_fast  # fast steps before each step of this part
        periods = before - np.repeat(before[np.cumsum(lengths) - lengths], lengths)
        early = milliseconds < 0
        periods[early] -= np.count_nonzero(is_fast & early)
        time_s = np.maximum(milliseconds, 0) * MILLISECOND_S + periods * self.period_s
        numbers = np.arange(self.first, self.first + len(found), dtype=np.int64)
        return Part(self.wheel, numbers, milliseconds, time_s, found, tuple(self.images))


class _Wheel:
    """What one wheel's controller did since it was taken."""

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

    def taken(self) -> _Taken:
        out = _Taken(self._wheel, self._number, self._period_s, self._blocks, self._images)
        self._number += sum(len(block) for _, block in self._blocks)
        self._blocks, self._images = [], []
        return out
