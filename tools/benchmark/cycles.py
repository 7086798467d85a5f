# SPDX-License-Identifier: Apache-2.0
"""Cycles of a Cortex-M4 for a path of executed blocks, by the table of its manual.

Arm 100166 (Cortex-M4 r0p1), table 3-1 and section 3.3.3. Published for memory without wait states;
what the flash adds is ``Flash``. Where the manual gives a range, both ends are computed: a refill
of the pipeline takes 1 to 3 cycles, a division 2 to 12, by its operands. No figure of a board is in
here.
"""

from __future__ import annotations

import re
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmark import build
from benchmark.blocks import Block
from benchmark.build import BenchError

REFILL = (1, 3)
DIVISION = (2, 12)
AT_MOST = 1250
"""Of the longest PWM interrupt, warm, at the longest refills: 14 % of the period at 20 kHz."""
LOAD_AT_MOST = 0.40
"""Of the core, in the worst millisecond, warm."""
EXCEPTION = 12
"""Cycles from the signal to the handler's first instruction, and from its last one back."""


@dataclass(frozen=True)
class Machine:
    """What differs between the cores and between their flash memories."""

    line_bytes: int
    wait_states: int
    instruction_lines: int
    """Lines that stay in a cache or a buffer."""
    constant_lines: int
    accumulate: tuple[int, int]
    """Cycles of mla and mls."""
    long_product: tuple[int, int]
    long_accumulate: tuple[int, int]


STM32F405 = Machine(16, 5, 64, 8, (1, 1), (1, 1), (1, 1))
"""RM0090 section 3.5: lines of 128 bits, wait states at 168 MHz, lines the accelerator keeps."""
STM32G431 = Machine(8, 4, 128, 32, (1, 1), (1, 1), (1, 1))
"""RM0440 section 3.3.5: 64 bits at a time at 170 MHz, 1 KiB of instructions, 256 bytes of data."""
STM32F103 = Machine(8, 2, 2, 0, (2, 2), (3, 5), (4, 7))
"""A Cortex-M3 (Arm 100165, table 3-1) at 64 MHz: RM0008 section 3.3.3, two buffers of 64 bits."""

_LINE = re.compile(r"^\s*([0-9a-f]+):\t([0-9a-f ]+?)\s*\t(\S+)\s*(.*)$")
_BRANCH = re.compile(r"^(b|bl|bx|blx)(eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le|al)?$")
_REGISTER = re.compile(r"\b(r\d+|sl|fp|ip|sp|lr|pc)\b")


@dataclass(frozen=True)
class Instruction:
    """One instruction as disassembled; mnemonic without its width."""

    address: int
    size: int
    mnemonic: str
    operands: str

    @property
    def is_branch(self) -> bool:
        """Whether it may go elsewhere, at the cost of a refill."""
        return (
            bool(_BRANCH.match(self.mnemonic))
            or self.mnemonic.startswith(("cbz", "cbnz", "tbb", "tbh"))
            or self._loads_pc
        )

    @property
    def _loads_pc(self) -> bool:
        if self.mnemonic.startswith(("pop", "ldm")):
            return "pc" in self.operands[self.operands.index("{") :]
        first = self.operands.partition(",")[0]
        return first == "pc" and self.mnemonic.startswith(("ldr", "mov", "add"))

    @property
    def is_single_load(self) -> bool:
        """Whether the next load's address phase can overlap with it."""
        return self.mnemonic.startswith("ldr") and not self.mnemonic.startswith(("ldrd", "ldrex"))

    @property
    def literal(self) -> int | None:
        """Address of the constant behind the code that it loads."""
        match = re.search(r"\[pc, #(\d+)\]", self.operands)
        return (self.address + 4 & ~3) + int(match[1]) if match else None

    def follows_load(self, before: Instruction) -> bool:
        """Whether this load or store is pipelined with the single load before it."""
        loaded = before.operands.partition(",")[0]
        address = self.operands.partition("[")[2]
        return before.is_single_load and loaded not in _REGISTER.findall(address)

    def cycles(self, before: Instruction | None, machine: Machine = STM32F405) -> tuple[int, int]:
        """Least and most cycles, without a refill.

        before: the instruction executed before it in the same block.
        """
        name = self.mnemonic
        if name.startswith(("mla", "mls")):
            return machine.accumulate
        if name.startswith(("smull", "umull")):
            return machine.long_product
        if name.startswith(("smlal", "umlal")):
            return machine.long_accumulate
        pipelined = before is not None and self.follows_load(before)
        one = 1
        if name.startswith(("sdiv", "udiv")):
            return DIVISION
        if name.startswith(("push", "pop", "ldm", "stm", "vpush", "vpop", "vldm", "vstm")):
            one = 1 + _registers(self.operands)
        elif name.startswith(("ldrd", "strd")):
            one = 3
        elif name.startswith(("ldr", "vldr", "vstr", "tbb", "tbh")):
            one = 1 if pipelined else 2
        elif name.startswith("str"):
            # The data phase of [register, #immediate] overlaps with the next instruction.
            by_register = bool(re.search(r"\[\w+, [a-z]", self.operands))
            written_back = self.operands.endswith("!") or not self.operands.endswith("]")
            one = 2 if (by_register or written_back) and not pipelined else 1
        elif name.startswith(("mrs", "msr", "cps")):
            one = 2
        elif name.startswith(("dsb", "dmb", "isb")):
            one = 4
        return one, one


