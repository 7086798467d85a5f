# SPDX-License-Identifier: Apache-2.0
"""The commands, one function each, from its options to its exit status; and what they share.

Loaded when a command runs; what is big and serves few commands is imported inside them.
"""

import argparse
import hashlib
import importlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path

from regen_table import __version__, installation, schema
from regen_table.schema import Drive
from rich import box
from rich.console import Console
from rich.table import Table

from hubsim import emulator, engine, files, progress, reasons, run, scenario
from hubsim.cli import arguments, console
from hubsim.errors import DoesNotApplyError, HubsimError
from hubsim.run import course, difference, evaluation, ideal_stop, recordings, stops
from hubsim.run.difference import Difference, Side, Tolerance
from hubsim.run.results import RunResult, as_json, json_object, load_result
from hubsim.scenario import Scenario, cycles, events, expression, overrides, quantities
from hubsim.scenario.criteria import Criterion
from hubsim.scenario.keys import Section, accepted

DEFAULT_SIGNALS = (
    "time_s", "driver.*", "vehicle.*", "battery.*", "bus.*",
    "wheel*.motor_torque_nm", "wheel*.hydraulic_torque_nm", "wheel*.command_nm",
    "wheel*.estimate_nm", "wheel*.available_nm", "wheel*.current_?_a", "wheel*.dc_w",
    "wheel*.shaft_w", "wheel*.copper_w", "wheel*.iron_w", "wheel*.inverter_w",
    "wheel*.winding_temperature_c", "wheel*.switch_temperature_c",
    "wheel*.speed_estimate_rad_per_s", "wheel*.reason", "wheel*.mode", "wheel*.speed_rad_per_s",
    "wheel*.valve", "anti_lock.*",
)  # fmt: skip


def drive_of(
    config: Path, settings: overrides.Overrides, strategy: str | None, chosen: Scenario
) -> Drive:
    """Read the drive that a command is to use."""
    if strategy is not None:
        settings.drive["brake", "strategy"] = strategy
    return console.warned(config, overrides.load_drive(config, settings, chosen))


def scenario_of(
    name: str, settings: overrides.Overrides, config: Path
) -> tuple[str, Scenario, Path]:
    """Read the scenario that a command is to use, fitted to its drive."""
    return scenario.load(name, settings.scenario, schema.load(config), settings.drive)


def warn_of(result: RunResult) -> None:
    """Warn on stderr of faults and of events whose time the run did not reach."""
    for fault in result.faults:
        print(
            f"hubsim: warning: {result.cycle}, {result.strategy}: wheel {fault.wheel} faulted at "
            f"{fault.time_s:.3f} s: {fault.reason}",
            file=sys.stderr,
        )
    for name, at_s in result.missed.items():
        print(f"hubsim: warning: {result.cycle}: event {name} at {at_s:g} s never came: "
              f"the run ended at {result.duration_s:g} s",
              file=sys.stderr)  # fmt: skip


def run_scenario(options: argparse.Namespace) -> int:
    """Do ``hubsim run``: one run, its energies, its criteria, its recordings."""
    wanted = {
        name: path for name in arguments.RECORDINGS if (path := getattr(options, name)) is not None
    }
    outputs_of = [*wanted.values(), *filter(None, [options.json])]
    for path in outputs_of:
        files.check_writable(path)
    files.check_distinct(outputs_of)
    settings = overrides.parse(options.settings)
    try:
        name, chosen, beside = scenario_of(options.scenario, settings, options.config)
    except DoesNotApplyError as stated:
        return _does_not_apply(stated, options.json)
    drive = drive_of(options.config, settings, options.strategy, chosen)
    rear = options.rear and drive_of(options.rear, settings, options.strategy, chosen)
    patterns = tuple(options.signals.split(",")) if options.signals else DEFAULT_SIGNALS
    if options.signals and not wanted:
        kinds = " or ".join(f"--{kind}" for kind in arguments.RECORDINGS)
        raise HubsimError(f"--signals: accepted: with {kinds}")
    with progress.shown() as bar:
        task = bar.add_task(f"{name}, {drive.brake.strategy}", total=None)
        result = run.simulate(
            name, drive, chosen, beside, (*(patterns if wanted else ()), *course.SIGNALS),
            settings.plant,
            lambda now, planned: bar.update(task, completed=int(now), total=int(planned)),
            date=options.date, processor=emulator.command() if options.on == "qemu" else None,
            application=engine.application_path() if options.on == "board" else None, rear=rear,
        )  # fmt: skip
    evaluated = evaluation.evaluate(chosen, drive, result)
    result = replace(
        result,
        criteria=[outcome.as_object() for outcome in evaluated],
        ideal={} if rear else ideal_stop.ideal_of(drive, chosen),  # of wheels that are alike
        observed=course.observed(result, chosen),
        origin=result.origin | ({"processor": options.on} if options.on else {}),
    )
    warn_of(result)
    if result.stopped is False:
        print(
            f"hubsim: warning: {name}: still moving after {result.duration_s:g} s (max_duration_s)",
            file=sys.stderr,
        )
    if wanted:
        recordings.write_all(result, wanted, run.matching(result.names, patterns))
    if options.json:
        files.write_text(options.json, as_json(json_object(result)))
    console.print_table([result])
    print(*console.limits_cost(result.ideal), *course.lines(result.observed), sep="\n")
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


