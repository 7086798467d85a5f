# SPDX-License-Identifier: Apache-2.0
"""The flashable image on the model of its chip (``bus.c``), with a virtual bus of python-can."""

from __future__ import annotations

import os
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import can

Millisecond = tuple[list[int], int | None, list[str]]
"""What the battery allows, what the brake's sensor measures, the words of the step."""


class Wheel:
    """The program with the chip; its bus is the virtual one."""

    def __init__(self, channel: str, configuration: Path | None = None) -> None:
        """Start it: a stop, or with a configuration of its own at rest until the end."""
        program = [os.environ["HUBFOC_CHIP_BUS"], os.environ["HUBFOC_CHIP_ELF"]]
        self.process = subprocess.Popen(
            program if configuration is None else [*program, str(configuration)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.to_chip: IO[str] = self.process.stdin
        self.from_chip: IO[str] = self.process.stdout
        self.bus = can.Bus(channel, interface="virtual")

    def listen(self) -> Millisecond | None:
        """Put the wheel's frames of a millisecond on the bus; None after the last one."""
        battery, sensor = [0, 0, 0, 0], None
        for line in self.from_chip:
            word, *rest = line.split()
            if word == "frame":
                self.bus.send(
                    can.Message(
                        arbitration_id=int(rest[0], 16),
                        data=bytes.fromhex(rest[1]),
                        is_extended_id=False,
                    )
                )
            elif word == "sensor":
                sensor = int(rest[0])
            elif word == "battery":
                battery = [int(value) for value in rest]
            else:
                return battery, sensor, rest
        return None

    def answer(self) -> None:
        """Give the wheel what is on the bus for it."""
        while (frame := self.bus.recv(timeout=0)) is not None:
            self.to_chip.write(f"frame {frame.arbitration_id:x} {frame.data.hex()}\n")
        self.to_chip.write("step\n")
        self.to_chip.flush()

    def close(self) -> int:
        """End its input, read what is left, and return its exit code."""
        self.bus.shutdown()
        self.to_chip.close()
        self.from_chip.read()
        self.from_chip.close()
        return self.process.wait(timeout=60)


@contextmanager
def standing(channel: str, configuration: Path) -> Iterator[Wheel]:
    """A wheel at rest beside what the caller does on the bus."""
    wheel, ends = Wheel(channel, configuration), threading.Event()

    def run() -> None:
        while not ends.is_set() and wheel.listen() is not None:
            wheel.answer()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield wheel
    finally:
        ends.set()
        thread.join()
        status = wheel.close()
    assert status == 0
