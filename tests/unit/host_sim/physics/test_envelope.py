# SPDX-License-Identifier: Apache-2.0
"""Firmware and plant at the edges of the envelope, every drive from every start.

Twenty-four runs here; the 480 of test_large_envelope.py are in host_sim/envelope.
"""

from envelope_bounds import misses
from hubsim import envelope
from hubsim.stored_share import DRIVES

COUNT, SEED = 24, 2


def test_no_edge_of_the_envelope_makes_a_fault_or_a_torque_that_is_not_commanded() -> None:
    cases = envelope.draw(DRIVES, COUNT, SEED)
    assert {(case.drive, case.start) for case in cases} == {
        (drive, start) for drive in DRIVES for start in envelope.STARTS
    }
    found = envelope.sweep(cases, processes=1)
    assert misses(found) == []
    made = [o for o in found if abs(o.torque_nm) > 0.0]
    assert len(made) >= COUNT // 2


def test_a_run_reads_back_as_it_was_written() -> None:
    found = envelope.sweep(envelope.draw(DRIVES, 1, SEED), processes=1)
    read = envelope.read_csv(envelope.as_csv(found))
    assert read[0].drive == found[0].drive
    assert envelope.as_csv(read) == envelope.as_csv(found)
