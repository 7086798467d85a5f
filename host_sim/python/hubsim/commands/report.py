# SPDX-License-Identifier: Apache-2.0
"""``hubsim report``: one page from results of runs."""

import argparse
from dataclasses import replace

from regen_table import provenance

from hubsim import commands, engine, files, overrides, run, scenario
from hubsim.errors import HubsimError
from hubsim.results import RunResult, load_result


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    from hubsim import comparison, report, stops  # noqa: PLC0415, few commands need them

    files.check_writable(options.output)
    found = [_with_origin(load_result(path), options.date) for path in options.results]
    names = list(dict.fromkeys(result.vehicle for result in found))
    configs = {
        name: options.config or engine.ROOT / "tools" / "motors" / f"{name}.toml" for name in names
    }
    known = {name: path for name, path in configs.items() if options.config or path.is_file()}
    no_overrides = overrides.Overrides()
    maps = {
        name: stops.optimum_map(overrides.load_drive(path, no_overrides))
        for name, path in known.items()
    }
    curves: list[report.CurveLike] = []
    if options.stops:
        if names[0] not in known:
            raise HubsimError(
                f"--stops: {configs[names[0]]}: file not found, accepted: with --config TOML"
            )
        standing = scenario.Scenario(max_duration_s=1.0)
        drives = [
            commands.drive_of(known[names[0]], overrides.Overrides(), strategy, standing)
            for strategy in run.STRATEGIES
        ]
        with commands.progress_bar("stops") as bar:
            curves = list(comparison.extras(drives, bar).stops)
    report.write_page(found, options.output, report.Extras(maps, curves, "hubsim report"))
    print(f"report: {options.output}")
    return 0


def _with_origin(result: RunResult, date: str | None) -> RunResult:
    """Return a result with an origin: its own, or that of this call where its file holds none."""
    if result.origin:
        return result
    made = provenance.provenance(result.vehicle, scenario=result.cycle, date=date)
    return replace(result, origin=made)
