# SPDX-License-Identifier: Apache-2.0
"""What the commands share: arguments, the drive they mean, progress, and where to put a warning."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from regen_table import installation
from regen_table.schema import Drive
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from hubsim import engine, overrides, run
from hubsim.results import RunResult
from hubsim.scenario import Scenario

MOTORS = engine.ROOT / "tools" / "motors"
DEFAULT_CONFIG = MOTORS / "lu2013.toml"


class Parser(argparse.ArgumentParser):
    """Answers a wrong call with one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and exit with status 2."""
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def add_common(command: argparse.ArgumentParser) -> None:
    """Add what every command that runs something takes."""
    command.add_argument(
        "--config",
        type=installation.drive_file,
        default=DEFAULT_CONFIG,
        metavar="TOML",
        help="the drive, a file or the name of one that comes along; default: lu2013",
    )
    command.add_argument(
        "--set", dest="settings", action="append", default=[], metavar="KEY=VALUE",
        help="a key of the scenario (also events.NAME.key, criteria.NAME.key), section.key of the drive, or plant.section.key of the "
        "simulated world alone; repeatable",
    )  # fmt: skip


def add_strategy(command: argparse.ArgumentParser) -> None:
    """Add the choice of one braking strategy."""
    command.add_argument(
        "--strategy",
        choices=run.STRATEGIES,
        metavar="NAME",
        help=f"{', '.join(run.STRATEGIES)}; default: the drive's own",
    )


def drive_of(
    config: Path, settings: overrides.Overrides, strategy: str | None, chosen: Scenario
) -> Drive:
    """Read the drive that a command is to use."""
    if strategy is not None:
        settings.drive["brake", "strategy"] = strategy
    return overrides.load_drive(config, settings, chosen)


def progress_bar(unit: str = "s") -> Progress:
    """Return a progress display on stderr that stays silent where nobody watches."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn(unit), TimeRemainingColumn(),
        console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip


def warn_of(result: RunResult) -> None:
    """Say on stderr what a reader of figures alone would not notice.

    Faults, events that never came.
    """
    for fault in result.faults:
        print(
            f"hubsim: warning: {result.cycle}, {result.strategy}: wheel {fault.wheel} faulted at {fault.time_s:.3f} s: {fault.reason}",
            file=sys.stderr,
        )
    for name, at_s in result.missed.items():
        print(f"hubsim: warning: {result.cycle}: event {name} at {at_s:g} s never came: the run ended at {result.duration_s:g} s",
              file=sys.stderr)  # fmt: skip
