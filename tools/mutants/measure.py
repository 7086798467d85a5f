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


def survivors(
    build: Build,
    wanted: Collection[int],
    jobs: int,
    settled: Callable[[int], str | None],
    progress: Callable[[int, int], None],
) -> tuple[list[int], list[int]]:
    """Return the mutants that no program kills: those with code of their own, and the others.

    Between the fast programs and the slow ones `settled` is asked, which may compile: "same" and
    "left" are what the mutant then counts as, without another program.
    """
    programs = sorted((profile(path) for path in build.programs), key=lambda one: one.cpu_ms)
    fast = [program for program in programs if program.cpu_ms < SLOW_MS]

    def outcome(number: int) -> str:
        met = [program for program in programs if number in program.reached]
        if any(is_killed(program, number) for program in met if program in fast):
            return "killed"
        slow = (program for program in met if program not in fast)
        known = settled(number)
        if known is None and any(is_killed(program, number) for program in slow):
            return "killed"
        return known or "left"

    found: dict[str, list[int]] = {"killed": [], "same": [], "left": []}
    with ThreadPoolExecutor(jobs) as pool:
        outcomes = zip(wanted, pool.map(outcome, wanted), strict=True)
        for count, (number, result) in enumerate(outcomes, 1):
            found[result].append(number)
            progress(count, len(wanted))
    return found["left"], found["same"]
