# SPDX-License-Identifier: Apache-2.0
"""The table of instructions in firmware/foc/README.md, written from a count and held to it."""

from __future__ import annotations

import re
import sys
from typing import Any

from benchmark.build import ROOT

README = ROOT / "firmware" / "foc" / "README.md"
CONFIG = "lu2013"
RELEASE = ") 12."
"""Of gcc, in the first line of its version."""
COLUMNS = ("min", "median", "p99", "max")
DEVIATION = 0.02
"""Share of a figure by which the table may be off before it is called out of date."""
_ROW = re.compile(r"^\| `(\w+)` \| ([\w-]+) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \| (.*) \|$", re.M)


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
        return f"| `{match[1]}` | {match[2]} | {' | '.join(map(str, figures))} | {match[7]} |"

    return _ROW.sub(row, text)


def out_of_date(text: str, report: dict[str, Any]) -> list[str]:
    """Name the rows whose figures differ from the report's by more than ``DEVIATION``."""
    found = measured(report)
    complaints = []
    for match in _ROW.finditer(text):
        figures = found.get((match[1], match[2]))
        shown = [int(figure) for figure in match.groups()[2:6]]
        if figures and any(abs(a - b) > DEVIATION * b for a, b in zip(shown, figures, strict=True)):
            complaints.append(f"{match[1]}, {match[2]}: shown {shown}, counted {figures}")
    return complaints


def status(report: dict[str, Any], update: bool) -> int:
    """Bring the table up to date if asked to; else return 1, and say so, if it is not.

    It applies to one configuration and one release of the compiler.
    """
    if update:
        README.write_text(updated(README.read_text(), report))
        return 0
    if report.get("config", CONFIG) != CONFIG or RELEASE not in report["compiler"]:
        return 0
    complaints = out_of_date(README.read_text(), report)
    for complaint in complaints:
        print(f"bench: table of firmware/foc/README.md: {complaint}", file=sys.stderr)
    if complaints:
        print("bench: ./tools/dev bench --update-readme writes that table", file=sys.stderr)
    return 1 if complaints else 0
