# SPDX-License-Identifier: Apache-2.0
"""``python -m run_tests``: what ``tools/dev test`` calls; its help describes the options."""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from run_tests import cases, choose, ctest, report
from run_tests.choose import BuildGraph
from run_tests.ctest import Test
from run_tests.quick import quick
from run_tests.report import Run, Times
from run_tests.suite import PRESETS, ROOT, Suite, closing_lines, jobs


def run_chosen(
    suite: Suite, presets: Sequence[str], tests: list[Test], options: argparse.Namespace
) -> Run:
    """Run the tests and print the output of ctest, then the closing lines of each preset."""
    changed = choose.changed_since(suite.root, "HEAD")
    long = [] if options.full else [test for test in tests if test.is_left_out(changed)]
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
            mine = [test for test in tests if test.preset == preset
                    and (options.full or ctest.FULL_LABEL not in test.labels)]  # fmt: skip
            if mine:
                print(" ".join(targets_of(preset, mine, suite, full=options.full)))
        return 0
    if options.folders:
        presets = [name for name in presets if any(test.preset == name for test in tests)]
    return ended(run_chosen(suite, presets, tests, options), suite, times, options)


def ended(run: Run, suite: Suite, times: Times, options: argparse.Namespace) -> int:
    """Write what was done, if that was asked for, and return the exit status."""
    if options.json:
        report.write(options.json, run, suite.printed(), times, options.begin, jobs())
    return 0 if run.good else 1


def targets_of(preset: str, tests: Sequence[Test], suite: Suite, *, full: bool) -> list[str]:
    """Return what has to be built for tests; everything where that is not known yet.

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
        return ["all", "full_tests"] if full else ["all"]
    needed = {path for test in tests for path in choose.products(test, graph, suite.opened)}
    return sorted(str(path.relative_to(directory)) for path in needed) or ["build.ninja"]


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
