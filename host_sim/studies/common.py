# SPDX-License-Identifier: Apache-2.0
"""What the studies share: options, runs in parallel, and the files that they leave.

A study measures its cases and leaves the table NAME.csv, its origin NAME.json, NAME.svg and
NAME.png. ``--refresh`` writes table, origin and SVG into the study's folder instead, and the tables
of its page between their marks.
"""

import argparse
import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from hubsim import files, progress
from hubsim.engine import ROOT
from hubsim.errors import HubsimError
from hubsim.run.results import as_json
from hubsim.sweep import cases
from hubsim.sweep.cases import DataclassInstance
from hubsim.sweep.drives import DRIVES
from matplotlib.figure import Figure
from regen_table import generate, installation, plotting
from regen_table.cli import REFUSED, Parser, interrupted, output_file
from regen_table.errors import ConfigurationError
from rich.progress import Progress

BEGINS, ENDS = "<!-- from {}.csv: {} -->\n", "<!-- end -->\n"
FREE = ("workers", "date", "json", "refresh", "page", "data")  # what goes with --refresh and --page

Case = TypeVar("Case")
Outcome = TypeVar("Outcome", bound=DataclassInstance)
Row = TypeVar("Row", bound=DataclassInstance)


def no_options(_parser: Parser) -> None:
    """Add no option."""


def no_further_keys(_outcomes: Sequence[DataclassInstance]) -> Mapping[str, Any]:
    """Return nothing."""
    return {}


@dataclass(frozen=True)
class Study(Generic[Case, Outcome]):
    """One study.

    Attributes
    ----------
    name : str
        Of its folder and files.
    text : str
        What it asks and how it measures, for ``--help``; the first line is that of the list.
    outcome : type
        A line of its table.
    cases : callable
        What to measure, from the options.
    measure : callable
        One case, by its number; a function of a module, which other processes can find.
    summary : callable
        What there is to say, a line each.
    figure : callable
        The picture.
    tables : callable
        The tables of the page, by the name of their mark.
    holds : callable
        Whether everything is as it should be: the exit status.
    count : int or None
        Of the cases that are drawn, with the options ``--count`` and ``--seed``; None: it has none.
    options : callable
        Adds further options.
    more : callable
        What ``--json`` has besides origin, summary and runs, by key.
    """

    name: str
    text: str
    outcome: type[Outcome]
    cases: Callable[[argparse.Namespace], list[Case]]
    measure: Callable[[int, Case], Outcome]
    summary: Callable[[Sequence[Outcome]], list[str]]
    figure: Callable[[Sequence[Outcome]], Figure]
    tables: Callable[[Sequence[Outcome]], Mapping[str, str]]
    holds: Callable[[Sequence[Outcome]], bool]
    count: int | None = None
    options: Callable[[Parser], None] = no_options
    more: Callable[[Sequence[Outcome]], Mapping[str, Any]] = no_further_keys

    @property
    def folder(self) -> Path:
        """Where its table, picture and page are."""
        return folder_of(self.name)

    def stored(self) -> list[Outcome]:
        """Return its stored table."""
        return read(self.outcome, self.folder / f"{self.name}.csv")

    def main(self, arguments: Sequence[str]) -> int:
        """Do ``./tools/dev study NAME``."""
        parser = parser_of(self.name, self.text, self.count)
        self.options(parser)
        options = parse(parser, arguments)
        return reported(self.name, lambda bar: self._made(options, bar))

    def _made(self, options: argparse.Namespace, bar: Progress) -> tuple[list[str], bool]:
        if options.page:
            found = self.stored()
            lines = self.summary(found)
            renew_page(self.name, self.tables(found))
            write_json(self.name, options, lines, found, self.more(found))
            return lines, self.holds(found)
        check(self.name, options)
        drawn = self.cases(options)
        task = bar.add_task(self.name, total=len(drawn))
        found = cases.measured(self.measure, drawn, options.workers, lambda: bar.advance(task))
        lines = self.summary(found)
        made = cases.files_of(self.name, found, lines, getattr(options, "seed", None), options.date)
        made |= plotting.rendered({self.name: self.figure(found)})
        leave(self.name, options, made, self.tables(found))
        write_json(self.name, options, lines, found, self.more(found))
        return lines, self.holds(found)


def folder_of(name: str) -> Path:
    """Return where a study's table, picture and page are."""
    return ROOT / "host_sim" / "studies" / name


def read(kind: type[Row], path: Path) -> list[Row]:
    """Read a table of outcomes of this kind."""
    return cases.read_csv(kind, files.read_text(path))


