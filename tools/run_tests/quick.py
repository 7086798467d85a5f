# SPDX-License-Identifier: Apache-2.0
"""A quick run: what belongs to changed files, as far as time allows."""

import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from run_tests import choose, ctest
from run_tests.choose import BuildGraph
from run_tests.ctest import Result, Test
from run_tests.report import Run, Times
from run_tests.suite import PRESETS, ROOT, Suite, closing_lines, jobs

# The most it may take, until when it builds, and when the last test is ended. What comes before and
# after, the look at the tools and the last lines, takes up to three seconds on a busy machine.
QUICK_S = 40.0
QUICK_BUILD_S = 21.0
QUICK_END_S = 36.0
TARGETS_AT_ONCE = 8


@dataclass
class Belonging:
    """The tests of changed files, first those to run first, and what is known of the choice."""

    graphs: dict[str, BuildGraph] = field(default_factory=dict)
    wanted: list[Test] = field(default_factory=list)
    unknown: list[Test] = field(default_factory=list)
    explained: set[Path] = field(default_factory=set)


def in_time(tests: Sequence[Test], suite: Suite, budget_s: float) -> list[Test]:
    """Return the first tests that together fit into a time on all cores."""
    chosen = []
    left_s = budget_s * jobs()
    for test in tests:
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


def tests_of_changes(
    suite: Suite, presets: Sequence[str], changed: set[Path], times: Times
) -> Belonging:
    """Configure the presets again where that is needed, and find the tests of changed files."""
    found = Belonging()
    for preset in presets:
        begin = time.monotonic()
        bring_up_to_date(preset)
        times[preset] = {"configure_s": time.monotonic() - begin}
        graph = found.graphs[preset] = BuildGraph(ROOT / "build" / preset)
        tests = [test for test in ctest.listed(ROOT, preset) if not test.is_left_out(changed)]
        mine = choose.of_changes(tests, changed, graph, suite.opened)
        for path in changed:
            if choose.of_changes(tests, {path}, graph, suite.opened):
                found.explained.add(path)
        found.unknown += [
            test for test in tests
            if "python" in test.labels
            and not (suite.opened / test.full_name).is_file()
            and test not in mine
        ]  # fmt: skip
        found.wanted += mine
    near = choose.nearest(found.wanted, changed, ROOT)
    found.wanted.sort(key=lambda test: (test not in near, suite.cost_s(test)))
    return found


def built_of(
    tests: Sequence[Test], suite: Suite, graphs: dict[str, BuildGraph], times: Times, end: float
) -> list[Test]:
    """Build what tests need, that of the first ones first; return those that are ready in time.

    A test of one preset may need a program of another: the host's, beside which it is run.
    """
    ready = list(tests)
    for preset, graph in graphs.items():
        needs = {test: choose.products(test, graph, suite.opened) for test in ready}
        targets = list(dict.fromkeys(path for test in ready for path in sorted(needs[test])))
        begin = time.monotonic()
        built = build_in_time(preset, targets, end)
        times[preset]["build_s"] = time.monotonic() - begin
        ready = [test for test in ready if needs[test] <= built]
    return ready


def quick(suite: Suite, revision: str, times: Times) -> Run:
    """Build and test what belongs to the files changed since a revision, in at most 40 s.

    First the unit tests of the folders with changed files, then the others, the shortest first.
    times: of configuring and building, by preset, which are added.
    """
    begin = time.monotonic()
    changed = choose.changed_since(ROOT, revision)
    presets = [name for name in PRESETS if (ROOT / "build" / name / "build.ninja").is_file()]
    if "host" not in presets:
        sys.exit("run_tests: --quick needs a tree that './tools/dev test' has built")
    found = tests_of_changes(suite, presets, changed, times)
    affordable = in_time(found.wanted, suite, QUICK_S / 2)
    ready = built_of(affordable, suite, found.graphs, times, begin + QUICK_BUILD_S)
    chosen = in_time(ready, suite, QUICK_END_S - 5.0 - (time.monotonic() - begin))
    results: dict[str, Result] = {}
    if chosen:
        results = suite.run(chosen, QUICK_END_S - (time.monotonic() - begin))
    done = [test for test in chosen if test.full_name in results]
    left = [test for test in found.wanted if test not in done]
    print()
    print(
        f"{len(changed)} files changed since {revision}; {len(found.wanted)} tests belong to them."
    )
    unexplained = sorted(str(path.relative_to(ROOT)) for path in changed - found.explained)
    if unexplained:
        print(f"No test is known to read: {', '.join(unexplained)}.")
    if left:
        shown = ", ".join(test.full_name for test in left[:12])
        more = f" and {len(left) - 12} more" if len(left) > 12 else ""
        print(f"Left out to save time: {len(left)} tests: {shown}{more}.")
    if found.unknown:
        print(
            "Left out, as what they read is known only after './tools/dev test': "
            f"{len(found.unknown)} Python tests."
        )
    print(f"All of this took {time.monotonic() - begin:.0f} s.")
    for preset in sorted({test.preset for test in done}, key=PRESETS.index):
        print("\n".join(closing_lines(preset, done, results)))
    return Run(done, results, [test.full_name for test in left])
