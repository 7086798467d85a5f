# SPDX-License-Identifier: Apache-2.0
"""What the optimum is worth: simulated stops beside ideal ones, and the study's verdict."""

from dataclasses import replace

import pytest
from regen_table import STOP_LIMITS, limited_stop
from studies.worth import study as worth
from studies.worth.study import Case


@pytest.mark.parametrize(("name", "share"), [("lu2013", 1.0), ("ebike36v", 0.5), ("m365", 0.5)])
def test_stored_shares_are_those_of_ideal_stops_inside_the_same_limits(
    name: str, share: float
) -> None:
    """Within two points of the kinetic energy: blend-out, delays and the torque's rate."""
    found = worth.measure(0, Case(name, 1, share))
    for strategy, stored in (
        ("parallel_free_travel", found.motor_first),
        ("series_optimal", found.series),
    ):
        drive = worth.vehicle(name, strategy)
        ideal = limited_stop.stop(
            drive,
            strategy,
            share * drive.motor.max_torque_nm,
            found.initial_speed_kmh,
            found.winding_temperature_c,
            None,
            STOP_LIMITS,
        )
        assert stored == pytest.approx(ideal.stored_share_of_kinetic, abs=0.02)
    assert found.gain >= -worth.TOLERANCE


def test_every_stop_of_every_vehicle_is_measured_cold_and_hot() -> None:
    cases = worth.drawn(worth.VEHICLES)
    assert len(set(cases)) == len(cases) == 10 * 2 * len(worth.DEMANDS)


def test_a_brake_is_given_to_a_vehicle_that_commands_none() -> None:
    assert worth.vehicle("m365", "series_optimal").brake.max_hydraulic_torque_nm == 3.0 * 16.0
    assert worth.vehicle("lu2013", "series_optimal").brake.max_hydraulic_torque_nm == 300.0


def test_a_series_brake_that_stores_less_is_no_good_study() -> None:
    good = worth.STUDY.stored()
    assert worth.STUDY.holds(good)
    assert not worth.STUDY.holds([*good, replace(good[0], series=good[0].motor_first - 0.01)])
