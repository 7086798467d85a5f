# SPDX-License-Identifier: Apache-2.0
"""Tables of energies and criteria on the terminal, and warnings of a drive."""

import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, cast

from regen_table import bus_capacitor, shortcomings
from regen_table.schema import Drive
from rich import box
from rich.console import Console, JustifyMethod
from rich.table import Table

from hubsim.run import ideal_stop
from hubsim.run.evaluation import CriterionResult
from hubsim.run.results import RunResult

KILO = 1e3
PERCENT = 100.0

# Key in the summary, heading, what it is.
ENERGIES = (
    (
        "traction",
        "traction",
        "chemical energy drawn from the battery while the driver does not brake",
    ),
    (
        "braking_at_wheels",
        "braking work",
        "work of motors and hydraulic brakes at the wheels while the driver brakes",
    ),
    (
        "battery_returned",
        "returned",
        "net chemical energy into the battery while the driver brakes",
    ),
    ("hydraulic", "hydraulic", "heat in the hydraulic brakes, whole run"),
    ("copper", "copper", "heat in the windings, whole run"),
    ("iron", "iron", "heat in the iron, whole run"),
    ("inverter", "inverter", "heat in the inverters (conduction, diodes, switching), whole run"),
    ("battery", "battery", "heat in the battery, whole run"),
)


def warned(config: Path, drive: Drive) -> Drive:
    """Return a drive; warn on stderr, once, of what decides a run and was not given.

    Also of a bus capacitor too small for its devices.
    """
    for found in filter(None, (shortcomings.absent_soc(drive), bus_capacitor.warning(drive))):
        _warn_once(f"hubsim: warning: {config}: {found}")
    return drive


@cache
def _warn_once(line: str) -> None:
    print(line, file=sys.stderr)


def energy_table(results: Sequence[RunResult]) -> Table:
    """Return the energy table, a column for each run.

    Share of the series optimum where that is among them.
    """
    best = next((r.returned_j for r in results if r.strategy == "series_optimal"), None)
    best = best if len(results) > 1 else None
    title = f"{results[0].cycle}: energies of the whole vehicle in kJ"
    table = Table(title=title, title_justify="left", pad_edge=False, box=box.SIMPLE_HEAD)
    table.add_column("")
    for result in results:
        table.add_column(result.strategy, justify="right")
    columns = [result.run_object["energy_j"] for result in results]
    for key, heading, _ in ENERGIES:
        table.add_row(heading, *(f"{column[key] / KILO:.2f}" for column in columns))
    table.add_section()
    table.add_row(
        "share of braking work stored",
        *(f"{PERCENT * r.braking_share_stored:.1f} %" for r in results),
    )
    if best is not None and best > 0.0:
        table.add_row(
            "share of the series optimum",
            *(f"{PERCENT * r.returned_j / best:.1f} %" for r in results),
        )
    if any(r.ideal for r in results):
        table.add_row("share that the ideal stop stores", *map(_ideal_share, results))
    table.add_row("energy residual", *(f"{r.residual_relative:.1e}" for r in results))
    return table


def _ideal_share(result: RunResult) -> str:
    share = ideal_stop.ideal_share(result.ideal)
    return "" if share is None else f"{PERCENT * share:.1f} %"


def limits_cost(ideal: Mapping[str, Any]) -> list[str]:
    """Return the line about what the drive's limits cost an ideal stop; none where they do not."""
    costs = ideal.get("limits_cost_j") or {}
    listed = ", ".join(f"{name} {joule / KILO:.2f} kJ" for name, joule in costs.items())
    return [f"what the drive's limits cost the ideal stop: {listed}"] if costs else []


def definitions() -> list[str]:
    """Return what the table's rows mean, one line each."""
    lines = [f"{heading}: {text}" for _, heading, text in ENERGIES]
    return [*lines, "share of braking work stored: returned / braking work"]


def criteria_table(name: str, evaluated: Sequence[CriterionResult]) -> Table:
    """Return the criteria of a run with what they came to."""
    applied = [outcome for outcome in evaluated if outcome.applies]
    met = sum(outcome.passed for outcome in applied)
    table = Table(
        title=f"{name}: {met} of {len(applied)} criteria met",
        title_justify="left",
        pad_edge=False,
        box=box.SIMPLE_HEAD,
    )
    for heading, justify in (
        ("criterion", "left"),
        ("value", "right"),
        ("at least", "right"),
        ("at most", "right"),
        ("unit", "left"),
    ):
        table.add_column(heading, justify=cast(JustifyMethod, justify))
    table.add_column("")
    table.add_column("", overflow="fold")
    for v in evaluated:
        limits = ["" if limit is None else f"{limit:.5g}" for limit in (v.at_least, v.at_most)]
        value = f"{v.value:.5g}" if v.applies else ""
        outcome = ("pass" if v.passed else "FAIL") if v.applies else ""
        table.add_row(v.name, value, *limits, v.unit, outcome, v.remark)
    return table


def print_criteria(name: str, evaluated: Sequence[CriterionResult]) -> None:
    """Print the criteria on stdout."""
    _console().print(criteria_table(name, evaluated))


def print_table(results: Sequence[RunResult]) -> None:
    """Print the energy table on stdout."""
    _console().print(energy_table(results))


def _console() -> Console:
    """Return a console on stdout that does not wrap lines in a narrow terminal."""
    return Console(highlight=False, width=None if Console().is_terminal else 120)
