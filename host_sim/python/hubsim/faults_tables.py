# SPDX-License-Identifier: Apache-2.0
"""Tables of ``host_sim/faults/README.md``, made of ``faults.csv``; run as a program: write them.

``python -m hubsim.faults_tables`` replaces what is between the marks of the README.
"""

import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hubsim import cases, faults
from hubsim.engine import ROOT
from hubsim.faults_sweep import Outcome

FOLDER = ROOT / "host_sim" / "faults"
BEGINS, ENDS = "<!-- from faults.csv: {} -->\n", "<!-- end -->\n"
LIMITS = ("distance", "wrong sign", "excess", "current", "bus")
EXCEPTIONS = Path(__file__).with_name("fault_exceptions.toml")
OTHERS_BELOW = 5  # faults with fewer runs without a right reason share a line


def stored(folder: Path = FOLDER) -> list[Outcome]:
    """Return the runs of the stored sweep."""
    return cases.read_csv(Outcome, (folder / "faults.csv").read_text(encoding="utf-8"))


def _share(named: int, of: int) -> str:
    return f"{100.0 * named / max(of, 1):.1f} %"


def by_group(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each group of faults, and their sum."""
    table = faults.table()
    lines = [
        "| group | faults | runs | harmless | "
        + " | ".join(LIMITS)
        + " | right reason | hold every limit |",
        "|" + " --- |" * (len(LIMITS) + 6),
    ]
    groups = list(dict.fromkeys(table[o.fault].group for o in outcomes))
    for group in (*sorted(groups, key=[f.group for f in table.values()].index), "all"):
        here = [o for o in outcomes if group in ("all", table[o.fault].group)]
        missed = Counter(limit for o in here for limit in o.misses())
        harmful = [o for o in here if not o.harmless]
        cells = [
            group,
            len({o.fault for o in here}),
            len(here),
            len(here) - len(harmful),
            *(missed[limit] for limit in LIMITS),
            _share(sum(o.reason_expected for o in harmful), len(harmful)),
            sum(not o.misses() for o in here),
        ]
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def unnamed(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each fault with harmful runs that lack a right first reason."""
    without = [o for o in outcomes if "reason" in o.misses()]
    count = Counter(o.fault for o in without)
    harmful = Counter(o.fault for o in outcomes if not o.harmless)
    lines = ["| fault | without | of harmful | shown instead |", "| --- | --- | --- | --- |"]
    few: list[str] = []
    for name, number in sorted(count.items(), key=lambda one: (-one[1], one[0])):
        shown = Counter(o.first_reason or "none" for o in without if o.fault == name)
        if number < OTHERS_BELOW:
            few.append(name)
            continue
        instead = ", ".join(f"{k} {v}" for k, v in shown.most_common())
        lines.append(f"| `{name}` | {number} | {harmful[name]} | {instead} |")
    rest = sum(count[name] for name in few)
    lines.append(f"| {len(few)} others | {rest} | {sum(harmful[n] for n in few)} | |")
    lines.append(f"| all | {len(without)} | {sum(harmful.values())} | |")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Explained:
    """Why faults miss limits: a table of ``fault_exceptions.toml``."""

    faults: tuple[str, ...]
    limits: tuple[str, ...]
    physics: str
    hardware: str


def explained() -> list[Explained]:
    """Return the reasons of the limits that are missed, in the order of the file."""
    data = tomllib.loads(EXCEPTIONS.read_text(encoding="utf-8"))["exception"]
    return [
        Explained(tuple(e["faults"]), tuple(e["limits"]), e["physics"], e["hardware"]) for e in data
    ]


def missed(outcomes: Sequence[Outcome]) -> Counter[tuple[str, str]]:
    """Return how many runs of each fault miss each limit."""
    return Counter((o.fault, limit) for o in outcomes for limit in o.misses())


def exceptions(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each reason why limits are missed, with the runs that miss them."""
    runs = missed(outcomes)
    lines = [
        "| fault | runs that miss | physics | what would close it |",
        "| --- | --- | --- | --- |",
    ]
    for why in explained():
        names = [f for f in why.faults if any(runs[f, limit] for limit in why.limits)]
        sums = {limit: sum(runs[f, limit] for f in names) for limit in why.limits}
        cells = [
            ", ".join(f"`{name}`" for name in names),
            ", ".join(f"{limit} {number}" for limit, number in sums.items() if number),
            why.physics,
            why.hardware,
        ]
        if names:
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def replaced(text: str, outcomes: Sequence[Outcome]) -> str:
    """Return the README with the tables of these runs."""
    tables = {
        "groups": by_group(outcomes),
        "unnamed": unnamed(outcomes),
        "exceptions": exceptions(outcomes),
    }
    for name, table in tables.items():
        before, rest = text.split(BEGINS.format(name), 1)
        after = rest.split(ENDS, 1)[1]
        text = before + BEGINS.format(name) + "\n" + table + "\n" + ENDS + after
    return text


if __name__ == "__main__":
    readme = FOLDER / "README.md"
    readme.write_text(replaced(readme.read_text(encoding="utf-8"), stored()), encoding="utf-8")
