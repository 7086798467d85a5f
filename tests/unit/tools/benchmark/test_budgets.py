# SPDX-License-Identifier: Apache-2.0
"""Budgets belong to a release of the compiler."""

from benchmark import run


def test_the_reference_compiler_is_held_to_the_goal_and_another_to_a_twentieth_more() -> None:
    """First lines as Debian 12 and 13 print them."""
    goal = run.Budget("cortex-m0plus", run.CURRENT_LOOP, 320, 1.05)
    assert run.goal_with("arm-none-eabi-gcc (15:12.2.rel1-1) 12.2.1 20221205", goal) == goal
    assert (
        run.goal_with("arm-none-eabi-gcc (15:14.2.rel1-1) 14.2.1 20241119", goal).median_at_most
        == 336
    )
    assert run.goal_with("something else", goal).median_at_most == 336


def test_a_goal_that_is_missed_says_so() -> None:
    """By its median, and by how far the dearest call lies above it."""
    goal = run.Budget("cortex-m4", run.CURRENT_LOOP, 100, 1.05)
    assert run.verdict_of(goal, "x", {"median": 100, "max": 105})["met"]
    assert not run.verdict_of(goal, "x", {"median": 101, "max": 105})["met"]
    assert not run.verdict_of(goal, "x", {"median": 100, "max": 106})["met"]
