# SPDX-License-Identifier: Apache-2.0
"""``python -m oracle``: what ``tools/dev oracle`` calls; its help describes the options."""

import argparse
import multiprocessing
import os
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from oracle import baseline, simulation, tasks
from oracle.baseline import OracleError, Results
from oracle.programs import Reached
from oracle.tasks import Done, Task


def finished(wanted: Sequence[Task], jobs: int) -> Iterator[tuple[int, Done]]:
    """Run the tasks, the longest first, and give each with its number as it is done."""
    longest_first = sorted(range(len(wanted)), key=lambda k: -wanted[k].cost)
    if jobs == 1:
        yield from ((k, tasks.done(wanted[k])) for k in longest_first)
        return
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        futures = {pool.submit(tasks.done, wanted[k]): k for k in longest_first}
        yield from ((futures[future], future.result()) for future in as_completed(futures))


def compute(wanted: Sequence[Task], jobs: int) -> list[Done]:
    """Run the tasks and show progress; return what each has found, in their order."""
    found: dict[int, Done] = {}
    begun = time.monotonic()
    for k, one in finished(wanted, jobs):
        found[k] = one
        progress = f"{len(found)} of {len(wanted)}, {time.monotonic() - begun:.0f} s"
        print(f"[{progress}] {one.part}: {one.label}", file=sys.stderr, flush=True)
        if one.failure:
            print(f"{one.part}: {one.label}: {one.failure}", flush=True)
    return [found[k] for k in range(len(wanted))]


def collected(found: Sequence[Done]) -> tuple[Results, Reached]:
    """Return all hashes, and what was reached."""
    results = Results(simulation.oracle().value_names())
    reached: Counter[tuple[str, int]] = Counter()
    for one in found:
        results.add(one.part, one.entries)
        reached.update(one.reached)
    return results, dict(reached)


def print_reached(reached: Reached) -> None:
    """Print what was reached, a list a line: number and slow steps."""
    steps = reached["slow_steps", 0]
    for name in dict.fromkeys(name for name, _ in reached):
        numbers = {n: count for (other, n), count in sorted(reached.items()) if other == name}
        if list(numbers) == [0] and name != "trip":
            print(f"{name}: {numbers[0]} ({100.0 * numbers[0] / steps:.1f} %)")
        else:
            print(f"{name}: " + ", ".join(f"{n}: {count}" for n, count in numbers.items()))


def list_values(part: str, entry: str, path: Path) -> None:
    """Write every change of a value of one entry into a file."""
    for task in tasks.of_part(part, quick=False):
        if task.has(entry):
            tasks.done(task, tasks.Listing(entry, path))
            return
    raise OracleError(f"{part}: no entry {entry!r}")


def parsed() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="tools/dev oracle", add_help=False)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--baseline", type=Path, default=baseline.STORED, metavar="FILE")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--part", action="append", choices=tasks.PARTS, metavar="PART")
    parser.add_argument("--values", nargs=2, metavar=("PART", "ENTRY"))
    parser.add_argument("--reached", action="store_true")
    processors = len(os.sched_getaffinity(0))
    parser.add_argument("--jobs", type=int, default=min(2, processors), metavar="N")
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        parser.error("--jobs needs a number of at least 1")
    if arguments.values and not arguments.output:
        parser.error("--values needs -o FILE")
    if not (arguments.check or arguments.output or arguments.reached):
        parser.error("--check, -o FILE or --reached (tools/dev oracle --help)")
    return arguments


def main() -> int:
    """Compute, and compare, write or list."""
    arguments = parsed()
    simulation.use_engine()
    try:
        if arguments.values:
            list_values(arguments.values[0], arguments.values[1], arguments.output)
            return 0
        parts = arguments.part or tasks.PARTS
        stored = Results.read(arguments.baseline) if arguments.check else None
        begun = time.monotonic()
        found = compute(tasks.plan(parts, arguments.quick), arguments.jobs)
        results, reached = collected(found)
        complete = not any(one.failure for one in found)
        cpu_s = sum(one.cpu_s for one in found)
        print(f"{time.monotonic() - begun:.0f} s, {cpu_s:.0f} s of processor time")
        if arguments.reached:
            print_reached(reached)
        if arguments.output:
            results.write(arguments.output)
        if stored is None:
            return 0 if complete else 1
        lines, equal = baseline.compared(stored, results, complete=not arguments.quick)
    except OracleError as error:
        print(f"tools/dev oracle: {error}", file=sys.stderr)
        return 1
    print("\n".join(lines))
    print("equal" if equal else f"not as in {arguments.baseline.name}")
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main())
