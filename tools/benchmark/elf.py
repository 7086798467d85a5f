# SPDX-License-Identifier: Apache-2.0
"""What the linker produced, read back through binutils.

Functions, calls, data they refer to, stack they push.

Standard library only: the stack report runs after every link, also on machines without the
project's environment. pyelftools would have to be there and would replace ``symbols`` alone: calls
and the stack that instructions take come from the disassembly, which it does not make.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

RAM_BEGINS = 0x20000000
_SYMBOL = re.compile(r"^\s*\d+: ([0-9a-f]+)\s+(\d+|0x[0-9a-f]+) (FUNC|OBJECT)\s.*\s(\S+)$")
_HEAD = re.compile(r"^([0-9a-f]+) <(\S+)>:$")
_LINE = re.compile(r"^\s*([0-9a-f]+):\t(\S+)\s*(.*)$")
_TARGET = re.compile(r"\b([0-9a-f]+) <([^>+]+)(\+0x[0-9a-f]+)?>")
_LITERAL = re.compile(r"\bpc, \[pc\b.*@ ([0-9a-f]+) ")


@dataclass(frozen=True)
class Symbol:
    """A sized symbol: address without the Thumb bit, size in bytes, code or data."""

    name: str
    address: int
    size: int
    is_code: bool


@dataclass
class Function:
    """One function as disassembled."""

    name: str
    address: int
    calls: set[str] = field(default_factory=set)
    """Functions it calls or jumps to."""
    return_sites: dict[str, list[int]] = field(default_factory=dict)
    """Called function -> addresses of the instructions following the calls."""
    jumps: set[str] = field(default_factory=set)
    """Functions it leaves to by a jump, so that their return goes to its own caller."""
    words: set[int] = field(default_factory=set)
    """Constants in its literal pool or built by movw/movt: among them addresses of its data."""
    pushed_bytes: int = 0
    """Stack that its instructions take, by the instructions themselves."""
    indirect: bool = False
    """Calls through a pointer."""
    variable: bool = False
    """Takes stack by the content of a register."""


def _run(tool: str, *arguments: str) -> str:
    return subprocess.run([tool, *arguments], check=True, capture_output=True, text=True).stdout


def all_symbols(elf: Path, prefix: str = "arm-none-eabi-") -> list[Symbol]:
    """Functions and objects of an ELF."""
    found = []
    for line in _run(prefix + "readelf", "-sW", str(elf)).splitlines():
        match = _SYMBOL.match(line)
        if match:
            address, size, kind, name = match.groups()
            found.append(Symbol(name, int(address, 16) & ~1, int(size, 0), kind == "FUNC"))
    return found


def symbols(elf: Path, prefix: str = "arm-none-eabi-") -> dict[str, Symbol]:
    """Functions and objects of an ELF by name; of several static ones with one name, the last."""
    return {symbol.name: symbol for symbol in all_symbols(elf, prefix)}


def _names(operands: str) -> set[str]:
    """Return the registers of a list without ranges: a return address is popped alone."""
    return set(re.findall(r"\w+", operands))


def _registers(operands: str) -> int:
    """Count of registers in a list like ``{r4, r6-r8, lr}``."""
    count = 0
    for part in re.findall(r"[^{},\s]+", operands[operands.index("{") :]):
        first, _, last = part.partition("-")
        count += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return count


def _pushed(mnemonic: str, operands: str) -> int:
    """Bytes by which an instruction lowers the stack pointer."""
    name = mnemonic.removesuffix(".w").removesuffix(".n")
    if name == "push" or (name in ("stmdb", "stmfd") and operands.startswith("sp!")):
        return 4 * _registers(operands)
    if name == "vpush":
        return (8 if "d" in operands else 4) * _registers(operands)
    if name in ("sub", "subw", "subs") and operands.startswith("sp"):
        match = re.search(r"#(\d+)", operands)
        return int(match.group(1)) if match else 0
    match = re.search(r"\[sp, #-(\d+)\]!", operands)
    return int(match.group(1)) if match and name.startswith("str") else 0


def _lowers_by_register(mnemonic: str, operands: str) -> bool:
    """Whether an instruction lowers the stack pointer by the content of a register."""
    return mnemonic.startswith("sub") and operands.startswith("sp, ") and "#" not in operands


class _Reader:
    """Goes through a disassembly, in which a call names what stands at an address."""

    def __init__(self, lines: list[str]) -> None:
        self.found: dict[str, Function] = {}
        self._at: dict[int, Function] = {}  # of each instruction
        self._popped = ""  # latest; ARMv6-M returns by `pop {r3}`, `bx r3` where it drops arguments
        for line in lines:
            if head := _HEAD.match(line):
                address, name = int(head.group(1), 16), head.group(2)
                # Static functions of one name have their addresses behind it, but for the first.
                key = f"{name}@{address:x}" if name in self.found else name
                current = self.found[key] = self._at[address] = Function(key, address)
            elif instruction := _LINE.match(line):
                self._at[int(instruction.group(1), 16)] = current

    def _note_jump_or_call(
        self, function: Function, mnemonic: str, operands: str, following: int
    ) -> None:
        name = mnemonic.removesuffix(".w").removesuffix(".n")
        target = _TARGET.search(operands)
        if name == "pop":
            self._popped = operands
        returns = name == "bx" and operands.split(maxsplit=1)[0] in {"lr", *_names(self._popped)}
        if name in ("bx", "blx") and not target and not returns:
            function.indirect = True
        if not target or not name.startswith(("b", "cb")):
            return
        address = int(target.group(1), 16)
        at = self._at.get(address)
        # ARMv6-M reaches farther than 2 KiB in a function by bl alone.
        if at is function and (name != "bl" or address != function.address):
            return
        called = at.name if at else target.group(2)
        function.calls.add(called)
        if name == "bl":
            function.return_sites.setdefault(called, []).append(following)
        else:
            function.jumps.add(called)

    def read(self, lines: list[str]) -> None:
        """Note what each function does."""
        current: Function | None = None
        high: dict[str, int] = {}
        low: dict[str, int] = {}
        literal = 0
        for line in lines:
            head = _HEAD.match(line)
            if head:
                current = self._at[int(head.group(1), 16)]
                high, low = {}, {}
                continue
            match = _LINE.match(line)
            if not match or current is None:
                continue
            address, mnemonic, operands = int(match.group(1), 16), match.group(2), match.group(3)
            if mnemonic == ".word":
                word = int(operands.split()[0], 16)
                current.words.add(word)
                if address == literal:  # of the linker's jump between flash and RAM
                    called = self._at.get(word & ~1)
                    name = called.name if called else f"{word:#x}"
                    current.calls.add(name)
                    current.jumps.add(name)
            elif mnemonic.startswith(("movw", "movt")):
                register, _, value = operands.partition(", #")
                half = low if mnemonic.startswith("movw") else high
                half[register] = int(value.split()[0])
                if register in low and register in high:
                    current.words.add(low[register] | high[register] << 16)
            else:
                current.pushed_bytes += _pushed(mnemonic, operands)
                current.variable |= _lowers_by_register(mnemonic, operands)
                loaded = _LITERAL.search(operands)
                literal = int(loaded.group(1), 16) if loaded else literal
                self._note_jump_or_call(current, mnemonic, operands, address + 4)


def functions(elf: Path, prefix: str = "arm-none-eabi-") -> dict[str, Function]:
    """Every function of an ELF, disassembled."""
    text = _run(prefix + "objdump", "-d", "--no-show-raw-insn", "-w", str(elf))
    lines = text.splitlines()
    reader = _Reader(lines)
    reader.read(lines)
    return reader.found


def reachable(start: str, all_functions: dict[str, Function]) -> set[str]:
    """Names of the functions that a call of ``start`` can reach, itself included."""
    seen: set[str] = set()
    ahead = [start]
    while ahead:
        name = ahead.pop()
        if name not in seen and name in all_functions:
            seen.add(name)
            ahead += all_functions[name].calls
    return seen


def size_of(
    start: str, functions: dict[str, Function], symbols: dict[str, Symbol]
) -> dict[str, int]:
    """Return bytes of all code that a call of ``start`` can reach, and of the tables it uses."""
    names = reachable(start, functions)
    words = {word for name in names for word in functions[name].words}
    constants = [s for s in symbols.values() if not s.is_code and s.address < RAM_BEGINS]
    tables = [s for s in constants if any(s.address <= word < s.address + s.size for word in words)]
    return {
        "code": sum(symbols[n].size for n in names if n in symbols),
        "tables": sum(s.size for s in tables),
    }
