# SPDX-License-Identifier: Apache-2.0
import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hubsim import run
from hubsim.errors import HubsimError
from hubsim.run import difference, recordings
from hubsim.run.difference import Side, Tolerance
from hubsim.scenario import Scenario
from regen_table.schema import Drive

Hubsim = Callable[..., subprocess.CompletedProcess[str]]
QUICK = ("--set", "initial_speed_kmh=10", "--set", "demand_nm=60")
TIME = np.array([0.0, 1.0, 2.0, 3.0])


def side(**signals: np.ndarray) -> Side:
    return Side("made up", {}, {"time_s": TIME} | signals)


def test_signals_are_compared_at_every_time() -> None:
    (found,) = difference.compare(
        side(x=np.array([0.0, 1.0, 2.0, 3.0])), side(x=np.array([0.0, 1.5, 2.0, 3.0])), Tolerance()
    )
    assert (found.largest, found.at_s, found.within) == (0.5, 1.0, False)
    assert found.rms == pytest.approx(0.25)
    assert (found.first, found.second) == (1.5, 1.625)


def test_recordings_with_other_times_are_interpolated_linearly() -> None:
    finer = Side(
        "finer", {}, {"time_s": np.linspace(0.5, 2.5, 21), "x": 2.0 * np.linspace(0.5, 2.5, 21)}
    )
    (found,) = difference.compare(side(x=2.0 * TIME), finer, Tolerance(absolute=1e-12))
    assert found.within
    assert found.first == pytest.approx(3.0)  # of the instants 1 s and 2 s, which both have


@pytest.mark.parametrize(
    ("tolerance", "within"),
    [(Tolerance(), False), (Tolerance(absolute=0.5), True), (Tolerance(absolute=0.49), False),
        (Tolerance(relative=0.05), True),
     (Tolerance(relative=0.04), False), (Tolerance(0.3, 0.02), True)],
)  # fmt: skip
def test_tolerances_are_absolute_or_relative_to_the_peak(
    tolerance: Tolerance, within: bool
) -> None:
    one, other = side(x=np.array([0.0, 1.0, 2.0, 10.0])), side(x=np.array([0.0, 1.5, 2.0, 10.0]))
    assert difference.compare(one, other, tolerance)[0].within is within
    ten, less = (Side(str(v), {"x": v}, {}) for v in (10.0, 9.5))
    assert difference.compare(ten, less, tolerance)[0].within is within


def test_a_signal_without_numbers_in_one_recording_differs() -> None:
    holed, whole = (
        side(x=np.array([0.0, math.nan, 2.0, 3.0])),
        side(x=np.array([0.0, 1.0, 2.0, 3.0])),
    )
    assert not difference.compare(holed, whole, Tolerance(absolute=1e9))[0].within
    assert difference.compare(holed, holed, Tolerance())[0].within


def test_of_codes_the_names_are_compared_and_no_mean_is_made() -> None:
    """Half of the times apart; the code of the later side is the one in force, not one between."""
    name = "wheel0.reason"
    first = Side("a", {}, {"time_s": TIME, name: np.array([0.0, 0.0, 2.0, 2.0])})
    second = Side(
        "b", {}, {"time_s": np.array([0.0, 1.5, 3.0]), name: np.array([0.0, 5.0, 2.0])}
    )  # at 0, 1, 2, 3 s: 0, 0, 5, 2
    (found,) = difference.compare(first, second, Tolerance(absolute=9.0, relative=0.2))
    assert (found.first, found.second) == ("MAX_TORQUE", "CHARGE_CURRENT")
    assert (found.at_s, found.largest, found.rms, found.within) == (2.0, 0.25, None, False)
    assert difference.compare(first, second, Tolerance(relative=0.25))[0].within
    (same,) = difference.compare(first, first, Tolerance())
    assert (same.within, same.largest, same.at_s) == (True, 0.0, None)


def test_every_signal_without_a_unit_is_compared_as_a_code(drive: Drive) -> None:
    vehicle, _ = run.prepare(drive, Scenario(max_duration_s=1.0), Path(), {})
    with vehicle:
        vehicle.start()
        for name, (unit, _) in vehicle.meanings().items():
            assert recordings.is_code(name) is (unit == ""), name


def test_recordings_of_one_run_agree_in_every_format(hubsim: Hubsim) -> None:
    assert (
        hubsim(
            "run", "stop", *QUICK, "--csv", "a.csv", "--parquet", "a.parquet", "--json", "a.json"
        ).returncode
        == 0
    )
    # Nine digits in a CSV, four bytes in Parquet.
    done = hubsim("compare", "a.csv", "a.parquet", "--relative", "1.2e-7")
    assert done.returncode == 0, done.stdout
    assert done.stdout.endswith("figures and signals within the tolerances\n")
    done = hubsim("compare", "a.parquet", "stop", *QUICK, "--only", "*.*")
    assert done.returncode == 0, done.stdout
    assert hubsim("compare", "a.json", "a.json").returncode == 0
    assert "nothing in common" in hubsim("compare", "a.json", "a.csv").stderr


def test_two_scenarios_are_run_and_compared(hubsim: Hubsim, tmp_path: Path) -> None:
    same = hubsim("compare", "stop", "stop", *QUICK)
    assert same.returncode == 0, same.stdout
    other = hubsim(
        "compare",
        "stop",
        "stop",
        *QUICK,
        "--set-b",
        "plant.motor.phase_resistance_ohm=0.062",
        "--relative",
        "0.03",
        "--json",
        "d.json",
    )
    assert other.returncode == 1
    assert "DIFFERS" in other.stdout
    written_json = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    found = {d["name"]: d for d in written_json["differences"]}
    copper = found["energy_j.copper"]
    assert copper["second"] / copper["first"] == pytest.approx(
        2.0, rel=0.03
    )  # the same currents through twice the resistance
    assert not copper["within"]
    assert found["distance_m"]["within"]
    chosen = hubsim("compare", "stop", "stop", *QUICK, "--set-b",
        "plant.motor.phase_resistance_ohm=0.062", "--relative", "0.03", "--only",
                    "distance_m,vehicle.speed*", "--all")  # fmt: skip
    assert chosen.returncode == 0, chosen.stdout
    assert "vehicle.speed_m_per_s" in chosen.stdout


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.txt", "", "a.txt: accepted: .json, .csv, .parquet, or a scenario"),
        ("a.csv", "time_s,x\n0,1,2\n", "a.csv: no csv file of a run"),
        ("a.csv", "x\n1\n", "a.csv: no csv file of a run: no column time_s"),
        ("a.json", "[1]", "a.json: no json file of a run: an object is needed"),
        ("a.json", "{", "a.json: no json file of a run"),
        ("a.parquet", "no table", "a.parquet: no parquet file of a run"),
    ],
)
def test_an_invalid_result_is_an_error_in_one_line(
    tmp_path: Path, name: str, text: str, message: str
) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(HubsimError) as caught:
        difference.read(tmp_path / name)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_recordings_without_common_times_are_refused() -> None:
    later = Side("later", {}, {"time_s": TIME + 10.0, "x": TIME})
    with pytest.raises(HubsimError, match="no time in common"):
        difference.compare(side(x=TIME), later, Tolerance())


def test_a_usage_error_is_one_line(hubsim: Hubsim) -> None:
    assert "none.csv: file not found" in hubsim("compare", "none.csv", "stop").stderr
    refused = hubsim("compare", "stop", "stop", "--relative", "-1")
    assert (refused.returncode, refused.stderr) == (
        2,
        "hubsim: --relative -1.0: accepted: a number from 0\n",
    )
