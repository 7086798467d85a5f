# SPDX-License-Identifier: Apache-2.0
"""What braking returns that only physics bounds, by the paper's closed form and by hand."""

import math

import numpy as np
import pytest
from regen_table import schema, unguarded
from regen_table.unguarded import Instants

SPEED = 100.0 * math.pi / 30.0


def instants(demand_nm: float, bus_v: float = 53.0, branch_v: float = 0.0) -> Instants:
    """Return ten instants of a second each at 100 r/min."""
    ones = np.ones(10)
    return Instants(
        ones, demand_nm * ones, SPEED * ones, 25.0 * ones, bus_v * ones, branch_v * ones, 0.9 * ones
    )


def closed_form_w() -> float:
    """Return the largest returned power of the paper's motor with i_d = 0 (physics, section 3)."""
    omega, flux, inductance = 23 * SPEED, 0.0204, 76e-6
    iron = 1.5 + 0.006 * omega
    square = (omega * inductance / iron) ** 2
    dead = 2.0 * 1e-6 * 20e3
    linear = 6.0 / math.pi * 0.8 * dead + 3.0 * 10e-6 * 20e3 / math.pi
    resistance = 0.031 + iron * square / (1.0 + square) + 5e-3 * dead + 3.3e-3 * (1.0 - dead)
    emf = omega * flux / (1.0 + square)
    return 1.5 * (emf - linear / 1.5) ** 2 / (4.0 * resistance)


def test_unlimited_demand_returns_the_closed_form_s_power_through_the_battery(
    paper: schema.Drive,
) -> None:
    """Four wheels on 53 V and R_s = 12 mohm: u i + R i^2 = 0 with u = 53 V at the cells."""
    power = 4.0 * closed_form_w()
    current = (-53.0 + math.sqrt(53.0**2 + 4.0 * 0.012 * power)) / (2.0 * 0.012)
    found = unguarded.returned_j(paper, instants(500.0))
    # The i_d of least loss gains a few watts of 800 over i_d = 0.
    assert 1.0 <= found / (10.0 * 53.0 * current) <= 1.01
    # With a branch that stands 1 V higher the same power takes less charge.
    raised = (-54.0 + math.sqrt(54.0**2 + 4.0 * 0.012 * power)) / (2.0 * 0.012)
    charged = unguarded.returned_j(paper, instants(500.0, branch_v=-1.0))
    assert charged / found == pytest.approx(raised / current, rel=1e-4)


def test_a_smaller_demand_is_all_of_the_motor(paper: schema.Drive) -> None:
    """Returned: work less losses. A demand inside the friction of the bearings returns nothing."""
    small = unguarded.returned_j(paper, instants(10.0))
    assert 0.5 * 4.0 * 10.0 * 10.0 * SPEED < small < 4.0 * 10.0 * 10.0 * SPEED
    assert unguarded.returned_j(paper, instants(20.0)) > small
    assert unguarded.returned_j(paper, instants(0.0)) <= 1e-3
    assert unguarded.returned_j(paper, Instants(*[np.empty(0)] * 7)) == 0.0


def test_current_and_bus_voltage_are_the_only_bounds(paper: schema.Drive) -> None:
    """At 100 r/min the EMF is 4.9 V: 10 V of bus allow 5.8 V a phase, and 6 V not even the EMF."""
    free = unguarded.returned_j(paper, instants(500.0))
    assert unguarded.returned_j(paper, instants(500.0, bus_v=10.0)) == pytest.approx(free, rel=1e-3)
    assert unguarded.returned_j(paper, instants(500.0, bus_v=4.0)) < 0.95 * free


def test_a_demand_below_coasting_adds_half_of_itself_where_the_bridge_opens(
    paper: schema.Drive,
) -> None:
    """At zero current the iron brakes with C = 3/2 p psi g psi/(1 + (g L)^2), g = omega/R_i."""
    omega = 23 * SPEED
    ratio = omega / (1.5 + 0.006 * omega)
    coasting = 1.5 * 23 * 0.0204**2 * ratio / (1.0 + (ratio * 76e-6) ** 2)
    demand = 0.8 * coasting
    as_much = unguarded.returned_j(paper, instants(coasting + 0.5 * demand))
    assert coasting + 0.5 * demand < 2.0 * coasting
    # max(D, C + D/2) of that larger demand is more than itself; of twice C on it is the demand.
    assert 0.0 < unguarded.returned_j(paper, instants(demand)) < as_much
    assert unguarded.returned_j(paper, instants(2.0 * coasting)) == pytest.approx(
        unguarded.returned_j(paper, instants(2.0 * coasting * (1.0 + 1e-9))), rel=1e-6
    )
    # 4.9 V of EMF, and 8.9 V of bus whose phase voltage of 5.15 V has them beyond 15/16.
    assert unguarded.returned_j(paper, instants(demand, bus_v=8.9)) <= 1e-3
