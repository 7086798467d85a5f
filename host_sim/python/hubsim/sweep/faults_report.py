# SPDX-License-Identifier: Apache-2.0
"""What ``hubsim faults`` leaves behind: table, origin and picture, and what there is to say.

The table grows run by run; a sweep that was interrupted goes on where it was.
"""

import argparse
import math
import os
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from regen_table import generate
from rich.progress import Progress

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.run.results import as_json
from hubsim.scenario import faults
from hubsim.sweep import cases, faults_sweep, processes
from hubsim.sweep.faults_outcome import Outcome
from hubsim.sweep.faults_sweep import Case
from hubsim.words import counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CSV = "faults.csv"
LIMITS = (
    "distance", "wrong sign", "excess", "current", "bus", "reason", "healed", "acknowledged",
)  # fmt: skip
WORST = 8
MAX_CSV_BYTES = 100_000_000


def chosen(options: argparse.Namespace) -> list[Case]:
    """Return the runs that the command asks for."""
    wanted = {fault.name for fault in faults.named(options.names)}
    if options.reduced:
        found = [case for case in faults_sweep.reduced() if case.fault in wanted]
    else:
        share = options.demand_share
        shares = faults_sweep.DEMAND_SHARES if share is None else (share,)
        if min(shares) <= 0.0:
            raise HubsimError(f"--demand-share {share:g}: accepted: more than 0")
        found = faults_sweep.plan(
            faults.named(options.names),
            demand_shares=shares,
            exact=options.names,
            whole=options.whole_vehicle,
        )
    drives = list(dict.fromkeys(config for config, _ in faults_sweep.VEHICLES))
    if options.config is not None and options.config not in drives:
        raise HubsimError(f"--config {options.config}: accepted: {', '.join(drives)}")
    return [c for c in found if options.config in (None, c.group.config)]


def sweep(several: Sequence[Case], table: Path | None, workers: int | None, bar: Progress) -> list[
    Outcome
]:  # fmt: skip
    """Make the runs that the table does not have yet, append each lot to it, return all of it."""
    known = {outcome.key: outcome for outcome in _read(table)}
    missing = [case for case in several if case.key not in known]
    task = bar.add_task("faults", total=len(several), completed=len(several) - len(missing))
    lots = list(faults_sweep.tasks(missing))
    count = workers or os.cpu_count() or 1
    if count == 1 or len(lots) == 1:
        for group, members in lots:
            _keep(faults_sweep.measure(group, members), known, table)
            bar.advance(task, len(members))
    else:
        with processes.pool(count) as pool:
            waiting = [pool.submit(faults_sweep.measure, group, lot) for group, lot in lots]
            for done in as_completed(waiting):
                found = done.result()
                _keep(found, known, table)
                bar.advance(task, len(found))
    asked = {case.key: known[case.key] for case in several}
    return list((asked | known).values())


def _read(table: Path | None) -> list[Outcome]:
    if table is None or not table.exists():
        return []
    try:
        return cases.read_csv(Outcome, files.read_text(table, MAX_CSV_BYTES))
    except (TypeError, KeyError, ValueError) as error:
        raise HubsimError(f"{table}: no table of faults: {error}") from error


def _keep(found: Sequence[Outcome], known: dict[Any, Outcome], table: Path | None) -> None:
    known |= {outcome.key: outcome for outcome in found}
    if table is not None:
        files.write_text(table, cases.as_csv(list(known.values())))


def conclude(options: argparse.Namespace, bar: Progress) -> tuple[list[str], bool]:
    """Do the command, and return what there is to say and that it is done."""
    if options.list:
        return faults.lines(), True
    if options.workers is not None and options.workers < 1:
        raise HubsimError(f"--workers {options.workers}: accepted: a whole number from 1")
    several = chosen(options)
    if not several:
        raise HubsimError("no run: none of these faults exists with this drive's rotor sensor")
    if options.output is not None:
        files.make_directory(options.output)
    if options.json is not None:
        files.check_writable(options.json)
    table = None if options.output is None else options.output / CSV
    found = sweep(several, table, options.workers, bar)
    if options.json is not None:
        files.write_text(options.json, as_json([as_object(outcome) for outcome in found]))
    lines = [*by_fault(found), "", *summary(found)]
    if options.output is not None:
        from regen_table import plotting  # noqa: PLC0415, with Matplotlib, which no list needs

        made = cases.files_of("faults", found, summary(found), None, options.date)
        generate.write_all(made | plotting.rendered({"faults": figure(found)}), options.output)
    return lines, True


def _number(value: float, digits: int = 6) -> float | None:
    return round(value, digits) if math.isfinite(value) else None


def as_object(o: Outcome) -> dict[str, Any]:
    """Return a run as the JSON file has it; null: never."""
    return {
        "fault": o.fault,
        "config": o.config,
        "rotor_sensor": o.rotor_sensor,
        "demand_nm": o.demand_nm,
        "instant_s": o.instant_s,
        "distance_ratio": _number(o.distance_ratio),
        "wrong_sign_ms": _number(o.wrong_sign_ms),
        "current_ratio": _number(o.current_ratio),
        "bus_peak_v": _number(o.bus_peak_v),
        "bus_limit_v": o.bus_limit_v,
        "first_reason": o.first_reason or None,
        "reason_expected": bool(o.reason_expected),
        "time_to_reason_ms": _number(o.time_to_reason_ms),
        "harmless": bool(o.harmless),
        "final_mode": o.final_mode,
        "healed_under_braking": bool(o.healed_under_braking),
    }


