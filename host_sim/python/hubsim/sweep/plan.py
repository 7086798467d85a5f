# SPDX-License-Identifier: Apache-2.0
"""Which runs a sweep consists of.

What varies is a key as ``--set`` takes it and a specification: a list (``5,20,40``) or
``range(first,last,count)`` makes a grid, ``normal(mean,deviation)``, ``uniform(lowest,highest)``
and ``choice(a,b,...)`` are drawn anew for every run. Every draw depends on the sweep's seed, the
run's number and the key alone, so a plan is the same however it is worked off.
"""

import hashlib
import itertools
import json
import math
import re
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hubsim.errors import HubsimError
from hubsim.scenario.overrides import value_of

RUNS_MAX = 1_000_000
_CALL = re.compile(r"(range|normal|uniform|choice)\((.*)\)", re.DOTALL)
_ARGUMENTS = {
    "range": "range(first,last,count)",
    "normal": "normal(mean,deviation)",
    "uniform": "uniform(lowest,highest)",
}
ACCEPTED = (
    "a,b,... or range(first,last,count) or normal(mean,deviation) or uniform(lowest,highest) or"
    " choice(a,b,...)"
)


@dataclass(frozen=True)
class Varied:
    """A key that varies: over a grid's values, or as a distribution with its figures."""

    key: str
    kind: str
    values: tuple[Any, ...]

    @property
    def is_drawn(self) -> bool:
        """Whether every run draws a value of its own."""
        return self.kind != "grid"

    def draw(self, seed: int, run: int) -> Any:  # noqa: ANN401, whatever the choices are
        """Return the value of one run."""
        source = np.random.default_rng([seed, run, zlib.crc32(self.key.encode())])
        if self.kind == "choice":
            return self.values[int(source.integers(len(self.values)))]
        first, second = self.values
        return float(
            source.normal(first, second) if self.kind == "normal" else source.uniform(first, second)
        )


def read(text: str) -> Varied:
    """Read ``KEY=SPECIFICATION``."""
    key, equals, specification = (part.strip() for part in text.partition("="))
    if not key or not equals or not specification:
        raise HubsimError(f"--vary {text!r}: accepted: KEY={ACCEPTED}")
    call = _CALL.fullmatch(specification)
    if call is None:
        return Varied(key, "grid", _items(key, specification))
    kind, inner = call.groups()
    items = _items(key, inner)
    if kind == "choice":
        return Varied(key, kind, items)
    figures = [
        float(item)
        for item in items
        if isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item)
    ]
    wrong = len(figures) != len(items) or len(figures) != (3 if kind == "range" else 2)
    if not wrong and kind == "range":
        wrong = figures[2] < 2 or figures[2] > RUNS_MAX or figures[2] != int(figures[2])
    elif not wrong:
        wrong = figures[1] < 0.0 if kind == "normal" else figures[1] <= figures[0]
    if wrong:
        raise HubsimError(
            f"--vary {key}: {specification!r} is not accepted, accepted: {_ARGUMENTS[kind]} with "
            "numbers"
        )
    if kind == "range":
        return Varied(
            key, "grid", tuple(np.linspace(figures[0], figures[1], int(figures[2])).tolist())
        )
    return Varied(key, kind, tuple(figures))


def _items(key: str, text: str) -> tuple[Any, ...]:
    """Split at commas outside brackets and quotes, and read each value as ``--set`` does."""
    parts = re.findall(r"""(?:[^,\[\]"']|\[[^\]]*\]|"[^"]*"|'[^']*')+""", text)
    if not parts or len(parts) != text.count(",") + 1 - sum(part.count(",") for part in parts):
        raise HubsimError(f"--vary {key}: {text!r} is not accepted, accepted: {ACCEPTED}")
    return tuple(value_of(part.strip()) for part in parts)


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep: for every point of the grid, ``draws`` runs."""

    varied: tuple[Varied, ...]
    draws: int
    seed: int

    @property
    def runs(self) -> int:
        """How many runs there are."""
        return self.draws * math.prod(len(v.values) for v in self.varied if not v.is_drawn)

    def points(self) -> Iterator[dict[str, Any]]:
        """Go through the runs in the order of their numbers; what varies by key."""
        grid = [v for v in self.varied if not v.is_drawn]
        number = 0
        for point in itertools.product(*(v.values for v in grid)):
            for _ in range(self.draws):
                values = dict(zip((v.key for v in grid), point, strict=True))
                values |= {v.key: v.draw(self.seed, number) for v in self.varied if v.is_drawn}
                yield {v.key: values[v.key] for v in self.varied}
                number += 1


def make(specifications: Sequence[str], draws: int | None, seed: int) -> Plan:
    """Put a plan together from the command line's texts."""
    varied = tuple(read(text) for text in specifications)
    keys = [v.key for v in varied]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise HubsimError(f"--vary {twice}: accepted: once")
    random = any(v.is_drawn for v in varied)
    if draws is not None and not random:
        raise HubsimError(
            f"--runs {draws}: accepted: with a normal, uniform or choice among --vary"
        )
    if random and draws is None:
        raise HubsimError("--runs: missing, accepted: how many draws to make")
    plan = Plan(varied, draws or 1, seed)
    if not varied or plan.runs > RUNS_MAX:
        raise HubsimError(
            f"--vary: {plan.runs if varied else 'no'} runs, accepted: 1 to {RUNS_MAX}"
        )
    return plan


def fingerprint(described: Mapping[str, Any]) -> str:
    """Return the identity of a sweep."""
    return hashlib.sha256(json.dumps(described, sort_keys=True, default=str).encode()).hexdigest()[
        :16
    ]
