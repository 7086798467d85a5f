# SPDX-License-Identifier: Apache-2.0
"""What a sweep of stops leaves behind: table, origin and picture, and what there is to say."""

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from regen_table import generate, plotting
from rich.progress import Progress

from hubsim import files
from hubsim.sweep import cases, drives, stored_share
from hubsim.sweep.stored_share import NOT_STARTED, SLOW_SHARE, TOLERANCE, TOLERANCE_LARGE, Outcome

SHOWN_PERCENT = 3.0  # what lies beyond is drawn on the edge
PERCENT = 100.0


def conclude(options: argparse.Namespace, bar: Progress) -> tuple[list[str], bool]:
    """Do the command; return what it says, and whether all stops are within."""
    cases.accept(options)
    files.make_directory(options.output)
    drawn = stored_share.draw(drives.DRIVES, options.count, options.seed)
    task = bar.add_task("stops", total=len(drawn))
    found = cases.measured(stored_share.measure, drawn, options.workers, lambda: bar.advance(task))
    lines = summary(found)
    table = cases.files_of("stops", found, lines, options.seed, options.date)
    generate.write_all(table | plotting.rendered({"stops": figure(found)}), options.output)
    return lines, holds(found)


def holds(outcomes: Sequence[Outcome]) -> bool:
    """Return whether all stops that have an ideal are within."""
    return all(o.within for o in outcomes if o.comparable)


def worst(outcomes: Sequence[Outcome], count: int = 5) -> list[Outcome]:
    """Return the comparable stops with the largest |difference| for their tolerance."""
    compared = [outcome for outcome in outcomes if outcome.comparable]
    return sorted(compared, key=lambda o: abs(o.difference) / o.tolerance, reverse=True)[:count]


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say about a sweep, a line each."""
    lines = []
    for name in dict.fromkeys(outcome.drive for outcome in outcomes):
        here = [outcome for outcome in outcomes if outcome.drive == name]
        compared = [outcome for outcome in here if outcome.comparable]
        faulted = sum(bool(outcome.first_fault) for outcome in here)
        started = [o.difference for o in compared if o.first_fault != NOT_STARTED]
        lines.append(
            f"{name}: {sum(o.within for o in compared)} of {len(compared)} within the tolerance, "
            f"{100.0 * min(started, default=0.0):+.2f} to {100.0 * max(started, default=0.0):+.2f} "
            f"% of the kinetic energy; {len(here) - len(compared)} without any currents inside "
            f"the limits; {faulted} with a fault; ripple at most "
            f"{100.0 * max(o.ripple_share_of_rated for o in here):.2f} % of rated"
        )
    for o in worst(outcomes):
        lines.append(
            f"worst: stop {o.number}, {o.drive}, {o.demand_nm:g} N m from {o.initial_speed_kmh:.1f}"
            f" km/h, {o.winding_temperature_c:.0f} degC, charge {o.soc:.3f}, {o.open_circuit_v:.1f}"
            f" V: {100.0 * o.stored:.2f} instead of {100.0 * o.ideal:.2f} %"
            f" ({o.first_fault or o.reason})"
        )
    return lines


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the difference to the ideal over the open-circuit voltage, a panel for each drive."""
    names = list(dict.fromkeys(outcome.drive for outcome in outcomes))
    made, panels = plotting.figure(
        "Stored share of the kinetic energy, firmware less ideal", 2, (len(names) + 1) // 2,
        10.0, 7.0,
    )  # fmt: skip
    groups = (
        (f"from {SLOW_SHARE:.0%} of the largest speed on", False, plotting.BLUE, TOLERANCE),
        (f"below {SLOW_SHARE:.0%}, or a charge current", True, plotting.ORANGE, TOLERANCE_LARGE),
    )
    for name, axes in zip(names, panels, strict=False):
        for text, wide, colour, tolerance in groups:
            here = [
                o
                for o in outcomes
                if o.drive == name and o.comparable and (o.tolerance == TOLERANCE_LARGE) == wide
            ]
            found = np.clip([PERCENT * o.difference for o in here], -SHOWN_PERCENT, SHOWN_PERCENT)
            axes.plot([o.open_circuit_v for o in here], found, ".", color=colour, label=text)
            for bound in (-tolerance, tolerance):
                axes.axhline(PERCENT * bound, color=colour, linewidth=0.8)
        axes.set(title=name, xlabel="open-circuit voltage, V", ylabel="% of the kinetic energy")
        axes.set_ylim(-1.05 * SHOWN_PERCENT, 1.05 * SHOWN_PERCENT)
    plotting.legend_below(made, panels[0], 2)
    return made
