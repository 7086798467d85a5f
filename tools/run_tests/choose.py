# SPDX-License-Identifier: Apache-2.0
"""Which tests belong to changed files or to a folder.

What depends on what in a build: build.ninja and the dependencies that compilers found.
"""

import os
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path

from run_tests.ctest import Test

_WORD = re.compile(r"(?:\$.|[^ $])+")


def _words(statement: str) -> list[str]:
    """Return the words of a build statement, its colon a word of its own."""
    words = []
    for raw in _WORD.findall(statement):
        ends = raw.endswith(":") and not raw.endswith("$:")
        word = re.sub(r"\$(.)", r"\1", raw.removesuffix(":") if ends else raw)
        words.extend([word, ":"] if ends else [word])
    return words


class BuildGraph:
    """Files and what is made of them in one build directory."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._made_of: dict[Path, set[Path]] = defaultdict(set)
        self.outputs: set[Path] = set()
        text = (directory / "build.ninja").read_text(encoding="utf-8").replace("$\n", "")
        for line in text.splitlines():
            if line.startswith("build "):
                self._read(_words(line.removeprefix("build ")))
        deps = subprocess.run(
            ["ninja", "-C", str(directory), "-t", "deps"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        output = directory
        for line in deps.splitlines():
            if line.startswith("    "):
                self._made_of[self._path(line.strip())].add(output)
            elif ": #deps" in line:
                output = self._path(line.rpartition(": #deps")[0])

    def _path(self, name: str) -> Path:
        return Path(os.path.normpath(self._directory / name))

    def _read(self, words: list[str]) -> None:
        """Take in one statement: OUT... [| OUT...] : RULE IN... [| IN...] [|| ORDER...]."""
        colon = words.index(":")
        made = [self._path(word) for word in words[:colon] if word != "|"]
        self.outputs.update(path for path in made if path.is_relative_to(self._directory))
        for word in words[colon + 2 :]:
            if word == "||":  # only an order, not a content
                break
            if word != "|":
                self._made_of[self._path(word)].update(made)

    def affected(self, changed: Iterable[Path]) -> set[Path]:
        """Return the files and everything that is made of them, directly or not."""
        waiting = list(changed)
        found: set[Path] = set()
        while waiting:
            path = waiting.pop()
            if path not in found:
                found.add(path)
                waiting.extend(self._made_of.get(path, ()))
        return found


def changed_since(root: Path, revision: str) -> set[Path]:
    """Return the files that differ from a revision of the repository, new ones included.

    Of sources without their repository nothing is known to have changed.
    """
    names: set[str] = set()
    if revision == "HEAD" and not (root / ".git").exists():
        return set()
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
    return [test for test in tests if test.is_for(changed) or reads(test, opened) & affected]


def nearest(tests: Iterable[Test], changed: Iterable[Path], root: Path) -> list[Test]:
    """Return the unit tests of the folders in which files have changed.

    Those of firmware/torque are in tests/unit/firmware/torque.
    """
    places = {root / "tests" / "unit" / Path(*path.relative_to(root).parts[:2]) for path in changed}
    places |= {path.parent for path in changed}

    def is_near(path: Path) -> bool:
        return path.parent in places and path.is_relative_to(root / "tests")

    return [test for test in tests if any(map(is_near, test.defined_in))]


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
