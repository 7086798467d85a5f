# SPDX-License-Identifier: Apache-2.0
"""``./tools/dev study``: the list, every study in a reduced form, and its page."""

import argparse
import csv
import json
import math
import shutil
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import published_maps
import pytest
from hubsim.engine import ROOT
from matplotlib.figure import Figure
from regen_table import plotting
from studies import __main__ as command
from studies import common
from studies.common import Study

# What makes each study small, and a line that it prints then.
REDUCED = {
    "blend_out": (["--count", "4"], "lu2013: 1 of 1 stops within"),
    "coast": (["--count", "4"], "lu2013: 1 of 1 within"),
    "dips": (["lu2013"], "lu2013      contactor opens         30.0 N m: dip  9"),
    "edges": (["--count", "12"], "boot: 1 of 1 runs within"),
    "envelope": (["--count", "4"], "lu2013: 1 of 1 runs with a good sensor"),
    "faults": (["bus_sensor_dead", "--reduced"], "of 1 fault:"),
    "healthy": (["--rides", "8:12"], "lu2013: 1 of 1 rides without"),
    "measured": (["--data", "DATA"], "torque of most regenerated power at 155 r/min: error 0."),
    "stored_share": (["--count", "4"], "lu2013: 1 of 1 within the tolerance"),
    "total_torque": (["ebike36v", "--only-stops", "--count", "4"], "ebike36v: worst rms"),
    "worth": (["ebike36v"], "ebike36v: +0.2 to +39.3 points"),
}


