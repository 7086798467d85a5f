# SPDX-License-Identifier: Apache-2.0
"""Healthy rides: each is the same wherever it is asked for, within its tolerances, and judged."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hubsim import reasons
from hubsim.run import STRATEGIES, plant
from hubsim.swarm import vehicles
from hubsim.swarm.vehicles import BRAKE, COAST, DRIVE, HOLD, REVERSE, Phase
from hubsim.sweep.drives import DRIVES
from studies.healthy import drawn as rides_drawn
from studies.healthy import rides, study
from studies.healthy.drawn import Ride, draw

MANY = 240


@pytest.fixture(scope="module")
def drawn() -> list[Ride]:
    return [draw(1, number) for number in range(MANY)]


def test_a_ride_depends_on_seed_and_number_alone(drawn: list[Ride]) -> None:
    assert [draw(1, number) for number in (171, 7, 32)] == [drawn[k] for k in (171, 7, 32)]
    assert draw(2, 7) != drawn[7]


def test_all_drives_sensors_beginnings_strategies_and_things_to_do_come(
    drawn: list[Ride],
) -> None:
    pairs = {(ride.drive, ride.sensor) for ride in drawn}
    assert pairs == {(d, s) for d in DRIVES for s in rides_drawn.SENSORS[d]}
    assert {ride.begins for ride in drawn} == {
        vehicles.PREPARED,
        vehicles.STANDING,
        vehicles.ROLLING,
    }
    assert {ride.strategy for ride in drawn} == set(STRATEGIES)
    done = {phase.kind for ride in drawn for phase in ride.phases}
    assert done == {HOLD, DRIVE, COAST, BRAKE, REVERSE}
    assert {ride.reports for ride in drawn} == {0, 1}
    assert {ride.soc for ride in drawn} > {0.0, 1.0}


def test_every_part_is_within_its_tolerance_and_uses_it(drawn: list[Ride]) -> None:
    shares: dict[str, list[float]] = {name: [] for name in vehicles.FACTORS}
    for ride in drawn:
        drive = rides_drawn.drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
        nominal = plant.parameters(drive)
        for name, (low, high) in vehicles.FACTORS.items():
            if nominal[name] and name != "motor.friction_torque_nm":  # which adds some
                shares[name].append((ride.plant[name] / nominal[name] - low) / (high - low))
    for name, found in shares.items():
        if found:
            assert -1e-5 <= min(found) < 0.1, name
            assert 0.9 < max(found) <= 1.0 + 1e-5, name


def test_a_slope_leaves_the_motor_torque_and_a_brake_the_road_its_grip(
    drawn: list[Ride],
) -> None:
    for ride in drawn:
        drive = rides_drawn.drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
        inertia = ride.plant["vehicle.mass_kg"] / drive.vehicle.driven_wheels
        inertia *= ride.plant["vehicle.wheel_radius_m"]
        for phase in ride.phases:
            pull = inertia * plant.STANDARD_GRAVITY_M_PER_S2 * abs(phase.slope)
            assert pull <= vehicles.PULL_SHARE * drive.motor.rated_torque_nm * (1.0 + 1e-6)
            if phase.kind == BRAKE:
                assert 0.0 < phase.torque_nm <= vehicles.HARDEST_M_PER_S2 * inertia
            if phase.kind in (DRIVE, REVERSE):
                assert 0.0 < phase.torque_nm <= drive.motor.max_torque_nm * (1.0 + 1e-9)


def test_a_hold_overcomes_every_slope_in_every_wind(drawn: list[Ride]) -> None:
    """As the plant has it, air and wind from behind or ahead; rolling resistance only helps."""
    holding = [ride for ride in drawn if ride.hold]
    assert {ride.drive for ride in holding} == set(DRIVES)
    for ride in holding:
        drive = rides_drawn.drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
        world, wheels = ride.plant, drive.vehicle.driven_wheels
        area_m2 = world["vehicle.frontal_area_m2"] * drive.vehicle.drag_coefficient
        air_n = 0.5 * plant.STANDARD_AIR_KG_PER_M3 * area_m2 * world["road.wind_m_per_s"] ** 2
        steepest = max(abs(phase.slope) for phase in ride.phases)
        road_n = world["vehicle.mass_kg"] * plant.STANDARD_GRAVITY_M_PER_S2 * steepest
        pull = (air_n + road_n) * world["vehicle.wheel_radius_m"] / wheels
        hold = drive.driver.hold_torque_nm or 0.0
        assert pull <= hold * (1.0 - world["brake.torque_loss"])
        assert hold <= drive.brake.max_hydraulic_torque_nm


def test_an_encoder_never_boots_at_rest(drawn: list[Ride]) -> None:
    assert all(ride.begins != vehicles.STANDING for ride in drawn if ride.sensor == "encoder")


def plain(number: int, phases: tuple[Phase, ...], **world: float) -> Ride:
    ride = draw(1, number)
    return replace(ride, phases=phases, plant={**ride.plant, "fault.can_delay_s": 0.0, **world})


DRIVES_AND_STOPS = (
    Phase(HOLD, 1.0, 0.0, 20.0),
    Phase(DRIVE, 4.0, 0.5, 20.0),
    Phase(BRAKE, 10.0, 0.0, 30.0),
)


def standing_lu2013() -> int:
    return next(
        number
        for number in range(0, 400, 12)
        if draw(1, number).begins == vehicles.STANDING and 0.2 < draw(1, number).soc < 0.9
    )


def test_a_ride_without_a_fault_has_no_warning_and_a_planted_one_is_reported(
    tmp_path: Path,
) -> None:
    number = standing_lu2013()
    good = study.measure(0, plain(number, DRIVES_AND_STOPS))
    assert (good.warnings, good.stops) == ("", 1)
    assert good.within
    broken = plain(number, DRIVES_AND_STOPS, **{"winding_sensor.open": 1.0})
    found = study.measure(1, broken)
    assert [name for name, _ in found.named] == ["WINDING_SENSOR"]
    assert not found.within
    hall = plain(number, DRIVES_AND_STOPS, **{"sensors.hall_stuck_low": 1.0})
    limps = study.measure(2, hall)
    assert limps.named[0][0] == "ROTOR_UNCERTAIN"
    assert limps.named[0][1] == pytest.approx(limps.limp_s, abs=0.1)
    assert not study.STUDY.holds([good, limps])
    assert study.more([good, found, limps]) == {
        "rides": 3,
        "warnings": [
            {"ride": number, "reason": name, "time_s": time_s}
            for o in (found, limps)
            for name, time_s in o.named
        ],
        "limp": 1,
    }
    assert json.loads(json.dumps(study.more([found])))["warnings"][0]["ride"] == number


def test_the_first_time_of_each_reason_counts_and_that_of_limp() -> None:
    low, high = (reasons.codes()[name] for name in ("ROTOR_UNCERTAIN", "BUS_OVERVOLTAGE"))
    columns = len(rides.SIGNALS)
    rows = np.zeros((6, columns))
    rows[:, rides.TIME] = np.arange(6) * 0.001
    rows[2:4, rides.WARNING] = low
    rows[3:5, rides.FAULT] = high
    assert rides.shown(rows, 0) == [
        ("ROTOR_UNCERTAIN", 0.002),
        ("BUS_OVERVOLTAGE", 0.003),
    ]
    assert rides.shown(rows[:2], high) == [("BUS_OVERVOLTAGE", 0.0)]
    assert math.isnan(rides.limp_s(rows))


def test_a_vehicle_that_does_not_start_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    ride = plain(8, DRIVES_AND_STOPS, **{"sensors.hall_stuck_high": 7.0})
    dead = replace(ride, begins=vehicles.PREPARED, sensor="hall")
    assert study.measure(0, dead).named == [(study.NOT_STARTED, 0.0)]


@pytest.mark.parametrize("text", ["7", "5:5", "9:3", "-1:4", "a:b"])
def test_a_range_of_rides_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(SystemExit):
        study.main(["--rides", text])


def test_some_rides_are_those_of_all() -> None:
    options = study.some("30:33")
    assert list(options) == [30, 31, 32]
    short = (Phase(HOLD, 0.1),)
    outcomes = [study.measure(k, replace(draw(1, n), phases=short)) for k, n in enumerate(options)]
    assert [o.number for o in outcomes] == [30, 31, 32]


def test_json_has_rides_warnings_and_limp(tmp_path: Path) -> None:
    place = ["--workers", "1", "-o", str(tmp_path), "--json", str(tmp_path / "all.json")]
    assert study.main(["--rides", "8:9", *place]) == 0
    found = json.loads((tmp_path / "all.json").read_text(encoding="utf-8"))
    assert (found["rides"], found["warnings"], found["limp"]) == (1, [], 0)
    assert [run["number"] for run in found["runs"]] == [8]
