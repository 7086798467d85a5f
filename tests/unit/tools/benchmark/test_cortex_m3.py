# SPDX-License-Identifier: Apache-2.0
"""The sum of both loops on a Cortex-M3, and its memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from benchmark import cortex_m3, cycles, interrupt, memory


@pytest.mark.parametrize(
    ("slow_step", "share", "result"),
    [("1000", "50", "fits"), ("16000", "65", "does not fit")],
)
def test_the_worst_millisecond_has_sixteen_pwm_interrupts_and_the_longest_slow_step(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    slow_step: str,
    share: str,
    result: str,
) -> None:
    """16 * 1 000 + 16 000 of 64 000 cycles, or 16 * 1 000 + 16 000 * 1.6."""

    def measured(image: Path, machine: cycles.Machine, others: bool) -> dict[str, Any]:
        assert not others
        assert image == Path("image.elf")
        assert machine == cycles.STM32F103
        return {
            "cycles": {
                "pwm_interrupt": {"cold": {"median": 500, "max": 1000}},
                "millisecond_interrupt": {"cold": {"median": 8000, "max": 16000}},
                "cold_an_instruction": 1.6,
            }
        }

    monkeypatch.setattr(interrupt, "measure", measured)
    cortex_m3.show_time(Path("image.elf"), int(slow_step))
    text = capsys.readouterr().out
    assert f"worst {16000 + max(16000, round(1.6 * int(slow_step)))}, {share} %" in text
    assert text.splitlines()[-1].startswith(result)


def test_flash_has_two_configurations_and_ram_no_black_box(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """60 000 + 2 * 3 008 are 480 more than 64 KiB; 20 000 of 20 480 bytes of RAM."""
    monkeypatch.setattr(memory, "sections", lambda _: (63_008, 28_192, 8_192))
    monkeypatch.setattr(memory, "section", lambda _, name: 3_000 * (name == ".hubfoc_config"))
    cortex_m3.show_memory(Path("image.elf"))
    flash, ram = capsys.readouterr().out.splitlines()
    assert "program 60000" in flash
    assert flash.endswith("66016 of 65536 bytes, 480 missing")
    assert ram.endswith("20000 of 20480 bytes, 480 left")


def test_another_argument_than_a_number_is_refused() -> None:
    assert cortex_m3.main(["image.elf"]) == 2
