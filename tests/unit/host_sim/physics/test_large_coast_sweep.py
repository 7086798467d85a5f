# SPDX-License-Identifier: Apache-2.0
"""All the cases of host_sim/coast once more, as the firmware is now."""

from pathlib import Path

from coast_bounds import misses
from hubsim import cases, coast
from hubsim.engine import ROOT

TABLE: Path = ROOT / "host_sim" / "coast" / "coast.csv"


def test_two_thousand_vehicles_are_let_go() -> None:
    recorded = cases.read_csv(coast.Outcome, TABLE.read_text(encoding="utf-8"))
    found = cases.measured(coast.measure, coast.draw(coast.DRIVES, len(recorded), 1))
    assert misses(found) == []
    better = sum(outcome.within for outcome in found)
    assert better >= sum(outcome.within for outcome in recorded) - 10
