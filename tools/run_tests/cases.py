# SPDX-License-Identifier: Apache-2.0
"""How many cases the tests of a run consisted of, counted in what they printed.

A test of ctest is one program. How many test functions it ran is in the summary that Unity or
pytest prints at its end, and the run's log has the whole output of every test. A test of proofs
says how many, and how many of these were known from an earlier run.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path

from run_tests.ctest import Result, Test

_BEGIN = re.compile(r"^\d+/\d+ Test: (\S+)$")
_OUTPUT, _END = "Output:", "<end of output>"
_UNITY = re.compile(r"(\d+) Tests \d+ Failures \d+ Ignored")
_PYTEST = re.compile(r"^(?:=+ )?(\d+ [a-z]+(?:, \d+ [a-z]+)*) in [\d.]+s")
_PYTEST_CASES = re.compile(r"(\d+) (?:passed|failed|skipped|xfailed|xpassed|errors?)\b")
_PROOFS = re.compile(r"^(\d+) (?:proof|contract)s? proved( before \(cached\))?: ")
KINDS = ("Unity functions", "property cases", "pytest cases", "proofs")


def outputs(log: Path) -> dict[str, list[str]]:
    """Return the lines that each test printed, by its full name, from ctest's log of a run."""
    found: dict[str, list[str]] = {}
    lines: list[str] = []
    inside = False
    for line in log.read_text(encoding="utf-8", errors="replace").splitlines():
        if inside:
            inside = line != _END
            lines.append(line)
        elif match := _BEGIN.match(line):
            lines = found.setdefault(match[1], [])
        else:
            inside = line == _OUTPUT
    return found


def proofs_of(printed: Sequence[str]) -> tuple[int, int]:
    """Return how many proofs a test ran, and how many were known to hold from an earlier run."""
    numbers = [0, 0]
    for line in printed:
        if match := _PROOFS.match(line):
            numbers[bool(match[2])] += int(match[1])
    return numbers[0], numbers[1]


def only_known(printed: Sequence[str]) -> bool:
    """Return whether a test of proofs ran none, so that its time says nothing of the proofs."""
    run, known = proofs_of(printed)
    return run == 0 and known > 0


def cases_of(test: Test, printed: Sequence[str]) -> tuple[str, int] | None:
    """Return kind and number of a test's cases; None of a test that has none of these kinds."""
    if "proof" in test.labels:
        run, known = proofs_of(printed)
        return ("proofs", run + known) if run + known else None
    if "python" in test.labels:
        for line in reversed(printed):
            if match := _PYTEST.match(line):
                return "pytest cases", sum(map(int, _PYTEST_CASES.findall(match[1])))
    for line in reversed(printed):
        if match := _UNITY.search(line):
            kind = "property cases" if "property" in test.labels else "Unity functions"
            return kind, int(match[1])
    return None


def counted(tests: Iterable[Test], printed: dict[str, list[str]]) -> dict[str, Counter[str]]:
    """Return how many cases of each kind ran, by kind and preset."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for test in tests:
        if test.full_name in printed and (cases := cases_of(test, printed[test.full_name])):
            found[cases[0]][test.preset] += cases[1]
    return found


def proofs(tests: Iterable[Test], printed: dict[str, list[str]]) -> tuple[int, int]:
    """Return how many proofs were run, and how many were known to hold from an earlier run."""
    found = [proofs_of(printed.get(test.full_name, ())) for test in tests if "proof" in test.labels]
    return sum(run for run, _ in found), sum(known for _, known in found)


def closing_line(
    tests: Sequence[Test], results: dict[str, Result], printed: dict[str, list[str]]
) -> str:
    """Return one line: how many tests ran, and how many cases of each kind in which preset."""
    ran = [test for test in tests
           if (result := results.get(test.full_name)) and not result.skipped]  # fmt: skip
    found = counted(ran, printed)
    words = [f"{len(ran)} tests ran"]
    for kind in KINDS:
        if kind in found:
            presets = ", ".join(f"{number} {name}" for name, number in found[kind].items())
            words.append(f"{found[kind].total()} {kind} ({presets})")
    if known := proofs(ran, printed)[1]:
        words.append(f"{known} of the proofs had been proved before")
    return "Cases: " + "; ".join(words) + "."
