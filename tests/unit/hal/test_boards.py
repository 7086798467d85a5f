# SPDX-License-Identifier: Apache-2.0
"""The boards' headers against the configurations that are made for them."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from regen_table import boards, loops, schema
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
    "BOARD_REFERENCE_mV",
    "BOARD_NETWORK_SHUNT_Ohm",
    "BOARD_NETWORK_GROUND_Ohm",
    "BOARD_NETWORK_REFERENCE_Ohm",
    "BOARD_NETWORK_LEVEL_LEAST_mV",
    "BOARD_NETWORK_LEVEL_MOST_mV",
    "BOARD_CURRENT_ZERO_CODE",
)

READ = FACTS[:8]

AMPLIFIER_GAIN, CODES = 16.0, 4096.0
RESISTORS, AMPLIFIER_OFFSET_MV, AMPLIFIER_GAIN_ERROR = 0.01, 3.0, 0.01
"""Tolerances: of the network's parts, and of the amplifier (DS12589, 5.3.22)."""
COMPARATOR_MV = 10.0
"""Its offset and the converter's that makes the threshold."""


def compiled(folder: Path, port: str, header: str, facts: Sequence[str]) -> dict[str, int]:
    """Return what a C compiler makes of a board's header."""
    lines = ['#include "board.h"', '#include "analog_start.h"', '#include "clock.h"']
    lines += ["#include <stdio.h>", "int main(void) {"]
    lines += [f'printf("{name} %lld\\n", (long long){name});' for name in facts]
    (folder / "facts.c").write_text("\n".join([*lines, "return 0; }"]))
    options = [f"-I{path}" for path in (folder, HAL / port, HAL / "stm32")]
    options.append(f'-DHUBFOC_BOARD_HEADER="boards/{header}.h"')
    command = ["cc", "-std=c11", "-Wno-int-to-pointer-cast", *options]
    subprocess.run([*command, "-o", folder / "facts", folder / "facts.c"], check=True)
    output = subprocess.run([folder / "facts"], check=True, capture_output=True, text=True).stdout
    return {name: int(value) for name, value in (line.split() for line in output.splitlines())}


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> dict[str, int]:
    """What a C compiler makes of the header of the B-G431B-ESC1."""
    return compiled(tmp_path_factory.mktemp("board"), "stm32g431", "b_g431b_esc1", FACTS)


@pytest.mark.parametrize("name", boards.known())
def test_the_tools_read_from_a_header_what_a_compiler_makes_of_it(
    name: str, tmp_path: Path
) -> None:
    read = boards.known()[name]
    found = compiled(tmp_path, read.port, name, READ)
    assert 1e3 * read.current_full_scale_a == pytest.approx(
        found["BOARD_CURRENT_FULL_SCALE_mA"], abs=1.0
    )
    assert 1e3 * read.voltage_full_scale_v == pytest.approx(
        found["BOARD_VOLTAGE_FULL_SCALE_mV"], abs=1.0
    )
    assert read.current_most_a == found["BOARD_CURRENT_MOST_A"]
    assert read.voltage_most_v == found["BOARD_VOLTAGE_MOST_V"]
    assert 1e9 * read.dead_time_s == pytest.approx(found["BOARD_DEAD_TIME_LEAST_ns"])
    assert read.timer_clock_hz == found["CLOCK_TIMER1_Hz"]
    settling_ns = found["BOARD_AMPLIFIER_SETTLING_ns"]
    assert (read.settled_s is None) == (settling_ns == 0)
    for dead_time_s in (read.dead_time_s, 1e-6):
        window_s = read.window_s(dead_time_s)
        assert (window_s is None) == (settling_ns == 0)
        if window_s is not None:
            window_ns = settling_ns + found["ANALOG_SAMPLING_ns"] + 5e8 * dead_time_s
            assert 1e9 * window_s == pytest.approx(window_ns, abs=1.0)


# V_REG, CURRENT_SHUNT_RES, CURRENT_AMP_GAIN, VIN_R1, VIN_R2, HW_DEAD_TIME_NSEC and the ends of
# HW_LIM_CURRENT_ABS and HW_LIM_VIN of vedderb/bldc, commit b9d287b: hwconf/trampa/vesc6/
# hw_60_core.h, hwconf/other/vesc4/hw_410.h, hwconf/trampa/75_300/hw_75_300_core.h and
# hwconf/makerbase/84_200_HP/hw_mksesc_84_200_hp.h; without a dead time of its own a board has that
# of motor/mc_interface.h. Of the first two the limit of the voltage is the gate driver's 60 V
# (SLOS719, SLES267) in place of 57 V.
SOURCES = {
    "vesc6_mk3": (3.30, 0.0005, 20.0, 39e3, 2.2e3, 360.0, 160.0, 60.0),
    "vesc6_mk6": (3.30, 0.0005, 20.0, 39e3, 2.2e3, 360.0, 160.0, 60.0),
    "vesc4_10": (3.30, 0.001, 10.0, 39e3, 2.2e3, 360.0, 150.0, 60.0),
    "vesc75_300": (3.44, 0.0005 / 3.0, 20.0, 56e3, 2.2e3, 1000.0, 480.0, 72.0),
    "mks84_200_hp": (3.30, 0.0005 / 3.0, 20.0, 56e3, 2.2e3, 660.0, 450.0, 120.0),
}


