# SPDX-License-Identifier: Apache-2.0
"""``hubsim run``: one run of a scenario, its energies, its verdicts, its recordings."""

import argparse
import sys
from pathlib import Path

from hubsim import arguments, files, outputs, overrides, recordings, run, scenario, verdicts
from hubsim.errors import HubsimError

DEFAULT_SIGNALS = (
    "time_s", "driver.*", "vehicle.*", "battery.*",
    "wheel*.motor_torque_nm", "wheel*.hydraulic_torque_nm", "wheel*.command_nm", "wheel*.estimate_nm", "wheel*.available_nm",
    "wheel*.current_?_a", "wheel*.dc_w", "wheel*.shaft_w", "wheel*.copper_w", "wheel*.iron_w", "wheel*.inverter_w",
    "wheel*.winding_temperature_c", "wheel*.speed_estimate_rad_per_s", "wheel*.reason", "wheel*.mode",
    "wheel*.speed_rad_per_s", "wheel*.valve", "anti_lock.*",
)  # fmt: skip


def add(commands: "argparse._SubParsersAction[arguments.Parser]") -> None:
    """Declare the command."""
    command = commands.add_parser(
        "run", help="one run of a scenario",
        description="Run a scenario, say where the energy went and whether the scenario's criteria are met. Exit status 1 if not.",
    )  # fmt: skip
    command.add_argument(
        "scenario", metavar="SCENARIO", help="a built-in scenario ('hubsim list') or a TOML file"
    )
    arguments.add_common(command)
    arguments.add_strategy(command)
    command.add_argument(
        "--signals",
        metavar="PATTERN,...",
        help="what recordings hold, '*' for anything; default: the most telling ones",
    )
    for kind in recordings.KINDS.values():
        command.add_argument(f"--{kind.name}", type=Path, metavar="FILE", help=kind.help)
    command.add_argument(
        "--json", type=Path, metavar="FILE", help="write energies, shares and verdicts"
    )
    command.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    wanted = {
        name: path for name in recordings.KINDS if (path := getattr(options, name)) is not None
    }
    outputs_of = [*wanted.values(), *filter(None, [options.json])]
    for path in outputs_of:
        files.check_writable(path)
    files.check_distinct(outputs_of)
    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    drive = arguments.drive_of(options.config, settings, options.strategy, chosen)
    patterns = tuple(options.signals.split(",")) if options.signals else DEFAULT_SIGNALS
    if options.signals and not wanted:
        raise HubsimError(
            f"--signals: accepted: with {' or '.join(f'--{kind}' for kind in recordings.KINDS)}"
        )
    with arguments.progress_bar() as bar:
        task = bar.add_task(f"{name}, {drive.brake.strategy}", total=None)
        result = run.simulate(
            name, drive, chosen, beside, patterns if wanted else (), settings.plant,
            lambda now, planned: bar.update(task, completed=int(now), total=int(planned)),
        )  # fmt: skip
    judged = verdicts.judge(chosen, drive, result)
    arguments.warn_of(result)
    if result.stopped is False:
        print(
            f"hubsim: warning: {name}: still moving after {result.duration_s:g} s (max_duration_s)",
            file=sys.stderr,
        )
    recorded = result.only(run.matching(result.names, patterns)) if wanted else result
    recordings.write_all(recorded, wanted)
    if options.json:
        files.write_text(options.json, outputs.as_json(outputs.run_object(result, judged)))
    outputs.print_table([result])
    failed = [verdict.name for verdict in judged if not verdict.passed]
    if judged:
        outputs.print_verdicts(name, judged)
    if failed:
        print(
            f"hubsim: {name}: {len(failed)} of {len(judged)} criteria not met: {', '.join(failed)}",
            file=sys.stderr,
        )
    return 1 if failed else 0
