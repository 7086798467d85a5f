# SPDX-License-Identifier: Apache-2.0
"""The sum of both loops on a Cortex-M3."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from benchmark import cortex_m3, cycles, interrupt


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

    def measured(image: Path, machine: cycles.Machine) -> dict[str, Any]:
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
    assert cortex_m3.main(["image.elf", slow_step]) == 0
    text = capsys.readouterr().out
    assert f"worst {16000 + max(16000, round(1.6 * int(slow_step)))}, {share} %" in text
    assert text.splitlines()[-1].startswith(result)


def test_an_image_and_a_slow_step_are_needed() -> None:
    assert cortex_m3.main([]) == 2
