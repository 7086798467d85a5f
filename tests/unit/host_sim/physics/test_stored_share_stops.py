# SPDX-License-Identifier: Apache-2.0
"""Stops over the whole range of battery, demand, speed and temperature, beside the ideal.

Forty of them here; the thousand of test_large_stop_sweep.py are in host_sim/stored_share.
"""

from hubsim import cases, stored_share
from stop_bounds import compared, misses

COUNT, SEED = 40, 2


def test_a_stop_stores_what_the_limits_allow() -> None:
    drawn = stored_share.draw(stored_share.DRIVES, COUNT, SEED)
    found = compared(cases.measured(stored_share.measure, drawn, processes=1))
    assert len(found) >= COUNT - 4
    assert {outcome.drive for outcome in found} == set(stored_share.DRIVES)
    assert misses(found) == []
    assert all(outcome.within for outcome in found)
