# SPDX-License-Identifier: Apache-2.0
"""Blocks of code that the models of the chips have executed (tests/target/chip).

Its programs are of the host's build: chip_ride runs a flashable image on the model of its chip,
chip_calls a program of the emulated board. Both write a line for each interrupt or call: what it
was, what it met, its instructions, and its blocks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmark import build
from benchmark.build import BenchError
from benchmark.elf import Function

PROGRAMS = build.ROOT / "build" / "host" / "tests" / "target" / "chip"
SECONDS_AT_MOST = 600.0

Block = tuple[int, int]
"""Address and bytes of instructions executed one after the other."""


@dataclass(frozen=True)
class Executed:
    """One interrupt from its handler's first instruction to its return, or one call."""

    name: str
    met: str
    instructions: int
    blocks: str
    """As written: many interrupts have the same."""

    @property
    def path(self) -> list[Block]:
        """Blocks in the order of their execution."""
        pairs = (block.partition("+") for block in self.blocks.split())
        return [(int(address, 16), int(size, 16)) for address, _, size in pairs]


def read(file: Path) -> Iterator[Executed]:
    """Return what a program has written, in the order of its lines."""
    with file.open() as lines:
        for line in lines:
            name, met, instructions, blocks = line.rstrip("\n").split("\t")
            yield Executed(name, met, int(instructions), blocks)


def program(name: str) -> Path:
    """Path of a program, or an error that says how it is made."""
    found = PROGRAMS / name
    if not found.is_file():
        raise BenchError(
            f"no program {found}; cmake --build --preset host --target {name} makes it"
        )
    return found


def calls(
    elf: Path,
    output: Path,
    functions: dict[str, Function],
    names: list[str],
    begin: str,
    most: int,
    arguments: Sequence[str] = (),
) -> list[Executed]:
    """Return the first calls of functions after ``begin`` was called, in the order of their ends.

    arguments: as those of count.calls().
    """
    command = [str(program("chip_calls")), str(elf), str(output), str(most)]
    command += [hex(functions[begin].address), " ".join(["ride", *arguments])]
    command += [f"{name}={functions[name].address:#x}" for name in names]
    build.run(command, f"{elf.stem} on the model's core", timeout_s=SECONDS_AT_MOST)
    return list(read(output))


def check_equal(
    elf: Path,
    functions: dict[str, Function],
    counted: dict[str, list[int]],
    begin: str,
    most: int,
    arguments: Sequence[str] = (),
) -> None:
    """Raise BenchError unless the model counts, call by call, what the plugin has counted."""
    found: dict[str, list[int]] = {name: [] for name in counted}
    output = elf.with_suffix(".blocks")
    for call in calls(elf, output, functions, list(counted), begin, most, arguments):
        found[call.name].append(call.instructions)
    for name, by_block in found.items():
        by_instruction = counted[name][: len(by_block)]
        if not by_block or by_block != by_instruction:
            at = next(
                (
                    i
                    for i, (a, b) in enumerate(zip(by_block, by_instruction, strict=False))
                    if a != b
                ),
                min(len(by_block), len(by_instruction)),
            )
            raise BenchError(
                f"{name} in {elf.name}: the model and the plugin count call {at} of"
                f" {len(by_block)} differently"
            )
