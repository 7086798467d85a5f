# SPDX-License-Identifier: Apache-2.0
import itertools
import math
from pathlib import Path

import pytest
from hubsim import run
from hubsim.errors import HubsimError
from hubsim.scenario import Scenario, cycles
from regen_table.schema import Drive


def seconds_by_slope(cycle: cycles.Cycle) -> dict[str, float]:
    out = {"stand": 0.0, "up": 0.0, "level": 0.0, "down": 0.0}
    for (t0, v0), (t1, v1) in itertools.pairwise(zip(cycle.time_s, cycle.speed_kmh, strict=True)):
        kind = "up" if v1 > v0 else "down" if v1 < v0 else "level" if v0 > 0.0 else "stand"
        out[kind] += t1 - t0
    return out


def test_ece15_has_the_phases_of_the_regulation() -> None:
    # Idling 60 s, accelerations 36 s, steady speed 57 s, decelerations 25 + 9 s (clutch), gear
    # changes 8 s; of the latter 6 s lie at level speed and 2 s in the last deceleration.
    assert seconds_by_slope(cycles.load("ece15")) == {
        "stand": 60.0,
        "up": 36.0,
        "level": 57.0 + 6.0,
        "down": 25.0 + 9.0 + 2.0,
    }


def test_ece15_has_duration_and_distance_of_the_regulation() -> None:
    cycle = cycles.load("ece15")
    assert cycle.duration_s == 195.0
    assert cycle.distance_m == pytest.approx(1013.0, rel=2e-3)
    assert max(cycle.speed_kmh) == 50.0


def test_udds_has_the_published_duration_distance_and_peak_speed() -> None:
    cycle = cycles.load("udds")
    assert cycle.duration_s == 1369.0
    assert cycle.distance_m == pytest.approx(7.45 * 1609.344, rel=1e-3)  # EPA: 7.45 miles
    assert max(cycle.speed_kmh) == pytest.approx(56.7 * 1.609344, abs=1e-3)  # EPA: 56.7 mi/h
    steps = {b - a for a, b in itertools.pairwise(cycle.time_s)}
    assert steps == {1.0}


def test_a_repeated_cycle_has_a_multiple_of_the_length() -> None:
    once = cycles.load("ece15")
    thrice = once.repeated(3)
    assert thrice.duration_s == 3 * once.duration_s
    assert thrice.distance_m == pytest.approx(3 * once.distance_m)
    assert all(b > a for a, b in itertools.pairwise(thrice.time_s))


def test_a_cycle_that_ends_at_speed_repeats_without_a_gap_in_time() -> None:
    ramp = cycles.Cycle("ramp", (0.0, 10.0), (0.0, 30.0)).repeated(2)
    assert all(b > a for a, b in itertools.pairwise(ramp.time_s))
    assert ramp.speed_kmh == (0.0, 30.0, 0.0, 30.0)


def test_a_cycle_file_in_the_directory_of_the_scenario_is_found(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text(
        "# made up\ntime_s,speed_km_h\n0,0\n5,10\n", encoding="utf-8"
    )
    assert cycles.load("mine.csv", tmp_path).distance_m == pytest.approx(5 * 5 / 3.6)


def test_a_cycle_with_a_grade_repeats_it() -> None:
    hill = cycles.Cycle("hill", (0.0, 5.0, 10.0), (10.0, 10.0, 10.0), (0.0, 0.05, 0.0)).repeated(2)
    assert hill.time_s == (0.0, 5.0, 10.0, 15.0, 20.0)
    assert hill.slope == (0.0, 0.05, 0.0, 0.05, 0.0)


def test_the_vehicle_climbs_the_grade_of_a_cycle(tmp_path: Path, drive: Drive) -> None:
    """At a steady 18 km/h up 4 %, with another 1 % of the scenario's own road."""
    (tmp_path / "hill.csv").write_text(
        "time_s,speed_mph,grade_percent\n0,11.18468,0\n2,11.18468,4\n6,11.18468,4\n",
        encoding="utf-8",
    )
    hill = Scenario(
        cycle="hill.csv", initial_speed_kmh=18.0, slope_percent=1.0, record_interval_s=0.1
    )
    result = run.simulate("hill", drive, hill, tmp_path, ["time_s", "vehicle.height_m"])
    sines = [math.sin(math.atan(percent / 100.0)) for percent in (1.0, 3.0, 5.0)]
    rise_m = 5.0 * (2.0 * sines[1] + 4.0 * sines[2])
    assert result.signal("vehicle.height_m")[-1] == pytest.approx(rise_m, rel=0.02)


def test_an_error_in_a_file_is_one_line_with_its_position(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("time_s,speed_km_h\n0,0\n1,-3\n", encoding="utf-8")
    with pytest.raises(HubsimError) as caught:
        cycles.read(path)
    assert str(caught.value) == f"{path}:3: speed '-3', accepted: 0 to 400 km/h"


def test_a_missing_or_binary_file_is_an_error_in_one_line(tmp_path: Path) -> None:
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(HubsimError, match="not UTF-8 text"):
        cycles.read(binary)
    with pytest.raises(HubsimError, match="file not found"):
        cycles.load("none.csv", tmp_path)
    with pytest.raises(
        HubsimError, match=r"no cycle 'wltp', accepted: ece15, udds or a \.csv file"
    ):
        cycles.load("wltp")
