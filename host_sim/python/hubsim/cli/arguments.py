# SPDX-License-Identifier: Apache-2.0
"""The command line: ``python -m hubsim COMMAND ...``.

Errors are one line on stderr. Exit status 0: done and every criterion met; 1: a criterion not met,
or failed; 2: refused, because the call or a file of its is wrong; 130: interrupted. Only what a
command needs is imported, and only when it runs: ``--help`` loads the standard library alone.
"""

import argparse
import contextlib
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from regen_table import installation
from regen_table.cli import REFUSED, Parser, ShowVersion, drive_file, interrupted, output_file
from regen_table.errors import ConfigurationError

from hubsim import moved
from hubsim.cli import swarms, sweeps
from hubsim.errors import HubsimError

DEFAULT_CONFIG = installation.ROOT / "tools" / "motors" / "lu2013.toml"
STRATEGIES = ("parallel_ratio", "parallel_free_travel", "series_optimal")
CARRIERS = ("qemu", "board")  # of the controllers, besides the engine itself
RECORDINGS = {
    "csv": "write the recorded signals as text",
    "parquet": "write the recorded signals as a Parquet table with units",
    "mdf": "write the recorded signals as an ASAM MDF4 measurement with units",
    "layout": "write a PlotJuggler layout for the recorded signals",
}
SUFFIXES = {
    "csv": (".csv", ".txt"),
    "parquet": (".parquet",),
    "mdf": (".mf4", ".mdf"),
    "layout": (".xml",),
}
_SHOWN_REPORT = "hubsim_report" if installation.INSTALLED else "build/report"
_REPORT = Path(_SHOWN_REPORT) if installation.INSTALLED else installation.ROOT / _SHOWN_REPORT

EXAMPLES = (
    "hubsim list --criteria",
    "hubsim run stop --set initial_speed_kmh=40 --set demand_nm=60 --json stop.json --mdf stop.mf4",
    "hubsim run stop --on qemu",
    "hubsim run contactor --set plant.bus.capacitance_f=2e-3",
    "hubsim compare stop stop --set-b plant.motor.phase_resistance_ohm=0.032 --relative 0.04",
    (
        "hubsim sweep stop --vary 'demand_nm=range(5,120,24)' "
        "--vary brake.strategy=series_optimal,parallel_ratio --output grid.parquet"
    ),
    "hubsim stops --count 40 --output stops",
    "hubsim faults --reduced --output faults",
    "hubsim swarm --seeds 0:500 --output swarm --json swarm.json",
    (
        "hubsim sweep stop --vary 'plant.vehicle.mass_kg=normal(660,30)' --runs 1000 --output "
        "draws.csv"
    ),
)
_SCENARIO = "a built-in scenario ('hubsim list') or a TOML file"


