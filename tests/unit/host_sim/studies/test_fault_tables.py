# SPDX-License-Identifier: Apache-2.0
"""The tables of the fault sweep's README beside the stored sweep."""

import math
from collections import Counter

import pytest
from hubsim.scenario import faults
from hubsim.sweep import drives
from hubsim.sweep.faults_outcome import Outcome
from studies.faults import bounds as faults_bounds
from studies.faults import study as faults_tables


def test_the_table_of_unnamed_runs_sums_up_to_all_of_them() -> None:
    stored = faults_tables.stored()
    cells = [line.split("|") for line in faults_tables.unnamed(stored).splitlines()[2:]]
    numbers = [int(cell[2]) for cell in cells]
    assert sum(numbers[:-1]) == numbers[-1] == sum("reason" in o.misses() for o in stored)


def test_each_limit_that_a_fault_misses_is_explained_once() -> None:
    pairs = Counter(
        (f, limit) for e in faults_tables.explained() for f in e.faults for limit in e.limits
    )
    assert max(pairs.values()) == 1
    assert faults_tables.unexplained(faults_tables.stored()) == []


def test_the_runs_of_the_three_tables_are_those_that_are_stored() -> None:
    for name, planned in faults_tables.chosen((), reduced=False).items():
        assert {case.key for case in planned} == {o.key for o in faults_tables.stored(name)}


def test_each_explanation_is_of_runs_that_exist() -> None:
    missed = faults_tables.missed(faults_tables.stored())
    for why in faults_tables.explained():
        assert set(why.faults) <= {fault.name for fault in faults.swept()}
        for fault in why.faults:
            assert any(missed[fault, limit] for limit in why.limits), fault
        for limit in why.limits:
            assert any(missed[fault, limit] for fault in why.faults), (why.faults, limit)
        assert why.physics
        assert why.hardware


def test_the_kinds_of_unnamed_runs_sum_up_to_all_of_them() -> None:
    stored = faults_tables.stored()
    table = faults_bounds.table(stored).split("\n\n")[0]
    lines = [line.split("|")[1:-1] for line in table.splitlines()[2:]]
    rows = {cells[0].strip(): [int(cell) for cell in cells[1:-1]] for cells in lines}
    unnamed = ["reason" in o.misses() for o in stored]
    assert rows["all"][:2] == [sum(not o.harmless for o in stored), sum(unnamed)]
    for harmful, without, *kinds in rows.values():
        assert harmful >= without == sum(kinds)
    for k in range(1, len(faults_bounds.KINDS) + 2):
        assert sum(row[k] for name, row in rows.items() if name != "all") == rows["all"][k]


def test_what_is_seen_in_a_run_is_hidden_with_a_smaller_error_or_at_a_lower_speed() -> None:
    def run(fault: str, share: float, instant_s: float) -> Outcome:
        return Outcome(
            fault, "lu2013", "hall", "stop", 75.0, instant_s, 1.0, 0.0, 0.0, 0.0, share, 0.5, 60.0,
            75.0, "", 0, math.nan, 0, "RUN", 0, 0,
        )  # fmt: skip

    assert faults_bounds.kind(run("hydraulic_strong", 1.03, 2.8)) == "no report"
    assert faults_bounds.kind(run("hydraulic_strong_measured", 1.03, 2.8)) == "late"
    # 0.15 of the EMF, 23 times 0.0204 V s, against half of 57 A in 31 mohm and of 1.2 V.
    flux_vs = 23 * 0.0204
    current_a = 40.0 / (1.5 * flux_vs)
    least_rad_s = 0.5 * (0.031 * current_a + 1e-6 * 20e3 * 58.4) / (0.15 * flux_vs)
    falls_rad_s2 = 75.0 / (165.0 * 0.25**2)
    begins_s = 2.8 + (40.0 / 3.6 / 0.25 - least_rad_s) / falls_rad_s2
    assert faults_bounds.kind(run("magnets_weak", 0.5, begins_s - 0.05)) == "late"
    assert faults_bounds.kind(run("magnets_weak", 0.5, begins_s + 0.05)) == "voltage"
    assert faults_bounds.kind(run("currents_gain_low", 0.5, 3.0)) == "late"
    assert faults_bounds.kind(run("currents_gain_low", 0.5, 8.0)) == "power"
    assert faults_bounds.kind(run("rotor_jump_30", 0.5, 8.4)) == "end of the stop"


def test_a_motor_with_magnets_at_the_surface_has_the_copper_loss_of_its_q_current() -> None:
    motor = drives.drive_named("lu2013").motor
    q_a = 30.0 / (1.5 * motor.pole_pairs * motor.flux_linkage_wb)
    expected = 1.5 * motor.phase_resistance_ohm * q_a**2
    assert faults_bounds.least_copper_w(motor, 30.0) == pytest.approx(expected)
    salient = drives.drive_named("ipm400v").motor
    q_a = 70.0 / (1.5 * salient.pole_pairs * salient.flux_linkage_wb)
    without_d = 1.5 * salient.phase_resistance_ohm * q_a**2
    assert faults_bounds.least_copper_w(salient, 70.0) < 0.8 * without_d


def test_the_table_of_exceptions_has_every_run_that_misses_a_limit() -> None:
    stored = faults_tables.stored()
    cells = [line.split("|")[2] for line in faults_tables.exceptions(stored).splitlines()[2:]]
    counted = sum(int(part.split()[-1]) for cell in cells for part in cell.split(","))
    assert counted == sum(len(o.misses()) for o in stored) > 0
