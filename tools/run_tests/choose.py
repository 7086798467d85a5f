# SPDX-License-Identifier: Apache-2.0
"""Which tests belong to changed files or to a folder."""

import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from run_tests.ctest import Test
from run_tests.graph import BuildGraph


def changed_since(root: Path, revision: str) -> set[Path]:
    """Return the files that differ from a revision of the repository, new ones included."""
    names: set[str] = set()
    for command in (
        ("diff", "--name-only", "-z", revision, "--"),
        ("ls-files", "--others", "--exclude-standard", "-z"),
    ):
        answer = subprocess.run(
            ["git", *command], cwd=root, capture_output=True, text=True, check=False
        )
        if answer.returncode != 0:
            sys.exit(f"run_tests: git {command[0]}: {answer.stderr.strip().splitlines()[-1]}")
        names |= set(filter(None, answer.stdout.split("\0")))
    return {root / name for name in names}


def reads(test: Test, opened: Path) -> set[Path]:
    """Return what a test is known to depend on directly.

    The files that its command line names, the lists that define it, and what its Python programs
    read when it ran last.
    """
    record = opened / test.full_name
    recorded = record.read_text(encoding="utf-8").splitlines() if record.is_file() else []
    return test.files() | set(test.defined_in) | set(map(Path, recorded))


def of_changes(
    tests: Iterable[Test], changed: set[Path], graph: BuildGraph, opened: Path
) -> list[Test]:
    """Return the tests that a change of these files can make fail, as far as is known."""
    affected = graph.affected(changed)
    return [test for test in tests if reads(test, opened) & affected]


def products(test: Test, graph: BuildGraph, opened: Path) -> set[Path]:
    """Return what has to be built for a test."""
    return reads(test, opened) & graph.outputs


def of_folder(tests: Iterable[Test], root: Path, folders: Sequence[str]) -> list[Test]:
    """Return the tests that are defined or whose files lie in folders under the root or tests/."""
    places = [place for folder in folders for place in (root / folder, root / "tests" / folder)]

    def inside(path: Path) -> bool:
        return any(path.is_relative_to(place) for place in places)

    return [
        test for test in tests if any(inside(path) for path in (*test.defined_in, *test.files()))
    ]
