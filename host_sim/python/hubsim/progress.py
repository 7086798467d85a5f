# SPDX-License-Identifier: Apache-2.0
"""What a long command shows on stderr: bars on a terminal, else a line now and then."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

FIRST_S = 2.0
GROWTH = 2.0  # of the time from line to line
LONGEST_S = 60.0


@contextmanager
def shown(unit: str = "s") -> Iterator[Progress]:
    """Show the tasks of a command until it is done, done and total in a unit."""
    console = Console(stderr=True)
    bars = Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn(unit),
        TimeRemainingColumn(), console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip
    if console.is_terminal:
        with bars:
            yield bars
        return
    ended = threading.Event()
    teller = threading.Thread(target=_tell, args=(bars, unit, ended), daemon=True)
    teller.start()
    try:
        yield bars
    finally:
        ended.set()
        teller.join()


def _tell(bars: Progress, unit: str, ended: threading.Event) -> None:
    """Print a line after 2 s, 4 s, 8 s and so on until the end."""
    begun, pause_s = time.monotonic(), FIRST_S
    while not ended.wait(pause_s):
        print(f"{time.monotonic() - begun:.0f} s: {_line(bars, unit)}", file=sys.stderr, flush=True)
        pause_s = min(pause_s * GROWTH, LONGEST_S)


def _line(bars: Progress, unit: str) -> str:
    """Return how far every task that is not done has come."""
    found = [
        f"{task.description} {task.completed:.0f} of {task.total:.0f} {unit}"
        for task in bars.tasks
        if task.total is not None and not task.finished
    ]
    return ", ".join(found) or "preparing"
