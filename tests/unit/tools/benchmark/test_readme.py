# SPDX-License-Identifier: Apache-2.0
"""The README's table of instructions against a report."""

import re

from benchmark import measure, readme
from benchmark.build import ROOT

TEXT = """Text | stays | as it is.

| function | core | min | median | 99 % | max |
|---|---|---|---|---|---|
| `foc_current_step` | cortex-m4 | 100 | 101 | 102 | 103 |
| `pwm_interrupt` | stm32f405 | 300 | 400 | 600 | 700 |
| `foc_current_step` | cortex-m3 | 1 | 2 | 3 | 4 |
"""


def counts(least: int, median: int, p99: int, most: int) -> dict[str, int]:
    return {"calls": 9, "min": least, "median": median, "p99": p99, "max": most}


REPORT = {
    "cores": {"cortex-m4": {"instructions": {"foc_current_step": counts(100, 104, 105, 106)}}},
    "interrupt": {"instructions": counts(300, 401, 602, 703)},
}


def test_counted_rows_are_replaced_and_the_others_unchanged() -> None:
    text = readme.updated(TEXT, REPORT)
    assert "| `foc_current_step` | cortex-m4 | 100 | 104 | 105 | 106 |" in text
    assert "| `pwm_interrupt` | stm32f405 | 300 | 401 | 602 | 703 |" in text
    assert "| `foc_current_step` | cortex-m3 | 1 | 2 | 3 | 4 |" in text
    assert text.startswith("Text | stays | as it is.")
    assert readme.updated(text, REPORT) == text


def test_the_readme_contains_the_rows_of_the_benchmark() -> None:
    rows = {(match[1], match[2]) for match in readme._ROW.finditer(readme.README.read_text())}
    assert rows == {
        ("foc_current_step", "cortex-m4"),
        ("foc_current_step", "cortex-m3"),
        ("foc_current_step", "cortex-m0plus"),
        ("controller_fast_step", "cortex-m4"),
        ("controller_fast_step_encoder", "cortex-m4"),
        ("controller_fast_step_angle", "cortex-m4"),
        ("pwm_interrupt", "stm32f405"),
    }


def test_the_figures_of_the_readme_are_within_the_enforced_ones() -> None:
    """A figure beyond its budget is one of a firmware that was."""
    shown = {
        (match[1], match[2]): [int(figure) for figure in match.groups()[2:]]
        for match in readme._ROW.finditer(readme.README.read_text(encoding="utf-8"))
    }
    enforced = [*measure.BUDGETS, measure.INTERRUPT_BUDGET]
    assert {(budget.function, budget.core) for budget in enforced} == set(shown)
    for budget in enforced:
        _, median, p99, most = shown[budget.function, budget.core]
        assert median <= budget.median_at_most, budget
        assert p99 <= (budget.p99_at_most or p99), budget
        assert most <= (budget.max_at_most or most), budget


def test_the_module_s_own_readme_has_the_medians_of_that_table() -> None:
    """What stands there as about is within 3 %."""
    text = " ".join((ROOT / "firmware/foc/README.md").read_text(encoding="utf-8").split())
    stated = re.search(
        r"current loop takes about (\d+) instructions on a Cortex-M4, the whole PWM interrupt about"
        r" (\d+)",
        text,
    )
    assert stated is not None
    table = readme.README.read_text(encoding="utf-8")
    medians = {(m[1], m[2]): int(m[4]) for m in readme._ROW.finditer(table)}
    for figure, row in zip(
        stated.groups(), [("foc_current_step", "cortex-m4"), ("pwm_interrupt", "stm32f405")],
        strict=True,
    ):  # fmt: skip
        assert abs(int(figure) / medians[row] - 1.0) < 0.03, row