@pytest.mark.parametrize("name", SOURCES)
def test_scales_dead_time_and_limits_of_a_board_are_those_of_its_source(name: str) -> None:
    reference_v, shunt_ohm, gain, upper, lower, dead_ns, most_a, most_v = SOURCES[name]
    read = boards.known()[name]
    assert read.current_full_scale_a == pytest.approx(
        reference_v / 2.0 / shunt_ohm / gain, rel=1e-5
    )
    assert read.voltage_full_scale_v == pytest.approx(reference_v * (upper + lower) / lower)
    assert 1e9 * read.dead_time_s == pytest.approx(dead_ns)
    assert read.current_most_a == most_a <= read.current_full_scale_a
    assert read.voltage_most_v == int(min(most_v, read.voltage_full_scale_v))
    assert (read.settled_s is None) == (name != "vesc4_10")  # HW_HAS_PHASE_SHUNTS


def test_every_board_that_exists_is_compared_with_its_source() -> None:
    """The B-G431B-ESC1 below; the gate board is a description."""
    assert {*SOURCES, "b_g431b_esc1", boards.DESCRIPTION} == set(boards.known())


def test_the_gate_board_shows_a_kiloampere_and_800_volts() -> None:
    read = boards.known()["gate_board"]
    assert read.current_full_scale_a > 1000.0 == read.current_most_a
    assert read.voltage_full_scale_v > 800.0 == read.voltage_most_v


@pytest.mark.parametrize("name", ["elaphe700", "leaf"])
def test_a_copy_of_the_gate_board_with_a_drives_ranges_is_a_board_for_that_drive(
    name: str, tmp_path: Path
) -> None:
    """Drives of 400 V, for which there is no other: only numbers that are marked "own" change."""
    drive = schema.load(name)
    inverter = drive.inverter
    own = {
        "DEAD_TIME_LEAST_ns": round(1e9 * inverter.dead_time_s),
        "SHUNT_nOhm": round(1.65e9 / inverter.current_full_scale_a),
        "DIVIDER_UPPER_Ohm": round(1e3 * (inverter.voltage_full_scale_v / 3.3 - 1.0)),
        "CURRENT_MOST_A": int(drive.motor.max_phase_current_a) + 1,
        "VOLTAGE_MOST_V": int(drive.battery.max_voltage_v) + 1,
    }
    text = (HAL / "stm32f405/boards/gate_board.h").read_text(encoding="utf-8")
    for fact, number in own.items():
        text, count = re.subn(rf"BOARD_{fact} = \d+", f"BOARD_{fact} = {number}", text)
        assert count == 1, fact
    (tmp_path / "boards").mkdir()
    (tmp_path / "boards/own.h").write_text(text, encoding="utf-8")
    found = compiled(tmp_path, "stm32f405", "own", READ)
    full_scale_a = found["BOARD_CURRENT_FULL_SCALE_mA"] / 1e3
    full_scale_v = found["BOARD_VOLTAGE_FULL_SCALE_mV"] / 1e3
    assert full_scale_a == pytest.approx(inverter.current_full_scale_a, rel=0.05)
    assert full_scale_v == pytest.approx(inverter.voltage_full_scale_v, rel=0.05)
    assert full_scale_a > found["BOARD_CURRENT_MOST_A"] >= drive.motor.max_phase_current_a


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


def level_mv(board: dict[str, int], *factors: float) -> float:
    """What the network makes of the reference without current; factors: of its resistances."""
    names = ("SHUNT", "GROUND", "REFERENCE")
    wanted = factors or (1.0, 1.0, 1.0)
    shunt, ground, reference = (
        1.0 / (board[f"BOARD_NETWORK_{name}_Ohm"] * factor)
        for name, factor in zip(names, wanted, strict=True)
    )
    return board["BOARD_REFERENCE_mV"] * reference / (shunt + ground + reference)


def zero_codes(board: dict[str, int]) -> tuple[float, float]:
    """Return the least and the most of an amplifier's output without current, in codes.

    What is at its inverting input's pin is not known: between ground and the voltage that brings
    the output to the middle, about which two firmwares for the board report it.
    """
    one = 1.0 + RESISTORS, 1.0 / (1.0 + RESISTORS)
    levels = [
        level_mv(board, a, b, c) for a in one for b in one for c in one
    ]  # at an end of each resistor
    code_mv = board["BOARD_REFERENCE_mV"] / CODES
    nominal = AMPLIFIER_GAIN * level_mv(board)
    spread = AMPLIFIER_GAIN * (max(levels) - level_mv(board) + AMPLIFIER_OFFSET_MV)
    spread += AMPLIFIER_GAIN_ERROR * nominal
    middle = board["BOARD_REFERENCE_mV"] / 2.0
    return (middle - spread) / code_mv, (nominal + spread) / code_mv