def _registers(operands: str) -> int:
    """Count registers in a list like ``{r4, r6-r8, lr}``."""
    total = 0
    for part in re.findall(r"[^{},\s]+", operands[operands.index("{") :]):
        first, _, last = part.partition("-")
        total += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return total


def disassemble(elf: Path) -> dict[int, Instruction]:
    """Instructions of an ELF by address."""
    found = {}
    text = build.run([build.PREFIX + "objdump", "-d", "-w", str(elf)], f"disassembling {elf.name}")
    for line in text.splitlines():
        match = _LINE.match(line)
        if match and not match[3].startswith("."):
            address, size = int(match[1], 16), len(match[2].replace(" ", "")) // 2
            mnemonic = re.sub(r"\.[nw]$", "", match[3])
            operands = match[4].partition(";")[0].partition("@")[0].strip()
            found[address] = Instruction(address, size, mnemonic, operands)
    return found


@dataclass(frozen=True)
class Cost:
    """Cycles of a path: warm at the shortest and longest refills and divisions, and cold."""

    least: int
    most: int
    cold: int


@dataclass
class Table:
    """What the blocks of one program take."""

    elf: Path
    machine: Machine = STM32F405
    _code: dict[int, Instruction] = field(init=False)
    _blocks: dict[tuple[Block, bool], tuple[int, int]] = field(default_factory=dict)
    _lines: dict[Block, list[tuple[int, int]]] = field(default_factory=dict)
    _paths: dict[tuple[Block, ...], tuple[int, int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Disassemble the program."""
        self._code = disassemble(self.elf)

    def instructions(self, block: Block) -> list[Instruction]:
        """Return the instructions of a block."""
        address, size = block
        found = []
        while address < block[0] + size:
            if address not in self._code:
                raise BenchError(f"{self.elf.name}: no instruction at {address:#x}")
            found.append(self._code[address])
            address += found[-1].size
        return found

    def block(self, block: Block, taken: bool) -> tuple[int, int]:
        """Least and most cycles of a block; taken: the next one is not the one behind it."""
        if (block, taken) not in self._blocks:
            least = most = 0
            before = None
            for instruction in self.instructions(block):
                a, b = instruction.cycles(before, self.machine)
                least, most = least + a, most + b
                before = instruction
            if taken and before is not None and before.is_branch:
                least, most = least + REFILL[0], most + REFILL[1]
            self._blocks[block, taken] = least, most
        return self._blocks[block, taken]

    def _lines_of(self, block: Block) -> list[tuple[int, int]]:
        """Lines of flash that a block is in, with the instructions in each."""
        if block not in self._lines:
            lines: list[tuple[int, int]] = []
            line_bytes = self.machine.line_bytes
            for instruction in self.instructions(block):
                last = (instruction.address + instruction.size - 1) // line_bytes
                for line in range(instruction.address // line_bytes, last + 1):
                    if not lines or lines[-1][0] != line:
                        lines.append((line, 0))
                lines[-1] = (last, lines[-1][1] + 1)
            self._lines[block] = lines
        return self._lines[block]

    def _waits(self, path: tuple[Block, ...]) -> int:
        """Cycles for which the core waits for instructions and literals, from empty caches.

        The line behind the one in use is read ahead: of its wait states remain those that the line
        in use does not cover, one cycle an instruction.
        """
        machine = self.machine
        constants: OrderedDict[int, None] = OrderedDict()
        cache: OrderedDict[int, None] = OrderedDict()
        waits = covered = 0
        before = -1
        for block in path:
            for line, instructions in self._lines_of(block):
                if line in cache:
                    cache.move_to_end(line)
                else:
                    ahead = covered if line == before + 1 else 0
                    waits += max(0, machine.wait_states - ahead)
                    cache[line] = None
                    if len(cache) > machine.instruction_lines:
                        cache.popitem(last=False)
                covered = instructions + (covered if line == before else 0)
                before = line
            for instruction in self.instructions(block):
                literal = instruction.literal
                if literal is None:
                    continue
                line = literal // machine.line_bytes
                waits += 0 if line in constants else machine.wait_states
                constants[line] = None
                constants.move_to_end(line)
                if len(constants) > machine.constant_lines:
                    constants.popitem(last=False)
        return waits

    def cost(self, path: list[Block]) -> Cost:
        """Cycles of an interrupt that executed these blocks, with entry and return."""
        key = tuple(path)
        if key not in self._paths:
            least = most = 2 * EXCEPTION
            for index, block in enumerate(key):
                last = index + 1 == len(key)
                # The return is paid by EXCEPTION.
                taken = not last and key[index + 1][0] != block[0] + block[1]
                a, b = self.block(block, taken)
                least, most = least + a, most + b
            self._paths[key] = least, most, self._waits(key)
        least, most, waits = self._paths[key]
        return Cost(least, most, most + waits)


def show(console: Console, found: dict[str, Any]) -> None:
    """Print the cycles of a report."""
    for name, text in (
        ("pwm_interrupt", "PWM interrupt"),
        ("millisecond_interrupt", "Millisecond interrupt"),
    ):
        least, most, cold = (found[name][kind] for kind in ("least", "most", "cold"))
        console.print(
            f"{text}, cycles by the core's table: median {least['median']} to {most['median']},"
            f" worst {least['max']} to {most['max']}, from cold flash {cold['max']}"
        )
    console.print(
        f"Load of the core in the worst millisecond: {100 * found['load_warm']:.1f} %, from cold"
        f" flash {100 * found['load_cold']:.1f} %"
    )


def judge(longest: int) -> dict[str, Any]:
    """Compare the cycles of the longest PWM interrupt of a ride without fault with the budget."""
    return {"cycles": longest, "cycles_at_most": AT_MOST, "met": longest <= AT_MOST}


def judge_load(found: dict[str, Any]) -> dict[str, Any]:
    """Compare the load of the worst millisecond, warm, with its budget."""
    share = found["load_warm"]
    return {"share": share, "share_at_most": LOAD_AT_MOST, "met": share <= LOAD_AT_MOST}


def summary(costs: list[Cost]) -> dict[str, dict[str, int]]:
    """Median, 99 % and worst of the interrupts' cycles."""
    columns = {
        "least": [cost.least for cost in costs],
        "most": [cost.most for cost in costs],
        "cold": [cost.cold for cost in costs],
    }
    return {
        name: {
            "median": ordered[len(ordered) // 2],
            "p99": ordered[len(ordered) * 99 // 100],
            "max": ordered[-1],
        }
        for name, ordered in ((name, sorted(values)) for name, values in columns.items())
    }
