# SPDX-License-Identifier: Apache-2.0
"""Flash, RAM and stack of a linked image, in all and by module of the firmware.

An image that is optimised whole has no parts that belong to one object. Its bytes are counted by
the debugger's information: code by the source line that it comes from, so that an inlined function
counts for the module that has written it, and variables and tables by the file that defines them.
"""

from __future__ import annotations

import json
import posixpath
import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import build, stack_report
from benchmark import elf as elf_reader

FLASH_AT_MOST = 192 * 1024
"""Of the image for the STM32F405, whose flash has 1 MiB."""
RAM_AT_MOST = 24 * 1024
"""Without black box and scope, whose sizes a port chooses."""
STACK_AT_MOST = 3200
"""By analysis; what a port reserves may be more."""

RAM_BEGINS = 0x20000000
RECORDINGS = (".retained", ".scope")
"""The sections of black box and scope."""
NAMELESS = "constants"
"""Texts, tables that the compiler made, padding: what neither a line nor a variable owns."""
LIBRARIES = "libraries"
_SECTION = re.compile(
    r"^\s*\[\s*\d+\] (\S+)\s+(\w+)\s+([0-9a-f]+) [0-9a-f]+ ([0-9a-f]+) .* (\w*A\w*) "
)
_SOURCE = re.compile(r"(?:^|/)(firmware|hal)/(\w+)/")
_FILE = re.compile(r"^(?:CU: )?(\S+):$")
_ROW = re.compile(r"^\S+ +(\d+|-) +0x([0-9a-f]+)\b")
_ENTRY = re.compile(r"^ <[0-9a-f]+><([0-9a-f]+)>: .*\((DW_TAG_\w+)\)")
_NAME = re.compile(r"DW_AT_name +: (?:\(\w+\) *)?(?:\(.*?offset: 0x[0-9a-f]+\): )?(.+)$")
_PLACE = re.compile(r"DW_AT_location +: .*\(DW_OP_addr: ([0-9a-f]+)\)$")
_REFERS = re.compile(r"DW_AT_(?:abstract_origin|specification) *: (?:\(\w+\) )?<0x([0-9a-f]+)>")


@dataclass(frozen=True)
class Memory:
    """Bytes of an image; RAM with the stack, and of it black box and scope."""

    flash: int
    ram: int
    recordings: int
    stack: int
    """By analysis (stack_report.py); 0: there is none beside the image."""
    modules: dict[str, tuple[int, int]]
    """Flash and RAM of each module, of the libraries, and of what has no name."""


def _allocated(elf: Path) -> Iterator[tuple[str, str, int, int]]:
    """Yield name, kind, address and size of every section that takes memory."""
    text = build.run([build.PREFIX + "readelf", "-SW", str(elf)], f"sections of {elf.name}")
    for match in filter(None, map(_SECTION.match, text.splitlines())):
        yield match[1], match[2], int(match[3], 16), int(match[4], 16)


def section(elf: Path, wanted: str) -> int:
    """Return the bytes of a section."""
    return sum(size for name, _, _, size in _allocated(elf) if name == wanted)


def sections(elf: Path) -> tuple[int, int, int]:
    """Return flash, RAM and of it black box and scope."""
    flash = ram = recordings = 0
    for name, kind, address, size in _allocated(elf):
        in_ram = address >= RAM_BEGINS
        ram += size if in_ram else 0
        flash += size if kind != "NOBITS" else 0
        recordings += size if name in RECORDINGS else 0
    return flash, ram, recordings


def _owner(path: str) -> str:
    """Return the module of a source file."""
    match = _SOURCE.search(posixpath.normpath(path))
    if not match:
        return LIBRARIES
    return "port" if match[1] == "hal" else match[2]


def _owned_code(elf: Path) -> Iterator[tuple[int, int, str]]:
    """Yield begin, end and module of the code of each row of the table of lines."""
    text = build.run(
        [build.PREFIX + "readelf", "-W", "--debug-dump=decodedline", str(elf)],
        f"lines of {elf.name}",
    )
    owner = owner_before = ""
    begins = None
    for line in text.splitlines():
        if row := _ROW.match(line):
            address = int(row[2], 16)
            if begins is not None:
                yield begins, address, owner_before
            begins, owner_before = (None if row[1] == "-" else address), owner
        elif file := _FILE.match(line):
            owner = _owner(file[1])


def _owned_variables(elf: Path) -> Iterator[tuple[int, str]]:
    """Yield address and module of each variable and table that the debugger knows."""
    text = build.run(
        [build.PREFIX + "readelf", "-W", "--debug-dump=info", str(elf)], f"variables of {elf.name}"
    )
    begins: list[int] = []
    owners: list[str] = []
    found: list[tuple[int, int]] = []
    tag, entry = "", 0
    for line in text.splitlines():
        if head := _ENTRY.match(line):
            tag, entry = head[2], int(head[1], 16)
        elif tag == "DW_TAG_compile_unit" and (name := _NAME.search(line)):
            begins.append(entry)
            owners.append(_owner(name[1]))
        elif tag == "DW_TAG_variable":
            if refers := _REFERS.search(line):  # what was declared in the unit of the source
                entry = int(refers[1], 16)
            elif place := _PLACE.search(line):
                found.append((int(place[1], 16), entry))
    for address, declared in found:
        yield address, owners[bisect_right(begins, declared) - 1]


def modules(elf: Path) -> dict[str, tuple[int, int]]:
    """Return flash and RAM of each module. Flash adds up to that of the image."""
    symbols = elf_reader.all_symbols(elf)
    sizes = {s.address: s.size for s in symbols if not s.is_code}
    owned = [(s.address, s.address + s.size, LIBRARIES) for s in symbols if s.is_code]
    owned += _owned_code(elf)
    owned += [(at, at + sizes.get(at, 0), owner) for at, owner in _owned_variables(elf)]
    flash: Counter[str] = Counter()
    ram: Counter[str] = Counter()
    for _, kind, address, size in _allocated(elf):
        owners = [""] * size
        for begin, end, owner in owned:
            if address <= begin < end <= address + size:
                owners[begin - address : end - address] = [owner] * (end - begin)
        counted = Counter(owners)
        nameless = counted.pop("", 0)
        flash += counted + Counter({NAMELESS: nameless}) if kind != "NOBITS" else Counter()
        ram += counted if address >= RAM_BEGINS else Counter()
    return {name: (flash[name], ram[name]) for name in sorted(flash | ram)}


def of(elf: Path) -> Memory:
    """Measure an image."""
    flash, ram, recordings = sections(elf)
    analysis = stack_report.result_of(elf)
    stack = json.loads(analysis.read_text())["bytes"] if analysis.is_file() else 0
    return Memory(flash, ram, recordings, stack, modules(elf))


def firmware(image: Path) -> dict[str, Any] | None:
    """Return the same for a report, if the image has been built."""
    return asdict(of(image)) if image.is_file() else None


def judge(image: Path, flash_at_most: int) -> list[dict[str, Any]]:
    """Compare an image with its budgets."""
    size = of(image)
    found = (
        ("flash", flash_at_most, size.flash),
        ("RAM without recordings", RAM_AT_MOST, size.ram - size.recordings),
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
                f" stack ({size['stack']} used) and {size['recordings']} of black box and scope;"
                " flash (RAM) by module: " + ", ".join(parts) + f"; at most {FLASH_AT_MOST}"
                " of flash"
            )
