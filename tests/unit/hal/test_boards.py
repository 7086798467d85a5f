# SPDX-License-Identifier: Apache-2.0
"""The boards' headers against the configurations that are made for them."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from regen_table import loops, schema
from regen_table.schema import Drive

SOURCE = Path(os.environ["HUBFOC_SOURCE_DIR"])
HAL = SOURCE / "hal"
FACTS = (
    "BOARD_CURRENT_FULL_SCALE_mA",
    "BOARD_VOLTAGE_FULL_SCALE_mV",
    "BOARD_CURRENT_MOST_A",
    "BOARD_VOLTAGE_MOST_V",
    "BOARD_DEAD_TIME_LEAST_ns",
    "BOARD_AMPLIFIER_SETTLING_ns",
    "ANALOG_SAMPLING_ns",
    "CLOCK_TIMER1_Hz",
)


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> dict[str, int]:
    """What a C compiler makes of the header of the B-G431B-ESC1."""
    folder = tmp_path_factory.mktemp("board")
    lines = ['#include "board.h"', '#include "analog_start.h"', '#include "clock.h"']
    lines += ["#include <stdio.h>", "int main(void) {"]
    lines += [f'printf("{name} %lld\\n", (long long){name});' for name in FACTS]
    (folder / "facts.c").write_text("\n".join([*lines, "return 0; }"]))
    options = [f"-I{HAL / name}" for name in ("stm32g431", "stm32")]
    command = ["cc", "-std=c11", "-Wno-int-to-pointer-cast", *options]
    subprocess.run([*command, "-o", folder / "facts", folder / "facts.c"], check=True)
    output = subprocess.run([folder / "facts"], check=True, capture_output=True, text=True).stdout
    return {name: int(value) for name, value in (line.split() for line in output.splitlines())}


@pytest.fixture(scope="module")
def bench() -> Drive:
    return schema.load(SOURCE / "tools" / "motors" / "bench" / "wheel24v.toml")


def test_the_full_scales_are_those_of_shunt_amplifier_divider_and_reference(
    board: dict[str, int],
) -> None:
    """3.3 V, 3 mOhm, 64/7, 169 and 18 kOhm; NuttX has 36.47 A and 10.39 V for a volt."""
    assert board["BOARD_CURRENT_FULL_SCALE_mA"] == pytest.approx(1650.0 / 0.003 * 7 / 64, abs=1.0)
    assert board["BOARD_CURRENT_FULL_SCALE_mA"] == pytest.approx(1650.0 * 36.47, rel=1e-3)
    assert board["BOARD_VOLTAGE_FULL_SCALE_mV"] == pytest.approx(3300.0 * 187 / 18, abs=1.0)


def test_the_bench_configuration_has_the_boards_full_scales_and_clock(
    board: dict[str, int], bench: Drive
) -> None:
    inverter = bench.inverter
    full_scale = 1e3 * inverter.current_full_scale_a, 1e3 * inverter.voltage_full_scale_v
    assert full_scale[0] == pytest.approx(board["BOARD_CURRENT_FULL_SCALE_mA"], rel=1e-3)
    assert full_scale[1] == pytest.approx(board["BOARD_VOLTAGE_FULL_SCALE_mV"], rel=1e-3)
    assert inverter.pwm_timer_clock_hz == board["CLOCK_TIMER1_Hz"]
    counts = loops.pwm_period_counts(bench)
    assert board["CLOCK_TIMER1_Hz"] / (2 * counts) == pytest.approx(inverter.pwm_frequency_hz)


def test_the_bench_configuration_stays_within_what_the_board_bears(
    board: dict[str, int], bench: Drive
) -> None:
    assert bench.battery.max_voltage_v <= board["BOARD_VOLTAGE_MOST_V"] == 25
    assert bench.motor.max_phase_current_a <= board["BOARD_CURRENT_MOST_A"] == 40


def test_the_bench_configurations_pulses_are_long_enough_for_the_converters(
    board: dict[str, int], bench: Drive
) -> None:
    """Settled and sampled half the dead time after the top (hal/stm32g431/README.md, Sampling)."""
    dead_ns = 1e9 * bench.inverter.dead_time_s
    assert dead_ns >= board["BOARD_DEAD_TIME_LEAST_ns"]
    window_ns = board["BOARD_AMPLIFIER_SETTLING_ns"] + board["ANALOG_SAMPLING_ns"] + dead_ns / 2
    pulse_ns = loops.min_pulse_s(bench) * 1e9
    assert window_ns <= pulse_ns < window_ns + 50
