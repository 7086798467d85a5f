# SPDX-License-Identifier: Apache-2.0
"""Recordings read back by independent libraries: the same numbers with their units."""

import subprocess
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from asammdf import MDF
from hubsim import cli, run, scenario
from hubsim.errors import HubsimError
from hubsim.run import recordings, spool
from hubsim.run.results import RunResult
from regen_table.schema import Drive

Hubsim = Callable[..., subprocess.CompletedProcess[str]]
UNITS = {
    "vehicle.speed_m_per_s": "m/s",
    "wheel0.motor_torque_nm": "N.m",
    "battery.voltage_v": "V",
    "wheel2.winding_temperature_c": "degC",
}


@pytest.fixture(scope="module")
def result() -> RunResult:
    from regen_table import schema  # noqa: PLC0415

    drive: Drive = schema.load(cli.DEFAULT_CONFIG)
    name, chosen, beside = scenario.load("stop", {"initial_speed_kmh": 5.0, "demand_nm": 60.0})
    return run.simulate(name, drive, chosen, beside, ["time_s", *UNITS, "wheel0.fault_reason"])


def test_csv_has_names_with_units_and_nine_significant_digits(
    result: RunResult, tmp_path: Path
) -> None:
    recordings.write_csv(result, tmp_path / "a.csv", result.names)
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].split(",") == result.names
    assert set(result.names) >= {"time_s", *UNITS}
    assert np.loadtxt(lines[1:], delimiter=",") == pytest.approx(result.rows, rel=1e-8, abs=1e-12)


def test_parquet_stores_values_with_units_and_short_ones_in_four_bytes(
    result: RunResult, tmp_path: Path
) -> None:
    recordings.write_parquet(result, tmp_path / "a.parquet", result.names)
    table = pq.read_table(tmp_path / "a.parquet")
    assert table.column_names == result.names
    for k, name in enumerate(result.names):
        kept = result.rows[:, k]
        if not name.endswith(("_s", "_m", "_m_per_s", "_j")):
            assert table[name].type == "float"
            kept = kept.astype(np.float32)
        assert table[name].to_numpy().tobytes() == np.ascontiguousarray(kept).tobytes(), name
    for name, unit in UNITS.items():
        metadata = table.schema.field(name).metadata
        assert metadata[b"unit"].decode() == unit
        assert len(metadata[b"text"]) > 3
    assert table.schema.metadata[b"scenario"] == b"stop"


