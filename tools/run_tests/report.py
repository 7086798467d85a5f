# SPDX-License-Identifier: Apache-2.0
"""What a run of ``tools/dev test`` did and what it took, for machines."""

import json
import resource
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from run_tests import cases
from run_tests.ctest import Result, Test

Times = dict[str, dict[str, float]]
"""Of configuring and building, in seconds, by preset."""


@dataclass
class Run:
    """The tests that were run, their results, and the names of those that were left out."""

    tests: Sequence[Test]
    results: dict[str, Result]
    left_out: list[str] = field(default_factory=list)
    not_built: list[str] = field(default_factory=list)

    def failed(self) -> list[str]:
        """Return the full names of the tests without a good result, and of broken builds."""
        names = [test.full_name for test in self.tests]
        bad = [name for name in names
               if (result := self.results.get(name)) is None
               or not (result.passed or result.skipped)]  # fmt: skip
        return [*bad, *(f"{preset}:build" for preset in self.not_built)]

    @property
    def good(self) -> bool:
        """Return True if every test ran and none failed."""
        return not self.failed()


def times_of(file: Path | None) -> Times:
    """Return the times by preset that a file has, a line for each: ``PRESET WORD SECONDS``."""
    times: Times = {}
    for line in file.read_text(encoding="utf-8").splitlines() if file and file.is_file() else ():
        preset, word, seconds = line.split()
        mine = times.setdefault(preset, {})
        mine[f"{word}_s"] = mine.get(f"{word}_s", 0.0) + float(seconds)
    return times


def _cpu_s() -> float:
    """Return the processor time of this process and of all that it has waited for.

    Those that the shell waited for before it became this process are among them.
    """
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def write(
    file: Path,
    run: Run,
    printed: dict[str, list[str]],
    times: Times,
    begin: float,
    cores: int,
) -> None:
    """Write a run as JSON.

    Parameters
    ----------
    file
        Where to.
    run
        The run.
    printed
        What its tests printed, by full name.
    times
        Of configuring and building, by preset.
    begin
        Of the whole command, in seconds since 1970.
    cores
        So many tests at the same time.
    """
    ran = [test for test in run.tests
           if (result := run.results.get(test.full_name)) and not result.skipped]  # fmt: skip
    presets = {}
    for name in dict.fromkeys([*times, *(test.preset for test in run.tests)]):
        test_s = sum(run.results[test.full_name].time_s for test in ran if test.preset == name)
        own = {"configure_s": 0.0, "build_s": 0.0} | times.get(name, {}) | {"test_s": test_s}
        presets[name] = {word: round(seconds, 1) for word, seconds in own.items()}
    proved, known = cases.proofs(ran, printed)
    content = {
        "wall_s": round(time.time() - begin, 1),
        "cpu_s": round(_cpu_s(), 1),
        "cores": cores,
        "presets": presets,
        "cases": {kind: dict(number) for kind, number in cases.counted(ran, printed).items()},
        "left_out": run.left_out,
        "failed": run.failed(),
        "proofs": {"run": proved, "cached": known},
    }
    file.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
