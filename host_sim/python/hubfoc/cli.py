# SPDX-License-Identifier: Apache-2.0
"""The command line: ``hubfoc COMMAND ...``."""

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from hubsim import can_protocol
from hubsim.cli.arguments import DEFAULT_CONFIG, TWO_DRIVES, Axles
from hubsim.errors import HubsimError
from regen_table import installation
from regen_table.cli import (
    FAILED,
    REFUSED,
    Parser,
    ShowVersion,
    drive_file,
    interrupted,
    output_file,
)
from regen_table.errors import ConfigurationError

from hubfoc.errors import HubfocError

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
SERVICE_BASE = 0x7F0
# Who does a command, imported only then: a help needs neither simulator nor bus.
DIRECTIONS = ("neutral", "forward", "reverse")
LIVE = (
    "A virtual vehicle in real time: in every wheel the whole application (boot, CAN, shell,"
    " watchdog) on a simulated board, with motor, inverter, battery, battery management, brake"
    " system and road in one process. A page in the browser drives it, breaks it and shows why it"
    " does what it does. Other programs reach it by CAN frames (hubfoc.dbc), as they would a"
    " vehicle."
)
_CAN = (
    "the bus: udp_multicast[:GROUP] for programs of this machine (default), virtual within one"
    " Python process, else a SocketCAN channel (not tried: the project's tests have none)"
)


def _add_bus(command: Parser) -> None:
    command.add_argument("--can", default="udp_multicast", metavar="BUS", help=_CAN)


def _add_vehicle(command: Parser) -> None:
    _add_bus(command)
    command.add_argument(
        "--base", type=lambda text: int(text, 0), default=can_protocol.BASE, metavar="IDENTIFIER",
        help=f"the lowest identifier, [vehicle] can_base; default: {can_protocol.BASE:#x}",
    )  # fmt: skip
    command.add_argument(
        "--for", dest="duration", type=float, metavar="SECONDS", help="default: until Ctrl-C"
    )


def _add_live(commands: Commands) -> None:
    live = commands.add_parser(
        "live", help="a virtual vehicle, its page and its CAN bus", description=LIVE
    )
    live.add_argument(
        "--config", type=drive_file, default=DEFAULT_CONFIG, metavar="DRIVE", action=Axles,
        help="a TOML file, or the name of a drive that comes along; default: lu2013; "
        f"{TWO_DRIVES}",
    )  # fmt: skip
    live.set_defaults(rear=None)
    live.add_argument(
        "--scenario", metavar="NAME",
        help="its simulated driver drives (hubsim list); default: nobody does, the vehicle stands"
        " until demands come by CAN",
    )  # fmt: skip
    _add_bus(live)
    live.add_argument(
        "--port", type=int, default=0, metavar="PORT",
        help="of the local HTTP service with the page; default: any that is free",
    )  # fmt: skip
    live.add_argument("--fast", action="store_true", help="as fast as it can, not in real time")
    live.add_argument(
        "--ready-json", action="store_true",
        help="the first line on stdout is a JSON object: ready, url, can, wheels, pid",
    )  # fmt: skip
    live.add_argument(
        "--no-page", action="store_true", help="without the page in the browser, for programs alone"
    )
    live.add_argument(
        "--no-open", action="store_true", help="opens no browser; the page's address is printed"
    )
    live.add_argument(
        "--board",
        action="store_true",
        help="no virtual vehicle: the page shows the real wheels that are on the bus --can",
    )
    live.add_argument(
        "--allow-demand",
        action="store_true",
        help="with --board: the page may send demands as long as its dead-man key is held",
    )
    live.add_argument(
        "--foxglove", type=int, metavar="PORT",
        help="all signals for Foxglove on this machine, by WebSocket; 0: any port that is free",
    )  # fmt: skip
    live.add_argument(
        "--plotjuggler",
        metavar="HOST:PORT",
        help="all signals for PlotJuggler's UDP server, as JSON with the field timestamp",
    )


