# SPDX-License-Identifier: Apache-2.0
"""The options of the commands that make many runs of every drive that comes along."""

import argparse
from pathlib import Path
from typing import TypeAlias

from regen_table.cli import Parser

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


def _add_envelope(commands: Commands) -> None:
    text = "the drives that come along at the edges of their envelope"
    command = commands.add_parser(
        "envelope",
        help=text,
        description=(
            f"{text[0].upper()}{text[1:]}: speed to 110 %, driving and braking demand, battery, "
            "charge limit and temperatures in a Latin hypercube for each drive, from every start: "
            "standing, rolling, full, cold, rotor sensor dead. Exit status 1 if a run with a good "
            "sensor has a fault."
        ),
    )
    command.add_argument(
        "--count", type=int, default=480, metavar="N", help="of all drives; default: 480"
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
        help="for envelope.csv, its origin envelope.json, envelope.svg, envelope.png",
    )
    add_date(command)


def _add_coast(commands: Commands) -> None:
    text = "motor torque without a demand beside the least that physics allows"
    command = commands.add_parser(
        "coast",
        help=text,
        description=(
            f"{text[0].upper()}{text[1:]}: speed up to 110 % of the largest, battery and slope in "
            "a Latin hypercube for each drive that comes along, the battery connected or "
            "disconnecting while the vehicle coasts, brakes or drives. Exit status 1 if a case "
            "has more torque or bus voltage than it should, or a fault."
        ),
    )
    command.add_argument(
        "--count", type=int, default=2000, metavar="N", help="of all drives; default: 2000"
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
        help="for coast.csv, its origin coast.json, coast.svg and coast.png",
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
        "--json", type=Path, metavar="FILE", help="write the runs as an array of objects"
    )
    add_date(command)


COMMANDS = (_add_stops, _add_envelope, _add_coast, _add_faults)
