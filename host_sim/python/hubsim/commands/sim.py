# SPDX-License-Identifier: Apache-2.0
"""``hubsim sim``: the three strategies side by side, with a page."""

import argparse
import sys

from hubsim import commands, console, overrides, run, scenario
from hubsim.errors import HubsimError


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    from hubsim import comparison  # noqa: PLC0415, only here

    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    if not chosen.follows:
        raise HubsimError(f"sim: scenario {name} has no cycle, accepted: one that has")
    drives = [
        commands.drive_of(options.config, settings, strategy, chosen) for strategy in run.STRATEGIES
    ]
    comparison.check_output(options.output)
    with commands.progress_bar() as bar:
        results = comparison.simulate_all(
            name, drives, chosen, beside, settings.plant, bar, options.date
        )
        shown = comparison.extras(drives, bar)
    for result in results:
        commands.warn_of(result)
    console.print_table(results)
    for line in comparison.write(results, options.output, shown):
        print(line)
    failed = [
        f"{result.strategy}: {criterion['name']}"
        for result in results
        for criterion in result.criteria
        if not criterion["passed"]
    ]
    if failed:
        print(f"hubsim: {name}: criteria not met: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0
