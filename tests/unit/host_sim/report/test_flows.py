# SPDX-License-Identifier: Apache-2.0
import math

import pytest
from hubsim.report import flows
from hubsim.report.flows import Flow

from tests.unit.host_sim.report.ideal_vehicle import STRATEGIES, Run, drive


def flow_of(run: Run) -> Flow:
    flow = flows.flow_of(run)
    assert flow is not None
    return flow


def check_balance(flow: Flow) -> None:
    """Inflow equals outflow in both lanes, except for parts omitted as too small.

    No part is negative.
    """
    largest = max(flow.drawn_j, flow.slowing_j, abs(flow.returned_j))
    few = 10.0 * flows.NEGLIGIBLE * largest  # only the usual flows
    assert (
        abs(flow.drawn_j - flows.total(flow.upper) - flows.total(flow.road) - flow.turned_j) <= few
    )
    assert abs(flow.slowing_j - flows.total(flow.lower) - flow.returned_j) <= few
    assert all(
        part.energy_j > 0.0 for part in (*flow.upper, *flow.road, *flow.lower, *flow.joining)
    )


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_diagram_of_a_cycle_balances_and_its_losses_equal_the_accounts(strategy: str) -> None:
    run = drive(strategy)
    flow = flow_of(run)
    check_balance(flow)
    for parts, phase in ((flow.upper, "while_driving_j"), (flow.lower, "while_braking_j")):
        accounts = run.summary[phase]
        for part in parts:
            # No polarisation in this vehicle: the battery's difference is its heat.
            assert part.energy_j == pytest.approx(accounts[part.name], rel=1e-6)
    assert {part.name for part in flow.road} == {"air", "rolling"}
    assert flow.turned_j == pytest.approx(run.summary["energy_j"]["braking_at_wheels"], rel=1e-9)
    assert not flow.joining


def test_the_driving_lane_is_the_same_for_all_strategies() -> None:
    found = [flow_of(drive(strategy)) for strategy in STRATEGIES]
    for flow in found[1:]:
        assert [(part.name, round(part.energy_j, 3)) for part in flow.upper] == [
            (part.name, round(part.energy_j, 3)) for part in found[0].upper
        ]
        assert flow.wheels_j == pytest.approx(found[0].wheels_j, rel=1e-9)


def test_without_the_split_losses_are_those_of_the_whole_run_and_road_load_is_unchanged() -> None:
    run = drive("series_optimal")
    known = flow_of(run)
    del run.summary["while_braking_j"]
    flow = flow_of(run)
    check_balance(flow)
    assert not flow.split
    assert {part.name: part.energy_j for part in flow.upper} == {
        name: run.summary["energy_j"][name] for name in ("battery", "inverter", "copper", "iron")
    }
    assert flows.total(flow.road) == pytest.approx(flows.total(known.road), rel=1e-3)


def test_without_drag_and_rolling_resistance_the_road_load_is_one_difference() -> None:
    run = drive("series_optimal")
    known = flow_of(run)
    del run.summary["energy_j"]["drag"]
    flow = flow_of(run)
    check_balance(flow)
    assert [part.name for part in flow.road] == ["road"]
    assert flows.total(flow.road) == pytest.approx(flows.total(known.road), rel=1e-3)


def test_polarisation_energy_belongs_to_the_battery_and_is_a_source_if_negative() -> None:
    run = drive("series_optimal")
    run.summary["energy_j"]["battery_returned"] -= 800.0  # stored in the polarisation
    kept = flow_of(run)
    check_balance(kept)
    assert kept.lower[-1].name == "battery"
    assert kept.lower[-1].energy_j == pytest.approx(
        run.summary["while_braking_j"]["battery"] + 800.0
    )
    run.summary["energy_j"]["battery_returned"] += 2800.0
    given = flow_of(run)
    check_balance(given)
    assert [part.name for part in given.joining] == ["polarisation"]
    assert given.joining[0].energy_j == pytest.approx(
        2000.0 - run.summary["while_braking_j"]["battery"]
    )


def test_a_stop_has_no_driving_lane_and_its_source_is_kinetic_energy() -> None:
    run = drive("parallel_free_travel")
    energy = run.summary["energy_j"]
    for name, value in run.summary["while_driving_j"].items():
        energy[name] -= value
        run.summary["while_driving_j"][name] = 0.0
    energy |= {
        "traction": 0.0,
        "drag": 500.0,
        "rolling": 3000.0,
        "stored_kinetic": -energy["braking_at_wheels"] - 3500.0,
    }
    flow = flow_of(run)
    check_balance(flow)
    assert flow.net and not flow.upper and not flow.road
    assert flow.slowing_j == pytest.approx(-energy["stored_kinetic"], rel=1e-9)
    assert {"air", "rolling"} <= {part.name for part in flow.lower}


def test_energy_stored_while_coasting_counts_as_returned() -> None:
    run = drive("parallel_free_travel")
    energy = run.summary["energy_j"]
    for name, value in run.summary["while_driving_j"].items():
        energy[name] -= value
        run.summary["while_driving_j"][name] = 0.0
    energy |= {
        "traction": -700.0,
        "drag": 500.0,
        "rolling": 3000.0,
        "stored_kinetic": -energy["braking_at_wheels"] - 4200.0,
    }
    flow = flow_of(run)
    check_balance(flow)
    assert flow.net
    assert flow.returned_j == pytest.approx(energy["battery_returned"] + 700.0)


def test_the_diagram_of_a_descent_balances() -> None:
    run = drive("series_optimal")
    energy = run.summary["energy_j"]
    # The road load exceeds the battery energy at the wheels.
    more = 2.0 * energy["drag"] + energy["traction"]
    energy |= {"drag": energy["drag"] + more, "climbed": -more}
    flow = flow_of(run)
    check_balance(flow)
    assert [part.name for part in flow.joining] == ["descent"]
    assert flow.turned_j == pytest.approx(0.0, abs=flows.NEGLIGIBLE * more)


def test_braking_that_draws_energy_has_negative_returned_energy() -> None:
    run = drive("parallel_ratio")
    run.summary["while_braking_j"]["copper"] += 9000.0
    run.summary["energy_j"]["battery_returned"] -= 9000.0
    flow = flow_of(run)
    check_balance(flow)
    assert flow.returned_j < 0.0


@pytest.mark.parametrize(
    "missing", ["traction", "braking_at_wheels", "battery_returned", "hydraulic"]
)
@pytest.mark.parametrize("how", [math.nan, "many", None])
def test_without_a_main_energy_no_diagram_is_drawn(missing: str, how: object) -> None:
    run = drive("series_optimal")
    if how is None:
        del run.summary["energy_j"][missing]
    else:
        run.summary["energy_j"][missing] = how
    assert flows.flow_of(run) is None


def test_a_run_without_energy_flow_has_no_diagram() -> None:
    run = drive("series_optimal")
    run.summary = {"energy_j": dict.fromkeys(run.summary["energy_j"], 0.0)}
    assert flows.flow_of(run) is None