class Axles(argparse.Action):
    """A first file is that of all wheels, a second one that of the rear axle (``rear``)."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,
    ) -> None:
        """Take one more file."""
        given = getattr(namespace, "axles", ())
        if len(given) == len(AXLES):
            parser.error(f"{option_string}: accepted: twice, {' and '.join(AXLES)}")
        setattr(namespace, AXLES[len(given)], values)
        namespace.axles = (*given, values)


AXLES = ("config", "rear")
TWO_DRIVES = "twice: of the front axle's wheels and of the rear axle's"
Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit status."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in moved.STUDIES:
        return moved.answer(given[0])
    options = parser().parse_args(given)
    try:
        commands = importlib.import_module("hubsim.cli.commands")
        status = int(commands.COMMANDS[options.command](options))
        sys.stdout.flush()
    except (HubsimError, ConfigurationError) as error:
        print(f"hubsim: {error}", file=sys.stderr)
        return REFUSED
    except ModuleNotFoundError as error:
        print(f"hubsim: {installation.missing(error)}", file=sys.stderr)
        return 1
    except KeyboardInterrupt as interrupt:
        return interrupted("hubsim", interrupt)
    except OSError as error:
        return _cannot_print(error)
    return status


def _cannot_print(error: OSError) -> int:
    """Say that standard output takes no more; a pipe that was closed needs no message."""
    if not isinstance(error, BrokenPipeError):
        print(f"hubsim: standard output: {error.strerror or error}", file=sys.stderr)
    with contextlib.suppress(OSError):  # what is buffered goes nowhere when the process ends
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 1


def parser() -> Parser:
    """Return the parser of the whole command line."""
    out = Parser(
        prog="hubsim",
        description="The simulated vehicle: complete controllers on a physical plant.",
        epilog="\n  ".join(["for example:", *EXAMPLES]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    out.add_argument("--version", action=ShowVersion)
    commands = out.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=Parser, dest="command"
    )
    for add in (
        *(_add_run, _add_sim, _add_sweep, *sweeps.COMMANDS, *swarms.COMMANDS),
        *(_add_compare, _add_list, _add_report, _add_blackbox, _add_crash),
    ):
        add(commands)
    return out


def _add_common(command: Parser, *, axles: bool = False) -> None:
    """Add what every command that runs something takes."""
    text = "a TOML file, or the name of a drive that comes along; default: lu2013"
    command.add_argument(
        "--config",
        type=drive_file,
        default=DEFAULT_CONFIG,
        metavar="DRIVE",
        action=Axles if axles else "store",
        help=f"{text}; {TWO_DRIVES}" if axles else text,
    )
    command.add_argument(
        "--set",
        dest="settings",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help=(
            "a key of the scenario (also events.NAME.key, criteria.NAME.key), section.key of the "
            "drive, or plant.section.key of the simulated world alone; repeatable"
        ),
    )


def _add_strategy(command: Parser) -> None:
    command.add_argument(
        "--strategy",
        choices=STRATEGIES,
        metavar="NAME",
        help=f"{', '.join(STRATEGIES)}; default: the drive's own",
    )


def _add_run(commands: Commands) -> None:
    command = commands.add_parser(
        "run",
        help="one run of a scenario",
        description=(
            "Run a scenario, show where the energy went and whether the scenario's "
            "criteria are met. Exit status 1 if not."
        ),
    )
    command.add_argument("scenario", metavar="SCENARIO", help=_SCENARIO)
    _add_common(command, axles=True)
    command.set_defaults(rear=None)
    _add_strategy(command)
    command.add_argument(
        "--signals",
        metavar="PATTERN,...",
        help="what recordings hold, '*' for anything; default: the most important ones",
    )
    for name, text in RECORDINGS.items():
        kind = output_file(*SUFFIXES[name])
        command.add_argument(f"--{name}", type=kind, metavar="FILE", help=text)
    command.add_argument(
        "--json",
        type=output_file(".json"),
        metavar="FILE",
        help="write energies, shares and criteria",
    )
    command.add_argument(
        "--on",
        choices=CARRIERS,
        metavar="CARRIER",
        help=(
            "qemu: the controllers as cross-compiled for the Cortex-M4 run on an emulated one, the"
            " plant on this machine; recordings and figures are the same bit for bit"
            " (host_sim/pil/README.md). board: the whole application, reached by CAN frames only,"
            " in every wheel (host_sim/application/README.md); default: the controllers' two steps"
        ),
    )
    sweeps.add_date(command)


def _add_sim(commands: Commands) -> None:
    text = "the urban cycle under the three strategies, table and report"
    command = commands.add_parser("sim", help=text, description=f"{text[0].upper()}{text[1:]}.")
    _add_common(command)
    command.add_argument(
        "--scenario",
        default="ece15",
        metavar="NAME",
        help="a scenario with a cycle; default: ece15",
    )
    command.add_argument(
        "--output", type=Path, default=_REPORT, metavar="DIR", help=f"default: {_SHOWN_REPORT}"
    )
    sweeps.add_date(command)


def _add_sweep(commands: Commands) -> None:
    command = commands.add_parser(
        "sweep",
        help="many runs of a scenario with keys that vary, into one table",
        description=(
            "Run a scenario over a grid of keys, over random draws, or both. An interrupted sweep"
            " goes on with the same command. Exit status 1 if a run could not be done or did not"
            " meet the scenario's criteria."
        ),
    )
    command.add_argument("scenario", metavar="SCENARIO", help=_SCENARIO)
    _add_common(command)
    _add_strategy(command)
    command.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="KEY=SPEC",
        required=True,
        help=(
            "a key as --set takes it, and a,b,... or range(first,last,count) for a grid;"
            " normal(mean,deviation), uniform(lowest,highest) or choice(a,b,...) for draws;"
            " repeatable"
        ),
    )
    command.add_argument("--runs", type=int, metavar="N", help="draws, for each point of the grid")
    command.add_argument(
        "--seed", type=int, default=1, metavar="N", help="of the draws; default: 1"
    )
    command.add_argument(
        "--collect",
        action="append",
        default=[],
        metavar="COLUMN=FORMULA",
        help="another column: a formula as in criteria; repeatable",
    )
    command.add_argument(
        "--output",
        type=Path,
        required=True,
        metavar="FILE",
        help="the table, .parquet or .csv; until it is complete, FILE.parts/",
    )
    command.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a Dask scheduler (tcp://host:port); default: workers on this machine",
    )
    command.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes on this machine; default: one for each core",
    )
    command.add_argument(
        "--restart",
        action="store_true",
        help="begin anew instead of going on with what an interrupted sweep left",
    )
    sweeps.add_date(command)


def _add_compare(commands: Commands) -> None:
    command = commands.add_parser(
        "compare",
        help="two results or two runs side by side",
        description=(
            "Compare figures and signals of two results (JSON, CSV, Parquet) or of two "
            "scenarios that are run now. Exit status 1 if anything that both have is further apart "
            "than the tolerances allow."
        ),
    )
    command.add_argument(
        "first", metavar="A", help="a file that 'hubsim run' wrote, or a scenario to run"
    )
    command.add_argument("second", metavar="B", help="another one")
    _add_common(command)
    for side in ("a", "b"):
        command.add_argument(
            f"--set-{side}",
            action="append",
            default=[],
            metavar="KEY=VALUE",
            help=f"as --set, for the run of {side.upper()} alone; repeatable",
        )
    command.add_argument(
        "--absolute",
        type=float,
        default=0.0,
        metavar="X",
        help="tolerated difference, in each one's unit; default: 0",
    )
    command.add_argument(
        "--relative",
        type=float,
        default=0.0,
        metavar="X",
        help="tolerated share of the larger figure, or of a signal's peak; default: 0",
    )
    command.add_argument(
        "--only",
        metavar="PATTERN,...",
        help="what to compare, '*' for anything; default: everything",
    )
    command.add_argument(
        "--all", action="store_true", help="show also what is within the tolerances"
    )
    command.add_argument(
        "--json", type=output_file(".json"), metavar="FILE", help="write the differences"
    )
    sweeps.add_date(command)


def _add_list(commands: Commands) -> None:
    command = commands.add_parser(
        "list",
        help="scenarios, cycles, drives, keys, signals",
        description="Show everything that has a name.",
    )
    command.add_argument(
        "--parameters",
        action="store_true",
        help="everything that events and --set plant.NAME=VALUE can change",
    )
    command.add_argument("--signals", action="store_true", help="everything that can be recorded")
    command.add_argument(
        "--layout",
        action="store_true",
        help="a PlotJuggler layout for everything that can be recorded",
    )
    command.add_argument(
        "--criteria",
        action="store_true",
        help="keys of events and criteria, functions of formulas, reasons",
    )


def _add_report(commands: Commands) -> None:
    command = commands.add_parser(
        "report",
        help="one page from the results of runs",
        description=(
            "Make one self-contained page from results written by "
            "'hubsim run --json RUN.json', each with what was recorded beside it "
            "('--parquet RUN.parquet' or '--csv RUN.csv', the same name)."
        ),
    )
    command.add_argument(
        "results",
        metavar="RESULT.json",
        type=Path,
        nargs="+",
        help="what 'hubsim run --json' wrote",
    )
    command.add_argument(
        *("-o", "--output"),
        type=output_file(".html", ".htm"),
        required=True,
        metavar="FILE",
        help="the page to write",
    )
    command.add_argument(
        "--config",
        type=drive_file,
        metavar="DRIVE",
        help="a file or a name; default: the one that comes along under the result's name",
    )
    command.add_argument(
        "--stops",
        action="store_true",
        help="also simulate stops at constant demand under all strategies",
    )
    command.add_argument(
        "--blackbox",
        action="append",
        default=[],
        type=Path,
        metavar="LOG",
        help=(
            "also show what a controller recorded around its first fault, from text with the "
            "shell's answer; --config as for 'hubsim blackbox'; repeatable"
        ),
    )
    command.add_argument(
        "--date",
        metavar="ISO-8601",
        help="of the page where a result holds no origin; default: SOURCE_DATE_EPOCH, or the clock",
    )


def _add_blackbox(commands: Commands) -> None:
    command = commands.add_parser(
        "blackbox",
        help="what a controller recorded around its first fault",
        description=(
            "Read what the shell's blackbox printed, from a terminal's log: what happened, how "
            "often each fault and warning came; --output writes both rings as tables and a picture."
        ),
    )
    command.add_argument("file", metavar="LOG", type=Path, help="text with the shell's answer")
    command.add_argument(
        "--config",
        type=drive_file,
        default=DEFAULT_CONFIG,
        metavar="DRIVE",
        help="the drive, whose full scales make amperes and volts; default: lu2013",
    )
    command.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="for blackbox_fast.csv, blackbox_slow.csv, blackbox.svg and blackbox.png",
    )


def _add_crash(commands: Commands) -> None:
    command = commands.add_parser(
        "crash",
        help="why a controller's program stopped",
        description=(
            "Read what the greeting or the shell's crash printed, from a terminal's log: the fault "
            "in words and, with the ELF of that firmware, where in the program it was."
        ),
    )
    command.add_argument("file", metavar="LOG", type=Path, help="text with the shell's answer")
    command.add_argument(
        "--elf", type=Path, metavar="ELF", help="names the functions; addr2line adds the lines"
    )
