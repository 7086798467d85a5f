# SPDX-License-Identifier: Apache-2.0
"""The command line: ``python -m regen_table COMMAND DRIVE ...``.

Errors are one line on stderr. Exit status 0: done; 1: something that was to be checked does not
hold, or failed; 2: refused, because the call or a file of its is wrong; 130: interrupted.
"""

import argparse
import importlib
import math
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from regen_table import BATTERIES, STOP_LIMITS, STRATEGIES, boards, installation, label
from regen_table.errors import CheckFailedError, ConfigurationError
from regen_table.suggest import suggestion

FAILED, REFUSED, INTERRUPTED = 1, 2, 130  # exit status


class Parser(argparse.ArgumentParser):
    """Answers a wrong call with one line, as everything else here."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and exit with status 2."""
        self.exit(REFUSED, f"{self.prog}: {message} (see {self.prog} --help)\n")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:  # noqa: ANN401
        """Refuse what is left over here, where the options of this very command are known."""
        options, left = super().parse_known_args(args, namespace)
        if left:
            word = left[0].partition("=")[0]
            if not word.startswith("-"):
                self.error(f"{word!r}: one argument too many")
            self.error(f"no {word!r}, {suggestion(word, self._option_string_actions)}")
        return options, left

    def _check_value(self, action: argparse.Action, value: Any) -> None:  # noqa: ANN401, as there
        """Refuse what is no choice, with the one that was meant."""
        if action.choices is not None and value not in action.choices:
            hint = suggestion(str(value), map(str, action.choices))
            raise argparse.ArgumentError(action, f"no {str(value)!r}, {hint}")


def drive_file(named: str) -> Path:
    """Return the file of a drive on the command line, named as ``installation.drive_file``."""
    try:
        return installation.drive_file(named)
    except ConfigurationError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def output_file(*suffixes: str) -> Callable[[str], Path]:
    """Return a parser of a file to write: its name ends in one of these, or in no suffix."""

    def parse(text: str) -> Path:
        path = Path(text)
        if path.suffix not in ("", *suffixes):
            raise argparse.ArgumentTypeError(
                f"{text!r}, accepted: a name that ends in {' or '.join(suffixes)}"
            )
        return path

    return parse


def interrupted(program: str, interrupt: KeyboardInterrupt) -> int:
    """Say on stderr that Ctrl-C ended a program, and how to go on; return the exit status."""
    print("; ".join(filter(None, (f"{program}: interrupted", str(interrupt)))), file=sys.stderr)
    return INTERRUPTED


class ShowVersion(argparse.Action):
    """The option --version of both commands."""

    def __init__(self, option_strings: Sequence[str], dest: str) -> None:
        text = "show version and commit, and exit"
        super().__init__(option_strings, dest, nargs=0, default=argparse.SUPPRESS, help=text)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Ask git only now."""
        print(installation.identity(parser.prog))
        parser.exit()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit code.

    What a command needs is loaded after the call has been understood: a call without a command, a
    wrong one and ``--help`` answer without NumPy and pydantic.
    """
    options = _parser().parse_args(
        _with_negative_lists(sys.argv[1:] if arguments is None else arguments)
    )
    try:
        commands = importlib.import_module("regen_table.commands")
        return int(getattr(commands, f"run_{options.command}")(options))
    except CheckFailedError as error:
        print(error, file=sys.stderr)
        return FAILED
    except ConfigurationError as error:
        print(error, file=sys.stderr)
        return REFUSED
    except ModuleNotFoundError as error:
        print(installation.missing(error), file=sys.stderr)
        return FAILED
    except BrokenPipeError:
        os.dup2(
            os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno()
        )  # the reader has gone: nothing more to say
        return FAILED
    except KeyboardInterrupt as interrupt:
        return interrupted("regen_table", interrupt)


def _with_negative_lists(arguments: Sequence[str]) -> list[str]:
    """Join "--option" "-1,2" into "--option=-1,2".

    A list that begins with a minus sign is no option.
    """
    joined: list[str] = []
    for argument in arguments:
        if (
            re.match(r"-[\d.]", argument)
            and joined
            and joined[-1].startswith("--")
            and "=" not in joined[-1]
        ):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return joined


