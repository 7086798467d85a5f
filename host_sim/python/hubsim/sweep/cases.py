# SPDX-License-Identifier: Apache-2.0
"""Many short runs of several drives: draw them, measure them in parallel, keep them as a table.

A case is a frozen dataclass that says what to run; an outcome is one of int, float and str fields
that says what came of it. ``stored_share`` and the studies (host_sim/studies) define theirs.
"""

import argparse
import csv
import io
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import Field, asdict, fields
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from regen_table import installation

from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run.results import as_json
from hubsim.sweep import processes


class DataclassInstance(Protocol):
    """What an instance of any dataclass has."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


Case = TypeVar("Case")
Outcome = TypeVar("Outcome", bound=DataclassInstance)

CHUNK = 4  # cases that a process takes at a time


def hypercube(
    drives: Sequence[str],
    count: int,
    seed: int,
    ranges: int,
    case: Callable[[str, int, Rows], Case],
) -> list[Case]:
    """Return so many cases, the drives in turn, each drive's a Latin hypercube.

    ``case`` gets a drive's name, the number among that drive's cases and a share 0 to 1 for each
    of the ranges.
    """
    found: list[list[Case]] = []
    for k, name in enumerate(drives):
        here = (count + len(drives) - 1 - k) // len(drives)
        source = np.random.default_rng([seed, *name.encode()])
        cells = np.stack([source.permutation(here) for _ in range(ranges)])
        shares = (cells + source.random(cells.shape)) / max(here, 1)
        found.append([case(name, j, shares[:, j]) for j in range(here)])
    return [several[j] for j in range(len(found[0])) for several in found if j < len(several)]


def measured(
    measure: Callable[[int, Case], Outcome],
    cases: Sequence[Case],
    workers: int | None = None,
    progress: Callable[[], None] | None = None,
) -> list[Outcome]:
    """Measure all cases, in as many processes as there are cores; order and result are the same.

    ``measure`` is a function of a module, not of a function: other processes look it up by name.
    """
    count = workers or os.cpu_count() or 1
    numbers = range(len(cases))
    if count == 1:
        return list(_counted(map(measure, numbers, cases), progress))
    with processes.pool(count) as pool:
        return list(_counted(pool.map(measure, numbers, cases, chunksize=CHUNK), progress))


def _counted(found: Iterable[Outcome], progress: Callable[[], None] | None) -> Iterable[Outcome]:
    for outcome in found:
        if progress is not None:
            progress()
        yield outcome


def as_csv(outcomes: Sequence[Outcome]) -> str:
    """Return a table, a line for each outcome, six digits of each number."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(outcomes[0])])
    for outcome in outcomes:
        writer.writerow(
            f"{value:.6g}" if isinstance(value, float) else value
            for value in asdict(outcome).values()
        )
    return text.getvalue()


def read_csv(kind: type[Outcome], text: str) -> list[Outcome]:
    """Read back what ``as_csv`` wrote of outcomes of this kind."""
    kinds = {field.name: field.type for field in fields(kind)}
    readers: dict[object, Callable[[str], Any]] = {int: int, float: float, str: str}
    return [
        kind(**{name: readers[kinds[name]](value) for name, value in row.items()})
        for row in csv.DictReader(io.StringIO(text))
    ]


def accept(options: argparse.Namespace) -> None:
    """Refuse numbers of ``--count``, ``--workers`` and ``--seed`` that mean nothing."""
    for name, least in (("count", 1), ("workers", 1), ("seed", 0)):
        value = getattr(options, name, None)
        if value is not None and value < least:
            raise HubsimError(f"--{name} {value}: accepted: a whole number from {least}")


def files_of(
    name: str, outcomes: Sequence[Outcome], lines: Sequence[str], seed: int | None, date: str | None
) -> dict[str, bytes]:
    """Return the table NAME.csv and its origin NAME.json, with the lines that sum it up."""
    origin = installation.provenance(scenario=name, seed=seed, date=date)
    content = as_json({"provenance": origin, "summary": lines})
    return {f"{name}.csv": as_csv(outcomes).encode(), f"{name}.json": content.encode()}