def _does_not_apply(stated: DoesNotApplyError, json: Path | None) -> int:
    """Say why a scenario is not for a drive; that is a result, not a failure."""
    print(stated)
    if json is not None:
        summary = {"cycle": stated.scenario, "vehicle": stated.drive, "applies": False}
        files.write_text(json, as_json(summary | {"needs": stated.needs}))
    return 0


def run_strategies(options: argparse.Namespace) -> int:
    """Do ``hubsim sim``: the three strategies side by side, with a page."""
    from hubsim.cli import comparison, kept  # noqa: PLC0415, only here

    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario_of(options.scenario, settings, options.config)
    if not chosen.follows:
        raise HubsimError(f"sim: scenario {name} has no cycle, accepted: one that has")
    drives = [drive_of(options.config, settings, strategy, chosen) for strategy in run.STRATEGIES]
    comparison.check_output(options.output)
    with (
        progress.shown() as bar,
        kept.meanwhile(drives, options.scenario, settings.plant, bar) as waiting,
    ):
        results = comparison.simulate_all(
            name, drives, chosen, beside, settings.plant, bar, options.date
        )
        shown = comparison.extras(drives, bar)
        shares = kept.of_results(results) | {c: f.result() for c, f in waiting.items()}
    for result in results:
        warn_of(result)
    console.print_table(results)
    for result in results:
        print(*(f"{result.strategy}: {line}" for line in course.lines(result.observed)), sep="\n")
    if shares:
        print(kept.line(shares))
    for line in comparison.write(results, options.output, shown):
        print(line)
    failed = comparison.not_met(results)
    failed += [f"{cycle}: {kept.CRITERION}" for cycle in waiting if shares[cycle] < kept.LEAST]
    if failed:
        print(f"hubsim: {name}: criteria not met: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def sweep_runs(options: argparse.Namespace) -> int:
    """Do ``hubsim sweep``: runs with keys that vary, into one table."""
    # Dask and Arrow are big; no other command needs them.
    from hubsim.sweep import conduct, plan, store, work  # noqa: PLC0415

    for name, value, least in (
        ("--runs", options.runs, 1),
        ("--workers", options.workers, 1),
        ("--seed", options.seed, 0),
    ):
        if value is not None and value < least:
            raise HubsimError(f"{name} {value}: accepted: a whole number from {least}")
    store.kind_of(options.output)
    files.check_writable(options.output)
    found = plan.make(options.vary, options.runs, options.seed)
    job = work.Job(
        _place(options.scenario),
        options.config.resolve(),
        options.strategy,
        tuple(options.settings),
        _collected(options.collect),
    )
    work.check(job, next(found.points()))
    described = {
        "hubsim": __version__, "scenario": options.scenario, "config": options.config.name,
        "strategy": options.strategy, "set": options.settings, "vary": options.vary,
        "runs": found.runs, "seed": options.seed, "collect": options.collect,
    }  # fmt: skip
    kept = store.Store(
        options.output,
        described,
        plan.fingerprint(described | {"content": _content(options)}),
        work.origin(job, options.seed, options.date),
    )
    if options.restart:
        kept.forget()
    with progress.shown("runs") as bar:
        task = bar.add_task(f"{options.scenario}", total=found.runs)
        try:
            table = conduct.conduct(
                job,
                found,
                kept,
                options.scheduler,
                options.workers,
                lambda done, planned: bar.update(task, completed=done, total=planned),
            )
        except KeyboardInterrupt:
            raise KeyboardInterrupt("the same command goes on where it stopped") from None
    for line in conduct.summary(table, [v.key for v in found.varied], options.output):
        print(line)
    return 0 if conduct.is_clean(table) else 1


def measure_many(options: argparse.Namespace) -> int:
    """Do ``hubsim stops`` and ``faults``: many runs of every drive."""
    # Matplotlib takes longer to load than most commands take.
    report = {"stops": "stored_share"}.get(options.command, options.command)
    module = importlib.import_module(f"hubsim.sweep.{report}_report")
    with progress.shown(options.command) as bar:
        lines, passed = module.conclude(options, bar)
    print(*lines, sep="\n")
    return 0 if passed else 1


def run_swarm(options: argparse.Namespace) -> int:
    """Do ``hubsim swarm``: runs that seeds draw, and their judge."""
    return int(importlib.import_module("hubsim.cli.swarm_runs").command(options))


def _place(name: str) -> str:
    """Return the scenario by a name that is the same in any directory."""
    return name if name in scenario.builtin_names() else str(Path(name).resolve())


def _collected(texts: list[str]) -> tuple[tuple[str, str], ...]:
    out = []
    for text in texts:
        column, equals, formula = (part.strip() for part in text.partition("="))
        if not column or not equals or not formula:
            raise HubsimError(f"--collect {text!r}: accepted: COLUMN=FORMULA")
        out.append((column, formula))
    return tuple(out)


def _content(options: argparse.Namespace) -> list[str]:
    """Return what a sweep's result depends on besides its command: files, and the engine itself."""
    path = (
        scenario.DIRECTORY / f"{options.scenario}.toml"
        if options.scenario in scenario.builtin_names()
        else Path(options.scenario)
    )
    return [
        hashlib.sha256(files.read_bytes(file)).hexdigest()
        for file in (path, options.config, engine.library_path())
    ]


def compare_runs(options: argparse.Namespace) -> int:
    """Do ``hubsim compare``: two results, or two runs, side by side."""
    for name in ("absolute", "relative"):
        if not 0.0 <= getattr(options, name) < float("inf"):
            raise HubsimError(f"--{name} {getattr(options, name)}: accepted: a number from 0")
    if options.json:
        files.check_writable(options.json)
    first, second = (
        _side(options, name, extra)
        for name, extra in ((options.first, options.set_a), (options.second, options.set_b))
    )
    found = difference.compare(first, second, Tolerance(options.absolute, options.relative))
    if options.only:
        found = [
            d
            for d in found
            if any(fnmatchcase(d.name, pattern) for pattern in options.only.split(","))
        ]
    if not found:
        raise HubsimError(f"{options.first} and {options.second}: nothing in common to compare")
    if options.json:
        written = {
            "provenance": installation.provenance(date=options.date),
            "sides": [{"name": s.name, "provenance": s.origin} for s in (first, second)],
            "differences": [d.as_object() for d in found],
        }
        files.write_text(options.json, as_json(written))
    apart = [d for d in found if not d.within]
    _print_differences(first.name, second.name, found if options.all else apart)
    alone = difference.only_in_one(first, second)
    if alone and not options.only:
        print(
            "hubsim: in one of them only: "
            f"{', '.join(alone[:8])}{' ...' if len(alone) > 8 else ''}",
            file=sys.stderr,
        )
    print(f"{len(found) - len(apart)} of {len(found)} figures and signals within the tolerances")
    return 1 if apart else 0


def _side(options: argparse.Namespace, name: str, extra: Sequence[str]) -> Side:
    if name not in scenario.builtin_names() and not name.endswith(".toml"):
        if extra:
            raise HubsimError(
                f"{name}: was run already, accepted: --set-a and --set-b with scenarios"
            )
        return difference.read(Path(name))
    settings = overrides.parse([*options.settings, *extra])
    title, chosen, beside = scenario_of(name, settings, options.config)
    drive = drive_of(options.config, settings, None, chosen)
    result = run.simulate(
        title, drive, chosen, beside, DEFAULT_SIGNALS, settings.plant, date=options.date
    )
    warn_of(result)
    signals = {signal: result.signal(signal) for signal in result.names}
    label = " ".join([title, *extra]) if extra else title
    return Side(label, difference.figures_of(json_object(result)), signals, result.origin)


def _print_differences(first: str, second: str, found: Sequence[Difference]) -> None:
    if not found:
        return
    table = Table(
        title=f"A: {first}\nB: {second}", title_justify="left", pad_edge=False, box=box.SIMPLE_HEAD
    )
    table.add_column("figure, or signal (means; codes where they first differ)")
    for heading in ("A", "B", "largest difference", "at s", "rms"):
        table.add_column(heading, justify="right")
    table.add_column("")
    for d in found:
        table.add_row(
            d.name,
            *(v if isinstance(v, str) else f"{v:.6g}" for v in (d.first, d.second)),
            f"{d.largest:.3g}",
            "" if d.at_s is None else f"{d.at_s:g}",
            "" if d.rms is None else f"{d.rms:.3g}",
            "" if d.within else "DIFFERS",
        )
    Console(highlight=False, width=None if Console().is_terminal else 140).print(table)


def list_names(options: argparse.Namespace) -> int:
    """Do ``hubsim list``: everything that has a name."""
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
        from hubsim.run import plotjuggler  # noqa: PLC0415, only here

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
    for path in sorted((installation.ROOT / "tools" / "motors").rglob("*.toml")):
        print(f"  {path.stem}")
    print(f"strategies (--strategy NAME):\n  {', '.join(run.STRATEGIES)}")
    print("keys of a scenario (--set KEY=VALUE):")
    _list_keys(Scenario)
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
    print("figures of a drive, besides the numbers of its file (drive.SECTION.KEY):")
    for name, figure in quantities.FIGURES.items():
        print(f"  {name:28} {figure.text}")
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
    drive = overrides.load_drive(arguments.DEFAULT_CONFIG, overrides.Overrides())
    vehicle, _ = run.prepare(drive, chosen, beside, {})
    with vehicle:
        vehicle.start()
        return vehicle.signals()


def write_report(options: argparse.Namespace) -> int:
    """Do ``hubsim report``: one page from results of runs."""
    from hubsim import report  # noqa: PLC0415, few commands need them
    from hubsim.cli import comparison  # noqa: PLC0415
    from hubsim.report import black_box  # noqa: PLC0415

    files.check_writable(options.output)
    found = [_with_origin(load_result(path), options.date) for path in options.results]
    names = list(dict.fromkeys(result.vehicle for result in found))
    configs = {
        name: options.config or engine.ROOT / "tools" / "motors" / f"{name}.toml" for name in names
    }
    known = {name: path for name, path in configs.items() if options.config or path.is_file()}
    maps = {
        name: stops.optimum_map(overrides.load_drive(path, overrides.Overrides()))
        for name, path in known.items()
    }
    records = [black_box.for_page(path, configs[names[0]]) for path in options.blackbox]
    curves: list[report.CurveLike] = []
    if options.stops:
        if names[0] not in known:
            raise HubsimError(
                f"--stops: {configs[names[0]]}: file not found, accepted: with --config TOML"
            )
        standing = Scenario(max_duration_s=1.0)
        drives = [
            drive_of(known[names[0]], overrides.Overrides(), strategy, standing)
            for strategy in run.STRATEGIES
        ]
        with progress.shown("stops") as bar:
            curves = list(comparison.extras(drives, bar).stops)
    report.write_page(found, options.output, report.Extras(maps, curves, "hubsim report", records))
    print(f"report: {options.output}")
    return 0


def show_record(options: argparse.Namespace) -> int:
    """Do ``hubsim blackbox`` and ``hubsim crash``: a controller's own records."""
    record = {"blackbox": "black_box"}.get(options.command, options.command)
    return int(importlib.import_module(f"hubsim.report.{record}").command(options))


def _with_origin(result: RunResult, date: str | None) -> RunResult:
    """Return a result with an origin: its own, or that of this call where its file holds none."""
    if result.origin:
        return result
    made = installation.provenance(result.vehicle, scenario=result.cycle, date=date)
    return replace(result, origin=made)


COMMANDS: dict[str, Callable[[argparse.Namespace], int]] = {
    "run": run_scenario,
    "sim": run_strategies,
    "sweep": sweep_runs,
    **dict.fromkeys(("stops", "faults"), measure_many),
    "swarm": run_swarm,
    "compare": compare_runs,
    "report": write_report,
    "list": list_names,
    **dict.fromkeys(("blackbox", "crash"), show_record),
}
