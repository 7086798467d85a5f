# SPDX-License-Identifier: Apache-2.0
"""The list of what physics forbids: known names, stated bounds, for runs with the fault alone."""

import pytest
from hubsim.scenario import faults
from hubsim.swarm import allowances, judge
from hubsim.swarm.drives import numbered

DRIVE = numbered(0).drive


def test_every_line_names_faults_an_invariant_a_bound_and_its_physics() -> None:
    known = faults.table()
    lines = allowances.listed()
    assert lines
    for line in lines:
        assert line.invariant in judge.INVARIANTS
        assert line.factor > 1.0 or line.adds
        assert line.physics
        assert line.hardware
        for name in line.faults:
            assert known[name].image_of == name, "the first of the mirror images stands for all"
    pairs = [(line.invariant, name) for line in lines for name in line.faults]
    assert len(pairs) == len(set(pairs))


def test_a_limit_is_wider_with_its_fault_alone() -> None:
    line = next(line for line in allowances.listed() if line.factor > 1.0)
    several = (line.faults[0], "config_bit")
    assert allowances.limit(line.invariant, several, DRIVE, 2.0) >= 2.0 * line.factor
    assert allowances.limit(line.invariant, ("config_bit",), DRIVE, 2.0) == 2.0
    assert allowances.limit(line.invariant, (), DRIVE, 2.0) == 2.0
    assert allowances.limit("finite", several, DRIVE, 0.0) == 0.0


def test_mirror_images_and_measured_variants_are_included() -> None:
    plain = allowances.limit("excess_braking", ("hydraulic_strong",), DRIVE, 5.0)
    measured = "hydraulic_strong" + faults.MEASURED_SUFFIX
    assert allowances.limit("excess_braking", (measured,), DRIVE, 5.0) == plain > 5.0
    images = faults.images("leg_b_low")
    assert len(images) > 1
    bounds = {allowances.limit("current", (name,), DRIVE, 1.0) for name in images}
    assert len(bounds) == 1 < max(bounds)


def test_additions_are_those_of_the_drive() -> None:
    motor = DRIVE.motor
    # Largest torque of the short circuit of a motor with L_d = L_q: 3/4 p psi^2 / L.
    peak = 0.75 * motor.pole_pairs * motor.flux_linkage_wb**2 / motor.d_inductance_h
    assert allowances.ADDITIONS["short_circuit"](DRIVE) == pytest.approx(1.25 * peak, rel=2e-3)
    assert allowances.ADDITIONS["motor"](DRIVE) == motor.max_torque_nm
