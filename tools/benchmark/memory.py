# SPDX-License-Identifier: Apache-2.0
"""Flash, RAM and stack of a linked image, in all and by module of the firmware."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import build, stack_report

FLASH_AT_MOST = 192 * 1024
"""Of the image for the STM32F405, whose flash has 1 MiB."""
RAM_AT_MOST = 24 * 1024
"""Without the black box, whose size a port chooses."""
STACK_AT_MOST = 2560
"""By analysis; what a port reserves may be more."""

RAM_BEGINS = 0x20000000
RETAINED = ".retained"
"""The section of the black box, whose size a port chooses."""
_SECTION = re.compile(
    r"^\s*\[\s*\d+\] (\S+)\s+(\w+)\s+([0-9a-f]+) [0-9a-f]+ ([0-9a-f]+) .* (\w*A\w*) "
)
_PLACED = re.compile(r"^ (\.\S+)\s+0x0*([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S+)$")
_OWNER = re.compile(
    r"libhubfoc_(\w+)\.a\(|hubfoc_(config)_image\.dir|hubfoc_(port)_\w+\.dir|hubfoc_(app)_main\.dir"
    r"|/lib(?!hubfoc)(\w+)\.a\("
)


@dataclass(frozen=True)
class Memory:
    """Bytes of an image; RAM with the stack, and of it the black box."""

    flash: int
    ram: int
    black_box: int
    stack: int
    """By analysis (stack_report.py); 0: there is none beside the image."""
    modules: dict[str, tuple[int, int]]
    """Flash and RAM of each module; the C library and the compiler's together."""


def _allocated(elf: Path) -> Iterator[tuple[str, str, int, int]]:
    """Yield name, kind, address and size of every section that takes memory."""
    text = build.run([build.PREFIX + "readelf", "-SW", str(elf)], f"sections of {elf.name}")
    for match in filter(None, map(_SECTION.match, text.splitlines())):
        yield match[1], match[2], int(match[3], 16), int(match[4], 16)


def section(elf: Path, wanted: str) -> int:
    """Return the bytes of a section."""
    return sum(size for name, _, _, size in _allocated(elf) if name == wanted)


def sections(elf: Path) -> tuple[int, int, int]:
    """Return flash, RAM and the black box's part of it."""
    flash = ram = black_box = 0
    for name, kind, address, size in _allocated(elf):
        in_ram = address >= RAM_BEGINS
        ram += size if in_ram else 0
        flash += size if kind != "NOBITS" else 0
        black_box += size if name == RETAINED else 0
    return flash, ram, black_box


def modules(linker_map: Path) -> dict[str, tuple[int, int]]:
    """Return flash and RAM of each module by the linker's map."""
    text = linker_map.read_text().partition("Linker script and memory map")[2]
    # A long name stands on a line of its own.
    text = re.sub(r"\n( \.\S+)\n\s+", r"\n\1 ", text)
    flash: Counter[str] = Counter()
    ram: Counter[str] = Counter()
    for line in text.splitlines():
        match = _PLACED.match(line)
        owner = _OWNER.search(match[4]) if match else None
        if not match or not owner or match[1].startswith((".debug", ".comment", ".ARM")):
            continue
        name = next(filter(None, owner.groups()[:4]), "libraries")
        address, size = int(match[2], 16), int(match[3], 16)
        if address >= RAM_BEGINS:
            ram[name] += size
        elif address > 0:
            flash[name] += size
    return {name: (flash[name], ram[name]) for name in sorted(flash | ram)}


def of(elf: Path) -> Memory:
    """Measure an image that lies beside its map."""
    flash, ram, black_box = sections(elf)
    linker_map, analysis = elf.with_suffix(".map"), stack_report.result_of(elf)
    stack = json.loads(analysis.read_text())["bytes"] if analysis.is_file() else 0
    parts = modules(linker_map) if linker_map.is_file() else {}
    return Memory(flash, ram, black_box, stack, parts)


def firmware(image: Path) -> dict[str, Any] | None:
    """Return the same for a report, if the image has been built."""
    return asdict(of(image)) if image.is_file() else None


def judge(image: Path, flash_at_most: int) -> list[dict[str, Any]]:
    """Compare an image with its budgets."""
    size = of(image)
    found = (
        ("flash", flash_at_most, size.flash),
        ("RAM without the black box", RAM_AT_MOST, size.ram - size.black_box),
        ("stack by analysis", STACK_AT_MOST, size.stack),
    )
    # An image without an analysis of its stack has not met the budget.
    return [
        {"function": name, "bytes_at_most": most, "bytes": bytes_, "met": 0 < bytes_ <= most}
        for name, most, bytes_ in found
    ]


def show(console: Console, report: dict[str, Any]) -> None:
    """Print flash and RAM of the images of a report."""
    for port, size in report["firmware_bytes"].items():
        if size:
            parts = [f"{name} {flash} ({ram})" for name, (flash, ram) in size["modules"].items()]
            console.print(
                f"Firmware {port}: {size['flash']} bytes of flash, {size['ram']} of RAM with the"
                f" stack ({size['stack']} used) and {size['black_box']} of the black box; flash"
                " (RAM) by module: " + ", ".join(parts) + f"; at most {FLASH_AT_MOST} of flash"
            )
