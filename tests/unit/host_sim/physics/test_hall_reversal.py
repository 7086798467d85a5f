# SPDX-License-Identifier: Apache-2.0
"""A wheel that rolls back and turns round under driving torque, with hall sensors."""

import hubsim
import numpy as np
import pytest
from hubsim.engine import ROOT

# Configuration, demand in N m, slope in %: it rolls back for half a second, then turns round.
CASES = (("lu2013", 38.0, 6.5), ("lu2013", 20.0, 3.0), ("scooter48v", 19.0, 9.5))
RATE_NM_PER_S = {"lu2013": 400.0, "scooter48v": 80.0}
TURNS = (0.0, 0.25, 0.5, 0.75)  # mechanical, where the wheel stands
EDGE_ERROR_DEG = 3.0  # of the sensors, and an edge seen a period late
MOST_BELOW_ROWS = 5  # the current follows an edge


@pytest.mark.parametrize(("name", "demand_nm", "slope_percent"), CASES)
def test_torque_is_never_less_than_at_a_start_from_standstill(
    name: str, demand_nm: float, slope_percent: float
) -> None:
    least = np.cos(np.radians(30.0 + EDGE_ERROR_DEG))
    for turn in TURNS:
        with hubsim.Bench(
            hubsim.load_configuration(ROOT / "tools" / "motors" / f"{name}.toml"),
            record=("time_s", "wheel0.motor_torque_nm", "wheel0.command_nm"),
            record_interval_s=0.001,
            slope_percent=slope_percent,
            drive_trace_nm=[
                [0.0, 0.0],
                [0.5, 0.0],
                [0.501, demand_nm],
                [3.0, demand_nm],
            ],
            max_duration_s=3.0,
            plant={"run.rotor_turn": turn},
        ) as bench:
            rows = bench.run()
        begun_s = 0.6 + demand_nm / RATE_NM_PER_S[name]
        driven = (rows["time_s"] > begun_s) & (rows["wheel0.command_nm"] > 0.9 * demand_nm)
        share = rows["wheel0.motor_torque_nm"][driven] / rows["wheel0.command_nm"][driven]
        assert np.sum(share < least) <= MOST_BELOW_ROWS, turn
        assert np.min(share) > 0.75, turn
