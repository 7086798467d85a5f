# SPDX-License-Identifier: Apache-2.0
"""Motor and hydraulic brake together make the demand, whatever the hydraulic brake's gain.

With measured hydraulic torque: 3 % rms and 10 % peak, from dead time plus 2.5 lags plus 50 ms after
a step of the demand.
"""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hubsim.scenario import Scenario
from hubsim.sweep.drives import DRIVES, drive_named
from studies.total_torque import runs, study
from studies.total_torque.study import START_SHARES, STOP, Case, Outcome

# Share of the rated torque, gain and lateness of the hydraulic brake.
STOPS = ((1.0, 0.8, 1.0), (1.0, 1.2, 1.0), (4.0, 1.2, 1.0), (2.0, 0.8, 0.5), (4.0, 0.8, 0.5))


@pytest.mark.parametrize("name", DRIVES)
def test_sum_of_both_brakes_is_the_demand_in_stops_with_a_weak_and_with_a_strong_brake(
    name: str,
) -> None:
    for start, (share, gain, lateness) in itertools.product(START_SHARES, STOPS):
        found = study.measure(0, Case(name, STOP, start, share, gain, lateness, 1))
        assert found.counted_s > 0.5
        assert found.within, found


def test_a_run_is_within_by_rms_and_peak_with_reports_and_by_its_faults_without() -> None:
    good = Outcome(0, "lu2013", STOP, 0.5, 1.0, 1.0, 1.0, 1, 0.02, 0.09, 2.0, "")
    assert good.within
    for bad in (replace(good, rms=0.04), replace(good, peak=0.11)):
        assert not bad.within
        assert replace(bad, reports=0).within
    assert not replace(good, reports=0, first_fault="OVERCURRENT").within


def test_without_a_hydraulic_brake_the_sum_is_short() -> None:
    drive = drive_named("lu2013")
    stop = Scenario(initial_speed_kmh=20.0, demand_nm=80.0, stop_at_standstill=True)
    dead = runs.simulate(drive, stop, {"brake.torque_loss": 1.0})
    assert dead.rms > 0.3


def test_a_step_of_the_demand_is_counted_when_the_window_is_over() -> None:
    demand = np.array([0.0, 0.0, 10.0, 10.0, 10.0, 10.5, 10.5])
    assert runs.settled(demand, 2).tolist() == [True, True, False, False, True, True, True]
