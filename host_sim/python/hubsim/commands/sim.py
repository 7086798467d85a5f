# SPDX-License-Identifier: Apache-2.0
"""``hubsim sim``: the three strategies side by side, with a page."""

import argparse
from pathlib import Path

from regen_table import installation

from hubsim import arguments, outputs, overrides, run, scenario
from hubsim.errors import HubsimError

_SHOWN = "hubsim_report" if installation.INSTALLED else "build/report"
_OUTPUT = Path(_SHOWN) if installation.INSTALLED else installation.ROOT / _SHOWN


def add(commands: "argparse._SubParsersAction[arguments.Parser]") -> None:
    """Declare the command."""
    text = "the urban cycle under the three strategies, table and report"
    command = commands.add_parser("sim", help=text, description=f"{text[0].upper()}{text[1:]}.")
    arguments.add_common(command)
    command.add_argument(
        "--scenario",
        default="ece15",
        metavar="NAME",
        help="a scenario with a cycle; default: ece15",
    )
    command.add_argument(
        "--output",
        type=Path,
        default=_OUTPUT,
        metavar="DIR",
        help=f"default: {_SHOWN}",
    )
    command.set_defaults(run=_sim)


def _sim(options: argparse.Namespace) -> int:
    from hubsim import comparison  # noqa: PLC0415, the report's modules are needed by this command only

    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    if not chosen.follows:
        raise HubsimError(f"sim: scenario {name} has no cycle, accepted: one that has")
    drives = [
        arguments.drive_of(options.config, settings, strategy, chosen)
        for strategy in run.STRATEGIES
    ]
    comparison.check_output(options.output)
    with arguments.progress_bar() as bar:
        results = comparison.simulate_all(name, drives, chosen, beside, settings.plant, bar)
        shown = comparison.extras(drives, bar)
    for result in results:
        arguments.warn_of(result)
    outputs.print_table(results)
    for line in comparison.write(results, options.output, shown):
        print(line)
    return 0
