# SPDX-License-Identifier: Apache-2.0
"""The command line: ``python -m regen_table COMMAND CONFIG.toml ...``.

Errors are one line on stderr and exit code 1.
"""

import argparse
import json
import math
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from regen_table import (
    __version__,
    calibrate,
    cycles,
    generate,
    ideal,
    installation,
    outputs,
    packs,
    points,
    provenance,
    relations,
    report,
    schema,
    stops,
)
from regen_table.errors import CheckFailedError, ConfigurationError


class _Parser(argparse.ArgumentParser):
    """Answers a wrong call with one line, as everything else here."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit code."""
    options = _parser().parse_args(
        _with_negative_lists(sys.argv[1:] if arguments is None else arguments)
    )
    try:
        return int(options.run(options))
    except (ConfigurationError, CheckFailedError) as error:
        print(error, file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(installation.missing(error), file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(
            os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno()
        )  # the reader has gone: nothing more to say
        return 1
    except KeyboardInterrupt:
        return 130


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
                f"{text!r}, accepted: numbers from {lowest:g} to {highest:g} {unit}, separated by commas"
            )
        return values

    return parse


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


_SPEEDS = _numbers(-1e5, 1e5, "r/min")
_TEMPERATURES = _numbers(-100.0, 300.0, "degC")
_TORQUES = _numbers(-1e5, 1e5, "N m")
_DEMANDS = _numbers(1e-3, 1e5, "N m")
_STRATEGIES = ("parallel_ratio", "parallel_free_travel", "series_optimal")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="regen_table",
        description="Loss models, optimum, configuration and table generator of hubfoc.",
    )
    parser.add_argument("--version", action="version", version=f"regen_table {__version__}")
    commands = parser.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=_Parser
    )

    def add(
        name: str, text: str, run: Callable[[argparse.Namespace], int], several: bool = False
    ) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        if several:
            command.add_argument("configs", type=Path, nargs="+", metavar="CONFIG.toml")
        else:
            command.add_argument("config", type=Path, metavar="CONFIG.toml")
        command.set_defaults(run=run)
        return command

    def add_point(command: argparse.ArgumentParser) -> None:
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
        command.add_argument(
            "--json", action="store_true", help="an array of objects instead of text"
        )

    command = add("generate", "write the configuration as C source and as binary image", _generate)
    command.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: firmware/config/generated"
    )
    command.add_argument(
        "--report",
        type=Path,
        metavar="FILE.json",
        help="also write margins, number formats and grid losses as JSON",
    )
    command.add_argument(
        "--date",
        metavar="ISO-8601",
        help="of the report; default: SOURCE_DATE_EPOCH, else the clock",
    )
    command.add_argument(
        "--plots",
        action="store_true",
        help="also draw the figures, into DIR or else build/report/figures",
    )

    command = add(
        "check",
        "compare checked-in files with what their TOML files generate",
        _check,
        several=True,
    )
    command.add_argument(
        "-o",
        "--output",
        type=Path,
        default=generate.GENERATED,
        metavar="DIR",
        help="default: firmware/config/generated",
    )

    add_point(add("solve", "best braking torque at speeds and winding temperatures", _solve))
    command = add("evaluate", "currents, powers and losses at any operating points", _evaluate)
    command.add_argument(
        "--torque-nm",
        type=_TORQUES,
        required=True,
        metavar="LIST",
        help="electromagnetic, negative brakes forward motion",
    )
    add_point(command)

    command = add("stop", "the ideal stop at constant braking demand, down to standstill", _stop)
    command.add_argument("--initial-speed-kmh", type=_number(0.1, 1000.0, "km/h"), required=True)
    command.add_argument(
        "--demand-nm",
        type=_DEMANDS,
        required=True,
        metavar="LIST",
        help="at each driven wheel, magnitude",
    )
    command.add_argument(
        "--strategy", choices=[*_STRATEGIES, "all"], help="default: the configuration's"
    )
    command.add_argument(
        "--winding-temperature-c",
        type=_number(-100.0, 300.0, "degC"),
        help="default: the reference temperature",
    )
    command.add_argument("--soc", type=_number(0.0, 1.0, ""))
    command.add_argument(
        "--battery",
        choices=packs.BATTERIES,
        default=packs.SETTLED,
        help="the battery's RC branch in steady state at every instant (default), or at rest before the stop and moving",
    )
    command.add_argument("--json", action="store_true")

    command = add("cycle", "the ideal drive cycle under all strategies", _cycle)
    command.add_argument(
        "--trace",
        type=Path,
        required=True,
        metavar="FILE.csv",
        help="columns time_s and speed_km_h",
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
    command.add_argument("--json", action="store_true")

    command = add(
        "figures", "draw the figures of the paper for a configuration, SVG and PNG", _figures
    )
    command.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")

    command = commands.add_parser(
        "calibrate",
        help="hall edges and encoder index from a recording",
        description="Hall edges and encoder index from a recording.",
    )
    columns = "v_ab_v, v_bc_v, hall_a, hall_b, hall_c and/or index, of a wheel spun by hand with the bridge off"
    command.add_argument("recording", type=Path, metavar="FILE.csv", help=columns)
    command.set_defaults(run=_calibrate)
    return parser


def _calibrate(options: argparse.Namespace) -> int:
    with _about(options.recording):
        found = calibrate.calibrate(calibrate.load(options.recording))
    print(calibrate.as_toml(found))
    return 0


def _generate(options: argparse.Namespace) -> int:
    drive = schema.load(options.config)
    with _about(options.config):
        found = report.collect(drive)
        made = generate.artefacts(drive)
    directory = options.output or generate.GENERATED
    files = {directory / name: content for name, content in made.files.items()}
    if options.report:
        origin = provenance.provenance(drive.name, made.image, date=options.date)
        files[options.report] = report.as_json(found, origin)
    paths = outputs.write_files(files, make_directories=True)
    if options.plots:
        from regen_table import figures  # noqa: PLC0415, Matplotlib takes longer to load than all else takes to run

        with _about(options.config):
            paths += figures.draw_all(drive, options.output or generate.FIGURES)
    for warning in relations.warnings(drive):  # last: what fails says one line
        print(f"{options.config}: warning: {warning}", file=sys.stderr)
    print(report.as_text(found))
    for path in paths:
        print(path)
    return 0


def _check(options: argparse.Namespace) -> int:
    for path in options.configs:
        with _about(path):
            generate.check(schema.load(path), options.output)
    print(f"{len(options.configs)} configuration(s) up to date")
    return 0


def _solve(options: argparse.Namespace) -> int:
    drive = schema.load(options.config)
    with _about(options.config):
        how = points.setting(drive, options.joint, options.soc)
        temperatures = _temperatures(drive, options.winding_temperature_c)
        records = [
            points.solve(drive, speed, warm, how)
            for warm in temperatures
            for speed in options.speed_rpm
        ]
    _show(
        records,
        options.json,
        [
            "speed_rpm",
            "winding_temperature_c",
            "torque_optimal_nm",
            "torque_zero_nm",
            "torque_idle_nm",
            "torque_optimal_limited_nm",
            "current_d_a",
            "current_q_a",
            "dc_power_w",
        ],
    )
    return 0


def _evaluate(options: argparse.Namespace) -> int:
    drive = schema.load(options.config)
    with _about(options.config):
        how = points.setting(drive, options.joint, options.soc)
        temperatures = _temperatures(drive, options.winding_temperature_c)
        records = [
            points.evaluate(drive, speed, torque, warm, how)
            for warm in temperatures
            for speed in options.speed_rpm
            for torque in options.torque_nm
        ]
    _show(
        records,
        options.json,
        [
            "speed_rpm",
            "torque_nm",
            "winding_temperature_c",
            "current_d_a",
            "current_q_a",
            "dc_power_w",
            "loss_copper_w",
            "loss_iron_w",
            "loss_inverter_w",
            "loss_battery_w",
            "region",
        ],
    )
    return 0


def _stop(options: argparse.Namespace) -> int:
    drive = schema.load(options.config)
    strategy = options.strategy or drive.brake.strategy
    warm = _one_temperature(drive, options.winding_temperature_c)
    with _about(options.config):
        found = [
            stops.stop(
                drive, name, demand, options.initial_speed_kmh, warm, options.soc, options.battery
            )
            for name in (_STRATEGIES if strategy == "all" else [strategy])
            for demand in options.demand_nm
        ]
    _show(
        [result.as_dict() for result in found],
        options.json,
        [
            "strategy",
            "demand_nm",
            "stop_distance_m",
            "stop_time_s",
            "kinetic_energy_j",
            "stored_share_of_kinetic",
        ],
    )
    return 0


def _cycle(options: argparse.Namespace) -> int:
    drive = schema.load(options.config)
    warm = _one_temperature(drive, options.winding_temperature_c)
    trace = cycles.load(options.trace, options.top_speed_kmh)
    with _about(options.config):
        found = [
            cycles.run(drive, trace, strategy, warm, options.soc, ideal.production(drive))
            for strategy in _STRATEGIES
        ]
    _show(
        [result.as_dict() for result in found],
        options.json,
        ["cycle", "strategy", "braking_share_stored", "residual_relative"],
    )
    return 0


def _figures(options: argparse.Namespace) -> int:
    from regen_table import figures  # noqa: PLC0415, as above

    drive = schema.load(options.config)
    with _about(options.config):
        for path in figures.draw_all(drive, options.output):
            print(path)
    return 0


def _temperatures(drive: schema.Drive, given: list[float] | None) -> list[float]:
    """Return the winding temperatures asked for, refusing those at which the copper law is meaningless."""
    found = [drive.motor.reference_temperature_c] if given is None else given
    return [_one_temperature(drive, value) for value in found]


def _one_temperature(drive: schema.Drive, given: float | None) -> float:
    value = drive.motor.reference_temperature_c if given is None else given
    share = 1.0 + drive.motor.resistance_temperature_coefficient_per_k * (
        value - drive.motor.reference_temperature_c
    )
    if share <= 0.0:
        raise ConfigurationError(
            f"--winding-temperature-c: {value:g} degC leaves no resistance, accepted: temperatures that leave some"
        )
    return value


def _show(records: Sequence[Any], as_json: bool, columns: list[str]) -> None:
    """Print records as JSON, or some of their keys as a table."""
    if as_json:
        print(json.dumps(records, indent=1, allow_nan=False))
        return
    rows = [columns] + [[_cell(record[name]) for name in columns] for record in records]
    widths = [max(len(row[k]) for row in rows) for k in range(len(columns))]
    for row in rows:
        print("  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)))


def _cell(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else "-" if value is None else str(value)


class _about:  # noqa: N801, reads as a word: with _about(path)
    """Begin the message of a ConfigurationError with the file it is about, once."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if isinstance(error, ConfigurationError) and not str(error).startswith(str(self.path)):
            raise ConfigurationError(f"{self.path}: {error}") from error
