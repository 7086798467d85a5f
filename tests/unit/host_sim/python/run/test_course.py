# SPDX-License-Identifier: Apache-2.0
"""What a run says besides energies: limits, modes, warnings, and physics that was left out."""

import json
from pathlib import Path

import numpy as np
import pytest
from hubsim import run, scenario
from hubsim.run import course
from hubsim_command import Hubsim
from regen_table.schema import Drive

OWN = """
initial_speed_kmh = 30.0
demand_nm = 60.0
stop_at_standstill = true
winding_temperature_c = 60.0
"""


def test_limits_have_the_share_of_the_recorded_times_and_findings_their_first_time(
    drive: Drive,
) -> None:
    name, chosen, beside = scenario.load("winding_sensor_open", {})
    result = run.simulate(name, drive, chosen, beside, course.SIGNALS)
    seen = course.observed(result, chosen)
    codes = np.stack([result.signal(f"wheel{k}.reason") for k in range(4)])
    assert seen["limits"]["WINDING_TEMPERATURE"] == pytest.approx(
        np.mean(np.any(codes == 9, axis=0))  # X(9, WINDING_TEMPERATURE) of core/reason.h
    )
    assert list(seen["limits"].values()) == sorted(seen["limits"].values(), reverse=True)
    assert "NONE" not in seen["limits"]
    (finding,) = seen["findings"]
    assert finding["reason"] == "WINDING_SENSOR"
    (broken_s,) = (event.at_s for event in chosen.events.values())
    assert broken_s <= finding["first_s"] < broken_s + 0.1
    assert finding["wheels"] == [0, 1, 2, 3]
    assert seen["modes"] == {"RUN": 1.0}
    assert "WINDING_SENSOR from 3.020 s on wheels 0, 1, 2, 3" in course.lines(seen)


def test_modes_other_than_healthy_are_named() -> None:
    seen = {"limits": {}, "modes": {"RUN": 0.7, "LIMP": 0.3}, "findings": [], "left_out": []}
    assert course.lines(seen) == [
        "limits of the motor torque, share of the time: none",
        "modes other than healthy, share of the time: LIMP 30 %",
    ]


def test_a_scenario_of_ones_own_heats_and_one_that_leaves_physics_out_says_so(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    (tmp_path / "mine.toml").write_text(OWN, encoding="utf-8")
    signals = ("--csv", "mine.csv", "--signals", "time_s,wheel0.winding_temperature_c")
    warm = hubsim("run", "mine.toml", *signals, "--json", "mine.json")
    assert warm.returncode == 0, warm.stderr
    assert "left out" not in warm.stdout
    temperature_c = np.loadtxt(tmp_path / "mine.csv", delimiter=",", skiprows=1)[:, 1]
    assert temperature_c[-1] > temperature_c[0] + 0.5
    assert json.loads((tmp_path / "mine.json").read_text())["observed"]["left_out"] == []

    off = ("--set", "plant.thermal.active=0", "--set", "drag=false", "--set", "noise=false")
    cold = hubsim("run", "mine.toml", *off, *signals, "--json", "mine.json")
    temperature_c = np.loadtxt(tmp_path / "mine.csv", delimiter=",", skiprows=1)[:, 1]
    assert temperature_c[-1] == temperature_c[0]
    left = json.loads((tmp_path / "mine.json").read_text())["observed"]["left_out"]
    assert [what.partition(" (")[0] for what in left] == [
        "heat", "air drag and rolling resistance", "noise of the sensors",
    ]  # fmt: skip
    assert f"left out: {', '.join(left)}" in cold.stdout
