# SPDX-License-Identifier: Apache-2.0
"""What a report of the benchmark prints."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from benchmark import cycles, memory
from benchmark.functions import CURRENT_LOOP, FUNCTIONS, INTERRUPT


def steps(console: Console, report: dict[str, Any]) -> None:
    """Print what was measured."""
    table = Table(
        title=(
            f"Instructions a call: fast loop in a closed loop with {report['config']}, slow step"
            " over the envelope"
        ),
        title_justify="left",
    )
    for heading in (
        "core",
        "function",
        "calls",
        "min",
        "median",
        "99 %",
        "max",
        "code",
        "tables",
        "stack",
    ):
        table.add_column(heading, justify="left" if heading in ("core", "function") else "right")
    for core, result in report["cores"].items():
        for name, text in FUNCTIONS.items():
            value, size = result["instructions"][name], result["size_bytes"][name]
            cells = [
                value["calls"],
                value["min"],
                value["median"],
                value["p99"],
                value["max"],
                size["code"],
                size["tables"],
                result["stack_bytes"][name],
            ]
            table.add_row(
                core if name == CURRENT_LOOP else "", f"{text} ({name})", *map(str, cells)
            )
        table.add_section()
    console.print(table)
    for config, value in report["envelope"].items():
        state = ", ".join(f"{name} {number}" for name, number in value["worst_state"].items())
        console.print(
            f"Slow step, {config}, {value['calls']} states: median {value['median']}, 99 %"
            f" {value['p99']}, worst {value['max']} at {state}"
        )


def interrupt(console: Console, measured: dict[str, Any]) -> None:
    """Print the PWM interrupt's instructions, all of them and by what it met."""
    table = Table(
        title=f"Instructions of the PWM interrupt, {measured['image']}, {measured['config']}",
        title_justify="left",
    )
    columns = ("calls", "min", "median", "p99", "max")
    for heading in ("state", *columns):
        table.add_column(heading, justify="left" if heading == "state" else "right")
    for state, value in {"all": measured["instructions"], **measured["states"]}.items():
        table.add_row(state, *(str(value[column]) for column in columns))
    console.print(table)
    console.print(f"The worst was met while {measured['worst_state']}")
    for ride, value in measured["other_rides"].items():
        console.print(
            f"Other rides, {ride}: worst {value['instructions']} instructions, {value['least']} to"
            f" {value['most']} cycles, from cold flash {value['cold']}"
        )
    cycles.show(console, measured["cycles"])


def budgets(console: Console, outcomes: list[dict[str, Any]]) -> None:
    """Print which budgets are met."""
    for outcome in outcomes:
        unit = next((unit for unit in ("bytes", "cycles", "share") if unit in outcome), None)
        amount = (
            f"{outcome[unit]} of {outcome[f'{unit}_at_most']} {unit}"
            if unit
            else f"{outcome['median']} of {outcome['median_at_most']} instructions, max/median"
            f" {outcome['spread']}"
        )
        if outcome.get("p99_at_most") is not None:
            amount += f", 99 % within {outcome['p99']} of {outcome['p99_at_most']}"
        if outcome.get("max_at_most") is not None:
            amount += f", worst {outcome['max']} of {outcome['max_at_most']}"
        names = {**FUNCTIONS, INTERRUPT: "PWM interrupt"}
        name = names.get(outcome["function"], outcome["function"])
        what = ", ".join([f"{outcome['core']} {name}", *filter(None, [outcome.get("config")])])
        console.print(f"{'met   ' if outcome['met'] else 'MISSED'}  {what}: {amount}")


def sizes(console: Console, report: dict[str, Any]) -> None:
    """Print the firmware's size and the simulation's speed."""
    memory.show(console, report)
    if report["simulation"]:
        four, one = (
            report["simulation"][f"realtime_factor_{name}"] for name in ("four_wheels", "one_wheel")
        )
        console.print(f"Simulation on one core: four wheels {four}, one {one} times real time")
