# SPDX-License-Identifier: Apache-2.0
"""``hubsim list``: everything that has a name."""

import argparse

from regen_table import installation

from hubsim import (
    cli,
    cycles,
    engine,
    events,
    expression,
    overrides,
    plotjuggler,
    reasons,
    run,
    scenario,
)
from hubsim.criteria import Criterion
from hubsim.keys import Section, accepted


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    if options.parameters:
        for name, parameter in engine.parameters().items():
            unit = "" if parameter.unit in {"", "1"} else f" {parameter.unit}"
            print(
                f"plant.{name:45} {parameter.lowest:g} to {parameter.highest:g}{unit}  "
                f"{parameter.text}"
            )
        return 0
    if options.signals:
        for name in signal_names():
            print(name)
        return 0
    if options.layout:
        print(plotjuggler.layout(signal_names()), end="")
        return 0
    if options.criteria:
        _list_criteria()
        return 0
    print("scenarios (hubsim run NAME):")
    for name in scenario.builtin_names():
        print(f"  {name:28} {scenario.load(name, {})[1].description}")
    print('cycles (cycle = "NAME" in a scenario):')
    for name in cycles.names():
        cycle = cycles.load(name)
        print(
            f"  {name:28} {cycle.duration_s:g} s, {cycle.distance_m / 1e3:.3f} km, up to "
            f"{max(cycle.speed_kmh):g} km/h"
        )
    print("drives (--config NAME, or a file):")
    for path in sorted((installation.ROOT / "tools" / "motors").glob("*.toml")):
        print(f"  {path.stem}")
    print(f"strategies (--strategy NAME):\n  {', '.join(run.STRATEGIES)}")
    print("keys of a scenario (--set KEY=VALUE):")
    _list_keys(scenario.Scenario)
    print(
        "also --set SECTION.KEY=VALUE of the drive, and --set plant.SECTION.KEY=VALUE (hubsim "
        "list --parameters)"
    )
    return 0


def _list_keys(section: type[Section]) -> None:
    for key, field in section.model_fields.items():
        print(f"  {key:28} {field.description} ({accepted(field)})")


def _list_criteria() -> None:
    print("keys of an event, [events.NAME]:")
    _list_keys(events.Event)
    print('disturbances (inject = "NAME"):')
    for name, injection in events.INJECTIONS.items():
        print(f"  {name:28} {injection.text}")
    print("keys of a criterion, [criteria.NAME]:")
    _list_keys(Criterion)
    print("functions of formulas:")
    for name, function in expression.FUNCTIONS.items():
        print(f"  {name:28} {function.text}")
    print("reasons (must_appear, must_not_appear):")
    for name, code in reasons.codes().items():
        print(f"  {name:28} {code}")
    print(f"  {reasons.ANY_FAULT:28} {reasons.first_fault()} and above")


def signal_names() -> list[str]:
    """Return the signals of the default drive's vehicle."""
    _, chosen, beside = scenario.load("stop", {})
    drive = overrides.load_drive(cli.DEFAULT_CONFIG, overrides.Overrides())
    vehicle, _ = run.prepare(drive, chosen, beside, {})
    with vehicle:
        vehicle.start()
        return vehicle.signals()