def by_fault(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a table, a line for each fault: the worst of its runs."""
    head = (
        f"{'fault':24s} {'runs':>4s} {'miss':>4s} {'harmless':>8s} {'distance':>8s} "
        f"{'drives':>12s} {'current':>7s} {'bus':>7s}  first reason, after; final mode"
    )
    out = [head]
    for name in dict.fromkeys(o.fault for o in outcomes):
        here = [o for o in outcomes if o.fault == name]
        never = any(not math.isfinite(o.distance_ratio) for o in here)
        far = math.inf if never else max(o.distance_ratio for o in here)
        reason, _ = Counter(o.first_reason or "none" for o in here).most_common(1)[0]
        times = [o.time_to_reason_ms for o in here if math.isfinite(o.time_to_reason_ms)]
        after = f", {np.median(times):.0f} ms" if times else ""
        mode, _ = Counter(o.final_mode for o in here).most_common(1)[0]
        drives = max(here, key=lambda o: o.wrong_sign_ms)
        out.append(
            f"{name:24s} {len(here):4d} {sum(bool(o.misses()) for o in here):4d} "
            f"{sum(o.harmless for o in here):8d} {'never' if never else f'{far:.2f}':>8s} "
            f"{f'{drives.wrong_nm:.0f} Nm {drives.wrong_sign_ms:.0f} ms':>12s} "
            f"{max(o.current_ratio for o in here):7.2f} "
            f"{max(o.bus_peak_v for o in here):5.1f} V  {reason}{after}; {mode}"
        )
    return out


def severity(o: Outcome) -> float:
    """Return how bad a run is: the sum of what it misses, each over its limit."""
    distance = o.distance_ratio if math.isfinite(o.distance_ratio) else 10.0
    return (
        max(distance / 1.1 - 1.0, 0.0) * 5.0
        + o.wrong_sign_ms / 5.0 * max(o.wrong_nm, 0.0) / 40.0
        + max(o.current_ratio / 1.3 - 1.0, 0.0)
        + max(o.bus_peak_v / o.bus_limit_v - 1.0, 0.0) * 10.0
    )


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say about a sweep, a line each."""
    harmful = [o for o in outcomes if not o.harmless]
    named = sum(o.reason_expected for o in harmful)
    misses = Counter(miss for o in outcomes for miss in o.misses())
    share = 100.0 * named / max(len(harmful), 1)
    lines = [
        f"{counted(len(outcomes), 'run')} of {counted(len({o.fault for o in outcomes}), 'fault')}: "
        f"{sum(not o.misses() for o in outcomes)} hold every limit, "
        f"{len(outcomes) - len(harmful)} are harmless; of the others {share:.1f} % have an "
        "expected first reason",
        "missed: " + ", ".join(f"{limit} {misses.get(limit, 0)}" for limit in LIMITS),
    ]
    worst = sorted(outcomes, key=severity, reverse=True)[:WORST]
    lines.extend(f"worst: {_sentence(o)}" for o in worst if severity(o) > 0.0)
    return lines


def _sentence(o: Outcome) -> str:
    way = f"{o.distance_ratio:.2f} of the distance" if math.isfinite(o.distance_ratio) else "no end"
    return (
        f"{o.fault}, {o.config}, {o.rotor_sensor}, {o.situation} at {o.demand_nm:g} N m, at "
        f"{o.instant_s:g} s: {way}, drove with {o.wrong_nm:.1f} N m, {o.wrong_sign_ms:.0f} ms above"
        f" 2; {o.current_ratio:.2f} of the trip current, {o.bus_peak_v:.1f} V; "
        f"{o.first_reason or 'no reason'}, {o.final_mode}"
    )


def figure(outcomes: Sequence[Outcome]) -> "Figure":
    """Draw the share of each fault's runs that misses each limit.

    A fault and its mirror images share a line.
    """
    from regen_table import plotting  # noqa: PLC0415, as above

    first = {o.fault: faults.table()[o.fault].image_of for o in outcomes}
    names = list(dict.fromkeys(first.values()))
    share = np.zeros((len(names), len(LIMITS)))
    for k, name in enumerate(names):
        here = [o.misses() for o in outcomes if first[o.fault] == name]
        share[k] = [sum(limit in missed for missed in here) / len(here) for limit in LIMITS]
    made, panels = plotting.figure(
        "Share of runs that miss a limit, %", 1, 1, 7.0, 1.5 + 0.17 * len(names)
    )
    axes = panels[0]
    axes.imshow(100.0 * share, aspect="auto", cmap="Reds", vmin=0.0, vmax=100.0)
    for k in range(len(names)):
        for j in range(len(LIMITS)):
            if share[k, j] > 0.0:
                axes.text(
                    j,
                    k,
                    f"{100.0 * share[k, j]:.0f}",
                    ha="center",
                    va="center",
                    fontsize=6,
                    color="white" if share[k, j] > 0.5 else "black",
                )
    axes.set_xticks(range(len(LIMITS)), LIMITS, fontsize=7)
    axes.tick_params(top=True, labeltop=True)
    axes.set_yticks(range(len(names)), names, fontsize=6)
    axes.grid(visible=False)
    return made
