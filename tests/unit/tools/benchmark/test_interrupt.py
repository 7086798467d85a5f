# SPDX-License-Identifier: Apache-2.0
"""Figures of the interrupts from what a model of a chip has written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import blocks, build, cycles, interrupt
from benchmark.interrupt import Interrupt


def taken(name: str, met: str, instructions: int, most: int) -> Interrupt:
    """An interrupt whose cold path takes twice as long as its warm one."""
    return Interrupt(name, met, instructions, cycles.Cost(most - 10, most, 2 * most))


def test_the_worst_millisecond_has_twenty_longest_interrupts_and_a_slow_step_of_the_budget() -> (
    None
):
    """20 * 1 000 cycles and 18 000 instructions at 3 000 / 2 000 cycles, of 100 000."""
    fast = [taken("pwm", "driving", 400, 700), taken("pwm", "driving", 600, 1000)]
    slow = [taken("millisecond", "driving", 2000, 3000), taken("millisecond", "idle", 100, 110)]
    found = interrupt._cycles(fast, slow, 100e6)
    assert found["load_warm"] == pytest.approx((20 * 1000 + 1.5 * 18000) / 100000)
    assert found["load_cold"] == pytest.approx((20 * 2000 + 3.0 * 18000) / 100000)
    assert found["pwm_interrupt"]["most"]["max"] == 1000


def test_a_slow_step_of_the_ride_beyond_the_budget_is_the_longest() -> None:
    slow = [taken("millisecond", "driving", 20000, 20000)]
    found = interrupt._cycles([taken("pwm", "driving", 400, 1000)], slow, 100e6)
    assert found["load_warm"] == pytest.approx((20 * 1000 + 20000) / 100000)


def test_interrupts_are_divided_by_what_they_met() -> None:
    calls = [taken("pwm", "driving", n, n) for n in (400, 500, 450)]
    calls += [taken("pwm", "idle", 300, 300), taken("pwm", "braking, hall edge", 700, 700)]
    found = interrupt._summary(calls)
    assert found["instructions"]["calls"] == 5
    assert found["worst_state"] == "braking, hall edge"
    assert found["states"]["driving"]["max"] == 500
    longest = interrupt.longest(calls)
    assert longest == {"calls": 5, "instructions": 700, "least": 690, "most": 700, "cold": 1400}


def test_a_line_is_an_interrupt_with_its_blocks(tmp_path: Path) -> None:
    file = tmp_path / "written"
    file.write_text("pwm\tbraking, hall edge\t12\t8000100+6 8000200+12\n")
    (found,) = blocks.read(file)
    assert (found.name, found.met, found.instructions) == ("pwm", "braking, hall edge", 12)
    assert found.path == [(0x8000100, 6), (0x8000200, 0x12)]


def test_a_count_that_the_disassembly_does_not_have_is_an_error(
    program: Callable[..., Path],
) -> None:
    image = program("int main(void) { return 0; }")
    code = cycles.disassemble(image)
    address = min(code)
    block = f"{address:x}+{code[address].size:x}"
    costs = interrupt.Costs(image, cycles.STM32F405)
    assert costs.of(blocks.Executed("pwm", "", 1, block)).least >= 24
    with pytest.raises(build.BenchError, match="2 instructions where the disassembly has 1"):
        interrupt.Costs(image, cycles.STM32F405).of(blocks.Executed("pwm", "", 2, block))


def test_an_image_without_the_vehicle_of_the_model_is_refused(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    with pytest.raises(build.BenchError, match="no image"):
        interrupt.measure(tmp_path / "absent.elf")
    with pytest.raises(build.BenchError, match="not the image's configuration"):
        interrupt.measure(program("int main(void) { return 0; }"))
