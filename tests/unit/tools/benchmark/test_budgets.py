# SPDX-License-Identifier: Apache-2.0
"""Budgets belong to a release of the compiler."""

from pathlib import Path

import pytest
from benchmark import cycles, measure, memory
from benchmark.functions import CURRENT_LOOP, FAST_STEP


def test_reference_compiler_must_meet_the_goal_and_others_within_5_per_cent() -> None:
    """First lines as Debian 12 and 13 print them."""
    goal = measure.Budget("cortex-m0plus", CURRENT_LOOP, 320, 1.05)
    assert measure.goal_with("arm-none-eabi-gcc (15:12.2.rel1-1) 12.2.1 20221205", goal) == goal
    assert (
        measure.goal_with("arm-none-eabi-gcc (15:14.2.rel1-1) 14.2.1 20241119", goal).median_at_most
        == 336
    )
    assert measure.goal_with("something else", goal).median_at_most == 336
    rare = measure.Budget("cortex-m4", FAST_STEP, 100, p99_at_most=200, max_at_most=300)
    assert measure.goal_with("something else", rare).p99_at_most == 210
    assert measure.goal_with("something else", rare).max_at_most == 315


def test_missed_goal_is_reported() -> None:
    """By median, ratio of maximum to median, 99th percentile and maximum."""

    def met(goal: measure.Budget, median: int, p99: int, most: int) -> bool:
        return bool(
            measure.outcome_of(goal, "x", {"median": median, "p99": p99, "max": most})["met"]
        )

    even = measure.Budget("cortex-m4", CURRENT_LOOP, 100, 1.05)
    assert met(even, 100, 104, 105)
    assert not met(even, 101, 104, 105)
    assert not met(even, 100, 104, 106)
    rare = measure.Budget("cortex-m4", FAST_STEP, 100, p99_at_most=200)
    assert met(rare, 100, 200, 300)
    assert not met(rare, 100, 201, 300)
    bounded = measure.Budget("cortex-m4", FAST_STEP, 100, max_at_most=300)
    assert met(bounded, 100, 200, 300)
    assert not met(bounded, 100, 200, 301)


def test_longest_interrupt_is_held_in_cycles_at_the_longest_refills() -> None:
    """1 250 cycles are met, one more is not, in each ride by itself."""
    outcomes = measure.judge_cycles({"a": 1250, "b": 1251})
    assert [outcome["function"] for outcome in outcomes] == ["a", "b"]
    assert [outcome["met"] for outcome in outcomes] == [True, False]
    assert [outcome["cycles"] for outcome in outcomes] == [1250, 1251]


def test_load_of_the_core_is_held_at_40_percent() -> None:
    for share, met in ((0.4, True), (0.4001, False)):
        assert cycles.judge_load({"load_warm": share, "load_cold": 0.9})["met"] is met


def test_stack_by_analysis_is_held_at_3200_bytes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An image without an analysis does not meet it."""

    def met(stack: int) -> bool:
        size = memory.Memory(100000, 20000, 8192, stack, {})
        monkeypatch.setattr(memory, "of", lambda _: size)
        outcomes = {o["function"]: o["met"] for o in memory.judge(Path("image"), 114688)}
        assert outcomes["flash"]
        assert outcomes["RAM without recordings"]
        return bool(outcomes["stack by analysis"])

    assert [met(stack) for stack in (3200, 3201, 0)] == [True, False, False]
