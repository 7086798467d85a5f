# SPDX-License-Identifier: Apache-2.0
"""The command line: ``hubfoc COMMAND ...``."""

import argparse
import sys
from collections.abc import Sequence

from hubsim.cli.arguments import DEFAULT_CONFIG
from hubsim.errors import HubsimError
from regen_table.cli import REFUSED, Parser, ShowVersion, drive_file, interrupted
from regen_table.errors import ConfigurationError

from hubfoc.errors import HubfocError

LIVE = (
    "A virtual vehicle in real time: in every wheel the whole application (boot, CAN, shell,"
    " watchdog) on a simulated board, with motor, inverter, battery, battery management, brake"
    " system and road in one process. Other programs reach it by CAN frames (hubfoc.dbc), as they"
    " would a vehicle."
)
_CAN = (
    "the bus: udp_multicast[:GROUP] for programs of this machine (default), virtual within one"
    " Python process, else a SocketCAN channel (not tried: the project's tests have none)"
)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    out = Parser(prog="hubfoc", description="Talk to wheels with hubfoc controllers.")
    out.add_argument("--version", action=ShowVersion)
    commands = out.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=Parser, dest="command"
    )
    live = commands.add_parser("live", help="a virtual vehicle on a CAN bus", description=LIVE)
    live.add_argument(
        "--config", type=drive_file, default=DEFAULT_CONFIG, metavar="DRIVE",
        help="a TOML file, or the name of a drive that comes along; default: lu2013",
    )  # fmt: skip
    live.add_argument(
        "--scenario", metavar="NAME",
        help="its simulated driver drives (hubsim list); default: nobody does, the vehicle stands"
        " until demands come by CAN",
    )  # fmt: skip
    live.add_argument("--can", default="udp_multicast", metavar="BUS", help=_CAN)
    live.add_argument(
        "--port", type=int, default=0, metavar="PORT",
        help="of the local HTTP service (GET /health); default: any that is free",
    )  # fmt: skip
    live.add_argument("--fast", action="store_true", help="as fast as it can, not in real time")
    live.add_argument(
        "--ready-json", action="store_true",
        help="the first line on stdout is a JSON object: ready, url, can, wheels, pid",
    )  # fmt: skip
    live.add_argument(
        "--no-page", action="store_true", help="without the page in a browser; there is none yet"
    )
    return out


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; a mistake is one line and exit status 2, Ctrl-C one line and 130."""
    options = parser().parse_args(arguments)
    try:
        from hubfoc.live import command  # noqa: PLC0415, a help needs no simulator

        return command.run(options)
    except (HubfocError, HubsimError, ConfigurationError) as error:
        print(f"hubfoc {options.command}: {error}", file=sys.stderr)
        return REFUSED
    except KeyboardInterrupt as interrupt:
        return interrupted(f"hubfoc {options.command}", interrupt)