def parser_of(name: str, text: str, count: int | None) -> Parser:
    """Return the options that every study has."""
    parser = Parser(
        prog=f"tools/dev study {name}",
        description=text,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    if count is not None:
        parser.add_argument(
            "--count", type=int, default=count, metavar="N", help=f"of all drives; default: {count}"
        )
        parser.add_argument(
            "--seed", type=int, default=1, metavar="N", help="of what is drawn; default: 1"
        )
    parser.add_argument("--workers", type=int, metavar="N", help="default: one for each core")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=ROOT / "build" / "studies" / name,
        metavar="DIR",
        help=f"for the table {name}.csv, its origin {name}.json, {name}.svg and {name}.png; "
        f"default: build/studies/{name}",
    )
    parser.add_argument(
        "--json",
        type=output_file(".json"),
        metavar="FILE",
        help="write origin, summary and every run",
    )
    parser.add_argument(
        "--refresh",
        action="store_true",
        help=f"measure everything and renew table, picture and page in host_sim/studies/{name}",
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="measure nothing: renew the tables of the page from the stored table",
    )
    parser.add_argument(
        "--date",
        metavar="ISO-8601",
        help="that outputs hold as their origin; default: SOURCE_DATE_EPOCH, or else the clock",
    )
    return parser


def add_drives(parser: Parser) -> None:
    """Add the drives to measure, for studies of a fixed list of cases."""
    parser.add_argument(
        "drives", nargs="*", type=_drive, default=DRIVES, metavar="DRIVE", help="default: all"
    )


def _drive(name: str) -> str:
    if name not in DRIVES:
        raise argparse.ArgumentTypeError(f"no {name!r}, accepted: {', '.join(DRIVES)}")
    return name


def parse(parser: Parser, arguments: Sequence[str]) -> argparse.Namespace:
    """Return the options; what goes into the repository has none that changes what is measured."""
    options = parser.parse_args(arguments)
    if options.refresh or options.page:
        for name, value in vars(options).items():
            if name not in FREE and value != parser.get_default(name):
                parser.error(f"--refresh and --page are of the whole study: not with {name}")
    return options


def check(name: str, options: argparse.Namespace) -> None:
    """Refuse numbers that mean nothing, and places that cannot be written to."""
    cases.accept(options)
    if options.json is not None:
        files.check_writable(options.json)
    files.make_directory(options.output)


def leave(
    name: str, options: argparse.Namespace, made: Mapping[str, bytes], tables: Mapping[str, str]
) -> None:
    """Write all files of a study, or none."""
    if not options.refresh:
        generate.write_all(dict(made), options.output)
        return
    wanted = {file: content for file, content in made.items() if not file.endswith(".png")}
    page = files.read_text(folder_of(name) / "README.md")
    wanted["README.md"] = with_tables(name, page, tables).encode()
    generate.write_all(wanted, folder_of(name))


def renew_page(name: str, tables: Mapping[str, str]) -> None:
    """Write these tables into the page."""
    path = folder_of(name) / "README.md"
    files.write_text(path, with_tables(name, files.read_text(path), tables))


def with_tables(name: str, page: str, tables: Mapping[str, str]) -> str:
    """Return a page with these tables between their marks."""
    for table, lines in tables.items():
        mark = BEGINS.format(name, table)
        before, found, rest = page.partition(mark)
        if not found:
            raise HubsimError(f"{folder_of(name) / 'README.md'}: no mark {mark.strip()}")
        page = f"{before}{mark}\n{lines}\n{ENDS}{rest.partition(ENDS)[2]}"
    return page


def markdown(columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table of Markdown."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join(f"| {' | '.join(str(cell) for cell in line)} |\n" for line in lines)


def percent(share: float, digits: int = 0) -> str:
    """Return a share in per cent."""
    return f"{100.0 * share:.{digits}f} %"


def write_json(
    name: str,
    options: argparse.Namespace,
    lines: Sequence[str],
    found: Sequence[DataclassInstance],
    more: Mapping[str, Any] | None = None,
) -> None:
    """Write what ``--json`` asks for; numbers that are not finite are null."""
    if options.json is None:
        return
    origin = installation.provenance(
        scenario=name, seed=getattr(options, "seed", None), date=options.date
    )
    runs = [{key: _finite(value) for key, value in asdict(o).items()} for o in found]
    content = {"provenance": origin, "summary": lines, **(more or {}), "runs": runs}
    files.write_text(options.json, as_json(content))


def _finite(value: Any) -> Any:  # noqa: ANN401, int, float or str
    return None if isinstance(value, float) and not math.isfinite(value) else value


def reported(name: str, made: Callable[[Progress], tuple[list[str], bool]]) -> int:
    """Do the work, print what it says and return the exit status."""
    try:
        with progress.shown("") as bar:
            lines, holds = made(bar)
    except (HubsimError, ConfigurationError) as error:
        print(f"study {name}: {error}", file=sys.stderr)
        return REFUSED
    except KeyboardInterrupt as interrupt:
        return interrupted(f"study {name}", interrupt)
    try:
        print(*lines, sep="\n", flush=True)
    except BrokenPipeError:  # the reader has gone: nothing more to say
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 0 if holds else 1
