# SPDX-License-Identifier: Apache-2.0
"""Write the tables of findings in README.md from the lists of core/reason.h and core/findings.h.

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
CORE = MODULE.parent / "core"
HEADERS = CORE / "include" / "core"
BEGIN = "<!-- from core/reason.h and core/findings.h by generate.py -->\n"
END = "<!-- end -->\n"

WORD = r'"([^"]*)"'
TIME = r'(AT_ONCE|NEVER|MS\(\d+\)|(?:FIELD|RAMP)\(\w+, \w+\)|OWN\("[^"]*"\))'


class Reason(NamedTuple):
    """One row of FAULT_LIST."""

    number: int
    name: str
    text: str
    clearing: str
    driver: str


class Check(NamedTuple):
    """One row of FINDING_FAULTS or FINDING_WARNINGS."""

    name: str
    reason: str
    evidence: str
    qualify: str
    heal: str
    explained_by: str
    reaction: str


def rows(source: Path, name: str, row: str) -> list[tuple[str, ...]]:
    """Return the columns of each row X(...) of a list; `row` matches one."""
    text = re.sub(r"[ \t]*\\\n\s*", " ", source.read_text(encoding="utf-8"))
    found = re.search(rf"#define {name}\(X\)(.*)", text)
    matches = re.findall(row, found[1]) if found else []
    if found is None or not matches or len(matches) != len(re.findall(r"\bX\(", found[1])):
        raise SystemExit(f"{source.name}: {name} is missing, or a row of it is not understood")
    return matches


def reasons() -> list[Reason]:
    """Return the list of faults, by number."""
    row = rf"X\((\d+), (\w+), {WORD}, (\w+), (\w+)\)"
    found = rows(HEADERS / "reason.h", "FAULT_LIST", row)
    return sorted(Reason(int(number), *columns) for number, *columns in found)


def checks(name: str) -> list[Check]:
    """Return a list of checks, in its order."""
    row = rf"X\((\w+), (\w+), (\w+), {TIME}, {TIME}, (\w+), (\w+)\)"
    return [Check(*columns) for columns in rows(HEADERS / "findings.h", name, row)]


def explanations() -> dict[str, list[str]]:
    """Return the checks that each word of the column "explained by" stands for."""
    source = CORE / "findings.c"
    text = re.sub(r"\s*\\\n\s*", " ", source.read_text(encoding="utf-8"))
    sets = dict(re.findall(r"#define (\w+_BITS)\s+(.*)", text))
    out = {}
    for name, bits in rows(source, "EXPLANATIONS", r"X\((\w+), ((?:[^()]|\([^()]*\))*)\)"):
        spelled = re.sub(r"\w+_BITS", lambda found: sets[found[0]], bits)
        out[name] = re.findall(r"BIT\((\w+)\)", spelled)
    return out


def shown(time: str) -> str:
    """Return a time as the table shows it: configuration fields as code."""
    macro, _, inside = time.rstrip(")").partition("(")
    if macro in ("AT_ONCE", "NEVER"):
        return macro.lower().replace("_", " ")
    if macro == "MS":
        return f"{inside} ms"
    if macro in ("FIELD", "RAMP"):
        field = f"`{inside.replace(', ', '.')}`"
        return field if macro == "FIELD" else f"torque ramp + {field}"
    parts = inside.strip('"').split(" + ")
    return " + ".join(f"`{part}`" if "." in part else part for part in parts)


def named(word: str) -> str:
    """Return an identifier as code."""
    return "none" if word == "NONE" else f"`{word}`"


def table(head: tuple[str, ...], body: list[tuple[str, ...]]) -> str:
    """Return a table of Markdown."""
    lines = [f"| {' | '.join(row)} |\n" for row in (head, *body)]
    lines.insert(1, "|" + "---|" * len(head) + "\n")
    return "".join(lines).replace("|  |", "| |")


def reason_table() -> str:
    """Return the table of reasons."""
    return table(
        ("number", "reason", "meaning", "clearing", "driver"),
        [
            (str(row.number), named(row.name), row.text, row.clearing, row.driver)
            for row in reasons()
        ],
    )


def check_table(name: str) -> str:
    """Return the table of some checks."""
    explained = {word for word, by in explanations().items() if by}
    return table(
        ("check", "reason", "evidence", "qualify time", "heal time", "explained by", "reaction"),
        [
            (
                named(row.name),
                named(row.reason),
                row.evidence.lower(),
                shown(row.qualify),
                shown(row.heal),
                named(row.explained_by) if row.explained_by in explained else "none",
                row.reaction,
            )
            for row in checks(name)
        ],
    )


def word_table(column: str, header: str, name: str) -> str:
    """Return the words of a column with their texts."""
    return table((column, ""), rows(HEADERS / header, name, rf"X\((\w+), {WORD}\)"))


def explanation_table() -> str:
    """Return the words of the column "explained by" with the checks they stand for."""
    return table(
        ("explained by", "while present or suspected"),
        [
            (named(word), ", ".join(named(check) for check in by))
            for word, by in explanations().items()
            if by
        ],
    )


def made() -> str:
    """Return everything between the two marks."""
    parts = [
        reason_table(),
        "Faults, in the order of causes:\n",
        check_table("FINDING_FAULTS"),
        "Warnings, likewise:\n",
        check_table("FINDING_WARNINGS"),
        explanation_table(),
        word_table("reaction", "findings.h", "FINDING_REACTION_LIST"),
        word_table("clearing", "fault.h", "FAULT_CLEARING_LIST"),
        word_table("driver", "fault.h", "FAULT_DRIVER_LIST"),
    ]
    return "\n".join(parts)


def readme(text: str) -> str:
    """Return the README with its tables made new."""
    before, _, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise SystemExit(f"{README.name}: the lines {BEGIN.strip()} and {END.strip()} are missing")
    return f"{before}{BEGIN}\n{made()}\n{END}{after}"


def main() -> int:
    """Write or check the tables."""
    parser = argparse.ArgumentParser(description="tables of findings from the lists of core")
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
            f"{README.name} is not what core/reason.h and core/findings.h make; run tools/dev"
            " python firmware/monitor/generate.py",
            file=sys.stderr,
        )
        return 1
    README.write_text(wanted, encoding="utf-8")
    print(f"wrote {README.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
