# SPDX-License-Identifier: Apache-2.0
"""The process that writes a recording, beside that of the vehicle: ``recorder.Recorder`` feeds it.

By its input come path and provenance, then pieces, then whether they are complete, each pickled; an
input that ends before that leaves no file. Its output is None, or why there is no file.
"""

import pickle
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from hubsim import steps
from hubsim.engine import STEP, Steps
from regen_table import layout

from hubfoc.recording import Event, Group, Part, Writer

GROUP_MS = 200  # are converted at once
MILLISECOND_S = 1e-3
# A millisecond of a wheel: its number, the wheel, its steps (STEP), the image of a boot in it.
WheelSteps = tuple[int, int, bytes, bytes | None]
Piece = tuple[list[WheelSteps], list[Event]]


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


class _Groups:
    """What has come since the latest group was written."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._wheels: dict[int, _Wheel] = {}
        self._events: list[Event] = []
        self._begin_ms = 0

    def take(self, piece: Piece) -> None:
        found, events = piece
        self._events += events
        for millisecond, wheel, block, image in found:
            own = self._wheels.setdefault(wheel, _Wheel(wheel))
            own.take(millisecond, np.frombuffer(block, STEP), image)
        if found and found[-1][0] >= self._begin_ms + GROUP_MS:
            self._begin_ms = found[-1][0]
            self.write()

    def write(self) -> None:
        parts = tuple(wheel.taken().part() for wheel in self._wheels.values())
        self._writer.write(Group(parts, tuple(self._events)))
        self._events = []


def _written(pieces: IO[bytes], path: Path, origin: dict[str, Any]) -> None:
    """Write until the end; an OSError where the file cannot be."""
    complete = False
    writer = Writer(path, origin)
    groups = _Groups(writer)
    try:
        while not isinstance(piece := pickle.load(pieces), bool):
            groups.take(piece)
        if piece:
            groups.write()
        complete = piece
    except EOFError:
        pass
    finally:
        writer.close(complete=complete)


def main() -> None:
    """Write one recording."""
    pieces, answer = sys.stdin.buffer, sys.stdout.buffer
    failure = None
    path, origin = pickle.load(pieces)
    try:
        _written(pieces, path, origin)
    except OSError as error:
        failure = f"{path}: cannot be written: {error.strerror or error}"
        while pieces.read(1 << 20):
            pass
    pickle.dump(failure, answer)


if __name__ == "__main__":
    main()
