# SPDX-License-Identifier: Apache-2.0
"""The options of the commands that make many runs of every drive that comes along."""

import argparse
from pathlib import Path
from typing import TypeAlias

from regen_table.cli import Parser, output_file

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def add_date(command: Parser) -> None:
    """Add the option of every command whose outputs hold their origin."""
    command.add_argument(
        "--date",
        metavar="ISO-8601",
        help="that outputs hold as their origin; default: SOURCE_DATE_EPOCH, or else the clock",
    )


def _add_stops(commands: Commands) -> None:
    text = "stops of the drives that come along beside the ideal inside the same limits"
    command = commands.add_parser(
        "stops",
        help=text,
        description=(
            f"{text[0].upper()}{text[1:]}: state of charge, demand, speed and winding temperature "
            "in a Latin hypercube for each drive. Exit status 1 if a stop stores more or less than "
            "it should, or has a fault."
        ),
    )
    command.add_argument(
        "--count", type=int, default=1040, metavar="N", help="of all drives; default: 1040"
    )
    command.add_argument("--seed", type=int, default=1, metavar="N", help="default: 1")
    command.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes on this machine; default: one for each core",
    )
    command.add_argument(
        "--output",
        type=Path,
        required=True,
        metavar="DIR",
        help="for stops.csv, its origin stops.json, stops.svg and stops.png",
    )
    add_date(command)


def _add_faults(commands: Commands) -> None:
    text = "every fault at instants of a stop, beside the stop without it"
    command = commands.add_parser(
        "faults",
        help=text,
        description=(
            f"{text[0].upper()}{text[1:]}: fault x instant x demand x rotor sensor x drive that "
            "comes along, one wheel with its share of the vehicle. Prints and draws a table. What "
            "faults.csv in the output folder already has is not run again."
        ),
    )
    command.add_argument("names", nargs="*", metavar="FAULT", help="faults or groups; default: all")
    command.add_argument(
        "--whole-vehicle",
        action="store_true",
        help="all driven wheels with the fault in each, instead of one with its share of mass and "
        "battery",
    )
    command.add_argument("--list", action="store_true", help="names and meanings, and no runs")
    command.add_argument(
        "--reduced", action="store_true", help="a few runs of every fault with the paper's vehicle"
    )
    command.add_argument("--config", metavar="NAME", help="only this drive; default: all")
    command.add_argument(
        "--demand-share",
        type=float,
        metavar="SHARE",
        help="only stops at this braking demand, share of the rated torque; default: 0.8 and 2.5",
    )
    command.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes on this machine; default: one for each core",
    )
    command.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="for faults.csv, its origin faults.json, faults.svg and faults.png",
    )
    command.add_argument(
        "--json",
        type=output_file(".json"),
        metavar="FILE",
        help="write the runs as an array of objects",
    )
    add_date(command)


COMMANDS = (_add_stops, _add_faults)