def test_the_list_has_a_line_for_each_study(capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main([]) == 0
    listed = capsys.readouterr().out
    assert command.names() == sorted(REDUCED)
    for name in command.names():
        (line,) = (line for line in listed.splitlines() if line.startswith(f"  {name} "))
        assert line.endswith(".")
        assert len(line) <= 100


@pytest.mark.parametrize("name", REDUCED)
def test_a_study_in_a_reduced_form_holds_and_leaves_table_origin_and_picture(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options, printed = REDUCED[name]
    if "DATA" in options:
        published = published_maps.write_all(tmp_path / "data")
        options = [str(published) if option == "DATA" else option for option in options]
    arguments = [*options, "--workers", "1", "--date", "2026-01-01", "-o", str(tmp_path / "out")]
    assert command.main([name, *arguments, "--json", str(tmp_path / "all.json")]) == 0
    assert printed in capsys.readouterr().out
    files = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert set(files) == {f"{name}.{ending}" for ending in ("csv", "json", "svg", "png")}
    origin = json.loads(files[f"{name}.json"])
    everything = json.loads((tmp_path / "all.json").read_text(encoding="utf-8"))
    assert origin["provenance"]["scenario"] == name
    assert {key: everything[key] for key in origin} == origin
    rows = list(csv.DictReader(files[f"{name}.csv"].decode().splitlines()))
    assert [set(run) for run in everything["runs"]] == [set(row) for row in rows]


@pytest.mark.parametrize("name", REDUCED)
def test_a_page_has_the_tables_of_the_stored_runs_and_the_command_that_makes_them(
    name: str,
) -> None:
    folder = common.folder_of(name)
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert page == common.with_tables(name, page, stored_tables(name))
    assert f"./tools/dev study {name} --refresh" in page
    assert f"]({name}.svg)" in page
    assert {f"{name}.{ending}" for ending in ("csv", "json", "svg")} <= {
        path.name for path in folder.iterdir()
    }


def stored_tables(name: str) -> dict[str, str]:
    study = import_module(f"studies.{name}.study")
    if name == "faults":
        return dict(study.tables(*(study.stored(n) for n in ("faults", study.OTHERS, study.WHOLE))))
    return dict(study.STUDY.tables(study.STUDY.stored()))


@pytest.mark.parametrize(
    ("arguments", "status", "answer"),
    [
        (["cost"], 2, "study: no study 'cost', did you mean coast?"),
        (["coast", "--count", "0"], 2, "study coast: --count 0: accepted: a whole number from 1"),
        (["dips", "--workers", "0"], 2, "study dips: --workers 0: accepted: a whole number from 1"),
        (["dips", "lu2014"], 2, "no 'lu2014', accepted: lu2013, ebike36v"),
        (["coast", "--refresh", "--count", "3"], 2, "are of the whole study: not with count"),
        (["faults", "hal_a_low"], 2, "no fault 'hal_a_low', did you mean hall_a_low?"),
        (["dips", "--json", "/nowhere/x.json"], 2, "/nowhere/x.json"),
    ],
)
def test_a_wrong_call_is_answered_in_one_line(
    arguments: list[str],
    status: int,
    answer: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    place = [] if "--refresh" in arguments else ["-o", str(tmp_path)]
    try:
        found = command.main([*arguments, *place])
    except SystemExit as end:
        found = int(end.code or 0)
    error = capsys.readouterr().err
    assert found == status
    assert answer in error
    assert error.count("\n") == 1


@dataclass(frozen=True)
class Outcome:
    number: int
    square: float


PAGE = """# A page

<!-- from squares.csv: all -->

old

<!-- end -->

the end
"""


def squares(options: argparse.Namespace) -> list[float]:
    return [float(k) for k in range(options.count)]


def measured(number: int, case: float) -> Outcome:
    return Outcome(number, case**2 if case else math.inf)


def empty(_outcomes: object) -> Figure:
    return plotting.figure("none")[0]


SQUARES = Study(
    name="squares",
    text="Squares.",
    outcome=Outcome,
    cases=squares,
    measure=measured,
    summary=lambda outcomes: [f"{len(outcomes)} squares"],
    figure=empty,
    tables=lambda outcomes: {
        "all": common.markdown(("n", "square"), [(o.number, o.square) for o in outcomes])
    },
    holds=lambda outcomes: outcomes[-1].square < 10.0,
    count=3,
)


def test_refresh_renews_only_table_picture_and_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(common, "folder_of", lambda _name: tmp_path)
    (tmp_path / "README.md").write_text(PAGE, encoding="utf-8")
    call = ["--workers", "1", "--date", "2026-01-01"]
    assert SQUARES.main([*call, "--refresh"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        *("README.md", "squares.csv", "squares.json", "squares.svg")
    }
    table = "| n | square |\n| --- | --- |\n| 0 | inf |\n| 1 | 1.0 |\n| 2 | 4.0 |\n"
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert page == PAGE.replace("old\n", table)
    assert SQUARES.stored() == [Outcome(0, math.inf), Outcome(1, 1.0), Outcome(2, 4.0)]
    # From the stored table alone.
    (tmp_path / "README.md").write_text(PAGE, encoding="utf-8")
    assert SQUARES.main(["--page"]) == 0
    assert (tmp_path / "README.md").read_text(encoding="utf-8") == page


def test_json_has_null_for_what_is_not_finite_and_the_status_is_1_where_the_study_does_not_hold(
    tmp_path: Path,
) -> None:
    call = ["--count", "5", "--workers", "1", "-o", str(tmp_path), "--json"]
    assert SQUARES.main([*call, str(tmp_path / "all.json")]) == 1
    found = json.loads((tmp_path / "all.json").read_text(encoding="utf-8"))
    assert found["summary"] == ["5 squares"]
    assert [run["square"] for run in found["runs"]] == [None, 1.0, 4.0, 9.0, 16.0]


def test_a_page_without_the_mark_of_a_table_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(common, "folder_of", lambda _name: tmp_path)
    shutil.copy(ROOT / "LICENSE", tmp_path / "README.md")
    assert SQUARES.main(["--workers", "1", "--refresh"]) == 2
    assert "no mark <!-- from squares.csv: all -->" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["README.md"]
