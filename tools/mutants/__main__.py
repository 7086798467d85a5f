# SPDX-License-Identifier: Apache-2.0
"""``python -m mutants``: what ``tools/dev mutants`` calls; its help describes the options."""

import argparse
import json
import os
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

from mutants import explained, measure, programs
from mutants.programs import ROOT, MutantsError

TABLES = ROOT / "tests" / "mutants"


@dataclass
class Result:
    """The mutants of one module: how many, and by name those that are in no table."""

    module: str
    mutants: int = 0
    killed: int = 0
    same_code: int = 0
    explained: int = 0
    open: int = 0
    unexplained: list[str] = field(default_factory=list)
    stale: list[str] = field(default_factory=list)

    def line(self) -> str:
        """Return the closing line."""
        return (
            f"{self.module}: {self.mutants} mutants, {self.killed} killed, {self.same_code} the"
            f" same code, {self.explained} explained, {self.open} open,"
            f" {len(self.unexplained)} not explained, {len(self.stale)} stale"
        )


def show_progress(count: int, total: int) -> None:
    """Show how many mutants are done, on a terminal."""
    if sys.stderr.isatty() and (count % 20 == 0 or count == total):
        print(f"\r{count} of {total}", end="" if count < total else "\n", file=sys.stderr)


def test_module(module: str, arguments: argparse.Namespace) -> Result:
    """Let the unit tests of one module meet its mutants, and compare with the tables."""
    numbered = programs.changes_of(module)
    wanted = [
        number
        for number, (path, _) in numbered.items()
        if number % arguments.every == 0 and arguments.file in (None, path.name)
    ]
    folder = programs.FOLDER / f"{module}-{arguments.file or arguments.every}"
    built = programs.build(module, folder, arguments.jobs, numbered)
    tables = explained.Tables(TABLES, module)
    name = explained.names(numbered)
    same = programs.SameCode(built, folder)

    def settled(number: int) -> str | None:
        if name[number] in tables.explained:
            return None if arguments.thorough else "left"
        return "same" if same(number) else None

    left, same_code = measure.survivors(built, wanted, arguments.jobs, settled, show_progress)
    known = {number for number in left if name[number] in tables.explained}
    rest = [number for number in left if number not in known]
    killed = len(wanted) - len(left) - len(same_code)
    result = Result(module, len(wanted), killed, len(same_code), len(known))
    if arguments.write_open:
        tables.write_open([name[number] for number in rest])
        tables.open = {name[number] for number in rest}
    fine = {name[number] for number in (*wanted, *numbered) if number not in wanted}
    fine |= {name[number] for number in left}
    result.open = sum(name[number] in tables.open for number in rest)
    for number in rest:
        path, change = numbered[number]
        if name[number] not in tables.open:
            where = f"{path.relative_to(ROOT)}:{change.line}"
            result.unexplained.append(f"{where}: {name[number].partition(': ')[2]}")
    result.stale = sorted((tables.explained.keys() | tables.open) - fine) + tables.wrong
    return result


def show_list(module: str) -> None:
    """Print every mutant of a module without building anything."""
    for path, change in programs.changes_of(module).values():
        print(
            f"{path.relative_to(ROOT)}:{change.line}: {change.kind}: {change.original} ->"
            f" {change.replacement or '(removed)'}"
        )


def main() -> int:
    """Test the mutants of the modules that were asked for."""
    parser = argparse.ArgumentParser(prog="tools/dev mutants")
    parser.add_argument("modules", nargs="*", metavar="MODULE")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N")
    parser.add_argument("--every", type=int, default=1, metavar="N")
    parser.add_argument("--file", metavar="NAME")
    parser.add_argument("--thorough", action="store_true")
    parser.add_argument("--write-open", action="store_true")
    arguments = parser.parse_args()
    for module in arguments.modules:
        if module not in programs.MODULES:
            parser.error(f"no module '{module}'; there are: {' '.join(programs.MODULES)}")
    if arguments.jobs < 1 or arguments.every < 1:
        parser.error("--jobs and --every need a number of at least 1")
    if arguments.write_open and (arguments.every != 1 or arguments.file):
        parser.error("--write-open needs all mutants, without --every and --file")
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
        for line in result.unexplained:
            print(f"survived: {line}")
        for line in result.stale:
            print(f"stale: {line}: killed, or not there any more")
        print(result.line(), flush=True)
        results.append(result)
    if arguments.json and not arguments.list:
        text = json.dumps([asdict(result) for result in results], indent=1)
        arguments.json.write_text(text + "\n", encoding="utf-8")
    return 1 if any(result.unexplained or result.stale for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
