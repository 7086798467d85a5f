# SPDX-License-Identifier: Apache-2.0
"""The STM32F405 around the flashable image.

A core emulated by Unicorn, and the peripherals that the image uses.

The image runs as it was linked, from its reset vector. Modelled of the peripherals is what the
firmware waits for, reads or acts on; every other register stores what is written. Time does not
pass by itself: whoever drives the chip calls its interrupts, through the image's own vector table.

Counted are instructions, from an interrupt's first one up to and with its return. What the core
itself does around them (stacking, at least 12 cycles each way) is no instruction. An instruction
whose condition fails counts as one.
"""

from __future__ import annotations

import struct
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import unicorn
from unicorn import arm_const

from benchmark.build import BenchError

FLASH, FLASH_BYTES = 0x08000000, 1 << 20
RAM, RAM_BYTES = 0x20000000, 128 << 10
STOP = 0x1FFF0000  # system memory: a return to it ends an emulation
PAGE = 0x1000
CORE_PERIPHERALS, CORE_BYTES = 0xE0000000, 0x100000
PERIPHERALS, PERIPHERALS_BYTES = 0x40000000, 0x80000
BOOT_SECONDS = 60
EXCEPTION_FRAME_BYTES = 32
NESTED_BITS = 0xFFFFFFF8

# RM0090: addresses of the registers that do more than store.
RCC_CR, RCC_CFGR = 0x40023800, 0x40023808
TIM_CR1, TIM_SR, TIM_ARR, TIM_RCR = 0x00, 0x10, 0x2C, 0x30
TIM_CCR, TIM_BDTR = (0x34, 0x38, 0x3C), 0x44
TIM_UPDATE, TIM_DOWN, TIM_OUTPUTS = 1 << 0, 1 << 4, 1 << 15
ADC_SR, ADC_FIRST, ADC_SECOND = (0x40012000, 0x40012100, 0x40012200), 0x3C, 0x40
GPIO_INPUTS = {"A": 0x40020010, "B": 0x40020410, "C": 0x40020810}
GPIOB_BSRR, GPIOC_BSRR = 0x40020418, 0x40020818
DRIVER_SDO, DRIVER_SDI, DRIVER_CLOCK, DRIVER_SELECT = 1 << 3, 4, 10, 9
CAN_MCR, CAN_MSR, CAN_TSR, CAN_RF0R = 0x40006400, 0x40006404, 0x40006408, 0x4000640C
CAN_MAILBOX = 0x400065B0
DWT_CYCCNT = 0xE0001004
SCB_VTOR, SCB_ICSR = 0xE000ED08, 0xE000ED04
ICSR_SET_PENDSV, ICSR_SET_SYSTICK = 1 << 28, 1 << 26
EXCEPTION_PENDSV, EXCEPTION_SYSTICK, EXCEPTION_ADC = 14, 15, 16 + 18


@dataclass
class Timer:
    """TIM1's counter: direction of the count and times of its updates."""

    at_top: bool = False
    repetitions: int = 0

    def next_end(self, reload: int) -> bool:
        """Run to the next end of the count. Returns whether that is an update."""
        self.at_top = not self.at_top
        if self.repetitions > 0:
            self.repetitions -= 1
            return False
        self.repetitions = reload
        return True


@dataclass
class GateDriver:
    """The gate driver's serial bus: frames of 16 bits, answered in the next one."""

    stored: dict[int, int] = field(default_factory=dict)
    data: int = 0
    high: bool = False
    frame: int = 0
    answer: int = 0

    def select(self, high: bool) -> None:
        """Begin a frame, or end it and carry it out."""
        if not high:
            self.frame = 0
            return
        address, value = self.frame >> 11 & 0xF, self.frame & 0x7FF
        if not self.frame >> 15 & 1:
            self.stored[address] = value
        self.answer = self.stored.get(address, 0)

    def clock(self, high: bool) -> bool | None:
        """Take an edge of the clock. Returns what the data line shows from a rising one on."""
        if high == self.high:
            return None
        self.high = high
        if not high:
            self.frame = (self.frame << 1 | self.data) & 0xFFFF
            return None
        shown = bool(self.answer >> 15 & 1)
        self.answer <<= 1
        return shown


