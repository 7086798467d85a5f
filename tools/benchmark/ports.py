# SPDX-License-Identifier: Apache-2.0
"""Cycles, load of the core and memory of each port's image: a table of this folder's README.

The STM32F405's figures are those of the PWM interrupt that a report has already, the STM32G431's
come from the same ride on its own peripherals (stm32g431.py). Both run at 20 kHz.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import cycles, interrupt, memory
from benchmark.build import ROOT
from benchmark.readme import DEVIATION, RELEASE
from benchmark.stm32g431 import ChipG431

README = ROOT / "tools" / "benchmark" / "README.md"
BEGINS = "<!-- cycles and memory of the ports -->\n"
ENDS = "<!-- end of the ports -->\n"
PORTS = ("stm32f405", "stm32g431")
IMAGE_G431 = ROOT / "build" / "stm32g431" / "hubfoc_stm32g431.elf"


def of(report: dict[str, Any], image_g431: Path = IMAGE_G431) -> dict[str, Any]:
    """Return the figures of the ports of a report; of the STM32G431 if its image was built."""
    found = {"stm32f405": {**report["interrupt"], "memory": report["firmware_bytes"]["stm32f405"]}}
    if image_g431.is_file():
        measured = interrupt.measure(image_g431, chip_type=ChipG431, machine=cycles.STM32G431)
        found["stm32g431"] = {**measured, "memory": memory.firmware(image_g431)}
    return found


def _range(least: int, most: int) -> str:
    return f"{least} to {most}"


def _column(port: dict[str, Any]) -> list[str]:
    """Cells of one port, as the rows of table() are named."""
    taken, size = port["cycles"], port["memory"]
    fast, slow = taken["pwm_interrupt"], taken["millisecond_interrupt"]
    return [
        str(port["instructions"]["median"]) + ", " + str(port["instructions"]["max"]),
        _range(fast["least"]["median"], fast["most"]["median"]),
        _range(fast["least"]["max"], fast["most"]["max"]),
        f"{fast['cold']['median']}, {fast['cold']['max']}",
        _range(slow["least"]["median"], slow["most"]["median"]),
        _range(slow["least"]["max"], slow["most"]["max"]),
        f"{100 * taken['load_warm']:.1f} %, {100 * taken['load_cold']:.1f} %",
        f"{size['flash']}, {size['ram'] - size['black_box']}",
    ]


NAMES = (
    "PWM interrupt, instructions: median, worst",
    "PWM interrupt, cycles, warm: median",
    "PWM interrupt, cycles, warm: worst",
    "PWM interrupt, cycles, cold: median, worst",
    "millisecond interrupt, cycles, warm: median of the ride",
    "millisecond interrupt, cycles, warm: worst of the ride",
    "load of the core in the worst millisecond: warm, cold",
    "bytes of flash; of RAM without the black box",
)


def table(ports: dict[str, Any]) -> str:
    """Return the table in Markdown."""
    rows = [["", *(f"{name} ({port['config']})" for name, port in ports.items())]]
    rows.append(["---"] * len(rows[0]))
    rows += [
        list(cells)
        for cells in zip(NAMES, *(_column(port) for port in ports.values()), strict=True)
    ]
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
