# SPDX-License-Identifier: Apache-2.0
"""The tests of a build directory as ctest lists them, and one run of ctest over several."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FULL_LABEL = "full"
# In a test's environment: the files and folders, separated by commas, whose change makes a test
# labelled full part of every run.
_WHEN_CHANGED = "HUBFOC_WHEN_CHANGED="
# Of a test whose time is not known, where it has to fit into a limit; in the order of a whole run
# it comes first, so that it cannot be the one that the others wait for.
DEFAULT_COST_S = 1.0
FIRST_S = 1e4
_ADDED = re.compile(r'^add_test\((?:\[=*\[)?([^\s\]]+)(?:\]=*\])? (".*)\)$', re.MULTILINE)
_RESULT = re.compile(r"^\s*\d+/\d+ Test\s+#\d+: (\S+) \.*\s*(.*?)\s+([\d.]+) sec")


def _normal(path: Path) -> Path:
    return Path(os.path.normpath(path))


@dataclass(frozen=True, eq=False)
class Test:
    """One test of one preset."""

    preset: str
    name: str
    command: tuple[str, ...]
    properties: dict[str, Any]
    defined_in: tuple[Path, ...]

    @property
    def full_name(self) -> str:
        """Return the name that is unique over all presets."""
        return f"{self.preset}:{self.name}"

    @property
    def labels(self) -> list[str]:
        """Return the labels; a test without any has an empty list."""
        return list(self.properties.get("LABELS", []))

    def words(self) -> list[str]:
        """Return what may name a file: arguments and environment, whole and in their parts.

        "-DLIMIT=plugin.so,instructions=1" has the part "plugin.so".
        """
        words = [*self.command, *self.properties.get("ENVIRONMENT", [])]
        return [*words, *(part for word in words for part in re.split("[=,;]", word))]

    def files(self) -> set[Path]:
        """Return the paths that the command line names, "::" and a test's name cut off."""
        here = Path(self.properties.get("WORKING_DIRECTORY", "."))
        return {
            _normal(here / word.partition("::")[0]) for word in self.words() if 0 < len(word) < 1000
        }

    def is_for(self, changed: Set[Path]) -> bool:
        """Return True if one of these files is, or lies in, what HUBFOC_WHEN_CHANGED names."""
        given = [word.removeprefix(_WHEN_CHANGED)
                 for word in self.properties.get("ENVIRONMENT", [])
                 if word.startswith(_WHEN_CHANGED)]  # fmt: skip
        names = [name for word in given for name in word.split(",")]
        return any(path.is_relative_to(name) for path in changed for name in names)

    def is_left_out(self, changed: Set[Path]) -> bool:
        """Return True if only a full run has it."""
        return FULL_LABEL in self.labels and not self.is_for(changed)


@dataclass(frozen=True)
class Result:
    """Outcome of one test: "Passed" or ctest's reason, and the wall-clock time in seconds."""

    outcome: str
    time_s: float

    @property
    def passed(self) -> bool:
        """Return True if it ran and passed."""
        return self.outcome == "Passed"

    @property
    def skipped(self) -> bool:
        """Return True if it ran and found that it cannot judge here."""
        return self.outcome in ("Skipped", "Not Run (Disabled)")


def _commands(build: Path) -> dict[str, tuple[str, ...]]:
    """Return the command of every test from the lists that CMake wrote.

    The output of ctest has none for a program that has not been built.
    """
    commands = {}
    for file in build.rglob("CTestTestfile.cmake"):
        for name, words in _ADDED.findall(file.read_text(encoding="utf-8")):
            found = re.findall(r'"((?:[^"\\]|\\.)*)"', words)
            commands[name] = tuple(re.sub(r"\\(.)", r"\1", word) for word in found)
    return commands


def listed(root: Path, preset: str) -> list[Test]:
    """Return the tests of a configured preset."""
    answer = subprocess.run(
        ["ctest", "--preset", preset, "--show-only=json-v1"],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
    )
    if answer.returncode != 0:
        sys.exit(f"run_tests: ctest lists no tests of {preset}: {answer.stderr.strip()}")
    content = json.loads(answer.stdout)
    graph = content["backtraceGraph"]
    unbuilt = any("command" not in test for test in content["tests"])
    commands = _commands(root / "build" / preset) if unbuilt else {}

    def lists_through(node: int | None) -> tuple[Path, ...]:
        files = []
        while node is not None:
            files.append(Path(graph["files"][graph["nodes"][node]["file"]]))
            node = graph["nodes"][node].get("parent")
        return tuple(dict.fromkeys(files))

    return [
        Test(
            preset,
            test["name"],
            tuple(test.get("command") or commands.get(test["name"], ())),
            {item["name"]: item["value"] for item in test.get("properties", [])},
            lists_through(test.get("backtrace")),
        )
        for test in content["tests"]
    ]


def cost_s(test: Test, costs: dict[str, float]) -> float:
    """Return how long a test takes, in seconds, as far as is known."""
    return costs.get(test.full_name, DEFAULT_COST_S)


def _quoted(value: Any) -> str:  # noqa: ANN401, whatever JSON holds
    if isinstance(value, bool):
        value = "ON" if value else "OFF"
    if isinstance(value, list):
        value = ";".join(map(str, value))
    return f"[==[{value}]==]"


def suite_text(tests: Sequence[Test], costs: dict[str, float], opened: Path, root: Path) -> str:
    """Return a CTestTestfile.cmake with these tests, the longest first.

    Every test keeps the properties of its own build directory. Python programs record what they
    read.
    """
    lines = []
    for test in tests:
        properties = dict(test.properties)
        properties["COST"] = costs.get(test.full_name, FIRST_S)
        properties["LABELS"] = [*test.labels, f"preset:{test.preset}"]
        properties["ENVIRONMENT"] = [
            *properties.get("ENVIRONMENT", []),
            f"HUBFOC_OPENED={opened / test.full_name}",
            f"HUBFOC_OPENED_ROOT={root}",
        ]
        if "DEPENDS" in properties:
            others = properties["DEPENDS"]
            properties["DEPENDS"] = [f"{test.preset}:{other}" for other in others]
        command = " ".join(map(_quoted, test.command or (f"not-built-{test.name}",)))
        lines.append(f"add_test({_quoted(test.full_name)} {command})")
        settings = " ".join(f"{name} {_quoted(value)}" for name, value in properties.items())
        lines.append(f"set_tests_properties({_quoted(test.full_name)} PROPERTIES {settings})")
    return "\n".join(lines) + "\n"


def run(folder: Path, jobs: int, limit_s: float | None = None) -> tuple[int, dict[str, Result]]:
    """Run the tests of a folder; return ctest's exit status and the results by name.

    Parameters
    ----------
    folder
        Where CTestTestfile.cmake is.
    jobs
        Tests at the same time.
    limit_s
        After this many seconds the run is ended; the tests that were not through have no result.
    """
    process = subprocess.Popen(
        ["ctest", "--parallel", str(jobs), "--output-on-failure", "--no-tests=error"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=limit_s is not None,
    )
    if limit_s is not None:
        signal.signal(signal.SIGALRM, lambda *_: _end(process.pid))
        signal.setitimer(signal.ITIMER_REAL, max(limit_s, 0.1))
    results = {}
    assert process.stdout is not None
    for line in process.stdout:
        sys.stdout.write(line)
        sys.stdout.flush()
        if match := _RESULT.match(line):
            results[match[1]] = Result(match[2].removeprefix("***"), float(match[3]))
    status = process.wait()
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    return status, results


def _end(group: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, signal.SIGTERM)
