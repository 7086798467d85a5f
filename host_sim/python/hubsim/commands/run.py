# SPDX-License-Identifier: Apache-2.0
"""``hubsim run``: one run of a scenario, its energies, its criteria, its recordings."""

import argparse
import sys
from dataclasses import replace

from hubsim import (
    cli,
    commands,
    console,
    evaluation,
    files,
    overrides,
    recordings,
    run,
    scenario,
    stops,
)
from hubsim.errors import HubsimError
from hubsim.results import as_json, json_object

DEFAULT_SIGNALS = (
    "time_s", "driver.*", "vehicle.*", "battery.*", "bus.*",
    "wheel*.motor_torque_nm", "wheel*.hydraulic_torque_nm", "wheel*.command_nm",
    "wheel*.estimate_nm", "wheel*.available_nm", "wheel*.current_?_a", "wheel*.dc_w",
    "wheel*.shaft_w", "wheel*.copper_w", "wheel*.iron_w", "wheel*.inverter_w",
    "wheel*.winding_temperature_c", "wheel*.switch_temperature_c",
    "wheel*.speed_estimate_rad_per_s", "wheel*.reason", "wheel*.mode", "wheel*.speed_rad_per_s",
    "wheel*.valve", "anti_lock.*",
)  # fmt: skip


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    wanted = {name: path for name in cli.RECORDINGS if (path := getattr(options, name)) is not None}
    outputs_of = [*wanted.values(), *filter(None, [options.json])]
    for path in outputs_of:
        files.check_writable(path)
    files.check_distinct(outputs_of)
    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    drive = commands.drive_of(options.config, settings, options.strategy, chosen)
    patterns = tuple(options.signals.split(",")) if options.signals else DEFAULT_SIGNALS
    if options.signals and not wanted:
        raise HubsimError(
            f"--signals: accepted: with {' or '.join(f'--{kind}' for kind in cli.RECORDINGS)}"
        )
    with commands.progress_bar() as bar:
        task = bar.add_task(f"{name}, {drive.brake.strategy}", total=None)
        result = run.simulate(
            name, drive, chosen, beside, patterns if wanted else (), settings.plant,
            lambda now, planned: bar.update(task, completed=int(now), total=int(planned)),
            date=options.date,
        )  # fmt: skip
    evaluated = evaluation.evaluate(chosen, drive, result)
    result = replace(
        result,
        criteria=[outcome.as_object() for outcome in evaluated],
        ideal=stops.ideal_of(drive, chosen),
    )
    commands.warn_of(result)
    if result.stopped is False:
        print(
            f"hubsim: warning: {name}: still moving after {result.duration_s:g} s (max_duration_s)",
            file=sys.stderr,
        )
    recorded = result.only(run.matching(result.names, patterns)) if wanted else result
    recordings.write_all(recorded, wanted)
    if options.json:
        files.write_text(options.json, as_json(json_object(result)))
    console.print_table([result])
    failed = [outcome.name for outcome in evaluated if not outcome.passed]
    if evaluated:
        console.print_criteria(name, evaluated)
    if failed:
        print(
            f"hubsim: {name}: {len(failed)} of {len(evaluated)} criteria not met: "
            f"{', '.join(failed)}",
            file=sys.stderr,
        )
    return 1 if failed else 0
