# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest
from hubsim.errors import HubsimError
from hubsim.sweep import plan


def test_lists_and_ranges_form_a_grid_in_nested_loop_order() -> None:
    found = plan.make(
        ["demand_nm=range(10,30,3)", "brake.strategy=parallel_ratio,series_optimal"], None, 1
    )
    assert found.runs == 6
    assert [tuple(point.values()) for point in found.points()] == [
        (demand, strategy)
        for demand in (10.0, 20.0, 30.0)
        for strategy in ("parallel_ratio", "series_optimal")
    ]


def test_random_draws_of_a_run_depend_only_on_seed_number_and_key() -> None:
    texts = ["plant.vehicle.mass_kg=normal(660,20)", "demand_nm=10,20", "noise=choice(true,false)"]
    found = list(plan.make(texts, 5, 7).points())
    assert len(found) == 10
    assert [point["demand_nm"] for point in found] == [10] * 5 + [20] * 5
    assert len({point["plant.vehicle.mass_kg"] for point in found}) == 10
    assert found == list(plan.make(texts, 5, 7).points())
    other = list(plan.make(texts, 5, 8).points())
    assert all(
        a["plant.vehicle.mass_kg"] != b["plant.vehicle.mass_kg"]
        for a, b in zip(found, other, strict=True)
    )
    without = list(plan.make([texts[0], texts[1]], 5, 7).points())
    assert [p["plant.vehicle.mass_kg"] for p in without] == [
        p["plant.vehicle.mass_kg"] for p in found
    ]


def test_random_draws_have_the_stated_distribution() -> None:
    draws = 4000
    points = list(
        plan.make(["a=normal(100,5)", "b=uniform(-1,3)", "c=choice(1,2,2,2)"], draws, 3).points()
    )
    a, b, c = (np.array([point[key] for point in points]) for key in "abc")
    # Five standard errors of mean and deviation.
    assert abs(a.mean() - 100.0) < 5 * 5.0 / math.sqrt(draws)
    assert abs(a.std() - 5.0) < 5 * 5.0 / math.sqrt(2 * draws)
    assert b.min() >= -1.0
    assert b.max() < 3.0
    assert abs(b.mean() - 1.0) < 5 * (4.0 / math.sqrt(12.0)) / math.sqrt(draws)
    assert abs(np.mean(c == 2) - 0.75) < 5 * math.sqrt(0.75 * 0.25 / draws)
    assert abs(np.corrcoef(a, b)[0, 1]) < 5 / math.sqrt(draws)


def test_a_list_of_lists_gives_a_grid_of_lists() -> None:
    assert plan.read("motor.iron_loss_resistance_ohm=[1.5,0.006],[2.0,0.006]").values == (
        [1.5, 0.006],
        [2.0, 0.006],
    )


@pytest.mark.parametrize(
    ("texts", "draws", "message"),
    [
        (
            ["demand_nm"],
            None,
            "--vary 'demand_nm': accepted: KEY=a,b,... or range(first,last,count)",
        ),
        (["demand_nm="], None, "--vary 'demand_nm=': accepted: KEY="),
        (["demand_nm=1,,2"], None, "--vary demand_nm: '1,,2' is not accepted"),
        (
            ["demand_nm=range(1,2)"],
            None,
            "--vary demand_nm: 'range(1,2)' is not accepted, accepted: range(first,last,count) "
            "with numbers",
        ),
        (["demand_nm=range(1,2,1.5)"], None, "accepted: range(first,last,count)"),
        (["demand_nm=normal(1,-2)"], 3, "accepted: normal(mean,deviation)"),
        (["demand_nm=normal(1,much)"], 3, "accepted: normal(mean,deviation)"),
        (["demand_nm=uniform(2,1)"], 3, "accepted: uniform(lowest,highest)"),
        (["demand_nm=normal(1,2)"], None, "--runs: missing, accepted: how many draws to make"),
        (["demand_nm=1,2"], 3, "--runs 3: accepted: with a normal, uniform or choice among --vary"),
        (["demand_nm=1,2", "demand_nm=3"], None, "--vary demand_nm: accepted: once"),
        (
            ["a=range(0,1,1000)", "b=range(0,1,1000)", "c=1,2"],
            None,
            "--vary: 2000000 runs, accepted: 1 to 1000000",
        ),
    ],
)
def test_an_error_is_one_line(texts: list[str], draws: int | None, message: str) -> None:
    with pytest.raises(HubsimError) as caught:
        plan.make(texts, draws, 1)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
