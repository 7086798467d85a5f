# SPDX-License-Identifier: Apache-2.0
"""No healthy hydraulic brake is named wrong by the deceleration.

Gain 0.8 to 1.2, delay and lag 0.5 to 2 times, or mass 0.88 to 1.15 and air drag 0.85 to 1.15 times
what the controller is told (with a mass of 0.85 one ride of scooter48v is named). All of these at
once: the study.
"""

from dataclasses import replace

import pytest
from studies.healthy_brakes import study as healthy_brakes
from studies.healthy_brakes.study import VEHICLES, Ride, named

RIDE = Ride("lu2013", "hall", 0.6, 0.5, 2.8, 2.5, 5.0, 1.5)
BRAKES = ((0.8, 0.5), (0.8, 2.0), (1.2, 0.5), (1.2, 2.0))
LOADS = ((0.88, 1.15), (1.15, 0.85), (0.88, 0.85), (1.15, 1.15))


@pytest.mark.parametrize(("drive", "sensor"), VEHICLES)
def test_no_gain_or_delay_within_the_band_is_named_wrong(drive: str, sensor: str) -> None:
    ride = replace(RIDE, drive=drive, rotor_sensor=sensor)
    for gain, lateness in BRAKES:
        assert named(replace(ride, gain=gain, lateness=lateness)) == "", (gain, lateness)


@pytest.mark.parametrize(("drive", "sensor"), VEHICLES)
def test_no_load_within_the_band_is_named_a_wrong_brake(drive: str, sensor: str) -> None:
    ride = replace(RIDE, drive=drive, rotor_sensor=sensor)
    for mass, drag in LOADS:
        assert named(replace(ride, mass=mass, drag=drag)) == "", (mass, drag)


def test_a_brake_of_half_its_gain_is_named_weak() -> None:
    assert named(replace(RIDE, gain=0.5)) == "HYDRAULIC_WEAK"


def test_the_same_seed_draws_the_same_rides_within_their_bands() -> None:
    rides = list(healthy_brakes.drawn(20, 3))
    assert rides == list(healthy_brakes.drawn(20, 3))
    assert all(0.8 <= ride.gain <= 1.2 and 0.85 <= ride.mass <= 1.15 for ride in rides)
    assert {(ride.drive, ride.rotor_sensor) for ride in rides} == set(VEHICLES)


def test_few_enough_named_rides_are_accepted_and_a_step_without_reports_is_not_counted() -> None:
    plain = [healthy_brakes.measure(k, RIDE) for k in range(2)]
    assert [o.finding for o in plain] == ["", ""]
    wrong = replace(plain[0], finding="HYDRAULIC_WEAK")
    assert healthy_brakes.holds(plain)
    assert healthy_brakes.holds([*plain * 6, wrong])  # 1 of 13
    assert not healthy_brakes.holds([*plain * 5, wrong])  # 1 of 11
    assert healthy_brakes.holds([*plain, replace(wrong, step=0.03)])
    assert not healthy_brakes.holds([*plain, replace(wrong, step=0.03, reports=1)])