def _add_watch(commands: Commands) -> None:
    command = commands.add_parser(
        "watch", help="what the wheels of a vehicle say, as it changes",
        description="What the wheels of a vehicle say, as it changes; with --signals, raw values of"
        " one wheel by XCP, ten lines a second.",
    )  # fmt: skip
    _add_vehicle(command)
    command.add_argument(
        "--signals", type=_names, metavar="NAME,...", help="of 'hubfoc a2l', such as output.mode"
    )
    _add_wheel(command)


def _names(text: str) -> list[str]:
    return text.split(",")


def _add_wheel(command: Parser) -> None:
    """Add which wheel speaks XCP, and where."""
    command.add_argument("--wheel", choices=WHEELS, default=WHEELS[0], help="on the bus")
    command.add_argument(
        "--xcp-base", type=lambda text: int(text, 0), default=SERVICE_BASE, metavar="IDENTIFIER",
        help=f"of XCP, [service] can_base; default: {SERVICE_BASE:#x}",
    )  # fmt: skip
    command.add_argument(
        "--udp", metavar="HOST:PORT", help="in the place of a bus: xcp of 'hubfoc live'"
    )


def _add_scope(commands: Commands) -> None:
    command = commands.add_parser(
        "scope", help="record up to eight signals at the PWM frequency, by XCP",
        description="Record signals of a wheel at its PWM frequency around a trigger, in raw"
        " values, and write them as a table whose time begins with the trigger.",
    )  # fmt: skip
    command.add_argument(
        "--signals", type=_names, required=True, metavar="NAME,...",
        help="at most eight, of 'hubfoc a2l', such as fast_input.phase_current_code_a",
    )  # fmt: skip
    command.add_argument(
        "--trigger", default="none", metavar="TRIGGER",
        help="above, below, rises or falls :SIGNAL:VALUE, with a raw value; finding or"
        " finding:REASON, when it appears; default: none, at once",
    )  # fmt: skip
    for name, default, text in (
        ("before", 0, "rows before the trigger's"),
        ("rows", 0, "of the record; default: as many as the wheel's memory holds"),
        ("every", 1, "PWM periods a row"),
    ):
        command.add_argument(f"--{name}", type=int, default=default, metavar="N", help=text)
    command.add_argument(
        "--wait", type=float, metavar="SECONDS", help="for the trigger; default: until Ctrl-C"
    )
    command.add_argument(
        "-o", "--output", type=output_file(".csv", ".parquet"), required=True, metavar="FILE",
        help=".csv, or .parquet with 'hubfoc[formats]'",
    )  # fmt: skip
    _add_bus(command)
    _add_wheel(command)


def _add_demand(commands: Commands) -> None:
    command = commands.add_parser(
        "demand", help="drive or brake every wheel",
        description="Demand torque of every wheel in the cycle of the protocol and show what the "
        "wheels say; at the end the demand is zero, then silent.",
    )  # fmt: skip
    _add_vehicle(command)
    for name in ("drive", "brake"):
        command.add_argument(
            f"--{name}", type=float, default=0.0, metavar="NM", help="at each wheel, N m"
        )
    command.add_argument("--direction", choices=DIRECTIONS, default="forward", help="to drive in")
    command.add_argument("--acknowledge", action="store_true", help="acknowledge faults as well")


def _add_a2l(commands: Commands) -> None:
    command = commands.add_parser(
        "a2l", help="the description for tools of XCP",
        description="Write the A2L of this version: every signal and parameter with its address in"
        " XCP, unit, range and text.",
    )  # fmt: skip
    command.add_argument("file", type=output_file(".a2l"), metavar="FILE.a2l")


