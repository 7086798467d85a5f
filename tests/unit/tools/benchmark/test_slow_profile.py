# SPDX-License-Identifier: Apache-2.0
"""The parts of a slow step: sums by group, and the README's table."""

from benchmark import slow_profile
from benchmark.count import Call

MONITOR, OPEN = "monitor_step", "monitor_open_step"


def step(monitor: int, open_phase: int, rest: int) -> list[Call]:
    """Two calls of the check of phases inside the monitor, that inside the step."""
    within = 2 * open_phase + monitor
    return [
        Call(OPEN, open_phase, open_phase),
        Call(OPEN, open_phase, open_phase),
        Call(MONITOR, within, monitor),
        Call(slow_profile.SLOW_STEP, within + rest, rest),
    ]


PROFILE = slow_profile.summary(step(100, 10, 1000) + step(300, 5, 500) + step(200, 20, 2000))


def test_every_instruction_of_a_step_belongs_to_one_part() -> None:
    """Steps of 1120, 810 and 2240 instructions; the last is the worst."""
    assert PROFILE["step"] == {"median": 1120, "in_worst": 2240, "max": 2240}
    limits, faults = (PROFILE["groups"][g] for g in (slow_profile.LIMITS, slow_profile.FAULTS))
    assert limits["parts"][MONITOR] == {"median": 200, "in_worst": 200, "max": 300}
    assert faults["parts"][OPEN] == {"median": 20, "in_worst": 40, "max": 40}
    assert limits["sum"] == {"median": 1100, "in_worst": 2200, "max": 2200}
    sums = [group["sum"]["in_worst"] for group in PROFILE["groups"].values()]
    assert sum(sums) == PROFILE["step"]["in_worst"]


def test_a_function_belongs_to_one_group() -> None:
    names = [name for group in slow_profile.PARTS.values() for name in group]
    assert len(names) == len(set(names))


def test_the_table_is_replaced_and_the_text_around_it_stays() -> None:
    text = f"before\n{slow_profile.BEGINS}old\n{slow_profile.ENDS}behind\n"
    new = slow_profile.updated(text, {"one": PROFILE, "two": PROFILE})
    assert new.startswith(f"before\n{slow_profile.BEGINS}| ")
    assert new.endswith(f"{slow_profile.ENDS}behind\n")
    assert "| **slow step** | 1120 / 2240 / 2240 | 1120 / 2240 / 2240 |" in new
    assert f"| `{OPEN}`: open phase | 20 / 40 | 20 / 40 |" in new
    assert slow_profile.updated(new, {"one": PROFILE, "two": PROFILE}) == new
