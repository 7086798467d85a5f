# SPDX-License-Identifier: Apache-2.0
"""The combined run of the tests of all presets, and what they cost."""

import json
import os
from collections.abc import Sequence
from pathlib import Path

from run_tests import cases, ctest
from run_tests.ctest import Result, Test

ROOT = Path(__file__).resolve().parents[2]
PRESETS = ("host", "host-asan", "stm32f405", "qemu")
# Times of the tests in seconds, written by --keep-costs; only their order matters.
COSTS = Path(__file__).with_name("costs.json")


class Suite:
    """The folder of the combined run: its list of tests, the times of earlier runs, the records."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.folder = root / "build" / "test"
        self.opened = self.folder / "opened"
        self._measured = self.folder / "costs.json"
        self._log = self.folder / "Testing" / "Temporary" / "LastTest.log"
        self.opened.mkdir(parents=True, exist_ok=True)
        self.costs: dict[str, float] = {}
        for file in (COSTS, self._measured):
            if file.is_file():
                self.costs |= json.loads(file.read_text(encoding="utf-8"))

    def cost_s(self, test: Test) -> float:
        """Return how long a test will take, in seconds."""
        return ctest.cost_s(test, self.costs)

    def run(self, tests: Sequence[Test], limit_s: float | None = None) -> dict[str, Result]:
        """Run tests, keep their times, and return their results by full name."""
        for test in tests:
            (self.opened / test.full_name).unlink(missing_ok=True)
        text = ctest.suite_text(tests, self.costs, self.opened, self.root)
        (self.folder / "CTestTestfile.cmake").write_text(text, encoding="utf-8")
        self._log.unlink(missing_ok=True)
        _, results = ctest.run(self.folder, jobs(), limit_s)
        known = {name for name, lines in self.printed().items() if cases.only_known(lines)}
        self.costs |= {name: result.time_s for name, result in results.items()
                       if result.passed and name not in known}  # fmt: skip
        self._measured.write_text(json.dumps(self.costs, indent=0), encoding="utf-8")
        return results

    def printed(self) -> dict[str, list[str]]:
        """Return what the tests of the last run printed, by full name."""
        return cases.outputs(self._log) if self._log.is_file() else {}

    def keep_costs(self) -> None:
        """Write the times of the tests there are now into the repository, for a fresh clone.

        In whole seconds, and without small changes, so that the file seldom changes.
        """
        names = {test.full_name for name in PRESETS for test in ctest.listed(self.root, name)}
        before = json.loads(COSTS.read_text(encoding="utf-8")) if COSTS.is_file() else {}
        kept = {name: steady_s(before.get(name), cost_s)
                for name, cost_s in sorted(self.costs.items()) if name in names}  # fmt: skip
        COSTS.write_text(json.dumps(kept, indent=0) + "\n", encoding="utf-8")


def steady_s(before_s: int | None, now_s: float) -> int:
    """Return a time in whole seconds; the one before where the difference does not matter."""
    if before_s is not None and abs(now_s - before_s) <= max(1.0, 0.3 * before_s):
        return before_s
    return round(now_s)


def jobs() -> int:
    """Return how many tests run at the same time."""
    return len(os.sched_getaffinity(0))


def closing_lines(preset: str, tests: Sequence[Test], results: dict[str, Result]) -> list[str]:
    """Return ctest's closing lines for the tests of one preset: count, time, failures by name."""
    mine = [(test, results.get(test.full_name)) for test in tests if test.preset == preset]
    failed = [
        f"\t{test.name} ({result.outcome if result else 'Not Run'})"
        for test, result in mine
        if result is None or not (result.passed or result.skipped)
    ]
    skipped = [f"\t{test.name} (Skipped)" for test, result in mine if result and result.skipped]
    share = round(100 * (len(mine) - len(failed)) / len(mine)) if mine else 0
    if failed and share == 100:
        share = 99
    lines = [
        f"{preset}:",
        f"{share}% tests passed, {len(failed)} tests failed out of {len(mine)}",
        f"Sum of the tests' times = {sum(r.time_s for _, r in mine if r):.2f} sec",
    ]
    if skipped:
        lines += ["The following tests did not run:", *skipped]
    if failed:
        lines += ["The following tests FAILED:", *failed]
    return lines