def test_the_level_without_current_is_the_measured_one_and_the_over_currents(
    board: dict[str, int],
) -> None:
    """128 mV at the pins of a board, within what its comparators accept."""
    assert level_mv(board) == pytest.approx(128.57, abs=0.01)
    assert level_mv(board) == pytest.approx(128.0, rel=RESISTORS)
    worst = level_mv(board) * 2.0 * RESISTORS + COMPARATOR_MV
    assert board["BOARD_NETWORK_LEVEL_LEAST_mV"] <= level_mv(board) - worst
    assert level_mv(board) + worst <= board["BOARD_NETWORK_LEVEL_MOST_mV"]


def test_every_board_without_a_defect_starts_with_the_bench_configuration(
    board: dict[str, int], bench: Drive
) -> None:
    """The third current is minus the sum of two, so its zero is beside the middle by both's."""
    least, most = zero_codes(board)
    beside = max(most - board["BOARD_CURRENT_ZERO_CODE"], board["BOARD_CURRENT_ZERO_CODE"] - least)
    assert beside > 200, "the default would refuse some"
    assert 2.0 * beside <= bench.monitor.offset_tolerance_codes


def test_a_broken_resistor_of_the_network_lies_beyond_the_tolerance(
    board: dict[str, int], bench: Drive
) -> None:
    """Open or shorted, with anything at the inverting input's pin; and that pin open: gain 1."""
    far = 1e9
    code_mv = board["BOARD_REFERENCE_mV"] / CODES
    bias_most_mv = (AMPLIFIER_GAIN * level_mv(board) - board["BOARD_REFERENCE_mV"] / 2.0) / (
        AMPLIFIER_GAIN - 1.0
    )
    broken = [level_mv(board)]  # at a gain of 1
    for resistor in range(3):
        for factor in (far, 1.0 / far):
            factors = [1.0, 1.0, 1.0]
            factors[resistor] = factor
            for bias_mv in (0.0, bias_most_mv):
                output = AMPLIFIER_GAIN * level_mv(board, *factors)
                broken.append(output - (AMPLIFIER_GAIN - 1.0) * bias_mv)
    for output_mv in broken:
        code = min(max(output_mv / code_mv, 0.0), CODES - 1.0)
        beside = abs(code - board["BOARD_CURRENT_ZERO_CODE"])
        assert beside > bench.monitor.offset_tolerance_codes


def test_the_trip_on_measured_current_can_be_seen_in_either_direction(
    board: dict[str, int], bench: Drive
) -> None:
    """The range above the highest zero is the smaller one, of current out of the motor."""
    seen = (CODES - 1.0 - zero_codes(board)[1]) / (CODES / 2.0)
    assert loops.overcurrent_pu(bench) <= loops.overcurrent_share_max(bench) <= seen


def test_the_hoverboards_header_compiles_and_gives_each_pin_once(tmp_path: Path) -> None:
    """Of a chip without a port; the timers' pins are those of the data sheet without a remap."""
    header = HAL / "stm32f103" / "boards" / "hoverboard.h"
    names = re.findall(r"#define (BOARD_\w+) PIN", header.read_text())
    lines = ["#define PIN(port, number) #port #number", '#include "boards/hoverboard.h"']
    lines += ["#include <stdio.h>", "int main(void) {"]
    lines += [f'puts("{name} " {name});' for name in names]
    lines += ['printf("%d %d\\n", BOARD_CURRENT_uA_PER_CODE, BOARD_DIVIDER_UPPER_Ohm);']
    (tmp_path / "pins.c").write_text("\n".join([*lines, "return 0; }"]))
    command = ["cc", "-std=c11", f"-I{HAL / 'stm32f103'}", "-o", str(tmp_path / "pins")]
    subprocess.run([*command, tmp_path / "pins.c"], check=True)
    output = subprocess.run([tmp_path / "pins"], check=True, capture_output=True, text=True).stdout
    *pins, scales = (line.split() for line in output.splitlines())
    found = {name.removeprefix("BOARD_"): pin for name, pin in pins}
    assert len(set(found.values())) == len(found) == len(names) > 20
    for timer, high, low in (
        ("M1", ("A8", "A9", "A10"), ("B13", "B14", "B15")),  # TIM1_CH1..3, CH1N..3N
        ("M2", ("C6", "C7", "C8"), ("A7", "B0", "B1")),  # TIM8
    ):
        assert tuple(found[f"{timer}_GATE_HIGH_{x}"] for x in "ABC") == high
        assert tuple(found[f"{timer}_GATE_LOW_{x}"] for x in "ABC") == low
    assert scales == ["20000", "30000"]
