# SPDX-License-Identifier: Apache-2.0
"""Which mutants the unit tests kill.

Every suite of a program first runs without a mutant: what it takes, and which mutants it reaches,
by a value that differs with them (runtime.h). Until the first such value a suite is the same with
the mutant as without. Then each mutant meets the suites that reach it, the fastest first, until one
fails: by an assertion, a signal, or ten times the CPU time it takes without a mutant.
"""

import os
import resource
import subprocess
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from unit_programs import suites_of

from mutants.programs import Build, MutantsError

LEAST_LIMIT_MS = 200
LIMIT_FACTOR = 10
SLOW_MS = 250  # of CPU time: more than it takes to compile a file
# A program that waits without using the processor.
WALL_LIMIT_S = 300


@dataclass(frozen=True)
class Suite:
    """A suite of a test program: its CPU time without a mutant, and the mutants it reaches."""

    command: tuple[str, ...]
    cpu_ms: int
    reached: frozenset[int]


def profile(program: Path, name: str) -> Suite:
    """Run a suite of a test program without a mutant."""
    record = program.with_name(f"{program.name}.{name}.reached")
    command = (str(program), name)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        command,
        env={**os.environ, "HUBFOC_MUTANTS_REACHED": str(record)},
        capture_output=True,
        text=True,
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise MutantsError(f"{name} of {program.name} fails without a mutant")
    reached = frozenset(number for number, hit in enumerate(record.read_bytes()) if hit)
    return Suite(command, round(1000 * (after.ru_utime - before.ru_utime)), reached)


def is_killed(suite: Suite, number: int) -> bool:
    """Return whether a suite fails with a mutant."""
    limit_ms = LEAST_LIMIT_MS + LIMIT_FACTOR * suite.cpu_ms
    limits = {"HUBFOC_MUTANT": str(number), "HUBFOC_MUTANT_LIMIT_MS": str(limit_ms)}
    try:
        done = subprocess.run(
            suite.command,
            env=os.environ | limits,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            close_fds=False,
            timeout=WALL_LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def outcomes(
    build: Build,
    wanted: Collection[int],
    jobs: int,
    same_code: Callable[[int], bool],
    progress: Callable[[int, int], None],
) -> dict[str, list[int]]:
    """Return which mutants are ``killed``, which have the ``same`` code, and which ``survived``.

    `same_code`, which compiles, is asked between the fast suites and the slow ones.
    """
    suites = [profile(program, name) for program in build.programs for name in suites_of(program)]
    suites.sort(key=lambda one: one.cpu_ms)

    def outcome(number: int) -> str:
        met = [suite for suite in suites if number in suite.reached]
        fast = [suite for suite in met if suite.cpu_ms < SLOW_MS]
        if any(is_killed(suite, number) for suite in fast):
            return "killed"
        if same_code(number):
            return "same"
        killed = any(is_killed(suite, number) for suite in met[len(fast) :])
        return "killed" if killed else "survived"

    found: dict[str, list[int]] = {"killed": [], "same": [], "survived": []}
    with ThreadPoolExecutor(jobs) as pool:
        for count, (number, result) in enumerate(
            zip(wanted, pool.map(outcome, wanted), strict=True), 1
        ):
            found[result].append(number)
            progress(count, len(wanted))
    return found
