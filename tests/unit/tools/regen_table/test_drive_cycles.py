# SPDX-License-Identifier: Apache-2.0
"""Drive cycles in the shapes in which they are published."""

import math
from pathlib import Path

import numpy as np
import pytest
from regen_table import drive_cycles, ideal_cycles, schema
from regen_table.errors import ConfigurationError

PAPER = Path(__file__).resolve().parents[4] / "tools" / "motors" / "lu2013.toml"


def read(folder: Path, text: str) -> drive_cycles.DriveCycle:
    path = folder / "cycle.csv"
    path.write_text(text, encoding="utf-8")
    return drive_cycles.read(path)


@pytest.mark.parametrize(
    "text",
    [
        "# where from\ntime_s,speed_km_h\n0,0\n2,36\n",
        "Time [s];Vehicle speed [km/h];Acceleration [m/s2]\n0;0,0;5,0\n2;36,0;5,0\n",
        "Total elapsed time (s),WLTC class 3 vehicle speed (km/h)\n11,0\n13,36\n",
        "Time,Speed (m/s)\n0,0\n2,10\n",
        "cycSecs,cycMps\n0,0\n2,10\n",
        "cycSecs,cycMps,cycRoadType\n0,0,0\n2,10,0\n",
        "EPA schedule\nTest Time, secs\tTarget Speed, mph\n0\t0\n2\t22.3693629\n",
        "time_min,v_kmh\n0,0\n0.0333333333333,36\n",
        "time_s,speed_m_per_s\n0,0\n2,10\n",
        "t_s , gear , speed_kph\n0,1,0\n2,2,36\n",
    ],
)
def test_a_cycle_is_read_in_the_units_of_its_heading(tmp_path: Path, text: str) -> None:
    """From 0 to 10 m/s in 2 s, however it is written."""
    found = read(tmp_path, text)
    assert found.time_s == pytest.approx((0.0, 2.0))
    assert found.speed_kmh == pytest.approx((0.0, 36.0))
    assert found.slope == ()


@pytest.mark.parametrize(
    ("column", "cell"),
    [
        ("grade_percent", "5"),
        ("Road grade [%]", "5"),
        ("slope_deg", repr(math.degrees(math.atan(0.05)))),
        ("grade_rad", repr(math.atan(0.05))),
        ("slope (m/m)", "0.05"),
        ("grade_1", "0.05"),
    ],
)
def test_the_grade_is_read_in_the_unit_of_its_heading(
    tmp_path: Path, column: str, cell: str
) -> None:
    found = read(tmp_path, f"time_s,speed_km_h,{column}\n0,0,0\n1,5,{cell}\n")
    assert found.slope == pytest.approx((0.0, 0.05))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,speed\n0,0\n1,1\n", ":1: 'speed' has no unit, accepted: speed_km_h, speed_mph or"),
        ("time_s,speed_mph,grade\n0,0,0\n1,1,1\n", ":1: 'grade' has no unit, accepted: grade_perc"),
        (
            "time_s,speed_mph,speed_mps\n0,0,0\n",
            ":1: 'speed_mph' and 'speed_mps', accepted: one column of speed",
        ),
        ("0,0\n1,5\n", ": no heading with time and speed, accepted: a heading as in time_s,speed"),
        ("", ": no heading with time and speed, accepted: a heading as in time_s,speed_km_h"),
        ("time_s,speed_km_h\n0,0\n2,1\n2,2\n", ":4: time 2 s, accepted: rising"),
        ("time_s,speed_km_h\n0,0\n1,fast\n", ":3: speed 'fast', accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\n1\n", ":3: speed '', accepted: 0 to 400 km/h"),
        ("time_s,speed_mph\n0,0\n1,300\n", ":3: speed '300', accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\n1,-3\n", ":3: speed '-3', accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\n1,nan\n", ":3: speed 'nan', accepted: 0 to 400 km/h"),
        ("time_s,speed_km_h\n0,0\ninf,5\n", ":3: time 'inf', accepted: a number"),
        ("time_s,speed_km_h\n0,0\n", ": fewer than two points, accepted: at least two"),
    ],
)
def test_what_cannot_be_read_is_one_line_with_its_place(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        read(tmp_path, text)
    assert str(caught.value).startswith(f"{tmp_path / 'cycle.csv'}{message}")
    assert "\n" not in str(caught.value)


def test_a_grade_is_climbed_in_the_ideal_cycle(tmp_path: Path) -> None:
    """Up 5 % and down again at constant speed: m g h each way, and the accounts still close."""
    drive = schema.load(PAPER)
    text = "time_s,speed_km_h,grade_percent\n0,20,0\n1,20,5\n61,20,5\n62,20,0\n"
    path = tmp_path / "hill.csv"
    path.write_text(text, encoding="utf-8")
    up = ideal_cycles.run(drive, ideal_cycles.load(path), "series_optimal", 25.0)
    rise_m = 20.0 / 3.6 * (60.0 + 2 * 0.5) * math.sin(math.atan(0.05))
    climbed_j = drive.vehicle.mass_kg * 9.80665 * rise_m
    assert up.energy_j.climbed == pytest.approx(climbed_j, rel=1e-3)
    assert up.residual_relative == pytest.approx(0.0, abs=1e-9)
    path.write_text(text.replace(",5\n", ",-5\n"), encoding="utf-8")
    down = ideal_cycles.run(drive, ideal_cycles.load(path), "series_optimal", 25.0)
    assert down.energy_j.climbed == pytest.approx(-climbed_j, rel=1e-3)
    assert down.energy_j.battery_returned > 0.5 * climbed_j
    path.write_text(text.replace(",grade_percent", ",gear"), encoding="utf-8")
    flat = ideal_cycles.run(drive, ideal_cycles.load(path), "series_optimal", 25.0)
    assert flat.energy_j.climbed == 0.0
    assert np.all(ideal_cycles.load(path).slope == 0.0)
