# SPDX-License-Identifier: Apache-2.0
"""Every single fault in a stop: what it does, and whether its reason is named.

The runs of ``hubsim faults``, which is the command for some of them: every fault at instants of a
stop or of a roll back, in every drive that comes along, beside the run without it. Here they become
the tables of the page: hard stops (faults.csv), gentle stops and the other drives' bridges
(others.csv), gains of all current sensors with the whole vehicle (whole_vehicle.csv). Exit status 1
if a limit is missed that exceptions.toml does not explain.
"""

import argparse
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from hubsim import reasons
from hubsim.engine import ROOT
from hubsim.scenario import faults
from hubsim.sweep import cases, faults_report, faults_sweep
from hubsim.sweep.faults_outcome import Outcome
from hubsim.sweep.faults_sweep import DEMAND_SHARES, ROLL_BACK, Case
from regen_table import plotting
from rich.progress import Progress
from studies import common
from studies.faults import bounds

NAME = "faults"
FOLDER = common.folder_of(NAME)
LIMITS = ("distance", "wrong sign", "excess", "current", "bus")
EXCEPTIONS = FOLDER / "exceptions.toml"
OTHERS, WHOLE = "others", "whole_vehicle"
WHOLE_FAULTS = ("currents_gain_low", "currents_gain_high")
WHOLE_VEHICLES = tuple(v for v in faults_sweep.VEHICLES if v[0] == "lu2013")
OF_THE_PAPERS_VEHICLE = "bridge"  # this group, the others' runs of which are in OTHERS
OTHERS_BELOW = 5  # faults with fewer runs without a right reason share a line


def stored(name: str = NAME) -> list[Outcome]:
    """Return the runs of a stored table."""
    return common.read(Outcome, FOLDER / f"{name}.csv")


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
    """Why faults miss limits: a table of ``exceptions.toml``."""

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


def tables(
    outcomes: Sequence[Outcome], others: Sequence[Outcome], whole: Sequence[Outcome]
) -> dict[str, str]:
    """Return the tables of the page."""
    return {
        "groups": by_group(outcomes),
        "unnamed": unnamed(outcomes),
        "exceptions": exceptions(outcomes),
        "notes": notes(outcomes),
        "bounds": bounds.table(outcomes),
        "whole vehicle": whole_vehicle(outcomes, whole),
        "others": by_drive(others),
    }


def unexplained(outcomes: Sequence[Outcome]) -> list[tuple[str, str]]:
    """Return the faults and the limits that they miss without an entry in ``exceptions.toml``."""
    known = {(f, limit) for e in explained() for f in e.faults for limit in e.limits}
    return sorted(set(missed(outcomes)) - known)


def is_other(case: Case) -> bool:
    """Return whether a run belongs to OTHERS: a gentle stop, or a bridge of another drive."""
    group = case.group
    rated_nm = faults_sweep.drive_of(group.config, group.rotor_sensor).motor.rated_torque_nm
    gentle = group.situation != ROLL_BACK and group.demand_nm < DEMAND_SHARES[1] * rated_nm
    bridge = faults.table()[case.fault].group == OF_THE_PAPERS_VEHICLE
    return gentle or (bridge and group.config != "lu2013")


def chosen(names: Sequence[str], reduced: bool) -> dict[str, list[Case]]:
    """Return the runs of each table."""
    wanted = faults.named(names)
    if reduced:
        swept = {fault.name for fault in wanted}
        return {NAME: [case for case in faults_sweep.reduced() if case.fault in swept]}
    every = faults_sweep.plan(wanted, exact=names)
    gains = [fault for fault in wanted if fault.name in WHOLE_FAULTS]
    return {
        NAME: [case for case in every if not is_other(case)],
        OTHERS: [case for case in every if is_other(case)],
        WHOLE: faults_sweep.plan(
            gains, WHOLE_VEHICLES, DEMAND_SHARES[1:], exact=WHOLE_FAULTS, whole=True
        ),
    }


def _made(options: argparse.Namespace, bar: Progress) -> tuple[list[str], bool]:
    if options.page:
        found = stored()
        lines = faults_report.summary(found)
        common.renew_page(NAME, tables(found, stored(OTHERS), stored(WHOLE)))
        common.write_json(NAME, options, lines, found)
        return lines, not unexplained(found)
    common.check(NAME, options)
    # What is refreshed is swept beside the build, where it can be interrupted.
    folder = ROOT / "build" / "studies" / NAME if options.refresh else options.output
    sweeps = {
        name: faults_report.sweep(several, folder / f"{name}.csv", options.workers, bar)
        for name, several in chosen(options.names, options.reduced).items()
        if several
    }
    found = sweeps[NAME]
    lines = faults_report.summary(found)
    made = cases.files_of(NAME, found, lines, None, options.date)
    made |= {f"{name}.csv": cases.as_csv(several).encode() for name, several in sweeps.items()}
    made |= plotting.rendered({NAME: faults_report.figure(found)})
    shown = tables(*sweeps.values()) if options.refresh else {}
    common.leave(NAME, options, made, shown)
    common.write_json(NAME, options, lines, found)
    left = unexplained(found)
    lines.extend(f"not explained: {fault} misses {limit}" for fault, limit in left)
    return lines, not left


def main(arguments: Sequence[str]) -> int:
    """Do ``./tools/dev study faults``."""
    parser = common.parser_of(NAME, __doc__, None)
    parser.add_argument(
        "names", nargs="*", default=[], metavar="FAULT", help="faults or groups; default: all"
    )
    parser.add_argument(
        "--reduced", action="store_true", help="a few runs of every fault with the paper's vehicle"
    )
    options = common.parse(parser, arguments)
    return common.reported(NAME, lambda bar: _made(options, bar))
