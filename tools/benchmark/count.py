# SPDX-License-Identifier: Apache-2.0
"""Instruction counts: run a program on the emulator and read what the plugin counted."""

from __future__ import annotations

import re
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmark import build
from benchmark.elf import Function

SECONDS_AT_MOST = 240.0
CALLS_AT_LEAST = 1000
REASONS = build.ROOT / "firmware" / "core" / "include" / "core" / "reason.h"


@dataclass(frozen=True)
class Count:
    """Instructions of the calls of one function; 99 % of the calls take ``p99`` or fewer."""

    calls: int
    min: int
    median: int
    p99: int
    max: int


def summary(values: list[int]) -> Count:
    """Summarise the instructions of every call of a function."""
    ordered = sorted(values)
    needed = -(-99 * len(ordered) // 100)
    median = int(statistics.median(ordered))
    return Count(len(ordered), ordered[0], median, ordered[needed - 1], ordered[-1])


def _ends(name: str, functions: dict[str, Function], seen: frozenset[str]) -> set[int]:
    """Addresses at which a function's calls come back.

    A function that another one leaves to by a jump returns to where that one was called.
    """
    ends: set[int] = set()
    for function in functions.values():
        ends |= set(function.return_sites.get(name, []))
        if name in function.jumps and function.name not in seen:
            ends |= _ends(function.name, functions, seen | {function.name})
    return ends


def _window(name: str, functions: dict[str, Function]) -> str:
    """Describe a function to the plugin: where it starts and where its calls come back to."""
    if name not in functions:
        raise build.BenchError(
            f"{name}: not a function of its own in the program; was it renamed or inlined?"
        )
    ends = sorted(_ends(name, functions, frozenset({name})))
    if not ends:
        raise build.BenchError(f"{name}: nothing calls it, so its end cannot be seen")
    return ":".join([name, hex(functions[name].address), *map(hex, ends)])


def emulator_command(core: build.Core, elf: Path, arguments: Sequence[str] = ()) -> list[str]:
    """Return the emulator's command line.

    With semihosting, without which the program's first request would abort the emulator.

    arguments: ``name=NUMBER``, for the emulated program.
    """
    emulator = build.tool("qemu-system-arm", "qemu-system-arm")
    quiet = [
        "-display",
        "none",
        "-monitor",
        "none",
        "-serial",
        "null",
        "-semihosting-config",
        ",".join(["enable=on,target=native", *(f"arg={text}" for text in ("ride", *arguments))]),
    ]
    return [emulator, "-M", core.machine, *quiet, "-kernel", str(elf)]


def loadable_plugin(directory: Path) -> Path:
    """Return the plugin in the first version of the interface that this emulator loads.

    The trial is a machine without a processor, whose monitor is told to quit.
    """
    emulator = build.tool("qemu-system-arm", "qemu-system-arm")
    idle = ["-M", "none", "-nodefaults", "-display", "none", "-monitor", "stdio"]
    complaint = ""
    for interface in build.PLUGIN_INTERFACES:
        plugin = build.compile_plugin(interface, directory)
        try:
            build.run(
                [emulator, *idle, "-plugin", str(plugin)],
                "loading the plugin",
                typed="quit\n",
                timeout_s=SECONDS_AT_MOST,
            )
        except build.BenchError as error:
            complaint = str(error)
            continue
        return plugin
    raise build.BenchError(
        f"the emulator loads none of the plugin's versions {build.PLUGIN_INTERFACES}: {complaint}"
    )


@dataclass(frozen=True)
class Call:
    """One call of a function: instructions, and those outside other named functions called."""

    name: str
    instructions: int
    own: int


def trace(
    core: build.Core,
    elf: Path,
    plugin: Path,
    functions: dict[str, Function],
    names: list[str],
    begin: str,
    arguments: Sequence[str] = (),
) -> tuple[list[Call], str]:
    """Return every call of the functions after ``begin`` was called, in the order of their ends.

    And what the program printed.
    """
    result = elf.with_suffix(".counts")
    options = [str(plugin), f"out={result}", f"from={functions[begin].address:#x}"]
    options += [f"fn={_window(name, functions)}" for name in names]
    text = build.run(
        [*emulator_command(core, elf, arguments), "-plugin", ",".join(options)],
        f"{elf.stem} on {core.name}",
        timeout_s=SECONDS_AT_MOST,
    )
    lines = [line.split() for line in result.read_text().splitlines()]
    return [Call(name, int(whole), int(own)) for name, whole, own in lines], text


def calls(
    core: build.Core,
    elf: Path,
    plugin: Path,
    functions: dict[str, Function],
    names: list[str],
    begin: str,
    arguments: Sequence[str] = (),
) -> tuple[dict[str, list[int]], str]:
    """Return instructions of every call of the functions after ``begin`` was called, in order.

    And what the program printed.
    """
    traced, text = trace(core, elf, plugin, functions, names, begin, arguments)
    found: dict[str, list[int]] = {name: [] for name in names}
    for call in traced:
        found[call.name].append(call.instructions)
    for name, values in found.items():
        if len(values) < CALLS_AT_LEAST:
            raise build.BenchError(
                f"{name}: counted {len(values)} calls on {core.name}, fewer than {CALLS_AT_LEAST}"
                " prove nothing"
            )
    return found, text


def count(
    core: build.Core,
    elf: Path,
    plugin: Path,
    functions: dict[str, Function],
    names: list[str],
    begin: str,
) -> dict[str, Count]:
    """Summary of every call of the named functions after ``begin`` was called."""
    found, _ = calls(core, elf, plugin, functions, names, begin)
    return {name: summary(values) for name, values in found.items()}


def by_reason(text: str, instructions: list[int]) -> dict[str, dict[str, int]]:
    """Summarise the states of the envelope that show the same reason, by its name.

    text: what the program printed with ``reasons=1``.
    """
    shown = [line[7:] for line in text.splitlines() if line.startswith("reason=")]
    found = {
        name: [n for n, reason in zip(instructions, shown, strict=True) if reason == number]
        for number, name in re.findall(r"X\((\d+), (\w+),", REASONS.read_text(encoding="utf-8"))
    }
    return {name: asdict(summary(values)) for name, values in found.items() if values}


def state_with(core: build.Core, elf: Path, index: int) -> dict[str, int]:
    """Return a state of the envelope, as the program itself describes it."""
    text = build.run(
        emulator_command(core, elf, [f"states={index + 1}", f"show={index}"]),
        f"the state with index {index}",
        timeout_s=SECONDS_AT_MOST,
    )
    fields = [line.partition("=") for line in text.splitlines()]
    return {name: int(value) for name, _, value in fields}


def describe_worst(core: build.Core, directory: Path, each: dict[str, Any]) -> None:
    """Add to each configuration's envelope how its program describes the worst state."""
    for config, value in each.items():
        worst = value["worst_state"]
        worst |= state_with(core, directory / f"envelope_{config}.elf", worst["index"])
