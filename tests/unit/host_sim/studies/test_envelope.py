# SPDX-License-Identifier: Apache-2.0
"""Firmware and plant at the edges of the envelope, every drive from every start."""

from collections.abc import Sequence

from hubsim.sweep import cases
from hubsim.sweep.drives import DRIVES
from studies.envelope import runs
from studies.envelope.runs import SENSOR_STARTS, Outcome

COUNT, SEED = 24, 2
DEVIATION = 0.01  # of the rated torque, torque beside its command
CURRENT_SHARE = 1.35  # of the phase current's limit: below the trip
BUS_SHARE = 1.02  # of the battery's largest voltage
DROVE_SHARE_S = 0.05  # a driving torque under the brake ends by then


def misses(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what is out of bounds."""
    found = []
    for o in outcomes:
        sound = o.start not in SENSOR_STARTS
        bounds = {
            "deviation": not sound or o.deviation <= DEVIATION,
            "current": o.current_share <= CURRENT_SHARE,
            "bus": o.bus_share <= BUS_SHARE,
            "drives under the brake": o.drove_s <= DROVE_SHARE_S,
            "fault": not (sound and o.first_fault),
        }
        found += [f"run {o.number} {o.drive} {o.start}: {k}" for k, ok in bounds.items() if not ok]
    return found


def test_no_edge_of_the_envelope_makes_a_fault_or_a_torque_that_is_not_commanded() -> None:
    drawn = runs.draw(DRIVES, COUNT, SEED)
    assert {(case.drive, case.start) for case in drawn} == {
        (drive, start) for drive in DRIVES for start in runs.STARTS
    }
    found = cases.measured(runs.measure, drawn, workers=1)
    assert misses(found) == []
    made = [o for o in found if abs(o.torque_nm) > 0.0]
    assert len(made) >= COUNT // 2


def test_a_controller_that_boots_beyond_the_emf_limit_stays_within_the_phase_current() -> None:
    """A short circuit from the open bridge: 354 A of ipm400v's 200."""
    for charge_share, speed_share in ((0.0, 1.0066), (0.9, 1.09)):
        case = runs.Case(
            "ipm400v", "rolling", speed_share, 100.0, 0.9, 390.03, 20.0, 30.0, charge_share
        )
        found = runs.measure(0, case)
        assert found.current_share <= 1.02
        assert found.first_fault == ""


def test_a_run_reads_back_as_it_was_written() -> None:
    found = cases.measured(runs.measure, runs.draw(DRIVES, 1, SEED), workers=1)
    read = cases.read_csv(runs.Outcome, cases.as_csv(found))
    assert read[0].drive == found[0].drive
    assert cases.as_csv(read) == cases.as_csv(found)
