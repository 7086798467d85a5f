# SPDX-License-Identifier: Apache-2.0
"""The options of ``hubsim swarm``."""

import argparse
import re
from pathlib import Path
from typing import TypeAlias

from regen_table.cli import Parser, drive_file, output_file

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"

SEEDS = range(100)
DRIVES = 400
LARGEST_SEED = 1 << 40


def seeds(text: str) -> range:
    """Return the seeds A:B, B not among them."""
    found = re.fullmatch(r"(\d{1,12}):(\d{1,12})", text)
    if found is None or int(found[1]) >= int(found[2]):
        raise argparse.ArgumentTypeError(f"{text!r}, accepted: A:B, seeds A to B - 1, A below B")
    return range(int(found[1]), int(found[2]))


def seed(text: str) -> int:
    """Return one seed."""
    if re.fullmatch(r"\d{1,12}", text) is None:
        raise argparse.ArgumentTypeError(f"{text!r}, accepted: a whole number from 0")
    return int(text)


def hours(text: str) -> float:
    """Return a time in hours."""
    try:
        found = float(text)
    except ValueError:
        found = -1.0
    if not 0.0 < found <= 1e4:
        raise argparse.ArgumentTypeError(f"{text!r}, accepted: a number above 0, at most 10000")
    return found


def _from_one(most: int) -> "type[int]":
    def read(text: str) -> int:
        if re.fullmatch(r"\d{1,6}", text) is None or not 1 <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text!r}, accepted: a whole number, 1 to {most}")
        return int(text)

    return read  # type: ignore[return-value]


def add_swarm(commands: Commands) -> None:
    """Add the command."""
    text = "runs of which a seed draws everything, judged by invariants"
    command = commands.add_parser(
        "swarm",
        help=text,
        description=(
            f"{text[0].upper()}{text[1:]}: the drive, a vehicle with parts wrong within their "
            "tolerances, sensors, battery, brake, road, driver, and in half of the runs one to "
            "three faults. Each run has a process of its own with a limit of time and memory. "
            "Exit status 1 if an invariant is violated."
        ),
    )
    which = command.add_mutually_exclusive_group()
    which.add_argument(
        "--seeds",
        type=seeds,
        default=SEEDS,
        metavar="A:B",
        help=f"seeds A to B - 1; default: {SEEDS.start}:{SEEDS.stop}",
    )
    which.add_argument(
        "--hours", type=hours, metavar="H", help="seeds from 0 on, for as long as that"
    )
    which.add_argument("--seed", type=seed, metavar="N", help="this one, with all it came to")
    which.add_argument(
        "--reduce", type=seed, metavar="N", help="make the run of a seed that fails small; with -o"
    )
    which.add_argument(
        "--scenario",
        type=Path,
        metavar="FILE",
        help="judge the run of a scenario's file, as --reduce writes it, with --config",
    )
    command.add_argument(
        "-o", dest="small", type=output_file(".toml"), metavar="S.toml", help="of --reduce"
    )
    command.add_argument(
        "--config", type=drive_file, metavar="DRIVE", help="of --scenario; default: lu2013"
    )
    command.add_argument("--healthy", action="store_true", help="no faults in any run")
    command.add_argument(
        "--drives",
        type=_from_one(DRIVES),
        default=DRIVES,
        metavar="N",
        help=f"the first N drives of the population alone; default: {DRIVES}",
    )
    command.add_argument(
        "--workers",
        type=_from_one(999),
        metavar="N",
        help="runs at a time on this machine; default: one for each core",
    )
    command.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="keep every run and the scenario of every seed that fails; the same command goes on",
    )
    command.add_argument(
        "--json", type=output_file(".json"), metavar="FILE", help="write what all runs came to"
    )


COMMANDS = (add_swarm,)