@dataclass
class Chip:
    """One chip with an image in its flash."""

    MAPPED: ClassVar[tuple[tuple[int, int], ...]] = (
        (PERIPHERALS, PERIPHERALS_BYTES),
        (CORE_PERIPHERALS, CORE_BYTES),
    )
    TIM1: ClassVar[int] = 0x40010000
    INPUTS: ClassVar[dict[str, int]] = GPIO_INPUTS
    CLOCK_HZ: ClassVar[float] = 168e6

    image: Path
    flash: int = FLASH
    """Where the image begins."""
    registers: dict[int, int] = field(default_factory=dict)
    timer: Timer = field(default_factory=Timer)
    driver: GateDriver = field(default_factory=GateDriver)
    frames: deque[tuple[int, bytes]] = field(default_factory=deque)
    """Received CAN frames, identifier and eight bytes, oldest first."""
    instructions: int = 0
    """Executed since counting began."""
    blocks: Counter[tuple[int, int]] | None = None
    """If given: how often each stretch of code, address and bytes, was entered."""
    path: list[tuple[int, int]] = field(default_factory=list)
    """Stretches of code of the latest call, in the order of their execution."""

    def __post_init__(self) -> None:
        """Load the image; the core stands at its reset vector."""
        self._core = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB)
        self._core.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4)
        self._core.mem_map(self.flash, FLASH_BYTES)
        self._core.mem_map(RAM, RAM_BYTES)
        self._core.mem_map(STOP, PAGE)
        for base, size in self.MAPPED:
            self._core.mmio_map(base, size, self._on_read, base, self._on_write, base)
        self._lengths: dict[tuple[int, int], int] = {}
        self._counting = False
        self._read: dict[int, Callable[[], int]] = {
            self.TIM1 + TIM_SR: self._timer_status,
            self.TIM1 + TIM_CR1: lambda: (
                self._of_timer(TIM_CR1) | (TIM_DOWN if self.timer.at_top else 0)
            ),
            DWT_CYCCNT: lambda: self.instructions & 0xFFFFFFFF,
            **self._reads(),
        }
        self._write: dict[int, Callable[[int], None]] = {
            self.TIM1 + TIM_SR: self._clearing(self.TIM1 + TIM_SR),
            **self._writes(),
        }
        for port in self.INPUTS.values():
            self.registers[port] = 0xFFFF
        self._load()

    def _load(self) -> None:
        data = self.image.read_bytes()
        if data[:6] != b"\x7fELF\x01\x01":
            raise BenchError(f"{self.image}: not an ELF of a 32-bit little-endian machine")
        table, each, count = struct.unpack_from("<I10xHH", data, 28)
        for at in range(table, table + each * count, each):
            kind, offset, _, physical, stored = struct.unpack_from("<5I", data, at)
            if kind == 1 and stored > 0:
                self._core.mem_write(physical, data[offset : offset + stored])
        stack, entry = struct.unpack("<2I", self._core.mem_read(self.flash, 8))
        self._core.reg_write(arm_const.UC_ARM_REG_SP, stack)
        self._entry = entry

    # ---- peripherals ----

    def _reads(self) -> dict[int, Callable[[], int]]:
        """Return the registers that show something else than what was written."""
        return {
            RCC_CR: lambda: self._ready_bits(RCC_CR, ((16, 17), (24, 25))),
            RCC_CFGR: lambda: self._ready_bits(RCC_CFGR, ((0, 2), (1, 3))),
            CAN_MSR: lambda: self.registers.get(CAN_MCR, 0) & 1,
            CAN_TSR: lambda: 7 << 26,
            CAN_RF0R: lambda: min(len(self.frames), 3),
            **{CAN_MAILBOX + 4 * i: self._of_frame(i) for i in range(4)},
        }

    def _writes(self) -> dict[int, Callable[[int], None]]:
        """Return the registers that do something else than store."""
        return {
            CAN_RF0R: self._release_frame,
            GPIOB_BSRR: self._set_port_b,
            GPIOC_BSRR: self._set_port_c,
            **{status: self._clearing(status) for status in ADC_SR},
        }

    def _of_timer(self, offset: int) -> int:
        return self.registers.get(self.TIM1 + offset, 0)

    def _ready_bits(self, register: int, pairs: tuple[tuple[int, int], ...]) -> int:
        """Return the register; what is switched on is ready."""
        value = self.registers.get(register, 0)
        for on, ready in pairs:
            value |= (value >> on & 1) << ready
        return value

    def _timer_status(self) -> int:
        """While the firmware waits for an update, the count advances by half a period per poll."""
        status = self._of_timer(TIM_SR)
        if (
            not status & TIM_UPDATE
            and self._of_timer(TIM_CR1) & 1
            and not self._counting
            and self.timer.next_end(self._of_timer(TIM_RCR))
        ):
            self.registers[self.TIM1 + TIM_SR] = status | TIM_UPDATE
        return status

    def _clear(self, register: int, value: int) -> None:
        """Write a register whose flags are cleared by a zero."""
        self.registers[register] = self.registers.get(register, 0) & value

    def _clearing(self, register: int) -> Callable[[int], None]:
        return lambda value: self._clear(register, value)

    def _set_port_b(self, value: int) -> None:
        for level, bits in ((1, value & 0xFFFF), (0, value >> 16)):
            if bits >> DRIVER_SDI & 1:
                self.driver.data = level

    def _set_port_c(self, value: int) -> None:
        for level, bits in ((True, value & 0xFFFF), (False, value >> 16)):
            if bits >> DRIVER_SELECT & 1:
                self.driver.select(level)
            shown = self.driver.clock(level) if bits >> DRIVER_CLOCK & 1 else None
            if shown is not None:
                port = GPIO_INPUTS["B"]
                others = self.registers[port] & ~DRIVER_SDO
                self.registers[port] = others | (DRIVER_SDO if shown else 0)

    def _release_frame(self, value: int) -> None:
        if value & 1 << 5 and self.frames:
            self.frames.popleft()

    def _of_frame(self, word: int) -> Callable[[], int]:
        """RIR, RDTR, RDLR or RDHR of the oldest frame."""
        return lambda: self._mailbox()[word]

    def _mailbox(self) -> tuple[int, ...]:
        if not self.frames:
            return 0, 0, 0, 0
        identifier, data = self.frames[0]
        return identifier << 21, len(data), *struct.unpack("<2I", data)

    def _on_read(self, _core: unicorn.Uc, offset: int, size: int, base: int) -> int:
        address = base + offset
        word = address & ~3
        value = self._read[word]() if word in self._read else self.registers.get(word, 0)
        return value >> 8 * (address & 3) & ((1 << 8 * size) - 1)

    def _on_write(self, _core: unicorn.Uc, offset: int, size: int, value: int, base: int) -> None:
        address = base + offset
        word = address & ~3
        if size < 4:
            shift, mask = 8 * (address & 3), (1 << 8 * size) - 1
            value = (
                self.registers.get(word, 0) & ~(mask << shift) & 0xFFFFFFFF
                | (value & mask) << shift
            )
        if word in self._write:
            self._write[word](value)
        else:
            self.registers[word] = value

    # ---- instructions ----

    def _on_block(self, _core: unicorn.Uc, address: int, size: int, _user: object) -> None:
        if not self._counting:
            return
        key = (address, size)
        if key not in self._lengths:
            self._lengths[key] = self._length(address, size)
        self.instructions += self._lengths[key]
        self.path.append(key)
        if self.blocks is not None:
            self.blocks[key] += 1

    def _length(self, address: int, size: int) -> int:
        """Count instructions in code; those of two halfwords begin with 11101, 11110 or 11111."""
        code = self._core.mem_read(address, size)
        at = count = 0
        while at < size:
            at += 4 if code[at + 1] >> 3 in (0b11101, 0b11110, 0b11111) else 2
            count += 1
        return count

    def _run(self, begin: int, end: int) -> None:
        try:
            self._core.emu_start(begin | 1, end)
        except unicorn.UcError as error:
            at = self._core.reg_read(arm_const.UC_ARM_REG_PC)
            raise BenchError(f"{self.image.name}: {error} at {at:#x}") from error

    def boot(self, until: int) -> None:
        """Run from the reset vector to an address: the first pass of the main loop."""
        self._core.emu_start(self._entry | 1, until, timeout=BOOT_SECONDS * unicorn.UC_SECOND_SCALE)
        if self._core.reg_read(arm_const.UC_ARM_REG_PC) != until:
            at = self._core.reg_read(arm_const.UC_ARM_REG_PC)
            raise BenchError(f"{self.image.name}: did not boot, at {at:#x} after {BOOT_SECONDS} s")
        # Only from here on every stretch of code reports itself.
        self._core.hook_add(unicorn.UC_HOOK_BLOCK, self._on_block)
        self._core.ctl_flush_tb()

    def call(self, function: int, argument: int = 0) -> int:
        """Call a function or an interrupt handler on the stack as it is, and come back.

        Returns the instructions executed, the return included.
        """
        before = self._core.context_save()
        stack = self._core.reg_read(arm_const.UC_ARM_REG_SP)
        self._core.reg_write(arm_const.UC_ARM_REG_SP, (stack - EXCEPTION_FRAME_BYTES) & NESTED_BITS)
        self._core.reg_write(arm_const.UC_ARM_REG_LR, STOP | 1)
        self._core.reg_write(arm_const.UC_ARM_REG_R0, argument)
        counted = self.instructions
        self.path = []
        self._counting = True
        self._run(function & ~1, STOP)
        self._counting = False
        self._core.context_restore(before)
        return self.instructions - counted

    def interrupt(self, exception: int) -> int:
        """Call an exception's handler as the vector table names it."""
        table = self.registers.get(SCB_VTOR, 0)
        handler = struct.unpack("<I", self._core.mem_read(table + 4 * exception, 4))[0]
        return self.call(handler)

    def take_pending(self) -> int:
        """Call the pending exceptions, PendSV and SysTick; return their instructions."""
        pending = self.registers.get(SCB_ICSR, 0)
        self.registers[SCB_ICSR] = 0
        total = 0
        if pending & ICSR_SET_PENDSV:
            total += self.interrupt(EXCEPTION_PENDSV)
        if pending & ICSR_SET_SYSTICK:
            total += self.interrupt(EXCEPTION_SYSTICK)
        return total

    # ---- inputs of the board ----

    def sample(
        self, current_codes: tuple[int, int, int], bus_code: int, temperature_code: int
    ) -> None:
        """Results of the three converters; both temperature sensors read the same code."""
        for status, code in zip(ADC_SR, current_codes, strict=True):
            self.registers[status + ADC_FIRST] = code
            self.registers[status + ADC_SECOND] = temperature_code
            self.registers[status] = 0x1C
        self.registers[ADC_SR[0] + ADC_SECOND] = bus_code

    def halls(self, state: int) -> None:
        """Levels of the three hall inputs, PC6 to PC8."""
        self.registers[GPIO_INPUTS["C"]] = 0xFFFF & ~(7 << 6) | state << 6

    @property
    def outputs_on(self) -> bool:
        """Whether the timer drives the bridge."""
        return bool(self._of_timer(TIM_BDTR) & TIM_OUTPUTS)

    @property
    def period_counts(self) -> int:
        """Counts from zero to the top."""
        return self._of_timer(TIM_ARR)

    @property
    def compare_counts(self) -> tuple[int, int, int]:
        """Compare values as last written."""
        a, b, c = (self._of_timer(register) for register in TIM_CCR)
        return a, b, c
