# SPDX-License-Identifier: Apache-2.0
"""``hubsim report``: one page from results that runs left behind."""

import argparse
from pathlib import Path

from regen_table import installation

from hubsim import arguments, engine, files, overrides, results_files, run, scenario
from hubsim.errors import HubsimError


def add(commands: "argparse._SubParsersAction[arguments.Parser]") -> None:
    """Declare the command."""
    command = commands.add_parser(
        "report", help="one page from the results of runs",
        description="Make one self-contained page from results written by 'hubsim run --json RUN.json', each with what was recorded "
        "beside it ('--parquet RUN.parquet' or '--csv RUN.csv', the same name).",
    )  # fmt: skip
    command.add_argument(
        "results",
        metavar="RESULT.json",
        type=Path,
        nargs="+",
        help="what 'hubsim run --json' wrote",
    )
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help="the page to write"
    )
    command.add_argument(
        "--config",
        type=installation.drive_file,
        metavar="TOML",
        help="the drive; default: the one that comes along under the result's name",
    )
    command.add_argument(
        "--stops",
        action="store_true",
        help="also simulate stops at constant demand under all strategies",
    )
    command.set_defaults(run=_report)


def _report(options: argparse.Namespace) -> int:
    from hubsim import comparison, report, stops  # noqa: PLC0415, the report's modules are needed by few commands

    files.check_writable(options.output)
    found = [results_files.load(path) for path in options.results]
    names = list(dict.fromkeys(result.vehicle for result in found))
    configs = {
        name: options.config or engine.ROOT / "tools" / "motors" / f"{name}.toml" for name in names
    }
    known = {name: path for name, path in configs.items() if options.config or path.is_file()}
    nothing = overrides.Overrides()
    maps = {
        name: stops.optimum_map(overrides.load_drive(path, nothing)) for name, path in known.items()
    }
    curves: list[report.CurveLike] = []
    if options.stops:
        if names[0] not in known:
            raise HubsimError(
                f"--stops: {configs[names[0]]}: file not found, accepted: with --config TOML"
            )
        standing = scenario.Scenario(max_duration_s=1.0)
        drives = [
            arguments.drive_of(known[names[0]], overrides.Overrides(), strategy, standing)
            for strategy in run.STRATEGIES
        ]
        with arguments.progress_bar("stops") as bar:
            curves = list(comparison.extras(drives, bar).stops)
    report.write_page(found, options.output, report.Extras(maps, curves, "hubsim report"))
    print(f"report: {options.output}")
    return 0
