# SPDX-License-Identifier: Apache-2.0
"""What the mutants of a module have come to: its score, and the changes that no test noticed."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mutants.operators import Change

ONE_IN_A_HUNDRED = 2.326
"""Standard deviations below the mean that a normal distribution exceeds in 99 of 100 cases."""


@dataclass(frozen=True)
class Survivor:
    """A change that no unit test notices; ``after`` is empty where a statement is left out."""

    file: str
    line: int
    operator: str
    before: str
    after: str

    @classmethod
    def of(cls, path: Path, change: Change) -> "Survivor":
        """Return a change of a file, by its path in the repository."""
        return cls(path.as_posix(), change.line, change.kind, change.original, change.replacement)

    def text(self) -> str:
        """Return the change on one line."""
        after = self.after or "(removed)"
        return f"{self.file}:{self.line}: {self.operator}: {self.before} -> {after}"


@dataclass(frozen=True)
class Result:
    """The mutants of one module, or a sample of them."""

    module: str
    mutants: int  # that there are
    compiled: int  # of these, that the tests met
    same_code: int  # for which the compiler makes the instructions of the unchanged code
    killed: int
    survivors: list[Survivor]

    @property
    def score(self) -> float:
        """Share of the mutants with code of their own that a test killed."""
        tested = self.compiled - self.same_code
        return self.killed / tested if tested else 1.0

    def least_here(self, least: float) -> float:
        """Return the score below which the module has, very likely, less than ``least``.

        That is ``least`` itself if all mutants were met. Of samples drawn at random from a module
        that has exactly ``least``, one in a hundred shows less than this.
        """
        tested = self.compiled - self.same_code
        left_out = 1.0 - self.compiled / self.mutants
        return least - ONE_IN_A_HUNDRED * math.sqrt(
            least * (1.0 - least) / max(tested, 1) * left_out
        )

    def meets(self, least: float) -> bool:
        """Return whether nothing speaks against a score of at least ``least``."""
        return self.score >= self.least_here(least)

    def text(self, least: float) -> str:
        """Return the closing line."""
        of_all = f" of {self.mutants}" if self.compiled < self.mutants else ""
        return (
            f"{self.module}: {self.compiled}{of_all} mutants compiled, {self.same_code} the same"
            f" code, {self.killed} killed, {len(self.survivors)} survived: score {self.score:.3f},"
            f" required {self.least_here(least):.3f}"
        )

    def as_json(self) -> dict[str, Any]:
        """Return the module's entry of the report."""
        return {
            "compiled": self.compiled,
            "same_code": self.same_code,
            "killed": self.killed,
            "score": self.score,
            "survivors": [asdict(survivor) for survivor in self.survivors],
        }
