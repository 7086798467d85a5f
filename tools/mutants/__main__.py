# SPDX-License-Identifier: Apache-2.0
"""``python -m mutants``: what ``tools/dev mutants`` calls; its help describes the options."""

import argparse
import json
import os
import random
import sys
from pathlib import Path

from mutants import measure, programs
from mutants.programs import ROOT, MutantsError
from mutants.report import Result, Survivor

LEAST = 0.92
SEED = 1


def show_progress(count: int, total: int) -> None:
    """Show how many mutants are done, on a terminal."""
    if sys.stderr.isatty() and (count % 20 == 0 or count == total):
        print(f"\r{count} of {total}", end="" if count < total else "\n", file=sys.stderr)


def test_module(module: str, arguments: argparse.Namespace) -> Result:
    """Let the unit tests of one module meet its mutants."""
    numbered = programs.changes_of(module)
    all_wanted = [n for n, (path, _) in numbered.items() if arguments.file in (None, path.name)]
    wanted = all_wanted
    if arguments.sample is not None and arguments.sample < len(all_wanted):
        wanted = sorted(random.Random(SEED).sample(all_wanted, arguments.sample))
    if not wanted:
        raise MutantsError("no mutants")
    folder = programs.FOLDER / f"{module}-{arguments.file or arguments.sample or 'all'}"
    built = programs.build(module, folder, arguments.jobs, numbered)
    same_code = programs.SameCode(built, folder)
    found = measure.outcomes(built, wanted, arguments.jobs, same_code, show_progress)
    survivors = [
        Survivor.of(path.relative_to(ROOT), change)
        for path, change in (numbered[n] for n in found["survived"])
    ]
    return Result(
        module, len(all_wanted), len(wanted), len(found["same"]), len(found["killed"]), survivors
    )


def show_list(module: str) -> None:
    """Print every mutant of a module without building anything."""
    for path, change in programs.changes_of(module).values():
        print(Survivor.of(path.relative_to(ROOT), change).text())


def parsed() -> argparse.Namespace:
    """Return the command line."""
    parser = argparse.ArgumentParser(prog="tools/dev mutants")
    parser.add_argument("modules", nargs="*", metavar="MODULE")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--least", type=float, default=LEAST, metavar="SCORE")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N")
    parser.add_argument("--sample", type=int, metavar="N")
    parser.add_argument("--file", metavar="NAME")
    arguments = parser.parse_args()
    for module in arguments.modules:
        if module not in programs.MODULES:
            parser.error(f"no module '{module}'; there are: {' '.join(programs.MODULES)}")
    if arguments.jobs < 1 or (arguments.sample is not None and arguments.sample < 1):
        parser.error("--jobs and --sample need a number of at least 1")
    if not 0.0 <= arguments.least <= 1.0:
        parser.error("--least needs a score from 0 to 1")
    return arguments


def main() -> int:
    """Test the mutants of the modules that were asked for."""
    arguments = parsed()
    results = []
    for module in arguments.modules or programs.MODULES:
        if arguments.list:
            show_list(module)
            continue
        try:
            result = test_module(module, arguments)
        except (MutantsError, ValueError) as error:
            print(f"tools/dev mutants: {module}: {error}", file=sys.stderr)
            return 1
        for survivor in result.survivors:
            print(survivor.text())
        print(result.text(arguments.least), flush=True)
        results.append(result)
    if arguments.json and not arguments.list:
        text = json.dumps({result.module: result.as_json() for result in results}, indent=1)
        arguments.json.write_text(text + "\n", encoding="utf-8")
    return 0 if all(result.meets(arguments.least) for result in results) else 1


if __name__ == "__main__":
    sys.exit(main())
