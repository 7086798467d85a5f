# SPDX-License-Identifier: Apache-2.0
"""Cycles, load of the core and memory of each port's image: a table of this folder's README.

    python -m benchmark.ports STM32F405.elf STM32G431.elf

compares flash and RAM of two linked images with their budgets; exit status 1 if one is missed. The
rows about cycles are of the models of the chips (interrupt.py). Both ports run at 20 kHz.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import interrupt, memory
from benchmark.build import ROOT, BenchError

README = ROOT / "tools" / "benchmark" / "README.md"
BEGINS = "<!-- cycles and memory of the ports -->\n"
ENDS = "<!-- end of the ports -->\n"
PORTS = ("stm32f405", "stm32g431")
IMAGE_G431 = ROOT / "build" / "stm32g431" / "hubfoc_stm32g431.elf"


def of(report: dict[str, Any], image_g431: Path = IMAGE_G431) -> dict[str, Any]:
    """Return the figures of the ports of a report; of the STM32G431 if its image was built.

    ``rows`` of a port are its cells of the table, by the names of the rows.
    """
    found = {"stm32f405": {**report["interrupt"], "memory": report["firmware_bytes"]["stm32f405"]}}
    if image_g431.is_file():
        measured = interrupt.measure(image_g431, interrupt.PORTS["stm32g431"])
        found["stm32g431"] = {**measured, "memory": memory.firmware(image_g431)}
    for port in found.values():
        port["rows"] = {**ride_rows(port), **memory_rows(port["memory"])}
    return found


def _range(least: int, most: int) -> str:
    return f"{least} to {most}"


def ride_rows(port: dict[str, Any]) -> dict[str, str]:
    """Cells of one port that are counted on the model of its chip."""
    taken = port["cycles"]
    fast, slow = taken["pwm_interrupt"], taken["millisecond_interrupt"]
    instructions = port["instructions"]
    rows = {
        "PWM interrupt, instructions: median, worst": (
            f"{instructions['median']}, {instructions['max']}"
        ),
        "PWM interrupt, cycles, warm: median": _range(
            fast["least"]["median"], fast["most"]["median"]
        ),
        "PWM interrupt, cycles, warm: worst": _range(fast["least"]["max"], fast["most"]["max"]),
        "PWM interrupt, cycles, cold: median, worst": (
            f"{fast['cold']['median']}, {fast['cold']['max']}"
        ),
        "millisecond interrupt, cycles, warm: median of the ride": _range(
            slow["least"]["median"], slow["most"]["median"]
        ),
        "millisecond interrupt, cycles, warm: worst of the ride": _range(
            slow["least"]["max"], slow["most"]["max"]
        ),
        "load of the core in the worst millisecond: warm, cold": (
            f"{100 * taken['load_warm']:.1f} %, {100 * taken['load_cold']:.1f} %"
        ),
    }
    for ride, value in port["other_rides"].items():
        rows[f"PWM interrupt, cycles, warm: worst, {ride}"] = _range(value["least"], value["most"])
    return rows


def memory_rows(size: dict[str, Any]) -> dict[str, str]:
    """Cells of one port that are known when it is linked."""
    rows = {
        "bytes of flash; of RAM without black box and scope": (
            f"{size['flash']}, {size['ram'] - size['recordings']}"
        ),
        "bytes of stack, by analysis": str(size["stack"]),
    }
    for module, (flash, ram) in size["modules"].items():
        rows[f"bytes of flash, RAM: `{module}`"] = f"{flash}, {ram}"
    return rows


def table(ports: dict[str, Any]) -> str:
    """Return the table in Markdown."""
    rows = [["", *(f"{name} ({port['config']})" for name, port in ports.items())]]
    rows.append(["---"] * len(rows[0]))
    names = dict.fromkeys(name for port in ports.values() for name in port["rows"])
    rows += [[name, *(port["rows"].get(name, "") for port in ports.values())] for name in names]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def updated(text: str, ports: dict[str, Any]) -> str:
    """Return the README with this table."""
    before, _, rest = text.partition(BEGINS)
    return before + BEGINS + table(ports) + ENDS + rest.partition(ENDS)[2]


def show(console: Console, ports: dict[str, Any]) -> None:
    """Print the table."""
    for row in table(ports).splitlines():
        console.print(row)


def update(report: dict[str, Any]) -> None:
    """Bring the table up to date."""
    README.write_text(updated(README.read_text(), report["ports"]))


def missed(images: dict[str, Path]) -> list[str]:
    """Name the budgets of memory that linked images miss."""
    return [
        f"{port}, {outcome['function']}: {outcome['bytes']} of {outcome['bytes_at_most']} bytes"
        for port, image in images.items()
        for outcome in memory.judge(image, memory.FLASH_AT_MOST)
        if not outcome["met"]
    ]


def main(arguments: list[str]) -> int:
    """Compare linked images with their budgets."""
    if len(arguments) != len(PORTS):
        print("usage: python -m benchmark.ports STM32F405.elf STM32G431.elf", file=sys.stderr)
        return 2
    images = {port: Path(image) for port, image in zip(PORTS, arguments, strict=True)}
    absent = [port for port, image in images.items() if not image.is_file()]
    if absent:
        raise BenchError(f"no image of {', '.join(absent)}; ./tools/dev firmware makes it")
    complaints = missed(images)
    for complaint in complaints:
        print(f"ports: {complaint}", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        sys.exit(f"error: {error}")
