# SPDX-License-Identifier: Apache-2.0
"""The record of a first fault: from the shell's text to amperes, volts and seconds."""

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from black_box_memory import memory, printed
from hubsim import cli
from hubsim.engine import ROOT
from hubsim.errors import HubsimError
from hubsim.report import black_box, starts

FULL_A, FULL_V = 100.0, 80.0


def read(content: bytes) -> black_box.Record:
    return black_box.read(black_box.bytes_of(printed(content), "log"), "log", FULL_A, FULL_V)


def test_entries_come_in_the_order_of_time_and_in_si_units() -> None:
    record = read(memory())
    number = np.arange(400)
    assert record.reason == "OVERCURRENT"
    assert record.fault_s == 1.5
    assert record.counts == {"OVERCURRENT": 3}
    np.testing.assert_allclose(record.current_a[:, 0], number / 2048.0 * FULL_A)
    np.testing.assert_allclose(record.current_a[:, 2], -number / 2048.0 * FULL_A)
    np.testing.assert_allclose(record.bus_v, FULL_V / 2.0)
    assert set(record.bridge) == {1}
    np.testing.assert_array_equal(record.rotor, number)
    np.testing.assert_allclose(record.fast_s[[0, -1]], [0.005 - 399 / 20000, 0.005])
    np.testing.assert_allclose(record.slow_s[[0, -1]], [0.5 - 1.99, 0.5])
    np.testing.assert_allclose(record.slow["command"], 0.1 * np.arange(200))
    np.testing.assert_allclose(record.slow["bus_a"], -1.5)
    np.testing.assert_allclose(record.slow["winding_c"], 25.0)


def test_a_record_that_a_reset_ended_ends_at_time_zero_without_its_empty_entries() -> None:
    record = read(memory(phase=3, after_reset=1, filled=50))
    assert not record.sealed
    assert record.fast_s.shape == (50,)
    assert record.fast_s[-1] == record.slow_s[-1] == 0.0


def test_causes_of_starts_are_named_and_counted() -> None:
    content = bytearray(memory(phase=3, after_reset=1, starts=(2, 4)))
    struct.pack_into("<H", content, 16 + 2 * (55 + 8), 6)
    record = read(bytes(content))
    assert (record.started_by, record.ended_by) == ("LOW_SUPPLY", "WINDOW_WATCHDOG")
    assert record.counts == {"OVERCURRENT": 3, "start by RESET_PIN": 6}
    lines = black_box.summary(record)
    assert ", ended by a reset (WINDOW_WATCHDOG), after a start by LOW_SUPPLY;" in lines[0]
    assert "6 times start by RESET_PIN" in lines


def test_counters_of_warnings_have_their_names() -> None:
    content = bytearray(memory(phase=3))
    named = {19: "ROTOR_UNCERTAIN", 26: "HYDRAULIC_FEEDBACK", 27: "OVERSPEED"}
    named |= {28: "BATTERY_DISCONNECTED", 29: "OFFSETS_STORED"}
    for place, code in enumerate(named):
        struct.pack_into("<H", content, 16 + 2 * (50 + place), code)
    struct.pack_into("<H", content, 16 + 2 * (92 - 64), 2)
    expected = {"OVERCURRENT": 3, "ROTOR_FROZEN": 2, **{name: n for n, name in named.items()}}
    assert read(bytes(content)).counts == expected


def test_causes_of_starts_have_the_firmware_s_codes_and_counters() -> None:
    text = (ROOT / "hal/include/hal/watchdog.h").read_text(encoding="utf-8")
    body = text.split("typedef enum {")[1].split("}")[0]
    names = re.findall(r"^\s*RESET_(\w+)", body, re.MULTILINE)
    assert names[-1] == "CAUSES"
    spoken = {"UNKNOWN": "", "POWER": "SUPPLY", "BROWN_OUT": "LOW_SUPPLY", "PIN": "RESET_PIN"}
    spoken |= {"LOW_POWER": "LOW_POWER_MODE"}
    assert tuple(spoken.get(name, name) for name in names[:-1]) == starts.CAUSES
    assert 64 - len(starts.CAUSES) == black_box.FIRST_START


def test_the_latest_of_several_answers_counts() -> None:
    text = printed(memory(filled=10)) + printed(memory(filled=20))
    content = black_box.bytes_of(text, "log")
    assert black_box.read(content, "log", FULL_A, FULL_V).fast_s.shape == (20,)


def test_damage_is_refused_with_one_line() -> None:
    good = memory()
    flipped = bytearray(good)
    flipped[1000] ^= 1
    with pytest.raises(HubsimError, match="the CRC of the record is wrong"):
        read(bytes(flipped))
    with pytest.raises(HubsimError, match="not a record of format 1"):
        read(bytes(4) + good[4:])
    with pytest.raises(HubsimError, match="no record"):
        black_box.bytes_of("nothing here", "log")
    lines = printed(good).splitlines()
    del lines[20]
    with pytest.raises(HubsimError, match="missing or damaged"):
        black_box.bytes_of("\n".join(lines), "log")


def test_the_command_prints_a_summary_and_writes_tables_and_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "log.txt"
    log.write_text(printed(memory()), encoding="utf-8")
    assert cli.main(["blackbox", str(log), "--output", str(tmp_path / "out")]) == 0
    text = capsys.readouterr().out
    assert "OVERCURRENT 1.500 s after the start; configuration 0x00001234" in text
    assert "before it: 10.0 rad/s, -2.0 N m of 14.9, hydraulic 3.0 N m" in text
    assert "3 times OVERCURRENT" in text
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {
        "blackbox.png",
        "blackbox.svg",
        "blackbox_fast.csv",
        "blackbox_slow.csv",
    }
    fast = (tmp_path / "out" / "blackbox_fast.csv").read_text(encoding="utf-8").splitlines()
    assert len(fast) == 401
