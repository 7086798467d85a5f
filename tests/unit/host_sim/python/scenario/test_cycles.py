# SPDX-License-Identifier: Apache-2.0
import itertools
from pathlib import Path

import pytest
from hubsim.errors import HubsimError
from hubsim.scenario import cycles


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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,speed\n0,0\n1,1\n", ":1: header 'time,speed', accepted: time_s,speed_km_h"),
        (
            "time_s,speed_km_h\n0,0\n2,1\n2,2\n",
            ":4: time_s 2, accepted: 0 in the first line, then rising",
        ),
        (
            "time_s,speed_km_h\n1,0\n2,1\n",
            ":2: time_s 1, accepted: 0 in the first line, then rising",
        ),
        (
            "time_s,speed_km_h\n0,0\n1,fast\n",
            ":3: '1,fast', accepted: two numbers, time_s and speed_km_h",
        ),
        (
            "time_s,speed_km_h\n0,0\n1,2,3\n",
            ":3: '1,2,3', accepted: two numbers, time_s and speed_km_h",
        ),
        ("time_s,speed_km_h\n0,0\n1,-3\n", ":3: speed_km_h -3 at 1 s, accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\n1,nan\n", ":3: speed_km_h nan at 1 s, accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\n", ": 1 points, accepted: at least two"),
        ("", ": 0 points, accepted: at least two"),
    ],
)
def test_an_error_in_a_file_is_one_line_with_its_position(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(HubsimError) as caught:
        cycles.read(path)
    assert str(caught.value) == f"{path}{message}"


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
