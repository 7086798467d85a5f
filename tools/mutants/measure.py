# SPDX-License-Identifier: Apache-2.0
"""Which mutants the unit tests kill.

Every program first runs without a mutant: what it takes, and which mutants it reaches, by a value
that differs with them (runtime.h). Until the first such value a program is the same with the mutant
as without. Then each mutant meets the programs that reach it, the fastest first, until one fails:
by an assertion, a signal, or ten times the CPU time it takes without a mutant.
"""

import os
import resource
import subprocess
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from mutants.programs import Build, MutantsError

LEAST_LIMIT_MS = 200
LIMIT_FACTOR = 10
SLOW_MS = 250  # of CPU time: more than it takes to compile a file
# A program that waits without using the processor.
WALL_LIMIT_S = 300


@dataclass(frozen=True)
class Program:
    """A test program: its CPU time without a mutant, and the mutants it reaches."""

    path: Path
    cpu_ms: int
    reached: frozenset[int]


def profile(path: Path) -> Program:
    """Run a test program without a mutant."""
    record = path.with_suffix(".reached")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [str(path)],
        env={**os.environ, "HUBFOC_MUTANTS_REACHED": str(record)},
        capture_output=True,
        text=True,
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise MutantsError(f"{path.name} fails without a mutant")
    reached = frozenset(number for number, hit in enumerate(record.read_bytes()) if hit)
    return Program(path, round(1000 * (after.ru_utime - before.ru_utime)), reached)


def is_killed(program: Program, number: int) -> bool:
    """Return whether a test program fails with a mutant."""
    limit_ms = LEAST_LIMIT_MS + LIMIT_FACTOR * program.cpu_ms
    limits = {"HUBFOC_MUTANT": str(number), "HUBFOC_MUTANT_LIMIT_MS": str(limit_ms)}
    try:
        done = subprocess.run(
            [str(program.path)],
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

    `same_code`, which compiles, is asked between the fast programs and the slow ones.
    """
    programs = sorted((profile(path) for path in build.programs), key=lambda one: one.cpu_ms)

    def outcome(number: int) -> str:
        met = [program for program in programs if number in program.reached]
        fast = [program for program in met if program.cpu_ms < SLOW_MS]
        if any(is_killed(program, number) for program in fast):
            return "killed"
        if same_code(number):
            return "same"
        killed = any(is_killed(program, number) for program in met[len(fast) :])
        return "killed" if killed else "survived"

    found: dict[str, list[int]] = {"killed": [], "same": [], "survived": []}
    with ThreadPoolExecutor(jobs) as pool:
        for count, (number, result) in enumerate(
            zip(wanted, pool.map(outcome, wanted), strict=True), 1
        ):
            found[result].append(number)
            progress(count, len(wanted))
    return found
