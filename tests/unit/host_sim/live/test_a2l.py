# SPDX-License-Identifier: Apache-2.0
"""The A2L: a public tool accepts it, and finds each object where the compiler has put it."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from hubfoc import a2l, addresses, cli
from regen_table import layout

ROOT = Path(__file__).resolve().parents[4]
A2LTOOL = Path(sys.executable).parent / "a2ltool"
OBJECTS = len(addresses.signals()) + len(addresses.fields()) + len(addresses.scope_words())
# What the slave shows, for the debugger's information of a compiler.
PAGES = """
#include "config/config.h"
#include "core/signals.h"
#define WORD(name, ...) int32_t name;
#define RAW(name, raw, ...) int32_t raw;
struct {
    struct { SIGNALS_SLOW_OUTPUTS(WORD) } output; struct { SIGNALS_SLOW_INPUTS(WORD) } input;
    struct { SIGNALS_FAST_OUTPUTS(RAW) } fast_output;
    struct { SIGNALS_FAST_INPUTS(RAW) } fast_input; struct { SIGNALS_FAST_VIEW(RAW) } fast_view;
} measurement_page __attribute__((section("signals"))) = {{1}, {1}};
config_t calibration_page __attribute__((section("page"))) = {1};
struct {
    int32_t signal_0, signal_1, signal_2, signal_3, signal_4, signal_5, signal_6, signal_7;
    int32_t SCOPE;
} scope_page __attribute__((section("scope"))) = {1};
"""


def tool(*arguments: object) -> str:
    done = subprocess.run(
        [A2LTOOL, *map(str, arguments)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "wheel.a2l"
    assert cli.main(["a2l", str(path)]) == 0
    return path


def pages(tmp_path: Path) -> Path:
    """Compile both pages to the addresses that the slave's header names."""
    header = (ROOT / "firmware/comms/include/comms/xcp.h").read_text(encoding="utf-8")
    at = dict(re.findall(r"XCP_(SIGNALS|PAGE|SCOPE)_ADDRESS UINT32_C\((0x\w+)\)", header))
    source, image = tmp_path / "pages.c", tmp_path / "pages.elf"
    scope = (ROOT / "firmware/comms/include/comms/scope.h").read_text(encoding="utf-8")
    page = scope.partition("int32_t signal[SCOPE_CHANNELS];")[2].partition("} scope_page_t;")[0]
    words = ", ".join(re.findall(r"int32_t (\w+);", page))
    source.write_text(PAGES.replace("SCOPE;", f"{words};"), encoding="utf-8")
    compiler = shutil.which("gcc") or "cc"
    subprocess.run(
        [
            compiler, "-std=c11", "-g", "-no-pie", "-nostdlib", "-static", "-Wl,--entry=0",
            f"-I{ROOT / 'firmware/core/include'}", f"-I{ROOT / 'firmware/config/include'}",
            f"-Wl,--section-start=signals={at['SIGNALS']}",
            f"-Wl,--section-start=page={at['PAGE']}",
            f"-Wl,--section-start=scope={at['SCOPE']}", "-o", image, source,
        ],
        check=True,
    )  # fmt: skip
    return image


def addresses_in(path: Path) -> list[int]:
    text = path.read_text(encoding="utf-8")
    found = re.findall(r"(?:ECU_ADDRESS|VALUE|VAL_BLK)\s+0x([0-9A-Fa-f]+)", text)
    return [int(digits, 16) for digits in found]


def test_a_strict_update_by_the_compilers_symbols_changes_no_address(
    file: Path, tmp_path: Path
) -> None:
    updated = tmp_path / "updated.a2l"
    tool(
        file, "--strict", "--check", "--elffile", pages(tmp_path), "--update", "FULL",
        "--update-mode", "STRICT", "--output", updated,
    )  # fmt: skip
    before, after = addresses_in(file), addresses_in(updated)
    assert len(before) == OBJECTS
    assert sorted(after) == sorted(before)
    assert len(set(after)) == OBJECTS


def test_a_wrong_name_does_not_pass_the_strict_update(file: Path, tmp_path: Path) -> None:
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("calibration_page.motor.type", "calibration_page.motor.kind"))
    done = subprocess.run(
        [A2LTOOL, file, "--elffile", pages(tmp_path), "--update", "FULL", "--update-mode",
         "STRICT", "--output", tmp_path / "updated.a2l"],
        capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode != 0


def test_the_interface_is_that_of_the_slave() -> None:
    text = a2l.text()
    assert re.search(r"EVENT \"slow step\" \"slow ste\" 0x0000 DAQ 1 1 6 0", text)
    assert re.search(r"EVENT \"PWM period\" \"PWM peri\" 0x0001 DAQ 1 0 3 0", text)
    assert "CAN_ID_MASTER 0x7F0 CAN_ID_SLAVE 0x7F4" in text
    assert "TIMESTAMP_SUPPORTED 1 SIZE_WORD UNIT_10US TIMESTAMP_FIXED" in text


def test_units_and_texts_are_those_of_the_lists() -> None:
    text = a2l.text()
    assert '/begin MEASUREMENT output.speed_rad_per_s "mechanical speed, estimated"' in text
    assert "SLONG CM_rad_s_thousandths 0 0" in text
    assert "COEFFS 0 1000 0 0 0 1" in text
    info = layout.load().sections["motor"]["pole_pairs"]
    assert f'/begin CHARACTERISTIC motor.pole_pairs "{info.text}"' in text
    assert re.search(r"VALUE 0x\w+ RL_long 0 CM_number_plain 1 60$", text, re.MULTILINE)
    assert "service_key" not in text
