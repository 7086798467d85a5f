# SPDX-License-Identifier: Apache-2.0
"""The bench's configuration of the ports' bring-up, as the README of the STM32F405 describes it."""

from __future__ import annotations

import cmath
import math
import os
import re
import tomllib
from pathlib import Path

import pytest
from regen_table import cli, derived, schema

SOURCE = Path(os.environ["HUBFOC_SOURCE_DIR"])
PORTS = SOURCE / "hal"
WHEEL = SOURCE / "tools" / "motors" / "bench" / "wheel24v.toml"
TURN_A_SECOND = 2.0 * math.pi


def bring_up(port: str) -> str:
    return (PORTS / port / "README.md").read_text().partition("## Bring-up")[2]


def changed(columns: int) -> str:
    """Return the wheel's TOML with the fields of the README's first columns."""
    text = WHEEL.read_text()
    rows = re.findall(r"^\| `(\[\w+\])` \|(.*)\|$", bring_up("stm32f405"), re.MULTILINE)
    assert len(rows) == 5
    for section, cells in rows:
        for cell in cells.split("|")[:columns]:
            for key, value in re.findall(r"`(\w+) = ([^`]+)`", cell):
                text = re.sub(rf"^{key} = .*\n(?: +#.*\n)*", "", text, flags=re.MULTILINE)
                assert section in text
                text = re.sub(rf"^{re.escape(section)}.*\n", rf"\g<0>{key} = {value}\n", text,
                              flags=re.MULTILINE)  # fmt: skip
    return text


@pytest.mark.parametrize("columns", [1, 2], ids=["b_g431b_esc1", "vesc"])
def test_the_bench_configuration_is_accepted(tmp_path: Path, columns: int) -> None:
    """With the short circuit where the over-voltage trips, which row 10 looks for."""
    path = tmp_path / "bench19v.toml"
    path.write_text(changed(columns))
    assert cli.main(["generate", str(path), "-o", str(tmp_path)]) == 0
    drive = schema.load(path)
    assert derived.overvoltage_trip_v(drive) == drive.inverter.device_voltage_v == 21.0
    assert drive.control.coast_delay_s == 0.0
    assert drive.control.limp_drive_share == 1.0


@pytest.mark.parametrize("board", ["vesc6_common", "vesc4_10"])
def test_a_vesc_has_the_full_scales_of_its_column(board: str) -> None:
    header = (PORTS / "stm32f405" / "boards" / f"{board}.h").read_text()
    fact = {name: int(value) for name, value in re.findall(r"(BOARD_\w+) = (\d+)", header)}
    inverter = tomllib.loads(changed(2))["inverter"]
    half_v = fact["BOARD_REFERENCE_mV"] / 2e3
    shunt_v_per_a = fact["BOARD_SHUNT_nOhm"] * 1e-9 * fact["BOARD_AMPLIFIER_GAIN"]
    divider = 1.0 + fact["BOARD_DIVIDER_UPPER_Ohm"] / fact["BOARD_DIVIDER_LOWER_Ohm"]
    assert inverter["current_full_scale_a"] == pytest.approx(half_v / shunt_v_per_a, rel=1e-3)
    assert inverter["voltage_full_scale_v"] == pytest.approx(2.0 * half_v * divider, rel=1e-3)
    assert 1e9 * inverter["dead_time_s"] >= fact["BOARD_DEAD_TIME_LEAST_ns"]


@pytest.mark.parametrize("port", ["stm32f405", "stm32g431"])
def test_readings_of_the_turned_wheel_are_those_of_its_motor(port: str) -> None:
    """EMF and torque of the short circuit at a turn a second, from flux linkage, R and L."""
    motor = tomllib.loads(changed(1))["motor"]
    poles, psi = motor["pole_pairs"], motor["flux_linkage_wb"]
    electrical = poles * TURN_A_SECOND
    current = (
        -electrical
        * psi
        / complex(motor["phase_resistance_ohm"], electrical * motor["q_inductance_h"])
    )
    torque_nm = 1.5 * poles * psi * abs(current) * math.cos(cmath.phase(-current))
    text = bring_up(port)
    assert f"{math.sqrt(3) * electrical * psi:.2f} V peak" in text
    assert f"brakes with {torque_nm:.0f} N m at {TURN_A_SECOND:.1f} rad/s" in text
