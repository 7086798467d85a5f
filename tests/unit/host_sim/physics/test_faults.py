# SPDX-License-Identifier: Apache-2.0
"""A few runs of every fault: what they hold, and by name what they do not hold yet.

``fault_misses.txt`` names the runs that miss a limit, and the limits. A new miss fails. ``python
fault_misses.py`` writes the list anew.
"""

import json
from pathlib import Path

import pytest
from fault_misses import LIST, as_text, listed
from hubsim import cli
from hubsim.scenario import faults
from hubsim.sweep import faults_report, faults_sweep
from hubsim.sweep.faults_outcome import Outcome

SLACK = 0.3  # of the limits: what is so near to one may change with any line of the firmware
KEYS = {
    "fault", "config", "rotor_sensor", "demand_nm", "instant_s", "distance_ratio", "wrong_sign_ms",
    "current_ratio", "bus_peak_v", "bus_limit_v", "first_reason", "reason_expected",
    "time_to_reason_ms", "harmless", "final_mode", "healed_under_braking",
}  # fmt: skip


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command as a user calls it."""
    folder = tmp_path_factory.mktemp("faults")
    arguments = ["faults", "--reduced", "--workers", "1", "--output", str(folder)]
    assert cli.main([*arguments, "--json", str(folder / "runs.json")]) == 0
    return folder


@pytest.fixture(scope="module")
def outcomes(swept: Path) -> list[Outcome]:
    return faults_report._read(swept / "faults.csv")


def test_every_fault_is_run(outcomes: list[Outcome]) -> None:
    assert len(outcomes) >= 150
    assert {o.fault for o in outcomes} == {fault.name for fault in faults.named(())}
    assert {o.situation for o in outcomes} == {
        faults_sweep.STOP,
        faults_sweep.ROLL_BACK,
    }


def test_the_json_file_is_an_array_of_objects_with_the_keys(swept: Path) -> None:
    found = json.loads((swept / "runs.json").read_text(encoding="utf-8"))
    assert all(set(run) == KEYS for run in found)
    assert all(isinstance(run["harmless"], bool) for run in found)
    never = [run for run in found if run["distance_ratio"] is None]
    assert {run["fault"] for run in never} <= {
        "hydraulic_dead",
        "hydraulic_dead_measured",
        "hydraulic_weak",
    }


def test_no_run_misses_a_limit_that_is_not_listed(outcomes: list[Outcome]) -> None:
    known = listed(LIST.read_text(encoding="utf-8"))
    missed = listed(as_text(outcomes, SLACK))
    new = {run: limits for run, limits in missed.items() if set(limits) - set(known.get(run, []))}
    assert new == {}


def test_no_fault_that_was_latched_goes_away_under_braking(
    outcomes: list[Outcome],
) -> None:
    assert [o.key for o in outcomes if o.healed_under_braking] == []


def test_no_latched_fault_can_be_acknowledged_while_the_wheel_turns(
    outcomes: list[Outcome],
) -> None:
    assert [o.key for o in outcomes if o.acknowledged_turning] == []


def test_a_sweep_goes_on_where_it_was(swept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = swept / "faults.csv"
    whole = table.read_text(encoding="utf-8")
    table.write_text("\n".join(whole.splitlines()[:-3]) + "\n", encoding="utf-8")
    several = faults_sweep.reduced()
    missing = {case.key for case in several} - {o.key for o in faults_report._read(table)}
    assert len(missing) == 3
    assert cli.main(["faults", "--reduced", "--workers", "1", "--output", str(swept)]) == 0
    assert table.read_text(encoding="utf-8") == whole
    assert "runs of" in capsys.readouterr().out


def test_a_stuck_thermistor_of_a_cold_motor_changes_no_run(
    outcomes: list[Outcome],
) -> None:
    still = [o for o in outcomes if o.fault == "winding_sensor_stuck"]
    assert still
    assert all(abs(o.distance_ratio - 1.0) < 1e-3 and o.error_share < 0.02 for o in still)
    assert all(o.harmless for o in still)


def test_a_dead_hydraulic_brake_leaves_the_motor_s_share_of_the_demand(
    outcomes: list[Outcome],
) -> None:
    """40 of 75 N m are left to the motor; the missing 35 are error, in N m of 30 rated."""
    dead = [o for o in outcomes if o.fault == "hydraulic_dead"]
    assert dead
    assert all(o.error_share > 35.0 / 30.0 for o in dead)


def test_an_unknown_name_is_refused_in_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert cli.main(["faults", "hal_a_low"]) != 0
    assert capsys.readouterr().err == "hubsim: no fault 'hal_a_low', did you mean hall_a_low?\n"


def test_the_list_needs_no_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["faults", "--list"]) == 0
    assert "rotor_frozen" in capsys.readouterr().out
