# SPDX-License-Identifier: Apache-2.0
"""Tables of ``host_sim/faults/README.md``, made of ``faults.csv``; run as a program: write them.

``python -m hubsim.faults_tables`` replaces what is between the marks of the README.
"""

import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hubsim import cases, faults, faults_bounds, reasons
from hubsim.engine import ROOT
from hubsim.faults_outcome import Outcome

FOLDER = ROOT / "host_sim" / "faults"
BEGINS, ENDS = "<!-- from faults.csv: {} -->\n", "<!-- end -->\n"
LIMITS = ("distance", "wrong sign", "excess", "current", "bus")
EXCEPTIONS = Path(__file__).with_name("fault_exceptions.toml")
WHOLE = "whole_vehicle.csv"
OTHERS = "others.csv"
OTHERS_BELOW = 5  # faults with fewer runs without a right reason share a line


def stored(name: str = "faults.csv") -> list[Outcome]:
    """Return the runs of the stored sweep."""
    return cases.read_csv(Outcome, (FOLDER / name).read_text(encoding="utf-8"))


def _share(harmful: Sequence[Outcome]) -> str:
    named = sum(o.reason_expected for o in harmful)
    return f"{100.0 * named / len(harmful):.1f} %" if harmful else "-"


def base(name: str) -> str:
    """Return the fault that stands for this one and its mirror images."""
    return faults.table()[name].image_of


def by_group(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each group of faults, and their sum."""
    table = faults.table()
    lines = [
        "| group | faults | runs | harmless | "
        + " | ".join(LIMITS)
        + " | right reason | of those with one | hold every limit |",
        "|" + " --- |" * (len(LIMITS) + 7),
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
            _share(harmful),
            _share([o for o in harmful if faults.expected()[o.fault]]),
            sum(not o.misses() for o in here),
        ]
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def by_drive(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each drive and situation, and their sum."""
    columns = [
        "drive",
        "situation",
        "runs",
        "harmless",
        *LIMITS,
        "right reason",
        "hold every limit",
    ]
    lines = ["| " + " | ".join(columns) + " |", "|" + " --- |" * len(columns)]
    places = dict.fromkeys((o.config, o.situation, o.demand_nm) for o in outcomes)
    for place in (*places, None):
        here = [o for o in outcomes if place in (None, (o.config, o.situation, o.demand_nm))]
        missed = Counter(limit for o in here for limit in o.misses())
        harmful = [o for o in here if not o.harmless]
        drive, situation = (
            ("all", "") if place is None else (place[0], f"{place[1]}, {place[2]:g} N m")
        )
        cells = [
            drive,
            situation,
            len(here),
            len(here) - len(harmful),
            *(missed[limit] for limit in LIMITS),
            _share(harmful),
            sum(not o.misses() for o in here),
        ]
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def unnamed(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each fault with harmful runs that lack a right first reason."""
    without = [o for o in outcomes if "reason" in o.misses()]
    count = Counter(base(o.fault) for o in without)
    harmful = Counter(base(o.fault) for o in outcomes if not o.harmless)
    lines = [
        "| fault | without | of harmful | shown instead |",
        "| --- | --- | --- | --- |",
    ]
    few: list[str] = []
    for name, number in sorted(count.items(), key=lambda one: (-one[1], one[0])):
        shown = Counter(o.first_reason or "none" for o in without if base(o.fault) == name)
        if number < OTHERS_BELOW:
            few.append(name)
            continue
        instead = ", ".join(f"{k} {v}" for k, v in shown.most_common())
        lines.append(f"| `{name}` | {number} | {harmful[name]} | {instead} |")
    rest = sum(count[name] for name in few)
    lines.append(f"| {len(few)} others | {rest} | {sum(harmful[n] for n in few)} | |")
    lines.append(f"| all | {len(without)} | {sum(harmful.values())} | |")
    return "\n".join(lines) + "\n"


def notes(outcomes: Sequence[Outcome]) -> str:
    """Return what hangs on single entries of the list of reasons."""
    harmful = [o for o in outcomes if not o.harmless]
    named = sum(o.reason_expected for o in harmful)
    limits = sum(o.reason_expected for o in harmful if o.first_reason in reasons.limits())
    pair = [o for o in harmful if o.fault == "currents_ab_frozen"]
    either = sum(o.first_reason in {"CURRENT_SENSOR_A", "CURRENT_SENSOR_B"} for o in pair)
    return (
        f"A limit is the right reason of {limits} runs; without them the share of all is "
        f"{100.0 * (named - limits) / len(harmful):.1f} %.\n{either} of {len(pair)} harmful runs "
        "of `currents_ab_frozen` show CURRENT_SENSOR_A or _B; with them it is "
        f"{100.0 * (named + either) / len(harmful):.1f} %.\n"
    )


def whole_vehicle(outcomes: Sequence[Outcome], all_wheels: Sequence[Outcome]) -> str:
    """Return lines of the same runs of one wheel and of the whole vehicle."""
    lines = [
        "| fault | wheels | runs | harmful | right reason | shown instead | excess: runs, most | "
        "longest distance |",
        "|" + " --- |" * 8,
    ]
    keys = {o.key for o in all_wheels}
    for fault in dict.fromkeys(o.fault for o in all_wheels):
        for wheels, several in (("one", outcomes), ("four", all_wheels)):
            here = [o for o in several if o.fault == fault and o.key in keys]
            harmful = [o for o in here if not o.harmless]
            instead = Counter(o.first_reason or "none" for o in harmful if not o.reason_expected)
            excess = [o.excess_nm for o in here if "excess" in o.misses()]
            lines.append(
                f"| `{fault}` | {wheels} | {len(here)} | {len(harmful)} | {_share(harmful)} | "
                + ", ".join(f"{k} {v}" for k, v in instead.most_common())
                + f" | {len(excess)}, {max(excess, default=0.0):.0f} N m | "
                f"{max(o.distance_ratio for o in here):.2f} |"
            )
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
    """Return how many runs of each fault, its mirror images included, miss each limit."""
    return Counter((base(o.fault), limit) for o in outcomes for limit in o.misses())


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
        "notes": notes(outcomes),
        "bounds": faults_bounds.table(outcomes),
        "whole vehicle": whole_vehicle(outcomes, stored(WHOLE)),
        "others": by_drive(stored(OTHERS)),
    }
    for name, table in tables.items():
        before, rest = text.split(BEGINS.format(name), 1)
        after = rest.split(ENDS, 1)[1]
        text = before + BEGINS.format(name) + "\n" + table + "\n" + ENDS + after
    return text


if __name__ == "__main__":
    readme = FOLDER / "README.md"
    readme.write_text(replaced(readme.read_text(encoding="utf-8"), stored()), encoding="utf-8")
