# SPDX-License-Identifier: Apache-2.0
"""The table of instructions in this folder's README, written from a count."""

from __future__ import annotations

import re
from typing import Any

from benchmark.build import ROOT

README = ROOT / "tools" / "benchmark" / "README.md"
COLUMNS = ("min", "median", "p99", "max")
_ROW = re.compile(r"^\| `(\w+)` \| ([\w-]+) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \|$", re.M)


def measured(report: dict[str, Any]) -> dict[tuple[str, str], list[int]]:
    """Return what a report counted, by function and core."""
    found = {
        (name, core): [value[column] for column in COLUMNS]
        for core, result in report.get("cores", {}).items()
        for name, value in result["instructions"].items()
    }
    if "interrupt" in report:
        value = report["interrupt"]["instructions"]
        found["pwm_interrupt", "stm32f405"] = [value[column] for column in COLUMNS]
    return found


def updated(text: str, report: dict[str, Any]) -> str:
    """Return the README with the report's figures in the rows that the report has."""
    found = measured(report)

    def row(match: re.Match[str]) -> str:
        figures = found.get((match[1], match[2]))
        if figures is None:
            return match[0]
        return f"| `{match[1]}` | {match[2]} | {' | '.join(map(str, figures))} |"

    return _ROW.sub(row, text)


def update(report: dict[str, Any]) -> None:
    """Bring the table up to date."""
    README.write_text(updated(README.read_text(), report))
