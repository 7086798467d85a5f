# SPDX-License-Identifier: Apache-2.0
"""The sweep of stops: which ones, what is measured of them, and what is said about it."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hubsim import cli, reasons, run
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run import ideal_stop
from hubsim.scenario import Scenario
from hubsim.sweep import cases, drives, stored_share, stored_share_report
from hubsim.sweep.stored_share import Case, Outcome

OUTCOME = Outcome(
    number=3, drive="lu2013", demand_nm=20.0, demand_share_of_rated=0.667,
    initial_speed_kmh=40.0, speed_share_of_top=0.66, winding_temperature_c=25.0, soc=0.5,
    open_circuit_v=53.0, stored=0.815, ideal=0.816, difference=-0.001,
    ripple_share_of_rated=0.002, first_fault="", reason="LOSS_OPTIMUM",
    ideal_reason="loss_optimum", impossible_s=0.0,
)  # fmt: skip


def test_every_drive_gets_a_latin_hypercube_over_its_whole_range() -> None:
    """So many stops, so many slices of each range: one stop in each slice."""
    count = 50
    drawn = stored_share.draw(drives.DRIVES, 4 * count, 9)
    assert drawn == stored_share.draw(drives.DRIVES, 4 * count, 9)
    assert drawn != stored_share.draw(drives.DRIVES, 4 * count, 10)
    for name in drives.DRIVES:
        drive = drives.drive_named(name)
        here = [case for case in drawn if case.drive == name]
        flat = name == "lu2013"
        battery = (
            [(case.open_circuit_v - 40.0) / 18.4 for case in here]
            if flat
            else [case.soc for case in here]
        )
        top = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
        low, high = drive.table.temperature_range_c
        for shares in (
            [(case.demand_nm / drive.motor.rated_torque_nm - 0.1) / 1.1 for case in here],
            [(case.initial_speed_kmh / top - 0.2) / 0.8 for case in here],
            [(case.winding_temperature_c - low) / (high - low) for case in here],
            battery,
        ):
            # A hair inside, because the values are rounded.
            slices = np.floor(np.clip(shares, 1e-6, 1.0 - 1e-6) * count + 1e-3)
            assert len(set(slices)) >= count - 2
    drive = drives.drive_named("ipm400v")
    assert drives.with_open_circuit_voltage(drive, 350.0) is drive


def rows_of(torque: list[float], reason: str) -> Rows:
    rows = np.zeros((len(torque), len(stored_share.SIGNALS)))
    rows[:, 0], rows[:, 1] = torque, reasons.codes()[reason]
    return rows


def test_ripple_is_the_deviation_from_a_straight_line_while_none_changes() -> None:
    time = np.arange(1000, dtype=np.float64)
    ramp = 0.01 * time
    wave = 0.2 * np.sin(2.0 * np.pi * time / 20.0)

    def ripple(torque: Rows, reason: str, rated_nm: float) -> float:
        return stored_share.ripple_nm(rows_of(list(torque), reason), rated_nm)

    assert ripple(ramp, "NONE", 100.0) == pytest.approx(0.0, abs=1e-9)
    found = ripple(ramp + wave, "LOSS_OPTIMUM", 100.0)
    assert found == pytest.approx(0.2, rel=0.15)  # a line through a wave leans a little
    assert ripple(ramp + wave, "TORQUE_RATE", 100.0) == 0.0
    assert ripple(wave[:250], "NONE", 100.0) == 0.0  # not yet settled
    # 1 N m in a window is 2.5 % of 40 N m: no steady state.
    assert ripple(ramp + wave, "LOSS_OPTIMUM", 40.0) == 0.0


def test_a_stop_stores_what_the_whole_vehicle_stores() -> None:
    """All four wheels of the paper's vehicle, at an open-circuit voltage that is not the file's."""
    case = Case("lu2013", 33.0, 12.0, 60.0, 0.5, 50.5)
    found = stored_share.measure(0, case)
    drive = drives.with_open_circuit_voltage(drives.drive_named("lu2013"), case.open_circuit_v)
    standing = Scenario(
        initial_speed_kmh=12.0, demand_nm=33.0, drag=False, stop_at_standstill=True,
        winding_temperature_c=60.0,
    )  # fmt: skip
    whole = run.simulate("stop", drive, standing, Path(), ())
    share = whole.account_j["energy.chemical_j"] / whole.account_j["energy.kinetic_j"]
    assert found.stored == pytest.approx(share, abs=3e-4)
    assert found.difference == found.stored - found.ideal
    assert found.within
    assert ideal_stop.ideal_of(drive, standing)["stored_share_of_kinetic"] == pytest.approx(
        found.ideal, abs=0.01
    )


def test_a_stop_without_an_ideal_is_not_compared() -> None:
    """640 r/min at 40 V: no currents inside the limits make so little torque."""
    found = stored_share.measure(0, Case("lu2013", 20.0, 60.3, 25.0, 0.5, 40.0))
    assert found.impossible_s > 1.0
    assert not found.comparable


def test_a_vehicle_that_cannot_reach_its_speed_without_a_fault_is_outside(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(*_: object) -> None:
        raise HubsimError("the controller of wheel 0 stays in FAULT before the run begins")

    monkeypatch.setattr(stored_share, "_simulated", refused)
    found = stored_share.measure(0, Case("lu2013", 20.0, 40.0, 25.0, 0.5, 53.0))
    assert (found.first_fault, found.stored) == (stored_share.NOT_STARTED, 0.0)
    assert found.comparable
    assert not found.within


def test_the_table_reads_back() -> None:
    text = cases.as_csv([OUTCOME, replace(OUTCOME, number=4, first_fault="OVERCURRENT")])
    back = cases.read_csv(stored_share.Outcome, text)
    assert [outcome.number for outcome in back] == [3, 4]
    assert back[0] == OUTCOME
    assert [outcome.within for outcome in back] == [True, False]


def test_tolerance_and_worst_stops() -> None:
    slow = replace(OUTCOME, number=1, speed_share_of_top=0.25, difference=0.015)
    fast = replace(OUTCOME, number=2, difference=0.012)
    none = replace(OUTCOME, number=5, difference=-0.5, impossible_s=1.0)
    assert (slow.within, fast.within, none.comparable) == (True, False, False)
    assert replace(fast, ideal_reason="charge_current").within
    assert [o.number for o in stored_share_report.worst([slow, OUTCOME, none, fast], 2)] == [2, 1]
    first, *named = stored_share_report.summary([slow, OUTCOME, none, fast])
    assert first.startswith("lu2013: 2 of 3 within the tolerance, -0.10 to +1.50 %")
    assert "1 without any currents" in first
    assert len(named) == 3


def test_the_command_writes_table_origin_and_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two stops of the e-bike, the slow one in this process; the same bytes a second time."""
    monkeypatch.setattr(drives, "DRIVES", ("ebike36v",))
    monkeypatch.setattr(stored_share, "SPEED_SHARE", (0.1, 0.15))
    monkeypatch.setattr(stored_share, "DEMAND_SHARE", (0.8, 1.0))
    call = ["stops", "--count", "2", "--workers", "1", "--date", "2026-01-01", "--output"]
    assert cli.main([*call, str(tmp_path / "a")]) == 0
    assert "ebike36v: 2 of 2 within the tolerance" in capsys.readouterr().out
    assert cli.main([*call, str(tmp_path / "b")]) == 0
    names = {"stops.csv", "stops.json", "stops.svg", "stops.png"}
    assert {path.name for path in (tmp_path / "a").iterdir()} == names
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    with (tmp_path / "a" / "stops.csv").open(encoding="utf-8") as text:
        assert [row["drive"] for row in csv.DictReader(text)] == ["ebike36v"] * 2
    origin = json.loads((tmp_path / "a" / "stops.json").read_text(encoding="utf-8"))
    assert (origin["provenance"]["scenario"], origin["provenance"]["seed"]) == ("stops", 1)
    assert cli.main(["stops", "--count", "0", "--output", str(tmp_path)]) == 2
    assert "--count 0: accepted: a whole number from 1" in capsys.readouterr().err
