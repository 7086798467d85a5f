# SPDX-License-Identifier: Apache-2.0
"""The tables of the fault sweep's README beside the stored sweep."""

from collections import Counter

from hubsim import faults, faults_tables


def test_the_tables_of_the_readme_are_those_of_the_stored_sweep() -> None:
    readme = (faults_tables.FOLDER / "README.md").read_text(encoding="utf-8")
    assert faults_tables.replaced(readme, faults_tables.stored()) == readme


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
    assert sorted(set(faults_tables.missed(faults_tables.stored())) - set(pairs)) == []


def test_each_explanation_is_of_runs_that_exist() -> None:
    missed = faults_tables.missed(faults_tables.stored())
    for why in faults_tables.explained():
        assert set(why.faults) <= set(faults.table())
        assert any(missed[fault, limit] for fault in why.faults for limit in why.limits)
        assert why.physics
        assert why.hardware


def test_the_table_of_exceptions_has_every_run_that_misses_a_limit() -> None:
    stored = faults_tables.stored()
    cells = [line.split("|")[2] for line in faults_tables.exceptions(stored).splitlines()[2:]]
    counted = sum(int(part.split()[-1]) for cell in cells for part in cell.split(","))
    assert counted == sum(len(o.misses()) for o in stored) > 0
