# SPDX-License-Identifier: Apache-2.0
"""Instruction counts: run a program on the emulator with the counting plugin and read what it wrote."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from pathlib import Path

from benchmark import build
from benchmark.elf import Function

SECONDS_AT_MOST = 240.0


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


def _window(name: str, functions: dict[str, Function]) -> str:
    """Describe a function to the plugin: where it starts and where its calls come back to."""
    if name not in functions:
        raise build.BenchError(
            f"{name}: not a function of its own in the program; was it renamed or inlined?"
        )
    ends = [site for function in functions.values() for site in function.return_sites.get(name, [])]
    jumps = [function.name for function in functions.values() if name in function.jumps]
    if jumps or not ends:
        raise build.BenchError(
            f"{name}: left by a jump from {', '.join(jumps) or 'nowhere'}, so its end cannot be seen"
        )
    return ":".join([name, hex(functions[name].address), *map(hex, ends)])


def emulator_command(core: build.Core, elf: Path) -> list[str]:
    """Return the emulator's command line, with semihosting, without which the program's first request would abort it."""
    emulator = build.tool("qemu-system-arm", "qemu-system-arm")
    quiet = [
        "-display",
        "none",
        "-monitor",
        "none",
        "-serial",
        "null",
        "-semihosting-config",
        "enable=on,target=native",
    ]
    return [emulator, "-M", core.machine, *quiet, "-kernel", str(elf)]


def loadable_plugin(core: build.Core, elf: Path, directory: Path) -> Path:
    """Return the plugin in the first version of the interface that this emulator loads.

    The trial runs the whole program, but the plugin watches nothing.
    """
    complaint = ""
    for interface in build.PLUGIN_INTERFACES:
        plugin = build.compile_plugin(interface, directory)
        try:
            build.run(
                [*emulator_command(core, elf), "-plugin", str(plugin)],
                "loading the plugin",
                timeout_s=SECONDS_AT_MOST,
            )
        except build.BenchError as error:
            complaint = str(error)
            continue
        return plugin
    raise build.BenchError(
        f"the emulator loads none of the plugin's versions {build.PLUGIN_INTERFACES}: {complaint}"
    )


def count(
    core: build.Core,
    elf: Path,
    plugin: Path,
    functions: dict[str, Function],
    names: list[str],
    begin: str,
) -> dict[str, Count]:
    """Instructions of every call of the named functions after ``begin`` was called."""
    result = elf.with_suffix(".counts")
    options = [str(plugin), f"out={result}", f"from={functions[begin].address:#x}"]
    options += [f"fn={_window(name, functions)}" for name in names]
    build.run(
        [*emulator_command(core, elf), "-plugin", ",".join(options)],
        f"the ride on {core.name}",
        timeout_s=SECONDS_AT_MOST,
    )
    found: dict[str, list[int]] = {name: [] for name in names}
    for line in result.read_text().splitlines():
        name, value = line.split()
        found[name].append(int(value))
    for name, values in found.items():
        if len(values) < 1000:
            raise build.BenchError(
                f"{name}: counted {len(values)} calls on {core.name}, fewer than 1000 prove nothing"
            )
    return {name: summary(values) for name, values in found.items()}
