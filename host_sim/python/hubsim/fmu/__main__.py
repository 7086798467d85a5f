# SPDX-License-Identifier: Apache-2.0
"""``python -m hubsim.fmu``: called by the build."""

import argparse
import sys
from pathlib import Path

from regen_table.cli import REFUSED, drive_file

from hubsim.errors import HubsimError
from hubsim.fmu import KINDS


def main() -> int:
    """Write a table or a package."""
    parser = argparse.ArgumentParser(
        prog="hubsim.fmu", description="Tables and packages of the co-simulation units."
    )
    commands = parser.add_subparsers(title="commands", required=True, dest="command")
    for name, text in (
        ("table", "the C table a unit is compiled with"),
        ("pack", "the finished unit"),
    ):
        command = commands.add_parser(name, help=text)
        command.add_argument("--kind", choices=KINDS, required=True)
        command.add_argument("--config", type=drive_file, required=True, metavar="DRIVE")
        command.add_argument("-o", "--output", type=Path, required=True, metavar="FILE")
        if name == "pack":
            command.add_argument(
                "--fmi", type=int, choices=(2, 3), required=True, help="version of the standard"
            )
            command.add_argument("--binary", type=Path, required=True)
            command.add_argument(
                "--sources", type=Path, required=True, help="a file with one C file a line"
            )
            command.add_argument("--table", type=Path, required=True)
    command = commands.add_parser("platforms", help="units with binaries for other platforms")
    command.add_argument("units", nargs="+", type=Path, metavar="UNIT")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    options = parser.parse_args()
    # What a help text does not need.
    from hubsim import files  # noqa: PLC0415
    from hubsim.engine import ROOT  # noqa: PLC0415
    from hubsim.fmu import pack, platforms  # noqa: PLC0415
    from hubsim.fmu.description import describe  # noqa: PLC0415

    try:
        if options.command == "platforms":
            for path in platforms.add(options.units, options.output):
                print(path)
            return 0
        unit = describe(options.kind, options.config)
        if options.command == "table":
            files.write_text(options.output, pack.c_table(unit))
        else:
            listed = [Path(line) for line in files.read_text(options.sources).splitlines() if line]
            pack.write(
                unit,
                options.fmi,
                options.binary,
                listed,
                options.table,
                ROOT / "LICENSE",
                options.output,
            )
    except HubsimError as error:
        print(f"hubsim.fmu: {error}", file=sys.stderr)
        return REFUSED
    return 0


sys.exit(main())
