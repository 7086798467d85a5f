# SPDX-License-Identifier: Apache-2.0
"""``python -m run_tests``: what ``tools/dev test`` calls; its help describes the options."""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from run_tests import cases, choose, ctest, report
from run_tests.choose import BuildGraph
from run_tests.ctest import Result, Test
from run_tests.report import Run

ROOT = Path(__file__).resolve().parents[2]
PRESETS = ("host", "host-asan", "stm32f405", "qemu")
# The sanitizers' build repeats the host's tests, so a quick run leaves it out.
QUICK_PRESETS = ("host", "stm32f405", "qemu")
QUICK_S = 60.0
QUICK_BUILD_S = 35.0
QUICK_END_S = 57.0
TARGETS_AT_ONCE = 8
# Times of the tests in seconds, written by --keep-costs; only their order matters.
COSTS = Path(__file__).with_name("costs.json")
LEAST_KEPT_S = 1.5


class Suite:
    """The folder of the combined run: its list of tests, the times of earlier runs, the records."""

    def __init__(self, root: Path) -> None:
        self._root = root
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
        text = ctest.suite_text(tests, self.costs, self.opened, self._root)
        (self.folder / "CTestTestfile.cmake").write_text(text, encoding="utf-8")
        self._log.unlink(missing_ok=True)
        _, results = ctest.run(self.folder, jobs(), limit_s)
        self.costs |= {name: result.time_s for name, result in results.items() if result.passed}
        self._measured.write_text(json.dumps(self.costs, indent=0), encoding="utf-8")
        return results

    def printed(self) -> dict[str, list[str]]:
        """Return what the tests of the last run printed, by full name."""
        return cases.outputs(self._log) if self._log.is_file() else {}

    def keep_costs(self) -> None:
        """Write the times of the tests there are now into the repository, for a fresh clone."""
        names = {test.full_name for name in PRESETS for test in ctest.listed(self._root, name)}
        kept = {name: round(cost_s) for name, cost_s in sorted(self.costs.items())
                if name in names and cost_s >= LEAST_KEPT_S}  # fmt: skip
        COSTS.write_text(json.dumps(kept, indent=0) + "\n", encoding="utf-8")


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


def run_chosen(
    suite: Suite, presets: Sequence[str], tests: list[Test], options: argparse.Namespace
) -> Run:
    """Run the tests and print the output of ctest, then the closing lines of each preset."""
    full = options.full
    long = [] if full else [test for test in tests if ctest.FULL_LABEL in test.labels]
    tests = [test for test in tests if test not in long]
    begin = time.monotonic()
    results = suite.run(tests) if tests else {}
    before = (
        f"Set-up took {options.setup_s} s, building {options.build_s} s, "
        if options.setup_s
        else ""
    )
    print(f"\n{before}testing {time.monotonic() - begin:.0f} s.".replace("\nt", "\nT"))
    if long:
        print(
            f"{len(long)} tests labelled {ctest.FULL_LABEL} were left out; "
            "./tools/dev test --full runs them."
        )
    for preset in presets:
        print("\n".join(closing_lines(preset, tests, results)))
    print(cases.closing_line(tests, results, suite.printed()))
    not_built = [name for name in options.not_built.split(",") if name]
    run = Run(tests, results, [test.full_name for test in long], not_built)
    failed = list(dict.fromkeys(name.partition(":")[0] for name in run.failed()))
    failed = [f"{name} (build)" if name in not_built else name for name in failed]
    sys.stdout.flush()
    if failed:
        print(f"tools/dev: failed: {' '.join(failed)}", file=sys.stderr)
    elif not tests:
        sys.exit("run_tests: no test was found")
    return run


def in_time(tests: Sequence[Test], suite: Suite, budget_s: float) -> list[Test]:
    """Return the shortest tests that together fit into a time on all cores."""
    chosen = []
    left_s = budget_s * jobs()
    for test in sorted(tests, key=suite.cost_s):
        cost_s = suite.cost_s(test)
        if cost_s <= min(left_s, budget_s):
            left_s -= cost_s
            chosen.append(test)
    return chosen


