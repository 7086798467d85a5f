# SPDX-License-Identifier: Apache-2.0
"""The crash record that a reset keeps, from the greeting or the shell's ``crash``.

The values are those of hal/include/hal/crash.h, in its order. Fault registers: Arm DDI 0403,
B3.2.15 and B3.2.16. Functions come from the symbols of the ELF, lines from addr2line if there is
one.
"""

import argparse
import re
import shutil
import struct
import subprocess
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.report import black_box

REGISTERS = ("r0", "r1", "r2", "r3", "r12", "lr", "pc", "psr", "sp", "cfsr", "hfsr", "address")
UNKNOWN = 0xFFFFFFFF
CFSR = {
    0: "instruction fetched from memory that is not executable",
    1: "data access to protected memory",
    3: "protected memory at the return from an exception",
    4: "protected memory while an exception stored registers: the stack",
    8: "no memory at the fetched instruction",
    9: "no memory at the accessed data",
    10: "no memory at written data, later than its instruction",
    11: "no memory at the return from an exception",
    12: "no memory while an exception stored registers: the stack",
    16: "undefined instruction",
    17: "instruction set that the core lacks: jump to an even address",
    18: "bad value for the program counter at the return from an exception",
    19: "coprocessor that is off or missing",
    24: "unaligned access",
    25: "division by zero",
}
HFSR = {1: "vector could not be read", 30: "raised to a hard fault"}
MODULES = ("", "core", "config", "foc", "torque", "monitor", "modes", "controller", "app")
_HEAD = re.compile(r"crash (\d+) since the supply came: (.+?) at 0x([0-9A-F]{8})")
_VALUES = re.compile(r"cfsr hfsr address:((?: 0x[0-9A-F]{8}){12})")
_SYMBOL_TABLE, _FUNCTION = 2, 2


@dataclass(frozen=True)
class Record:
    """The latest crash of a log."""

    count: int
    cause: str
    pc: int
    registers: dict[str, int]
    """Empty if only the greeting was logged."""


def read(text: str, name: str) -> Record:
    """Return the latest record of a terminal's log, with the registers that follow it."""
    heads = list(_HEAD.finditer(text))
    if not heads:
        raise HubsimError(f"{name}: no record, accepted: what the greeting or crash printed")
    last = heads[-1]
    values = _VALUES.search(text, last.end())
    registers: dict[str, int] = {}
    if values is not None:
        words = (int(word, 16) for word in values[1].split())
        registers = dict(zip(REGISTERS, words, strict=True))
    return Record(int(last[1]), last[2], int(last[3], 16), registers)


def functions(elf: bytes, name: str) -> list[tuple[int, int, str]]:
    """Return address, size and name of the functions in a 32-bit little-endian ELF, ascending."""
    try:
        if elf[:6] != b"\x7fELF\x01\x01":
            raise ValueError
        at, size, count = struct.unpack_from("<I", elf, 32)[0], *struct.unpack_from("<2H", elf, 46)
        sections = [struct.unpack_from("<10I", elf, at + k * size) for k in range(count)]
        found = []
        for section in sections:
            if section[1] != _SYMBOL_TABLE:
                continue
            names = sections[section[6]][4]
            for place in range(section[4], section[4] + section[5], 16):
                label, value, length, info = struct.unpack_from("<3IB", elf, place)
                if info & 0xF == _FUNCTION:
                    begin = names + label
                    text = elf[begin : elf.index(b"\0", begin)].decode()
                    found.append((value & ~1, length, text))
    except (struct.error, ValueError, IndexError) as damaged:
        raise HubsimError(f"{name}: accepted: the firmware's ELF of 32 bits") from damaged
    return sorted(found)


def place_of(address: int, known: list[tuple[int, int, str]]) -> str:
    """Return ``function+0xOFFSET``, or an empty text outside of all functions."""
    k = bisect_right(known, address & ~1, key=lambda function: function[0]) - 1
    if k < 0 or address & ~1 >= known[k][0] + max(known[k][1], 2):
        return ""
    return f"{known[k][2]}+0x{(address & ~1) - known[k][0]:X}"


def _line_of(address: int, elf: Path) -> str:
    tool = shutil.which("arm-none-eabi-addr2line")
    if tool is None:
        return ""
    command = [tool, "-e", str(elf), hex(address & ~1)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    line = made.stdout.strip()
    return "" if line.startswith("??") or not line else f" ({line})"


def _bits(value: int, meanings: dict[int, str]) -> list[str]:
    return [text for bit, text in meanings.items() if value >> bit & 1]


def described(record: Record, elf: Path | None = None) -> list[str]:
    """Return what happened, as lines."""
    lines = [f"crash {record.count} since the supply came: {record.cause}"]
    if record.cause == "failed check":
        module = record.pc >> 16
        owner = MODULES[module] if module < len(MODULES) else str(module)
        return [*lines, f"check {record.pc & 0xFFFF} of {owner}"]
    known = functions(elf.read_bytes(), str(elf)) if elf is not None else []
    for name in ("pc", "lr"):
        value = record.registers.get(name, record.pc if name == "pc" else UNKNOWN)
        if value == UNKNOWN:
            lines.append(f"{name:8} unknown")
            continue
        place = place_of(value, known)
        line = _line_of(value, elf) if elf is not None and place else ""
        lines.append(f"{name:8} 0x{value:08X} {place}{line}".rstrip())
    if record.registers:
        lines += [f"{'why':8} {text}" for text in _bits(record.registers["cfsr"], CFSR)]
        lines += [f"{'why':8} {text}" for text in _bits(record.registers["hfsr"], HFSR)]
        address = record.registers["address"]
        lines.append(f"{'address':8} " + ("unknown" if address == UNKNOWN else f"0x{address:08X}"))
        rest = (name for name in REGISTERS if name not in ("pc", "lr", "address"))
        lines.append(" ".join(f"{name} 0x{record.registers[name]:08X}" for name in rest))
    return lines


def command(options: argparse.Namespace) -> int:
    """Print the record of a log."""
    record = read(files.read_text(options.file, black_box.LONGEST_BYTES), str(options.file))
    if options.elf is not None and not options.elf.is_file():
        raise HubsimError(f"{options.elf}: no such file, accepted: the ELF of that firmware")
    print("\n".join(described(record, options.elf)))
    return 0
