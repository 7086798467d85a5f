# SPDX-License-Identifier: Apache-2.0
"""Cycles, load of the core and memory of each port's image: a table of this folder's README.

    python -m benchmark.ports STM32F405.elf STM32G431.elf

compares the rows that need no ride (flash, RAM, stack, modules) with two linked images, and these
with their budgets; exit status 1 if one is off. The other rows are of the models of the chips
(interrupt.py). Both ports run at 20 kHz.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import build, interrupt, memory
from benchmark.build import ROOT, BenchError
from benchmark.readme import DEVIATION, RELEASE

README = ROOT / "tools" / "benchmark" / "README.md"
BEGINS = "<!-- cycles and memory of the ports -->\n"
ENDS = "<!-- end of the ports -->\n"
PORTS = ("stm32f405", "stm32g431")
IMAGE_G431 = ROOT / "build" / "stm32g431" / "hubfoc_stm32g431.elf"
BYTES_DEVIATION = 0.005
"""Of the sums of flash and RAM; the stack is exact."""
MODULE_BYTES = 64
"""Of a module, or DEVIATION, if that is more."""


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
        "bytes of flash; of RAM without the black box": (
            f"{size['flash']}, {size['ram'] - size['black_box']}"
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


def _figures(text: str) -> dict[str, list[float]]:
    """Figures of each row."""
    rows = [line.split("|")[1:-1] for line in text.splitlines() if line.startswith("| ")]
    return {
        row[0].strip(): [float(n) for cell in row[1:] for n in re.findall(r"\d+\.?\d*", cell)]
        for row in rows[2:]
    }


def out_of_date(text: str, ports: dict[str, Any]) -> list[str]:
    """Name the rows of the table that are off by more than ``DEVIATION``."""
    shown = _figures(text.partition(BEGINS)[2].partition(ENDS)[0])
    return [
        f"{name}: shown {shown.get(name)}, counted {now}"
        for name, now in _figures(table(ports)).items()
        if len(shown.get(name, [])) != len(now)
        or any(abs(a - b) > DEVIATION * b for a, b in zip(shown[name], now, strict=True))
    ]


def _shown_rows(text: str) -> tuple[list[str], dict[str, list[str]]]:
    """Return the heading's cells and the other rows' of the README's table."""
    inside = text.partition(BEGINS)[2].partition(ENDS)[0]
    rows = [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in inside.splitlines()
        if line.startswith("| ")
    ]
    return (rows[0][1:], {row[0]: row[1:] for row in rows[2:]}) if rows else ([], {})


def _is_off(name: str, shown: str, now: str) -> bool:
    """Whether a cell of the memory is another one than the image's."""
    figures, counted = ([int(n) for n in re.findall(r"\d+", cell)] for cell in (shown, now))
    if len(figures) != len(counted):
        return True
    if "stack" in name:
        return figures != counted
    is_module = "`" in name
    most = [max(MODULE_BYTES, DEVIATION * n) if is_module else BYTES_DEVIATION * n for n in counted]
    return any(abs(a - b) > m for a, b, m in zip(figures, counted, most, strict=True))


def memory_out_of_date(text: str, sizes: dict[str, dict[str, Any]]) -> list[str]:
    """Name the cells of flash, RAM, stack and modules that are not those of the linked images."""
    heading, shown = _shown_rows(text)
    complaints = []
    for port, size in sizes.items():
        column = next((i for i, cell in enumerate(heading) if cell.startswith(port)), None)
        for name, now in memory_rows(size).items():
            cells = shown.get(name, [])
            cell = cells[column] if column is not None and column < len(cells) else ""
            if _is_off(name, cell, now):
                complaints.append(f"{port}, {name}: shown {cell or 'nothing'}, linked {now}")
    return complaints


def show(console: Console, ports: dict[str, Any]) -> None:
    """Print the table."""
    for row in table(ports).splitlines():
        console.print(row)


def status(report: dict[str, Any], update: bool) -> int:
    """Bring the table up to date if asked to; else return 1, and say so, if it is not."""
    ports = report.get("ports", {})
    if not ports:
        return 0
    if update:
        README.write_text(updated(README.read_text(), ports))
        return 0
    complaints = out_of_date(README.read_text(), ports) if RELEASE in report["compiler"] else []
    for complaint in complaints:
        print(f"bench: table of tools/benchmark/README.md: {complaint}", file=sys.stderr)
    if complaints:
        print("bench: ./tools/dev bench --update-readme writes that table", file=sys.stderr)
    return 1 if complaints else 0


def missed(images: dict[str, Path]) -> list[str]:
    """Name the budgets of memory that linked images miss."""
    return [
        f"{port}, {outcome['function']}: {outcome['bytes']} of {outcome['bytes_at_most']} bytes"
        for port, image in images.items()
        for outcome in memory.judge(image, memory.FLASH_AT_MOST)
        if not outcome["met"]
    ]


def main(arguments: list[str]) -> int:
    """Compare the table with linked images."""
    if len(arguments) != len(PORTS):
        print("usage: python -m benchmark.ports STM32F405.elf STM32G431.elf", file=sys.stderr)
        return 2
    images = {port: Path(image) for port, image in zip(PORTS, arguments, strict=True)}
    sizes = {port: memory.firmware(image) for port, image in images.items()}
    absent = [port for port, size in sizes.items() if size is None]
    if absent:
        raise BenchError(f"no image of {', '.join(absent)}; ./tools/dev firmware makes it")
    compiler = build.run([build.PREFIX + "gcc", "--version"], "the compiler's version")
    complaints = missed(images)
    if RELEASE in compiler.splitlines()[0]:
        known = {port: size for port, size in sizes.items() if size is not None}
        complaints += memory_out_of_date(README.read_text(), known)
    for complaint in complaints:
        print(f"ports: {complaint}", file=sys.stderr)
    if complaints:
        print("ports: ./tools/dev bench --update-readme writes the table", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        sys.exit(f"error: {error}")
