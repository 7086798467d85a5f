# SPDX-License-Identifier: Apache-2.0
"""The command line: ``python -m hubsim COMMAND ...``.

Mistakes are one line on stderr. Exit status 0: done and every criterion met; 1: refused, failed or
a criterion not met; 2: wrong call.
"""

import argparse
import contextlib
import os
import sys
from collections.abc import Sequence

from regen_table.errors import ConfigurationError

from hubsim import __version__
from hubsim.arguments import DEFAULT_CONFIG, Parser
from hubsim.commands import compare, listing, report, run, sim, sweep
from hubsim.errors import HubsimError

__all__ = ["DEFAULT_CONFIG", "EXAMPLES", "main", "parser"]

EXAMPLES = (
    "hubsim list --criteria",
    "hubsim run stop --set initial_speed_kmh=40 --set demand_nm=60 --json stop.json --mdf stop.mf4",
    "hubsim run contactor --set plant.bus.capacitance_f=2e-3",
    "hubsim compare stop stop --set-b plant.motor.phase_resistance_ohm=0.032 --relative 0.04",
    "hubsim sweep stop --vary 'demand_nm=range(5,120,24)' --vary brake.strategy=series_optimal,parallel_ratio --output grid.parquet",
    "hubsim sweep stop --vary 'plant.vehicle.mass_kg=normal(660,30)' --runs 1000 --output draws.parquet",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit status."""
    options = parser().parse_args(arguments)
    try:
        status = int(options.run(options))
        sys.stdout.flush()
    except (HubsimError, ConfigurationError) as error:
        print(f"hubsim: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except OSError as error:
        return _cannot_print(error)
    return status


def _cannot_print(error: OSError) -> int:
    """Say that standard output takes no more; a reader that has seen enough needs no message."""
    if not isinstance(error, BrokenPipeError):
        print(f"hubsim: standard output: {error.strerror or error}", file=sys.stderr)
    with contextlib.suppress(OSError):  # what is buffered goes nowhere when the process ends
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 1


def parser() -> Parser:
    """Return the parser of the whole command line."""
    out = Parser(
        prog="hubsim", description="The simulated vehicle: complete controllers on a physical plant.",
        epilog="\n  ".join(["for example:", *EXAMPLES]), formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    out.add_argument("--version", action="version", version=f"hubsim {__version__}")
    commands = out.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=Parser
    )
    for command in (run, sim, sweep, compare, listing, report):
        command.add(commands)
    return out
