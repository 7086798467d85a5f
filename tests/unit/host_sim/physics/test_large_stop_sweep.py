# SPDX-License-Identifier: Apache-2.0
"""All the stops of host_sim/stored_share once more, as the firmware is now."""

from pathlib import Path

from hubsim import cases, stored_share
from hubsim.engine import ROOT
from stop_bounds import compared, misses

TABLE: Path = ROOT / "host_sim" / "stored_share" / "stops.csv"


def test_a_thousand_stops_store_what_the_limits_allow() -> None:
    recorded = cases.read_csv(stored_share.Outcome, TABLE.read_text(encoding="utf-8"))
    drawn = stored_share.draw(stored_share.DRIVES, len(recorded), 1)
    found = cases.measured(stored_share.measure, drawn)
    assert misses(compared(found)) == []
    better = sum(outcome.within for outcome in found)
    assert better >= sum(outcome.within for outcome in recorded) - 3
