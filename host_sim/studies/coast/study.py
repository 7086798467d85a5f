# SPDX-License-Identifier: Apache-2.0
"""Torque of a motor of which none is wanted, beside the least that physics allows.

Speed up to 110 % of the largest, battery and slope in a Latin hypercube for each drive that comes
along, the battery connected or disconnecting while the vehicle coasts, brakes or drives. Exit
status 1 if a case has more torque or bus voltage than it should, or a fault.
"""

from collections.abc import Sequence

import numpy as np
from hubsim.sweep import drives
from matplotlib.figure import Figure
from regen_table import plotting
from studies.coast import runs
from studies.coast.runs import BRAKE, COAST, DRIVE, Outcome
from studies.common import Study, markdown

SHOWN_NM = -2.0  # what lies below, inside the feasible minimum, is drawn on the edge


def worst(outcomes: Sequence[Outcome], count: int = 5) -> list[Outcome]:
    """Return the cases with the largest excess for their tolerance."""
    return sorted(outcomes, key=lambda o: o.excess_nm / o.tolerance_nm, reverse=True)[:count]


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say about a sweep, a line each."""
    lines = []
    for name in dict.fromkeys(outcome.drive for outcome in outcomes):
        here = [outcome for outcome in outcomes if outcome.drive == name]
        stays = [o.excess_nm for o in here if not np.isfinite(o.cut_s)]
        leaves = [o.excess_nm for o in here if np.isfinite(o.cut_s)]
        lines.append(
            f"{name}: {sum(o.within for o in here)} of {len(here)} within "
            f"{here[0].tolerance_nm:g} N m beyond the feasible minimum; worst "
            f"{max(stays, default=0.0):.2f} N m with the battery, {max(leaves, default=0.0):.2f} "
            f"N m where it leaves; bus at most {100.0 * max(o.highest_bus_share for o in here):.0f}"
            f" % of the rating; {sum(bool(o.first_fault) for o in here)} with a fault"
        )
        lines.extend(f"worst: {_sentence(o)}" for o in worst(here, 2))
    return lines


def _sentence(o: Outcome) -> str:
    cut = f"battery leaves at {o.cut_s:g} s" if np.isfinite(o.cut_s) else "battery stays"
    return (
        f"case {o.number}, {o.drive}, {o.demand} from {o.initial_speed_kmh:.1f} km/h, slope "
        f"{o.slope_percent:.1f} %, {o.open_circuit_v:.1f} V, {cut}: {o.torque_nm:.1f} N m at "
        f"{o.at_s:.3f} s, {o.speed_kmh:.1f} km/h and {o.bus_v:.1f} V where {o.way} takes "
        f"{o.least_nm:.1f}, {o.excess_nm:.2f} beyond; {o.first_fault or o.warning or 'no warning'}"
    )


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: a line for each drive."""
    rows = []
    for name in dict.fromkeys(outcome.drive for outcome in outcomes):
        here = [outcome for outcome in outcomes if outcome.drive == name]
        stays = [o for o in here if not np.isfinite(o.cut_s)]
        leaves = [o for o in here if np.isfinite(o.cut_s)]
        rows.append(
            (
                name,
                *(f"{sum(o.within for o in some)} of {len(some)}" for some in (stays, leaves)),
                *(f"{_most_nm(some):.1f}" for some in (stays, leaves)),
                f"{100.0 * max(o.highest_bus_share for o in here):.0f} %",
                sum(bool(o.first_fault) for o in here),
            )
        )
    columns = (
        "drive",
        "within, battery stays",
        "within, battery leaves",
        "most beyond, stays, N m",
        "most beyond, leaves, N m",
        "bus, of the rating",
        "faults",
    )
    return {"drives": markdown(columns, rows)}


def _most_nm(outcomes: Sequence[Outcome]) -> float:
    return max((max(o.excess_nm, 0.0) for o in outcomes), default=0.0)


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the torque beyond the least over speed, a panel for each drive."""
    names = list(dict.fromkeys(outcome.drive for outcome in outcomes))
    made, panels = plotting.figure(
        "Motor torque beyond iron drag and feasible minimum",
        2,
        (len(names) + 1) // 2,
        10.0,
        7.0,
    )
    groups = (
        ("coasting, battery stays", COAST, False, plotting.BLUE),
        ("coasting, battery leaves", COAST, True, plotting.GREEN),
        ("braking, battery leaves", BRAKE, True, plotting.ORANGE),
        ("driving, battery leaves", DRIVE, True, plotting.RED),
    )
    for name, axes in zip(names, panels, strict=False):
        for text, demand, leaves, colour in groups:
            here = [
                o
                for o in outcomes
                if (o.drive, o.demand, bool(np.isfinite(o.cut_s))) == (name, demand, leaves)
            ]
            axes.plot(
                [100.0 * o.speed_share_of_top for o in here],
                [max(o.excess_nm, SHOWN_NM) for o in here],
                ".",
                color=colour,
                label=text,
            )
        tolerance = max((o.tolerance_nm for o in outcomes if o.drive == name), default=0.0)
        axes.axhline(tolerance, color="0.3", linewidth=0.8)
        axes.set(title=name, xlabel="initial speed, % of the largest", ylabel="N m")
    plotting.legend_below(made, panels[0], 2)
    return made


STUDY = Study(
    name="coast",
    text=__doc__,
    outcome=Outcome,
    cases=lambda options: runs.draw(drives.DRIVES, options.count, options.seed),
    measure=runs.measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    count=2000,
)
main = STUDY.main
