"""Recordings read back by other people's libraries: the same numbers, with their units."""

import itertools
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from asammdf import MDF
from hubsim import cli, layout, recordings, run, scenario
from hubsim.commands import listing
from hubsim.errors import HubsimError
from hubsim.results import RunResult
from regen_table.schema import Drive

Hubsim = Callable[..., subprocess.CompletedProcess[str]]
UNITS = {"vehicle.speed_m_per_s": "m/s", "wheel0.motor_torque_nm": "N.m", "battery.voltage_v": "V", "wheel2.winding_temperature_c": "degC"}


@pytest.fixture(scope="module")
def result() -> RunResult:
    from regen_table import schema  # noqa: PLC0415

    drive: Drive = schema.load(cli.DEFAULT_CONFIG)
    name, chosen, beside = scenario.load("stop", {"initial_speed_kmh": 5.0, "demand_nm": 60.0})
    return run.simulate(name, drive, chosen, beside, ["time_s", *UNITS])


def test_csv_has_the_names_with_units_and_nine_digits(result: RunResult, tmp_path: Path) -> None:
    recordings.write_csv(result, tmp_path / "a.csv")
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].split(",") == result.names
    assert set(result.names) >= {"time_s", *UNITS}
    assert np.loadtxt(lines[1:], delimiter=",") == pytest.approx(result.rows, rel=1e-8, abs=1e-12)


def test_parquet_has_every_bit_and_every_unit(result: RunResult, tmp_path: Path) -> None:
    recordings.write_parquet(result, tmp_path / "a.parquet")
    table = pq.read_table(tmp_path / "a.parquet")
    assert table.column_names == result.names
    for k, name in enumerate(result.names):
        assert table[name].to_numpy().tobytes() == np.ascontiguousarray(result.rows[:, k]).tobytes()
    for name, unit in UNITS.items():
        metadata = table.schema.field(name).metadata
        assert metadata[b"unit"].decode() == unit
        assert len(metadata[b"text"]) > 3
    assert table.schema.metadata[b"scenario"] == b"stop"


def test_mdf4_has_every_bit_and_every_unit_on_one_time_axis(result: RunResult, tmp_path: Path) -> None:
    recordings.write_mdf(result, tmp_path / "a.mf4")
    with MDF(tmp_path / "a.mf4") as file:
        assert file.version.startswith("4")
        assert len(file.groups) == 1
        for name, unit in UNITS.items():
            channel = file.get(name)
            assert channel.unit == unit
            assert channel.samples.tobytes() == result.signal(name).tobytes()
            assert channel.timestamps.tobytes() == result.signal("time_s").tobytes()


def test_a_measurement_without_time_is_refused(result: RunResult, tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match=r"the signals do not include time_s, accepted: --signals with time_s"):
        recordings.write_mdf(result.only(["vehicle.speed_m_per_s"]), tmp_path / "a.mf4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_the_same_run_writes_the_same_bytes(result: RunResult, tmp_path: Path, kind: str) -> None:
    for name in "ab":
        recordings.KINDS[kind].write(result, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def curves(text: str) -> list[str]:
    return [curve.attrib["name"] for curve in ET.fromstring(text).iter("curve")]


def test_the_layout_is_made_of_the_signals_that_there_are() -> None:
    known = listing.signal_names()
    text = layout.layout(known)
    root = ET.fromstring(text)
    assert set(curves(text)) <= set(known)
    assert [tab.attrib["tab_name"] for tab in root.iter("Tab")] == ["vehicle", "torques", *(f"wheel {k}" for k in range(4))]
    for splitter in root.iter("DockSplitter"):
        plots = splitter.findall("DockArea/plot")
        assert len(plots) == int(splitter.attrib["count"])
        assert sum(map(float, splitter.attrib["sizes"].split(";"))) == pytest.approx(1.0, abs=1e-5)
        for plot in plots:
            found = [curve.attrib for curve in plot.iter("curve")]
            assert found
            assert len({curve["name"] for curve in found}) == len(found)
            assert all(a["color"] != b["color"] for a, b in itertools.pairwise(found))


def test_no_telling_signal_falls_out_of_the_layout() -> None:
    shown = curves(layout.layout(listing.signal_names()))
    for signal in ("driver.reference_m_per_s", "vehicle.speed_m_per_s", "battery.current_a", "bus.voltage_v", "wheel3.hydraulic_torque_nm",
                   "wheel0.current_q_a", "wheel1.dc_w", "wheel2.winding_temperature_c", "wheel0.reason", "wheel0.mode"):  # fmt: skip
        assert signal in shown


def test_a_layout_leaves_out_what_was_not_recorded() -> None:
    assert curves(layout.layout(["time_s", "vehicle.speed_m_per_s", "wheel10.mode", "wheel2.mode"])) == [
        "vehicle.speed_m_per_s", "wheel2.mode", "wheel10.mode"
    ]  # fmt: skip


def test_the_layout_in_the_package_is_up_to_date() -> None:
    assert layout.PATH.read_text(encoding="utf-8") == layout.layout(listing.signal_names())


def test_all_recordings_of_one_call_hold_the_same_signals(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim("run", "stop", "--set", "initial_speed_kmh=5", "--signals", "time_s,vehicle.*", "--csv", "a.csv",
                  "--parquet", "a.parquet", "--mdf", "a.mf4", "--layout", "a.xml")  # fmt: skip
    assert done.returncode == 0, done.stderr
    names = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert names[0] == "time_s"
    assert all(name.startswith("vehicle.") for name in names[1:])
    assert pq.read_table(tmp_path / "a.parquet").column_names == names
    with MDF(tmp_path / "a.mf4") as file:
        assert set(names[1:]) <= set(file.channels_db)
    assert curves((tmp_path / "a.xml").read_text(encoding="utf-8")) == ["vehicle.speed_m_per_s"]


def test_signals_without_a_recording_are_a_mistake(hubsim: Hubsim) -> None:
    done = hubsim("run", "stop", "--signals", "vehicle.*")
    assert (done.returncode, done.stderr) == (1, "hubsim: --signals: accepted: with --csv or --parquet or --mdf or --layout\n")
