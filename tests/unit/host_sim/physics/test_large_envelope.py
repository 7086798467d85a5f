# SPDX-License-Identifier: Apache-2.0
"""All the runs of host_sim/envelope once more, as the firmware is now."""

from pathlib import Path

from envelope_bounds import misses
from hubsim import cases, envelope
from hubsim.engine import ROOT
from hubsim.stored_share import DRIVES

TABLE: Path = ROOT / "host_sim" / "envelope" / "envelope.csv"


def test_no_more_edges_of_the_envelope_are_missed_than_the_table_names() -> None:
    recorded = cases.read_csv(envelope.Outcome, TABLE.read_text(encoding="utf-8"))
    found = cases.measured(envelope.measure, envelope.draw(DRIVES, len(recorded), 1))
    assert set(misses(found)) <= set(misses(recorded))
