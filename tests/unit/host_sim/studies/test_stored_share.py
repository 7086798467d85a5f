# SPDX-License-Identifier: Apache-2.0
"""Stops over the whole range of battery, demand, speed and temperature, beside the ideal."""

from hubsim.sweep import cases, drives, stored_share
from hubsim.sweep.stored_share import RIPPLE_MAX, TOLERANCE

COUNT, SEED = 20, 2
MOST_ABOVE = TOLERANCE  # the ideal, slow stops included


def test_a_stop_stores_what_the_limits_allow() -> None:
    drawn = stored_share.draw(drives.DRIVES, COUNT, SEED)
    measured = cases.measured(stored_share.measure, drawn, workers=1)
    found = [outcome for outcome in measured if outcome.comparable]
    assert len(found) >= COUNT - 2
    assert {outcome.drive for outcome in found} == set(drives.DRIVES)
    assert [outcome for outcome in found if not outcome.within] == []
    assert [outcome for outcome in found if outcome.difference > MOST_ABOVE] == []
    assert [outcome for outcome in found if outcome.ripple_share_of_rated > RIPPLE_MAX] == []
