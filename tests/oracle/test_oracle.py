# SPDX-License-Identifier: Apache-2.0
"""The oracle computes the same hashes every time, and says which ones differ."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from oracle import baseline, programs, simulation, tasks
from oracle.__main__ import main
from oracle.baseline import Hashes, OracleError, Results

simulation.use_engine()

ONE = Hashes("0f", "1f", "2f", "", 20, 1)
OTHER = Hashes("0e", "1f", "2f", "", 20, 1)


def results(**parts: dict[str, Hashes]) -> Results:
    return Results(["slow_output.mode"], dict(parts))


def test_a_program_gives_the_same_hashes_again_and_in_any_division() -> None:
    together = programs.run("random_slow", (2, 4))[0]
    assert len(together) == 2
    assert programs.run("random_slow", (2, 4))[0] == together
    apart = programs.run("random_slow", (2, 3))[0] | programs.run("random_slow", (3, 4))[0]
    assert apart == together


def test_a_scenario_has_the_same_hashes_after_any_other() -> None:
    first = simulation.run_scenario("rolling_start", "lu2013", {}, None)
    other = simulation.run_scenario("brake_onset", "lu2013", {}, None)
    assert {"fast", "slow", "events"} < set(first.differs(other))
    assert simulation.run_scenario("rolling_start", "lu2013", {}, None) == first


def test_the_random_steps_reach_torque_and_every_mode() -> None:
    _, reached = programs.run("random_slow", (0, 5))
    steps = reached["slow_steps", 0]
    assert reached["motor_commands", 0] > 0.3 * steps
    assert reached["switching", 0] > 0.5 * steps
    assert {number for name, number in reached if name == "mode"} == set(range(7))


def test_a_changed_value_changes_the_hash_that_a_program_prints() -> None:
    (right,) = programs.run("random_slow", (0, 1))[0].values()
    changed = programs.run("random_slow", (0, 1, "--change", "slow_output.mode", 3))[0]
    assert [right.differs(one) for one in changed.values()] == [["slow"]]


def test_values_that_change_are_listed(tmp_path: Path) -> None:
    path = tmp_path / "values.txt"
    programs.run("random_slow", (0, 2, "--values", path, 1))
    lines = path.read_text(encoding="ascii").splitlines()
    names = {line.split()[2] for line in lines}
    assert all(re.fullmatch(r"\d+ 0 [\w.]+ -?\d+", line) for line in lines)
    assert {"slow_output.mode", "limits.braking_voltage_mNm", "setpoint.safe_bridge"} < names


def test_every_part_has_tasks_and_its_entries_are_found() -> None:
    for part in tasks.PARTS:
        several = tasks.of_part(part, quick=False)
        assert several
        assert {type(task) for task in tasks.of_part(part, quick=True)} <= {
            type(task) for task in several
        }
    with pytest.raises(OracleError, match="'slow'"):
        tasks.of_part("slow", quick=False)


def test_a_run_that_cannot_go_on_is_a_difference() -> None:
    task = tasks.ScenarioTask("scenarios", "stop", "scooter48v", {"initial_speed_kmh": 90.0})
    one = tasks.done(task)
    assert "stays in FAULT before the run begins" in one.failure
    assert one.entries == {}
    found = Results(["slow_output.mode"])
    found.add(one.part, one.entries)
    stored = results(scenarios={task.label: ONE})
    assert baseline.compared(stored, found, complete=True) == (
        ["scenarios: DIFFERS in missing: 1 of 1 entries, the first is "
         "'stop scooter48v' (missing)"], False,
    )  # fmt: skip


def test_without_tasks_there_is_no_answer() -> None:
    with pytest.raises(OracleError, match="--quick"):
        tasks.plan(["cycle"], quick=True)


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    some = results(cycle={"a": ONE, "b": replace(ONE, bytes="3f")}, faults={"c": OTHER})
    some.write(tmp_path / "some.json")
    assert Results.read(tmp_path / "some.json") == some


@pytest.mark.parametrize("text", ["{", "[]", '{"format": 0}'])
def test_another_file_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "other.json"
    path.write_text(text, encoding="ascii")
    with pytest.raises(OracleError, match=r"other\.json"):
        Results.read(path)
    with pytest.raises(OracleError, match="cannot be read"):
        Results.read(tmp_path / "absent.json")


def test_a_difference_names_part_kind_and_first_entry() -> None:
    stored = results(cycle={"a": ONE, "b": ONE}, faults={"c": ONE})
    found = results(cycle={"a": ONE, "b": OTHER}, faults={"c": ONE})
    lines, equal = baseline.compared(stored, found, complete=True)
    assert not equal
    assert lines == [
        "cycle: DIFFERS in fast: 1 of 2 entries, the first is 'b' (fast)",
        "faults: 1 entries equal",
    ]
    assert baseline.compared(stored, stored, complete=True)[1]


def test_a_missing_entry_is_a_difference_unless_only_some_are_compared() -> None:
    stored, found = results(cycle={"a": ONE, "b": ONE}), results(cycle={"a": ONE})
    assert not baseline.compared(stored, found, complete=True)[1]
    assert baseline.compared(stored, found, complete=False)[1]


def test_without_an_entry_to_compare_the_hashes_are_not_equal() -> None:
    stored, found = results(cycle={"a": ONE}), results(cycle={"b": ONE})
    lines, equal = baseline.compared(stored, found, complete=False)
    assert not equal
    assert "not stored" in lines[-1]


def test_another_list_of_values_is_a_difference() -> None:
    found = Results(["slow_output.mode", "slow_output.other"], {"cycle": {"a": ONE}})
    stored = results(cycle={"a": ONE})
    lines, equal = baseline.compared(stored, found, complete=True)
    assert not equal
    assert lines[0].startswith("accessors.h")


def test_a_run_of_another_length_is_named_so() -> None:
    assert ONE.differs(replace(ONE, slow_steps=2, slow="0c")) == ["steps", "slow"]


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str]]:
    def run(*arguments: object) -> tuple[int, str]:
        words = ["oracle", "--part", "sequences", "--jobs", "1", *map(str, arguments)]
        monkeypatch.setattr("sys.argv", words)
        status = main()
        return status, capsys.readouterr().out

    return run


def test_the_command_accepts_its_own_hashes_and_refuses_others(
    command: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    path = tmp_path / "own.json"
    assert command("-o", path)[0] == 0
    status, shown = command("--check", "--baseline", path)
    assert (status, shown.splitlines()[-1]) == (0, "equal")
    text = path.read_text(encoding="ascii")
    first = next(iter(json.loads(text)["parts"]["sequences"].values()))["slow"]
    path.write_text(text.replace(first, "0" * 16), encoding="ascii")
    status, shown = command("--check", "--baseline", path)
    assert status == 1
    assert "sequences: DIFFERS in slow: 1 of 15 entries" in shown


def test_the_command_names_the_options_that_it_needs(
    command: Callable[..., tuple[int, str]], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == 2
    assert "--check" in capsys.readouterr().err


def test_values_of_one_entry_are_written(
    command: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    path = tmp_path / "values.txt"
    assert command("--values", "scenarios", "brake_onset", "-o", path)[0] == 0
    lines = path.read_text(encoding="ascii").splitlines()
    assert {line.split()[1] for line in lines} == {"0", "1", "2", "3"}
    assert any(line.split()[2] == "fast_output.compare_a_counts" for line in lines)
    assert command("--values", "scenarios", "absent", "-o", path)[0] == 1
