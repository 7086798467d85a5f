# SPDX-License-Identifier: Apache-2.0
"""The commands, a module each with ``main(options)``, and what they share.

The drive that a call means, progress, warnings.
"""

import sys
from pathlib import Path

from regen_table.schema import Drive
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from hubsim import overrides
from hubsim.results import RunResult
from hubsim.scenario import Scenario


def drive_of(
    config: Path, settings: overrides.Overrides, strategy: str | None, chosen: Scenario
) -> Drive:
    """Read the drive that a command is to use."""
    if strategy is not None:
        settings.drive["brake", "strategy"] = strategy
    return overrides.load_drive(config, settings, chosen)


def progress_bar(unit: str = "s") -> Progress:
    """Return a progress display on stderr that is silent where stderr is no terminal."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn(unit),
        TimeRemainingColumn(), console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip


def warn_of(result: RunResult) -> None:
    """Warn on stderr of faults and of events whose time the run did not reach."""
    for fault in result.faults:
        print(
            f"hubsim: warning: {result.cycle}, {result.strategy}: wheel {fault.wheel} faulted at "
            f"{fault.time_s:.3f} s: {fault.reason}",
            file=sys.stderr,
        )
    for name, at_s in result.missed.items():
        print(f"hubsim: warning: {result.cycle}: event {name} at {at_s:g} s never came: "
              f"the run ended at {result.duration_s:g} s",
              file=sys.stderr)  # fmt: skip
