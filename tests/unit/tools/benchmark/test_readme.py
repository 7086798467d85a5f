# SPDX-License-Identifier: Apache-2.0
"""The README's table of instructions against a report."""

from benchmark import readme

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
