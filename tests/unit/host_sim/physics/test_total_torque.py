# SPDX-License-Identifier: Apache-2.0
"""Motor and hydraulic brake together make the demand, whatever the hydraulic brake's gain.

With measured hydraulic torque: 3 % rms and 10 % peak, from dead time plus 2.5 lags plus 50 ms after
a step of the demand. The figures of all gains, delays and cycles: firmware/torque/README.md.
"""

import itertools

import numpy as np
import pytest
from hubsim import total_torque
from hubsim.scenario import Scenario
from hubsim.stored_share import DRIVES, drive_named
from hubsim.total_torque import FEEDBACK, weak_and_late

RMS, PEAK = 0.03, 0.1
STARTS = (0.5, 0.66)  # of the largest speed
# Share of the rated torque, gain and lateness of the hydraulic brake.
STOPS = ((1.0, 0.8, 1.0), (1.0, 1.2, 1.0), (4.0, 1.2, 1.0), (2.0, 0.8, 0.5), (4.0, 0.8, 0.5))


@pytest.mark.parametrize("name", DRIVES)
def test_sum_of_both_brakes_is_the_demand_in_stops_with_a_weak_and_with_a_strong_brake(
    name: str,
) -> None:
    drive = drive_named(name)
    top_kmh = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    for start, (share, gain, lateness) in itertools.product(STARTS, STOPS):
        stop = Scenario(
            initial_speed_kmh=start * top_kmh,
            demand_nm=share * drive.motor.rated_torque_nm,
            stop_at_standstill=True,
            max_duration_s=60.0,
        )
        brake = weak_and_late(drive, gain, lateness)
        found = total_torque.simulate(drive, stop, FEEDBACK | brake)
        assert found.fault == 0.0
        assert found.counted_s > 0.5
        assert found.rms <= RMS, (start, share, gain, lateness)
        assert found.peak <= PEAK, (start, share, gain, lateness)


def test_without_a_hydraulic_brake_the_sum_is_short() -> None:
    drive = drive_named("lu2013")
    stop = Scenario(initial_speed_kmh=20.0, demand_nm=80.0, stop_at_standstill=True)
    dead = total_torque.simulate(drive, stop, {"brake.torque_loss": 1.0})
    assert dead.rms > 0.3


def test_a_step_of_the_demand_is_counted_when_the_window_is_over() -> None:
    demand = np.array([0.0, 0.0, 10.0, 10.0, 10.0, 10.5, 10.5])
    assert total_torque.settled(demand, 2).tolist() == [True, True, False, False, True, True, True]
