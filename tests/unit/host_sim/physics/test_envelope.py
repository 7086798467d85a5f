# SPDX-License-Identifier: Apache-2.0
"""Firmware and plant at the edges of the envelope, every drive from every start.

Twenty-four runs here; the 480 of test_large_envelope.py are in host_sim/envelope.
"""

from envelope_bounds import misses
from hubsim import cases, envelope
from hubsim.stored_share import DRIVES

COUNT, SEED = 24, 2


def test_no_edge_of_the_envelope_makes_a_fault_or_a_torque_that_is_not_commanded() -> None:
    drawn = envelope.draw(DRIVES, COUNT, SEED)
    assert {(case.drive, case.start) for case in drawn} == {
        (drive, start) for drive in DRIVES for start in envelope.STARTS
    }
    found = cases.measured(envelope.measure, drawn, processes=1)
    assert misses(found) == []
    made = [o for o in found if abs(o.torque_nm) > 0.0]
    assert len(made) >= COUNT // 2


def test_a_controller_that_boots_beyond_the_emf_limit_stays_within_the_phase_current() -> None:
    """A short circuit from the open bridge: 354 A of ipm400v's 200."""
    for charge_share, speed_share in ((0.0, 1.0066), (0.9, 1.09)):
        case = envelope.Case(
            "ipm400v", "rolling", speed_share, 100.0, 0.9, 390.03, 20.0, 30.0, charge_share
        )
        found = envelope.measure(0, case)
        assert found.current_share <= 1.02
        assert found.first_fault == ""


def test_a_run_reads_back_as_it_was_written() -> None:
    found = cases.measured(envelope.measure, envelope.draw(DRIVES, 1, SEED), processes=1)
    read = cases.read_csv(envelope.Outcome, cases.as_csv(found))
    assert read[0].drive == found[0].drive
    assert cases.as_csv(read) == cases.as_csv(found)