def _numbers(lowest: float, highest: float, unit: str) -> Callable[[str], list[float]]:
    """Return a parser of a comma-separated list of numbers in a range."""

    def parse(text: str) -> list[float]:
        try:
            values = [float(part) for part in text.split(",")]
        except ValueError:
            values = [math.nan]
        if not all(lowest <= value <= highest for value in values):
            raise argparse.ArgumentTypeError(
                f"{text!r}, accepted: numbers from {lowest:g} to {highest:g} {unit}, separated by"
                " commas"
            )
        return values

    return parse


def _limits(text: str) -> tuple[str, ...]:
    """Return the limits that a list names."""
    names = tuple(STOP_LIMITS if text == "all" else text.split(","))
    if not set(names) <= set(STOP_LIMITS):
        raise argparse.ArgumentTypeError(
            f"{text!r}, accepted: all, or some of {', '.join(STOP_LIMITS)}, separated by commas"
        )
    return names


def _number(lowest: float, highest: float, unit: str) -> Callable[[str], float]:
    """Return a parser of one number in a range."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(
                f"{text!r}, accepted: a number from {lowest:g} to {highest:g} {unit}"
            )
        return value

    return parse


def _whole_number(lowest: int, highest: int) -> Callable[[str], int]:
    """Return a parser of one whole number in a range."""

    def parse(text: str) -> int:
        if not (text.isdecimal() and lowest <= int(text) <= highest):
            raise argparse.ArgumentTypeError(
                f"{text!r}, accepted: a whole number from {lowest} to {highest}"
            )
        return int(text)

    return parse


_SPEEDS = _numbers(-1e5, 1e5, "r/min")
_TEMPERATURES = _numbers(-100.0, 300.0, "degC")
_TORQUES = _numbers(-1e5, 1e5, "N m")
_DEMANDS = _numbers(1e-3, 1e5, "N m")


def _add_point(command: argparse.ArgumentParser) -> None:
    """Add the arguments of the operating points."""
    command.add_argument(
        "--speed-rpm", type=_SPEEDS, required=True, metavar="LIST", help="mechanical"
    )
    command.add_argument(
        "--winding-temperature-c",
        type=_TEMPERATURES,
        metavar="LIST",
        help="default: the reference temperature",
    )
    command.add_argument(
        "--joint",
        action="store_true",
        help="both currents free, inside phase current and voltage (default: i_d = 0)",
    )
    command.add_argument(
        "--soc",
        type=_number(0.0, 1.0, ""),
        help="state of charge, where the battery's voltage depends on it",
    )
    _add_answer(command)


def _add_answer(command: argparse.ArgumentParser) -> None:
    """Add the arguments of the output."""
    command.add_argument("--json", action="store_true", help="an array of objects instead of text")
    command.add_argument(
        "--output",
        type=output_file(".json"),
        metavar="FILE.json",
        help="also write the array into a file, with version, commit, configuration and date",
    )
    _add_date(command)


def _add_date(command: argparse.ArgumentParser) -> None:
    """Add the date of what is written."""
    command.add_argument(
        "--date",
        metavar="ISO-8601",
        help="of the file written; default: SOURCE_DATE_EPOCH, else the clock",
    )


def _add_fit(command: argparse.ArgumentParser) -> None:
    """Add the arguments of the loss fit."""
    command.add_argument(
        "measurements",
        type=Path,
        nargs="+",
        metavar="FILE.csv",
        help="columns by heading: tools/regen_table/README.md, Measured losses; several are fitted"
        " together",
    )
    command.add_argument(
        "--max-speed-rpm",
        type=_number(0.0, 1e5, "r/min"),
        metavar="N",
        help="leave out faster points, where the field is weakened",
    )
    command.add_argument(
        "--inertia-kg-m2",
        type=_number(1e-9, 1e4, "kg m2"),
        metavar="J",
        help="of all that turns in a coast-down",
    )
    command.add_argument(
        "--winding-temperature-c",
        type=_number(-100.0, 300.0, "degC"),
        metavar="N",
        help="of rows without a column of it; default: unknown",
    )
    command.add_argument(
        "--drive",
        type=drive_file,
        metavar="DRIVE",
        help="a TOML file, or the name of one in tools/motors: pole pairs, flux, what else of the"
        " inverter is known",
    )
    command.add_argument(
        "-o",
        "--output",
        type=output_file(".toml"),
        metavar="FILE.toml",
        help="keys of [motor] and [inverter], with --drive",
    )
    command.add_argument(
        "--json", type=output_file(".json"), metavar="FILE.json", help="everything that was found"
    )
    command.add_argument(
        "--picture",
        type=output_file(".svg", ".png"),
        metavar="FILE.svg",
        help="losses, residuals and best braking torque, SVG or PNG",
    )


def _add_flux(command: argparse.ArgumentParser) -> None:
    """Add the arguments of the flux map."""
    command.add_argument(
        "map",
        type=Path,
        metavar="MAP",
        help="CSV or Parquet with i_d_a, i_q_a, psi_d_wb, psi_q_wb, or NPZ, as motulator's",
    )
    command.add_argument("--pole-pairs", type=_whole_number(1, 60), required=True, metavar="N")
    command.add_argument(
        "--torque-nm",
        type=_number(1e-3, 2e4, "N m"),
        metavar="T",
        help="where the constants make the torque exact; default: half the map's largest",
    )
    command.add_argument(
        "--max-current-a",
        type=_number(0.1, 3000.0, "A"),
        metavar="I",
        help="peak phase current that the map must hold in every direction",
    )
    command.add_argument(
        "-o",
        "--output",
        type=output_file(".toml"),
        metavar="FILE.toml",
        help="flux linkage and inductances as keys of [motor]",
    )
    command.add_argument("--json", type=output_file(".json"), metavar="FILE.json")


def _add_explain(command: argparse.ArgumentParser) -> None:
    """Add the keys to explain."""
    command.add_argument(
        "keys",
        nargs="+",
        metavar="KEY",
        help="section.key, a key alone, or a section for all of it",
    )


def _add_new(command: argparse.ArgumentParser) -> None:
    """Add the numbers and words of a label."""
    command.add_argument("name", metavar="NAME", help="of the drive: letters, digits, - and _")
    for quantity in label.QUANTITIES:
        ends = (quantity.lowest, quantity.highest)
        command.add_argument(
            quantity.option,
            type=_whole_number(int(ends[0]), int(ends[1]))
            if quantity.whole
            else _number(*ends, quantity.unit),
            metavar=quantity.metavar,
            help=quantity.text,
        )
    for choice in label.CHOICES:
        command.add_argument(
            choice.option, choices=choice.words, help=f"{choice.text}; default: {choice.words[0]}"
        )
    command.add_argument(
        "--board",
        choices=[*boards.known(), label.OWN_BOARD],
        help="one with a header, or a bridge of one's own; default: the smallest that will do",
    )
    command.add_argument(
        "-o",
        "--output",
        type=output_file(".toml"),
        metavar="FILE.toml",
        help="default: tools/motors/NAME.toml",
    )


def _add_calibrate(command: argparse.ArgumentParser) -> None:
    columns = (
        "v_ab_v, v_bc_v, hall_a, hall_b, hall_c and/or index, of a wheel spun by hand, both ways,"
        " with the bridge off"
    )
    command.add_argument("recording", type=Path, metavar="FILE.csv", help=columns)


def _add_key(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "file", type=Path, metavar="FILE", help="a new file, which its owner alone can read"
    )


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="regen_table",
        description="Loss models, optimum, configuration and table generator of hubfoc.",
    )
    parser.add_argument("--version", action=ShowVersion)
    commands = parser.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=Parser
    )

    def add(name: str, text: str, several: bool = False) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        about = "a TOML file, or the name of one in tools/motors"
        if several:
            command.add_argument("configs", type=drive_file, nargs="+", metavar="DRIVE", help=about)
        else:
            command.add_argument("config", type=drive_file, metavar="DRIVE", help=about)
        command.set_defaults(command=name)
        return command

    command = add("generate", "write the configuration as C source and as binary image")
    command.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: firmware/config/generated"
    )
    command.add_argument(
        "--set",
        dest="settings",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="section.key of the file with another value, also part of the name; repeatable",
    )
    command.add_argument(
        "--report",
        type=output_file(".json"),
        metavar="FILE.json",
        help="also write margins, number formats and grid losses as JSON",
    )
    _add_date(command)
    command.add_argument(
        "--plots",
        action="store_true",
        help="also draw the figures, into DIR or else build/report/figures",
    )

    command = add(
        "check",
        "compare checked-in files with what their TOML files generate",
        several=True,
    )
    command.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help="default: firmware/config/generated",
    )

    _add_point(add("solve", "best braking torque at speeds and winding temperatures"))
    command = add("evaluate", "currents, powers and losses at any operating points")
    command.add_argument(
        "--torque-nm",
        type=_TORQUES,
        required=True,
        metavar="LIST",
        help="electromagnetic, negative brakes forward motion",
    )
    _add_point(command)

    command = add("stop", "the ideal stop at constant braking demand, down to standstill")
    command.add_argument("--initial-speed-kmh", type=_number(0.1, 1000.0, "km/h"), required=True)
    command.add_argument(
        "--demand-nm",
        type=_DEMANDS,
        required=True,
        metavar="LIST",
        help="at each driven wheel, magnitude",
    )
    command.add_argument(
        "--strategy", choices=[*STRATEGIES, "all"], help="default: the configuration's"
    )
    command.add_argument(
        "--winding-temperature-c",
        type=_number(-100.0, 300.0, "degC"),
        help="default: the reference temperature",
    )
    command.add_argument("--soc", type=_number(0.0, 1.0, ""))
    command.add_argument(
        "--battery",
        choices=BATTERIES,
        default=BATTERIES[0],
        help=(
            "the battery's RC branch in steady state at every instant (default), or at rest before"
            " the stop and moving"
        ),
    )
    command.add_argument(
        "--limits",
        type=_limits,
        metavar="LIST",
        help=(
            "keep the drive's limits: all, or some of "
            + ", ".join(STOP_LIMITS)
            + "; with --battery dynamic. The demand then contains the bearings' friction"
        ),
    )
    command.add_argument(
        "--open-circuit-voltage-v",
        type=_number(1.0, 1900.0, "V"),
        help="in the place of the file's, where that is one number",
    )
    _add_answer(command)

    command = add("cycle", "the ideal drive cycle under all strategies")
    command.add_argument(
        "--trace",
        type=Path,
        required=True,
        metavar="FILE.csv",
        help="a drive cycle with the units in its heading, host_sim/cycles/README.md",
    )
    command.add_argument(
        "--top-speed-kmh",
        type=_number(0.1, 1000.0, "km/h"),
        help="scale the trace so that this is its fastest speed",
    )
    command.add_argument(
        "--winding-temperature-c",
        type=_number(-100.0, 300.0, "degC"),
        help="default: the reference temperature",
    )
    command.add_argument("--soc", type=_number(0.0, 1.0, ""))
    _add_answer(command)

    command = add("figures", "draw the figures of the paper for a configuration, SVG and PNG")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")

    for name, text, add_arguments in (
        ("fit", "loss parameters from a measured map, no-load curve or coast-down", _add_fit),
        ("flux", "check a flux map, and the constants that stand for it at a torque", _add_flux),
        ("new", "a short TOML file from the numbers of a label; asks on a terminal", _add_new),
        ("explain", "what a key means, its default, and where it is used", _add_explain),
        ("calibrate", "hall edges and encoder index from a recording", _add_calibrate),
        ("key", "draw a key for the lock of XCP, [service] key", _add_key),
    ):
        command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        add_arguments(command)
        command.set_defaults(command=name)
    return parser
