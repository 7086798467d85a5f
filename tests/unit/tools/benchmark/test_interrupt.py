# SPDX-License-Identifier: Apache-2.0
"""The model of the chip: instructions counted by hand, frame protection by an independent
implementation.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cantools
import pytest
from benchmark import build, elf, interrupt
from benchmark.chip import TIM_CR1, TIM_DOWN, TIM_RCR, TIM_SR, TIM_UPDATE, Chip

LU2013 = build.ROOT / "tools" / "motors" / "lu2013.toml"
DBC = build.ROOT / "firmware" / "comms" / "hubfoc.dbc"

# As in test_count.py: straight 11, loop(n) 2 n + 2, skipped 5 with two that are not taken, outer
# 14.
PROGRAM = """
#define ASM __attribute__((naked, noinline, used))
ASM void straight(void) { __asm volatile(".rept 10\\n nop\\n .endr\\n bx lr"); }
ASM void loop(void) { __asm volatile("movs r0, #7\\n 1: subs r0, #1\\n bne 1b\\n bx lr"); }
ASM void skipped(void) {
    __asm volatile("cmp sp, #0\\n itt eq\\n moveq r0, #1\\n moveq r1, #2\\n bx lr");
}
ASM void outer(void) { __asm volatile("push {r4, lr}\\n bl straight\\n pop {r4, pc}"); }
ASM void wide(void) {
    __asm volatile("movw r0, #0x1234\\n movt r0, #0x4001\\n"
                   "ldr.w r1, [r0]\\n str r1, [r0]\\n bx lr");
}
__attribute__((noinline, used)) void background(void) { __asm volatile(""); }
__attribute__((noinline, used)) void start(void) { for (;;) { background(); } }
__attribute__((section(".table"), used)) void *const table[2] = {(void *)0x20001000, (void *)start};
"""


@pytest.fixture
def chip(tmp_path: Path) -> tuple[Chip, dict[str, elf.Symbol]]:
    """Link the program to the chip's flash address and run it until its background loop."""
    source, image = tmp_path / "program.c", tmp_path / "program.elf"
    source.write_text(PROGRAM)
    command = [build.PREFIX + "gcc", *build.CORES[0].flags, "-O2", "-nostdlib", "-Wl,-estart"]
    command += [
        "-Wl,--section-start=.table=0x08000000",
        "-Wl,-Ttext=0x08000100",
        "-Wl,-zmax-page-size=8",
    ]
    build.run([*command, str(source), "-o", str(image)], "linking")
    symbols = elf.symbols(image)
    made = Chip(image)
    made.boot(symbols["background"].address)
    return made, symbols


@pytest.mark.parametrize(
    ("name", "instructions"),
    [("straight", 11), ("loop", 16), ("skipped", 5), ("outer", 14), ("wide", 5)],
)
def test_counts_equal_those_made_by_hand(
    chip: tuple[Chip, dict[str, elf.Symbol]], name: str, instructions: int
) -> None:
    core, symbols = chip
    for _ in range(3):
        assert core.call(symbols[name].address) == instructions


def test_the_timer_updates_at_both_ends_until_its_repetition_counter_is_loaded(
    chip: tuple[Chip, dict[str, elf.Symbol]],
) -> None:
    """RM0090 section 17.3.3, assumed by the timer start of the firmware."""
    core, _ = chip
    core.registers[Chip.TIM1 + TIM_CR1] = 1

    def directions(looks: int) -> list[bool]:
        """Direction of the count at every update within a number of samples."""
        seen = []
        for _ in range(looks):
            core.registers[Chip.TIM1 + TIM_SR] = 0
            core._timer_status()
            if core.registers[Chip.TIM1 + TIM_SR] & TIM_UPDATE:
                seen.append(bool(core._read[Chip.TIM1 + TIM_CR1]() & TIM_DOWN))
        return seen

    assert directions(4) == [True, False, True, False]
    core.registers[Chip.TIM1 + TIM_RCR] = 1
    assert directions(7) == [True, True, True, True]


def test_frames_hold_the_demand_of_the_ride_in_the_layout_of_the_protocol() -> None:
    vehicle = interrupt.Vehicle(tomllib.loads(LU2013.read_text()))
    frames = [vehicle.frames(ms) for ms in range(interrupt.START_MS)]
    assert [ms for ms, several in enumerate(frames) if several] == list(range(0, 300, 10))
    database: Any = cantools.database.load_file(DBC)
    for number, several in enumerate(filter(None, frames), start=1):
        assert [identifier for identifier, _ in several] == [0x100, 0x140]
        decoded: list[Any] = [database.decode_message(*frame) for frame in several]
        demand, limits = decoded
        assert demand["counter"] == limits["counter"] == number
        assert demand["enable"] == (number > interrupt.START_MS // 2 // 10 + 1)
        assert 0 in (demand["drive_torque_nm"], demand["brake_torque_nm"])
        assert limits["charge_current_a"] == 200
        assert limits["discharge_current_a"] == 250


def test_an_image_without_a_known_configuration_is_refused(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    with pytest.raises(build.BenchError, match="no image"):
        interrupt.measure(tmp_path / "absent.elf")
    with pytest.raises(build.BenchError, match="no configuration"):
        interrupt.measure(program("int main(void) { return 0; }"))
