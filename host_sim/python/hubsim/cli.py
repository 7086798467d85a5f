"""The command line: ``python -m hubsim COMMAND ...``. Mistakes are one line on stderr; exit status 1, or 2 for a wrong call."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from regen_table.errors import ConfigurationError
from regen_table.schema import Drive
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from hubsim import __version__, cycles, engine, files, outputs, overrides, run, scenario
from hubsim.errors import HubsimError
from hubsim.results import RunResult

MOTORS = engine.ROOT / "tools" / "motors"
DEFAULT_CONFIG = MOTORS / "lu2013.toml"
DEFAULT_SIGNALS = (
    "time_s", "driver.*", "vehicle.*", "battery.*",
    "wheel*.motor_torque_nm", "wheel*.hydraulic_torque_nm", "wheel*.command_nm", "wheel*.estimate_nm", "wheel*.available_nm",
    "wheel*.current_?_a", "wheel*.dc_w", "wheel*.shaft_w", "wheel*.copper_w", "wheel*.iron_w", "wheel*.inverter_w",
    "wheel*.winding_temperature_c", "wheel*.speed_estimate_rad_per_s", "wheel*.reason", "wheel*.mode",
)  # fmt: skip


class _Parser(argparse.ArgumentParser):
    """Answers a wrong call with one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except (HubsimError, ConfigurationError) as error:
        print(f"hubsim: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="hubsim", description="The simulated vehicle: complete controllers on a physical plant.")
    parser.add_argument("--version", action="version", version=f"hubsim {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND", parser_class=_Parser)

    command = commands.add_parser("run", help="one run of a scenario", description="Run a scenario and say where the energy went.")
    command.add_argument("scenario", metavar="SCENARIO", help="a built-in scenario ('hubsim list') or a TOML file")
    _add_common(command)
    command.add_argument(
        "--strategy", choices=run.STRATEGIES, metavar="NAME", help=f"{', '.join(run.STRATEGIES)}; default: the drive's own"
    )
    command.add_argument("--signals", metavar="PATTERN,...", help="what --csv holds, '*' for anything; default: the most telling ones")
    command.add_argument("--csv", type=Path, metavar="FILE", help="write the recorded signals")
    command.add_argument("--json", type=Path, metavar="FILE", help="write energies and shares")
    command.set_defaults(run=_run)

    command = commands.add_parser("list", help="scenarios, cycles, drives, keys, signals")
    command.add_argument("--parameters", action="store_true", help="everything that --set plant.NAME=VALUE can change")
    command.add_argument("--signals", action="store_true", help="everything that can be recorded")
    command.set_defaults(run=_list)

    command = commands.add_parser("sim", help="the urban cycle under the three strategies, table and report")
    _add_common(command)
    command.add_argument("--scenario", default="ece15", metavar="NAME", help="a scenario with a cycle; default: ece15")
    command.add_argument("--output", type=Path, default=engine.ROOT / "build" / "report", metavar="DIR", help="default: build/report")
    command.set_defaults(run=_sim)
    return parser


def _add_common(command: argparse.ArgumentParser) -> None:
    command.add_argument("--config", type=Path, default=DEFAULT_CONFIG, metavar="TOML", help="the drive; default: tools/motors/lu2013.toml")
    command.add_argument(
        "--set", dest="settings", action="append", default=[], metavar="KEY=VALUE",
        help="a key of the scenario, section.key of the drive, or plant.section.key of the simulated world alone; repeatable",
    )  # fmt: skip


def _drive(options: argparse.Namespace, settings: overrides.Overrides, strategy: str | None) -> Drive:
    if strategy is not None:
        settings.drive["brake", "strategy"] = strategy
    return overrides.load_drive(options.config, settings)


def progress_bar() -> Progress:
    """Return a progress display on stderr that stays silent where nobody watches."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("s"), TimeRemainingColumn(),
        console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip


def warn_of_faults(result: RunResult) -> None:
    """Say on stderr that a controller gave up: the run went on without it."""
    for fault in result.faults:
        print(
            f"hubsim: warning: {result.cycle}, {result.strategy}: wheel {fault.wheel} faulted at {fault.time_s:.3f} s: {fault.reason}",
            file=sys.stderr,
        )


def _run(options: argparse.Namespace) -> int:
    for path in filter(None, (options.csv, options.json)):
        files.check_writable(path)
    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    drive = _drive(options, settings, options.strategy)
    patterns = options.signals.split(",") if options.signals else DEFAULT_SIGNALS
    with progress_bar() as bar:
        task = bar.add_task(f"{name}, {drive.brake.strategy}", total=None)
        result = run.simulate(
            name, drive, chosen, beside, patterns if options.csv else (), settings.plant,
            lambda now, planned: bar.update(task, completed=int(now), total=int(planned)),
        )  # fmt: skip
    warn_of_faults(result)
    if result.stopped is False:
        print(f"hubsim: warning: {name}: still moving after {result.duration_s:g} s (max_duration_s)", file=sys.stderr)
    if options.csv:
        outputs.write_csv(result, options.csv)
    if options.json:
        files.write_text(options.json, outputs.as_json(outputs.run_object(result)))
    outputs.print_table([result])
    return 0


def _list(options: argparse.Namespace) -> int:
    if options.parameters:
        for name, parameter in engine.parameters().items():
            unit = "" if parameter.unit in {"", "1"} else f" {parameter.unit}"
            print(f"plant.{name:45} {parameter.lowest:g} to {parameter.highest:g}{unit}  {parameter.text}")
        return 0
    if options.signals:
        for name in _signal_names():
            print(name)
        return 0
    print("scenarios (hubsim run NAME):")
    for name in scenario.builtin_names():
        print(f"  {name:28} {scenario.load(name, {})[1].description}")
    print('cycles (cycle = "NAME" in a scenario):')
    for name in cycles.names():
        cycle = cycles.load(name)
        print(f"  {name:28} {cycle.duration_s:g} s, {cycle.distance_m / 1e3:.3f} km, up to {max(cycle.speed_kmh):g} km/h")
    print(f"drives (--config {MOTORS.relative_to(engine.ROOT)}/NAME.toml):")
    for path in sorted(MOTORS.glob("*.toml")):
        print(f"  {path.stem}")
    print(f"strategies (--strategy NAME):\n  {', '.join(run.STRATEGIES)}")
    print("keys of a scenario (--set KEY=VALUE):")
    for key, field in scenario.Scenario.model_fields.items():
        print(f"  {key:28} {field.description} ({scenario.accepted(key)})")
    print("also --set SECTION.KEY=VALUE of the drive, and --set plant.SECTION.KEY=VALUE (hubsim list --parameters)")
    return 0


def _signal_names() -> list[str]:
    """Return the signals of the default drive's vehicle."""
    _, chosen, beside = scenario.load("stop", {})
    drive = overrides.load_drive(DEFAULT_CONFIG, overrides.Overrides())
    vehicle, _ = run.prepare(drive, chosen, beside, {})
    with vehicle:
        vehicle.start()
        return vehicle.signals()


def _sim(options: argparse.Namespace) -> int:
    from hubsim import comparison  # noqa: PLC0415, the report's modules are needed by this command only

    settings = overrides.parse(options.settings)
    name, chosen, beside = scenario.load(options.scenario, settings.scenario)
    if chosen.cycle is None:
        raise HubsimError(f"sim: scenario {name} has no cycle, accepted: one that has")
    drives = [_drive(options, settings, strategy) for strategy in run.STRATEGIES]
    comparison.check_output(options.output)
    with progress_bar() as bar:
        results = comparison.simulate_all(name, drives, chosen, beside, settings.plant, bar)
    for result in results:
        warn_of_faults(result)
    outputs.print_table(results)
    for line in comparison.write(results, options.output):
        print(line)
    return 0
