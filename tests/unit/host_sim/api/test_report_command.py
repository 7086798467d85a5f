# SPDX-License-Identifier: Apache-2.0
"""``hubsim report``: one page from result files, and errors in one line."""

import base64
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from black_box_memory import memory, printed
from hubsim import run, scenario
from hubsim.engine import ROOT
from hubsim.run import evaluation, ideal_stop
from hubsim.run.results import load_result
from hubsim_command import Hubsim, hubsim_in
from regen_table import schema


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("results")


@pytest.fixture(scope="module")
def call(folder: Path) -> Hubsim:
    return hubsim_in(folder)


@pytest.fixture(scope="module")
def result(call: Hubsim) -> str:
    made = call(
        "run", "stop", "--set", "initial_speed_kmh=20", "--set", "demand_nm=60", "--strategy",
        "series_optimal", "--signals", "*", "--json", "one.json", "--parquet", "one.parquet",
        "--csv", "two.csv",
    )  # fmt: skip
    assert made.returncode == 0, made.stderr
    return "one.json"


def test_a_result_read_back_equals_the_run(result: str, folder: Path) -> None:
    name, chosen, beside = scenario.load("stop", {"initial_speed_kmh": 20.0, "demand_nm": 60.0})
    drive = schema.load(ROOT / "tools" / "motors" / "lu2013.toml")
    found = load_result(folder / result)
    expected = run.simulate(name, drive, chosen, beside, ["*"], date=found.origin["date"])
    assert found.names == expected.names
    assert np.allclose(found.rows, expected.rows, rtol=1e-7, atol=0.0)  # some as float32
    evaluated = [outcome.as_object() for outcome in evaluation.evaluate(chosen, drive, expected)]
    expected = replace(expected, criteria=evaluated, ideal=ideal_stop.ideal_of(drive, chosen))
    assert found.summary == expected.summary
    assert len(found.summary["criteria"]) == 4
    assert found.summary["ideal_stop"]["demand_nm"] == 60.0
    (folder / "two.json").write_text(
        (folder / result).read_text(encoding="utf-8"), encoding="utf-8"
    )
    assert np.allclose(load_result(folder / "two.json").rows, expected.rows, rtol=1e-8, atol=0.0)


def test_a_page_is_written_from_result_files(result: str, call: Hubsim, folder: Path) -> None:
    made = call("report", result, "-o", "page.html")
    assert made.returncode == 0, made.stderr
    text = (folder / "page.html").read_text(encoding="utf-8")
    for wanted in (
        "A stop at constant demand",
        "Where the motor brakes",
        "Over time",
        "Total torque error",
        "hubsim report",
    ):
        assert wanted in text
    assert "Stops: how much" not in text


def test_a_result_without_a_recording_shows_its_energies(
    result: str, call: Hubsim, folder: Path
) -> None:
    (folder / "alone.json").write_text(
        (folder / result).read_text(encoding="utf-8"), encoding="utf-8"
    )
    made = call("report", "alone.json", "-o", "alone.html")
    assert made.returncode == 0, made.stderr
    assert "No signals were recorded" in (folder / "alone.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("no.json", None, "no.json: file not found"),
        ("text.json", "not JSON", "text.json: not JSON"),
        ("list.json", "[]", "list.json: not a result"),
        ("part.json", json.dumps({"cycle": "stop"}), "part.json: not a result of a run"),
        ("odd.json", json.dumps({"duration_s": "long"}), "odd.json: not a result of a run"),
    ],
)
def test_an_invalid_result_is_an_error_that_names_it_and_no_page_is_written(
    name: str, content: str | None, message: str, call: Hubsim, folder: Path
) -> None:
    if content is not None:
        (folder / name).write_text(content, encoding="utf-8")
    made = call("report", name, "-o", "none.html")
    assert made.returncode == 2
    assert message in made.stderr
    assert made.stderr.count("\n") == 1
    assert not (folder / "none.html").exists()


def test_a_damaged_recording_is_an_error_that_names_the_file(
    result: str, call: Hubsim, folder: Path
) -> None:
    for suffix, content in ((".csv", "time_s,x\n1,2\nthree,4\n"), (".parquet", "no table")):
        (folder / "bad.json").write_text(
            (folder / result).read_text(encoding="utf-8"), encoding="utf-8"
        )
        recording = folder / f"bad{suffix}"
        recording.write_text(content, encoding="utf-8")
        made = call("report", "bad.json", "-o", "none.html")
        recording.unlink()
        assert made.returncode == 2
        assert f"bad{suffix}" in made.stderr
        assert made.stderr.count("\n") == 1


def test_the_page_shows_a_black_box_with_the_lines_and_picture_of_its_own_command(
    result: str, call: Hubsim, folder: Path
) -> None:
    (folder / "log.txt").write_text(printed(memory()), encoding="utf-8")
    alone = call("blackbox", "log.txt", "--output", "box")
    assert alone.returncode == 0, alone.stderr
    lines = alone.stdout.splitlines()[:-1]
    assert len(lines) == 4
    made = call("report", result, "--blackbox", "log.txt", "-o", "box.html")
    assert made.returncode == 0, made.stderr
    text = (folder / "box.html").read_text(encoding="utf-8")
    assert "<h2>Black box: OVERCURRENT</h2>" in text
    for line in lines:
        assert f"<li>{line}</li>" in text
    coded = re.findall(r'src="data:image/svg[+]xml;base64,([^"]+)"', text)
    assert [base64.b64decode(one) for one in coded] == [
        (folder / "box" / "blackbox.svg").read_bytes()
    ]
    without = call("report", result, "-o", "page.html")
    assert without.returncode == 0
    assert "Black box" not in (folder / "page.html").read_text(encoding="utf-8")


def test_a_damaged_black_box_is_an_error_and_no_page_is_written(
    result: str, call: Hubsim, folder: Path
) -> None:
    lines = printed(memory()).splitlines()
    del lines[20]
    (folder / "damaged.txt").write_text("\n".join(lines), encoding="utf-8")
    made = call("report", result, "--blackbox", "damaged.txt", "-o", "none.html")
    assert made.returncode == 2
    assert made.stderr.count("\n") == 1
    assert "damaged.txt: the line before" in made.stderr
    assert not (folder / "none.html").exists()