def build_in_time(preset: str, targets: Sequence[Path], end: float) -> set[Path]:
    """Build targets, a few at a time, until a time; return those that are built.

    A compiler's error ends the whole run.
    """
    directory = ROOT / "build" / preset
    built: set[Path] = set()
    for first in range(0, len(targets), TARGETS_AT_ONCE):
        left_s = end - time.monotonic()
        if left_s <= 0:
            break
        batch = targets[first : first + TARGETS_AT_ONCE]
        names = [str(path.relative_to(directory)) for path in batch]
        try:
            answer = subprocess.run(
                ["ninja", "-C", str(directory), *names],
                capture_output=True,
                text=True,
                timeout=left_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            break
        if answer.returncode != 0:
            sys.exit(answer.stdout[-4000:] + f"run_tests: {preset}: the build failed")
        built.update(batch)
    return built


def bring_up_to_date(preset: str) -> None:
    """Let CMake configure again if what it reads has changed, before its lists are read."""
    command = ["ninja", "-C", str(ROOT / "build" / preset), "build.ninja"]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        sys.exit(answer.stdout[-4000:] + f"run_tests: {preset} cannot be configured")


def quick(suite: Suite, revision: str, times: dict[str, dict[str, float]]) -> Run:
    """Build and test what belongs to the files changed since a revision, in at most 60 s.

    times: of configuring and building, by preset, which are added.
    """
    begin = time.monotonic()
    changed = choose.changed_since(ROOT, revision)
    presets = [name for name in QUICK_PRESETS if (ROOT / "build" / name / "build.ninja").is_file()]
    if "host" not in presets:
        sys.exit("run_tests: --quick needs a tree that './tools/dev test' has built")
    wanted: list[Test] = []
    ready: list[Test] = []
    unknown: list[Test] = []
    explained = set()
    for preset in presets:
        at = [time.monotonic()]
        bring_up_to_date(preset)
        at.append(time.monotonic())
        graph = BuildGraph(ROOT / "build" / preset)
        tests = ctest.listed(ROOT, preset)
        mine = choose.of_changes(tests, changed, graph, suite.opened)
        for path in changed:
            if choose.of_changes(tests, {path}, graph, suite.opened):
                explained.add(path)
        unknown += [
            test for test in tests
            if "python" in test.labels
            and not (suite.opened / test.full_name).is_file()
            and test not in mine
        ]  # fmt: skip
        wanted += mine
        affordable = in_time(mine, suite, QUICK_S / 2)
        needs = {test: choose.products(test, graph, suite.opened) for test in affordable}
        targets = list(dict.fromkeys(path for test in affordable for path in sorted(needs[test])))
        at.append(time.monotonic())
        built = build_in_time(preset, targets, begin + QUICK_BUILD_S)
        times[preset] = {"configure_s": at[1] - at[0], "build_s": time.monotonic() - at[2]}
        ready += [test for test in affordable if needs[test] <= built]
    chosen = in_time(ready, suite, QUICK_END_S - 5.0 - (time.monotonic() - begin))
    results: dict[str, Result] = {}
    if chosen:
        results = suite.run(chosen, QUICK_END_S - (time.monotonic() - begin))
    done = [test for test in chosen if test.full_name in results]
    print()
    print(f"{len(changed)} files changed since {revision}; {len(wanted)} tests belong to them.")
    unexplained = sorted(str(path.relative_to(ROOT)) for path in changed - explained)
    if unexplained:
        print(f"No test is known to read: {', '.join(unexplained)}.")
    left = [test for test in wanted if test not in done]
    if left:
        shown = ", ".join(test.full_name for test in left[:12])
        more = f" and {len(left) - 12} more" if len(left) > 12 else ""
        print(f"Left out to save time: {len(left)} tests: {shown}{more}.")
    if unknown:
        print(
            "Left out, as what they read is known only after './tools/dev test': "
            f"{len(unknown)} Python tests."
        )
    print(
        "The build with sanitizers was left out. All of this took"
        f" {time.monotonic() - begin:.0f} s."
    )
    for preset in sorted({test.preset for test in done}, key=PRESETS.index):
        print("\n".join(closing_lines(preset, done, results)))
    return Run(done, results, [test.full_name for test in left])


def main() -> int:
    """Run the selected tests; the exit status is 1 if a test failed or none was found."""
    now = time.time()
    parser = argparse.ArgumentParser(prog="run_tests")
    parser.add_argument("--presets", default=",".join(PRESETS), help="comma-separated")
    parser.add_argument("--full", action="store_true", help="with the tests labelled full")
    parser.add_argument("--quick", action="store_true", help="only what belongs to changed files")
    parser.add_argument("--since", default="HEAD", metavar="REV", help="changed since when")
    parser.add_argument("--setup-s", help="how long the set-up took, to be printed with the rest")
    parser.add_argument("--build-s", help="how long the build took")
    parser.add_argument("--json", type=Path, metavar="FILE", help="what was done, for machines")
    parser.add_argument("--begin", type=float, default=now, help="of it all, seconds since 1970")
    parser.add_argument("--times", type=Path, metavar="FILE", help="of configuring and building")
    parser.add_argument("--not-built", default="", help="presets whose build failed")
    parser.add_argument("--list-targets", action="store_true", help="what the folders' tests need")
    parser.add_argument("--keep-costs", action="store_true", help="write costs.json")
    parser.add_argument("folders", nargs="*", metavar="FOLDER", help="only these folders' tests")
    options = parser.parse_args()
    suite = Suite(ROOT)
    if options.keep_costs:
        suite.keep_costs()
        return 0
    times = report.times_of(options.times)
    if options.quick:
        return ended(quick(suite, options.since, times), suite, times, options)
    presets = [name for name in options.presets.split(",") if name]
    tests = [test for preset in presets for test in ctest.listed(ROOT, preset)]
    if options.folders:
        tests = choose.of_folder(tests, ROOT, options.folders)
    if options.list_targets:
        for preset in presets:
            mine = [test for test in tests if test.preset == preset]
            if mine:
                print(" ".join(targets_of(preset, mine, suite)))
        return 0
    if options.folders:
        presets = [name for name in presets if any(test.preset == name for test in tests)]
    return ended(run_chosen(suite, presets, tests, options), suite, times, options)


def ended(
    run: Run, suite: Suite, times: dict[str, dict[str, float]], options: argparse.Namespace
) -> int:
    """Write what was done, if that was asked for, and return the exit status."""
    if options.json:
        report.write(options.json, run, suite.printed(), times, options.begin, jobs())
    return 0 if run.good else 1


def targets_of(preset: str, tests: Sequence[Test], suite: Suite) -> list[str]:
    """Return what has to be built for tests; "all" where that is not known yet.

    Tests that need nothing built need the build's own list to be up to date.
    """
    directory = ROOT / "build" / preset
    graph = BuildGraph(directory)
    known = [
        bool(test.command)
        and ("python" not in test.labels or (suite.opened / test.full_name).is_file())
        for test in tests
    ]
    if not all(known):
        return ["all"]
    needed = {path for test in tests for path in choose.products(test, graph, suite.opened)}
    return sorted(str(path.relative_to(directory)) for path in needed) or ["build.ninja"]


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