def test_a_recording_in_many_blocks_has_the_same_rows(
    result: RunResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ["time_s", "vehicle.speed_m_per_s", "wheel0.motor_torque_nm"]
    for block, rows in (("whole", 10**6), ("parts", 7)):
        monkeypatch.setattr(recordings, "BLOCK_BYTES", rows * len(names) * 8)
        for kind, write in recordings.WRITERS.items():
            write(result, tmp_path / f"{block}.{kind}", names)
    assert (tmp_path / "parts.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    parts, whole = (pq.ParquetFile(tmp_path / f"{block}.parquet") for block in ("parts", "whole"))
    assert parts.read().equals(whole.read())
    assert (parts.num_row_groups, whole.num_row_groups) == (-(-len(result.rows) // 7), 1)
    with MDF(tmp_path / "parts.mdf") as file:
        assert len(file.groups) == 1
        for name in names[1:]:
            assert file.get(name).samples.tobytes() == result.signal(name).tobytes()
            assert file.get(name).timestamps.tobytes() == result.signal("time_s").tobytes()


def test_parquet_splits_the_bytes_of_numbers_and_lists_codes(
    result: RunResult, tmp_path: Path
) -> None:
    names = ["time_s", "wheel0.motor_torque_nm", "wheel0.fault_reason"]
    recordings.write_parquet(result, tmp_path / "a.parquet", names)
    group = pq.ParquetFile(tmp_path / "a.parquet").metadata.row_group(0)
    encodings = [set(group.column(k).encodings) for k in range(3)]
    assert all("BYTE_STREAM_SPLIT" in some for some in encodings[:2])
    assert "RLE_DICTIONARY" in encodings[2]


def test_many_rows_go_to_a_file_and_come_back_as_they_were(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rows = np.random.default_rng(1).normal(size=(1000, 3))
    found = []
    for most in (1 << 26, 5000, 0):
        monkeypatch.setattr(spool, "MOST_BYTES", most)
        collected = spool.Spool(3)
        for part in np.split(rows, [0, 10, 500, 990]):
            collected.add(part)
        found.append(collected.rows())
    assert [isinstance(some, np.memmap) for some in found] == [False, True, True]
    assert all(np.array_equal(some, rows) for some in found)
    assert spool.Spool(4).rows().shape == (0, 4)


def test_mdf4_stores_exact_values_and_units_on_one_time_axis(
    result: RunResult, tmp_path: Path
) -> None:
    recordings.write_mdf(result, tmp_path / "a.mf4", result.names)
    with MDF(tmp_path / "a.mf4") as file:
        assert file.version.startswith("4")
        assert len(file.groups) == 1
        for name, unit in UNITS.items():
            channel = file.get(name)
            assert channel.unit == unit
            assert channel.samples.tobytes() == result.signal(name).tobytes()
            assert channel.timestamps.tobytes() == result.signal("time_s").tobytes()


def test_a_recording_without_time_is_refused(result: RunResult, tmp_path: Path) -> None:
    with pytest.raises(
        HubsimError, match=r"the signals do not include time_s, accepted: --signals with time_s"
    ):
        recordings.write_mdf(result, tmp_path / "a.mf4", ["vehicle.speed_m_per_s"])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["csv", "parquet", "mdf", "layout"])
def test_recordings_do_not_depend_on_the_time_of_day(
    result: RunResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    clock_s = time.time
    for name, later_s in (("a", 0.0), ("b", 100_000.0)):
        with monkeypatch.context() as patch:
            patch.setattr(time, "time", lambda later_s=later_s: clock_s() + later_s)
            recordings.write_all(result, {kind: tmp_path / name}, result.names)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_recordings_are_identical_for_the_same_seed_only(hubsim: Hubsim, tmp_path: Path) -> None:
    noisy = (
        "run",
        "stop",
        "--set",
        "initial_speed_kmh=3",
        "--set",
        "plant.sensors.current_noise_a=0.2",
        "--signals",
        "time_s,*_a",
    )
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        recorded = ("--csv", f"{name}.csv", "--parquet", f"{name}.parquet", "--mdf", f"{name}.mf4")
        done = hubsim(*noisy, "--set", f"seed={seed}", "--date", "2026-01-01", *recorded)
        assert done.returncode == 0, done.stderr
    for ending in ("csv", "parquet", "mf4"):
        first, again, other = ((tmp_path / f"{name}.{ending}").read_bytes() for name in "abc")
        assert first == again, ending
        assert first != other, ending


def test_all_recordings_of_one_call_contain_the_same_signals(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim("run", "stop", "--set", "initial_speed_kmh=5", "--signals", "time_s,vehicle.*",
        "--csv", "a.csv",
                  "--parquet", "a.parquet", "--mdf", "a.mf4", "--layout", "a.xml")  # fmt: skip
    assert done.returncode == 0, done.stderr
    names = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert names[0] == "time_s"
    assert all(name.startswith("vehicle.") for name in names[1:])
    assert pq.read_table(tmp_path / "a.parquet").column_names == names
    with MDF(tmp_path / "a.mf4") as file:
        assert set(names[1:]) <= set(file.channels_db)
    drawn = ET.parse(tmp_path / "a.xml").getroot()
    assert [curve.attrib["name"] for curve in drawn.iter("curve")] == ["vehicle.speed_m_per_s"]
    assert [file.attrib["filename"] for file in drawn.iter("fileInfo")] == ["a.csv"]


def test_signals_without_a_recording_are_an_error(hubsim: Hubsim) -> None:
    done = hubsim("run", "stop", "--signals", "vehicle.*")
    assert (done.returncode, done.stderr) == (
        2,
        "hubsim: --signals: accepted: with --csv or --parquet or --mdf or --layout\n",
    )
