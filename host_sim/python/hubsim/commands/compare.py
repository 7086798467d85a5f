# SPDX-License-Identifier: Apache-2.0
"""``hubsim compare``: two results, or two runs, side by side."""

import argparse
import sys
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from regen_table import provenance
from rich import box
from rich.console import Console
from rich.table import Table

from hubsim import commands, difference, files, overrides, run, scenario
from hubsim.commands.run import DEFAULT_SIGNALS
from hubsim.difference import Difference, Side, Tolerance
from hubsim.errors import HubsimError
from hubsim.results import as_json, json_object


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    for name in ("absolute", "relative"):
        if not 0.0 <= getattr(options, name) < float("inf"):
            raise HubsimError(f"--{name} {getattr(options, name)}: accepted: a number from 0")
    if options.json:
        files.check_writable(options.json)
    first, second = (
        _side(options, name, extra)
        for name, extra in ((options.first, options.set_a), (options.second, options.set_b))
    )
    found = difference.compare(first, second, Tolerance(options.absolute, options.relative))
    if options.only:
        found = [
            d
            for d in found
            if any(fnmatchcase(d.name, pattern) for pattern in options.only.split(","))
        ]
    if not found:
        raise HubsimError(f"{options.first} and {options.second}: nothing in common to compare")
    if options.json:
        written = {
            "provenance": provenance.provenance(date=options.date),
            "sides": [{"name": s.name, "provenance": s.origin} for s in (first, second)],
            "differences": [d.as_object() for d in found],
        }
        files.write_text(options.json, as_json(written))
    apart = [d for d in found if not d.within]
    _print(first.name, second.name, found if options.all else apart)
    alone = difference.only_in_one(first, second)
    if alone and not options.only:
        print(
            "hubsim: in one of them only: "
            f"{', '.join(alone[:8])}{' ...' if len(alone) > 8 else ''}",
            file=sys.stderr,
        )
    print(f"{len(found) - len(apart)} of {len(found)} figures and signals within the tolerances")
    return 1 if apart else 0


def _side(options: argparse.Namespace, name: str, extra: Sequence[str]) -> Side:
    if name not in scenario.builtin_names() and not name.endswith(".toml"):
        if extra:
            raise HubsimError(
                f"{name}: was run already, accepted: --set-a and --set-b with scenarios"
            )
        return difference.read(Path(name))
    settings = overrides.parse([*options.settings, *extra])
    title, chosen, beside = scenario.load(name, settings.scenario)
    drive = commands.drive_of(options.config, settings, None, chosen)
    result = run.simulate(
        title, drive, chosen, beside, DEFAULT_SIGNALS, settings.plant, date=options.date
    )
    commands.warn_of(result)
    signals = {signal: result.signal(signal) for signal in result.names}
    label = " ".join([title, *extra]) if extra else title
    return Side(label, difference.figures_of(json_object(result)), signals, result.origin)


def _print(first: str, second: str, found: Sequence[Difference]) -> None:
    if not found:
        return
    table = Table(
        title=f"A: {first}\nB: {second}", title_justify="left", pad_edge=False, box=box.SIMPLE_HEAD
    )
    table.add_column("figure, or signal (means)")
    for heading in ("A", "B", "largest difference", "at s", "rms"):
        table.add_column(heading, justify="right")
    table.add_column("")
    for d in found:
        table.add_row(
            d.name,
            f"{d.first:.6g}",
            f"{d.second:.6g}",
            f"{d.largest:.3g}",
            "" if d.at_s is None else f"{d.at_s:g}",
            "" if d.rms is None else f"{d.rms:.3g}",
            "" if d.within else "DIFFERS",
        )
    Console(highlight=False, width=None if Console().is_terminal else 140).print(table)