def _add_params(commands: Commands) -> None:
    params = commands.add_parser(
        "params", help="the parameters of a wheel, by XCP",
        description="Show what a wheel is configured with, compare it with a TOML, store other"
        " values, export it; whole numbers in the units of the fields.",
    )  # fmt: skip
    actions = params.add_subparsers(
        title="actions", required=True, metavar="ACTION", parser_class=Parser, dest="action"
    )
    get = actions.add_parser("get", help="print fields")
    get.add_argument("prefix", nargs="?", default="", help="of the names: motor., motor.type")
    diff = actions.add_parser("diff", help="print the fields that differ from a TOML's; exit 1")
    diff.add_argument("config", type=drive_file, metavar="DRIVE")
    change = actions.add_parser("set", help="store values at rest; the wheel restarts with them")
    change.add_argument("assignments", nargs="+", metavar="SECTION.FIELD=VALUE")
    change.add_argument(
        "--key", type=Path, required=True, metavar="FILE", help="of the TOML's [service] key"
    )
    export = actions.add_parser(
        "export", help="write a TOML that makes the wheel's image",
        description="Write a drive's TOML with a section [fields], which has what differs in the"
        " wheel; the image made of it is the wheel's, byte for byte, but for its key.",
    )  # fmt: skip
    export.add_argument("config", type=drive_file, metavar="DRIVE", help="to begin with")
    export.add_argument("file", type=output_file(".toml"), metavar="FILE.toml")
    for action in (get, diff, change, export):
        _add_bus(action)
        action.add_argument("--wheel", choices=WHEELS, default=WHEELS[0], help="on the bus")
        action.add_argument(
            "--base", type=lambda text: int(text, 0), default=SERVICE_BASE, metavar="IDENTIFIER",
            help=f"of XCP, [service] can_base; default: {SERVICE_BASE:#x}",
        )  # fmt: skip
        action.add_argument(
            "--udp", metavar="HOST:PORT", help="in the place of a bus: xcp of 'hubfoc live'"
        )


def _add_record(commands: Commands) -> None:
    command = commands.add_parser(
        "record", help="record a virtual vehicle, every step of its controllers",
        description="Let a virtual vehicle begin again and record everything that its controllers"
        " get and command, at the PWM frequency, until Ctrl-C or the end of the time.",
    )  # fmt: skip
    command.add_argument("file", type=Path, metavar="FILE", help=".parquet or .csv")
    command.add_argument("--url", required=True, help="of the vehicle, as 'hubfoc live' prints it")
    command.add_argument(
        "--scenario", metavar="NAME", help="begin with this one; default: with the present one"
    )
    command.add_argument(
        "--for", dest="duration", type=float, metavar="SECONDS",
        help="of the simulation; default: until Ctrl-C",
    )  # fmt: skip


def _add_replay(commands: Commands) -> None:
    command = commands.add_parser(
        "replay", help="run a recording through the controllers again",
        description="Run what was recorded through the same C again and compare every output;"
        " exit status 1 if one differs with the recorded parameters.",
    )  # fmt: skip
    command.add_argument("file", type=Path, metavar="FILE", help=".parquet or .csv")
    command.add_argument(
        "--config", type=drive_file, metavar="DRIVE",
        help="other parameters: what the controllers would have commanded (open loop)",
    )  # fmt: skip
    command.add_argument(
        "--simulate",
        action="store_true",
        help="the whole vehicle again (closed loop), with what came from outside",
    )
    command.add_argument("--json", type=Path, metavar="FILE", help="what was found, for programs")


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    out = Parser(prog="hubfoc", description="Talk to wheels with hubfoc controllers.")
    out.add_argument("--version", action=ShowVersion)
    commands = out.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=Parser, dest="command"
    )
    for add in (
        _add_live, _add_watch, _add_demand, _add_a2l, _add_params, _add_scope, _add_record,
        _add_replay,
    ):  # fmt: skip
        add(commands)
    return out


def _do(options: argparse.Namespace) -> int:
    """Import a command's module and run it: a help needs neither simulator nor bus."""
    name = options.command
    if name == "live":
        name = "live.command"
    elif name == "scope" or getattr(options, "signals", None):
        name = "scope"
    elif name in {"watch", "demand"}:
        name = "commands"
    return int(importlib.import_module(f"hubfoc.{name}").run(options))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; a mistake is one line and exit status 2, Ctrl-C one line and 130."""
    options = parser().parse_args(arguments)
    try:
        return _do(options)
    except (HubfocError, HubsimError, ConfigurationError) as error:
        print(f"hubfoc {options.command}: {error}", file=sys.stderr)
        return REFUSED
    except ModuleNotFoundError as error:
        print(f"hubfoc {options.command}: {installation.missing(error)}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt as interrupt:
        return interrupted(f"hubfoc {options.command}", interrupt)
