# SPDX-License-Identifier: Apache-2.0
"""Budgets belong to a release of the compiler."""

from benchmark import cycles, measure


def test_reference_compiler_must_meet_the_goal_and_others_within_5_per_cent() -> None:
    """First lines as Debian 12 and 13 print them."""
    goal = measure.Budget("cortex-m0plus", measure.CURRENT_LOOP, 320, 1.05)
    assert measure.goal_with("arm-none-eabi-gcc (15:12.2.rel1-1) 12.2.1 20221205", goal) == goal
    assert (
        measure.goal_with("arm-none-eabi-gcc (15:14.2.rel1-1) 14.2.1 20241119", goal).median_at_most
        == 336
    )
    assert measure.goal_with("something else", goal).median_at_most == 336
    rare = measure.Budget("cortex-m4", measure.FAST_STEP, 100, p99_at_most=200, max_at_most=300)
    assert measure.goal_with("something else", rare).p99_at_most == 210
    assert measure.goal_with("something else", rare).max_at_most == 315


def test_missed_goal_is_reported() -> None:
    """By median, ratio of maximum to median, 99th percentile and maximum."""

    def met(goal: measure.Budget, median: int, p99: int, most: int) -> bool:
        return bool(
            measure.outcome_of(goal, "x", {"median": median, "p99": p99, "max": most})["met"]
        )

    even = measure.Budget("cortex-m4", measure.CURRENT_LOOP, 100, 1.05)
    assert met(even, 100, 104, 105)
    assert not met(even, 101, 104, 105)
    assert not met(even, 100, 104, 106)
    rare = measure.Budget("cortex-m4", measure.FAST_STEP, 100, p99_at_most=200)
    assert met(rare, 100, 200, 300)
    assert not met(rare, 100, 201, 300)
    bounded = measure.Budget("cortex-m4", measure.FAST_STEP, 100, max_at_most=300)
    assert met(bounded, 100, 200, 300)
    assert not met(bounded, 100, 200, 301)


def test_longest_interrupt_is_held_in_cycles_at_the_longest_refills() -> None:
    """1 250 cycles are met, one more is not."""
    for longest, met in ((1250, True), (1251, False)):
        found = {"pwm_interrupt": {"least": {"max": 1100}, "most": {"max": longest}}}
        outcome = cycles.judge(found)
        assert outcome == {"cycles": longest, "cycles_at_most": 1250, "met": met}
