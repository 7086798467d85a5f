# SPDX-License-Identifier: Apache-2.0
"""Kinetic energy that a stop stores, beside the ideal inside the same limits.

State of charge, demand, speed and winding temperature in a Latin hypercube for each drive that
comes along: the runs of ``hubsim stops``. Exit status 1 if a stop stores more or less than it
should, or has a fault.
"""

from collections.abc import Sequence

from hubsim.sweep import drives, stored_share, stored_share_report
from hubsim.sweep.stored_share import Outcome
from studies.common import Study, markdown


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the tables of the page: a line for each drive, and the worst stops."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name]
        compared = [o for o in here if o.comparable]
        differences = [100.0 * o.difference for o in compared]
        rows.append(
            (
                name,
                f"{sum(o.within for o in compared)} of {len(compared)}",
                len(here) - len(compared),
                f"{min(differences):+.2f} to {max(differences):+.2f}",
                f"{100.0 * max(o.ripple_share_of_rated for o in here):.2f}",
                sum(bool(o.first_fault) for o in here),
            )
        )
    columns = (
        "drive",
        "within",
        "without an ideal",
        "difference, % of the kinetic energy",
        "ripple at most, % of rated",
        "faults",
    )
    worst = [
        (
            o.number,
            o.drive,
            f"{o.demand_nm:g}",
            f"{o.initial_speed_kmh:.1f}",
            f"{o.winding_temperature_c:.0f}",
            f"{o.open_circuit_v:.1f}",
            f"{100.0 * o.stored:.2f}",
            f"{100.0 * o.ideal:.2f}",
            o.first_fault or o.reason,
        )
        for o in stored_share_report.worst(outcomes)
    ]
    of_a_stop = (
        "stop",
        "drive",
        "demand, N m",
        "from, km/h",
        "winding, °C",
        "open circuit, V",
        "stored, %",
        "ideal, %",
        "active bound",
    )
    return {"drives": markdown(columns, rows), "worst": markdown(of_a_stop, worst)}


STUDY = Study(
    name="stored_share",
    text=__doc__,
    outcome=Outcome,
    cases=lambda options: stored_share.draw(drives.DRIVES, options.count, options.seed),
    measure=stored_share.measure,
    summary=stored_share_report.summary,
    figure=stored_share_report.figure,
    tables=tables,
    holds=stored_share_report.holds,
    count=1040,
)
main = STUDY.main
