# SPDX-License-Identifier: Apache-2.0
"""Write the failure table of README.md from the list of faults in core/reason.h.

tools/dev python firmware/monitor/generate.py            write
tools/dev python firmware/monitor/generate.py --check    only say whether it is up to date
"""

import argparse
import re
import sys
from pathlib import Path
from typing import NamedTuple

MODULE = Path(__file__).resolve().parent
README = MODULE / "README.md"
CORE = MODULE.parent / "core" / "include" / "core"
BEGIN = "<!-- from core/reason.h by generate.py -->\n"
END = "<!-- end -->\n"


class Fault(NamedTuple):
    """One row of the list: the columns of core/fault.h as the header writes them."""

    number: int
    name: str
    text: str
    qualify: str
    heal: str
    reaction: str
    clearing: str
    driver: str


def one_line(header: Path) -> str:
    """Return a header with its continued lines joined."""
    text = header.read_text(encoding="utf-8")
    return re.sub(r"\s+", " ", re.sub(r"\s*\\\n\s*", " ", text))


def faults(header: Path) -> list[Fault]:
    """Return the list of faults, by number."""
    words = ", ".join(['"([^"]*)"'] * 3)
    rows = re.findall(rf"X\((\d+), (\w+), {words}, (\w+), (\w+), (\w+)\)", one_line(header))
    if not rows:
        raise SystemExit(f"{header.name}: no row of a fault was found")
    return sorted(Fault(int(number), *columns) for number, *columns in rows)


def texts(header: Path, name: str) -> dict[str, str]:
    """Return identifier and text of one of the lists of core/fault.h."""
    found = re.search(rf'#define {name}\(X\)((?: X\(\w+, "[^"]*"\))+)', one_line(header))
    if found is None:
        raise SystemExit(f"{header.name}: {name} is missing")
    return dict(re.findall(r'X\((\w+), "([^"]*)"\)', found[1]))


def shown(time: str) -> str:
    """Return a time as the table shows it: configuration fields as code."""
    return " + ".join(f"`{part}`" if "." in part else part for part in time.split(" + "))


def table(listed: list[Fault], header: Path) -> str:
    """Return the failure table and the words of its columns, as Markdown."""
    lines = [
        "| number | reason | meaning | qualify time | heal time | reaction | clearing | driver |\n",
        "|---|---|---|---|---|---|---|---|\n",
    ]
    lines.extend(
        f"| {row.number} | `{row.name}` | {row.text} | {shown(row.qualify)} | {shown(row.heal)} |"
        f" {row.reaction} | {row.clearing} | {row.driver} |\n"
        for row in listed
    )
    for name in ("REACTION", "CLEARING", "DRIVER"):
        lines.append(f"\n| {name.lower()} | |\n|---|---|\n")
        lines.extend(
            f"| {identifier} | {text} |\n"
            for identifier, text in texts(header, f"FAULT_{name}_LIST").items()
        )
    return "".join(lines)


def readme(text: str) -> str:
    """Return the README with its table made new."""
    before, _, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise SystemExit(f"{README.name}: the lines {BEGIN.strip()} and {END.strip()} are missing")
    made = table(faults(CORE / "reason.h"), CORE / "fault.h")
    return f"{before}{BEGIN}\n{made}\n{END}{after}"


def main() -> int:
    """Write or check the table."""
    parser = argparse.ArgumentParser(description="failure table from core/reason.h")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; fail if it is out of date"
    )
    only_check = parser.parse_args().check
    before = README.read_text(encoding="utf-8")
    wanted = readme(before)
    if wanted == before:
        return 0
    if only_check:
        print(
            f"{README.name} is not what core/reason.h makes; run tools/dev python"
            " firmware/monitor/generate.py",
            file=sys.stderr,
        )
        return 1
    README.write_text(wanted, encoding="utf-8")
    print(f"wrote {README.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
