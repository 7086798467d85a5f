# SPDX-License-Identifier: Apache-2.0
"""What the commands do: one function a command, from its options to its exit code.

Loaded after the arguments have been understood, because NumPy and pydantic take longer to load than
an explanation may take to appear.
"""

import argparse
import json
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from regen_table import (
    DYNAMIC,
    STRATEGIES,
    calibrate,
    explain,
    filling,
    flux_constants,
    flux_files,
    flux_map,
    generate,
    ideal,
    ideal_cycles,
    image,
    installation,
    label,
    limited_stop,
    loss_fit,
    measured,
    outputs,
    points,
    questions,
    schema,
    service_key,
)
from regen_table.errors import ConfigurationError


def run_new(options: argparse.Namespace) -> int:
    """Write a short TOML file from the numbers of a label, whole or not at all."""
    path = options.output or installation.new_drive_file(options.name)
    if path.suffix != ".toml":
        path = path.with_name(f"{path.name}.toml")
    outputs.check_writable(path)
    if path.exists():
        raise ConfigurationError(f"{path}: exists, accepted: another NAME or -o FILE.toml")
    given = {name: value for name, value in vars(options).items() if value is not None}
    if sys.stdin.isatty() and sys.stdout.isatty():
        given |= questions.ask(given)
    written, drive = _of_label(options.name, given, path)
    image.build(drive)
    outputs.write_text(path, written.text)
    for line in written.estimated:
        print(f"estimated: {line}")
    _print_assumptions(drive)
    print(path)
    return 0


def _of_label(
    name: str, given: Mapping[str, Any], path: Path
) -> tuple[label.Written, schema.Drive]:
    """Return a label's file and its drive, with the board that is given or one that accepts it."""
    if "board" not in given:
        return _with_a_board(name, given, path)
    written = label.short_file(name, given)
    try:
        return written, _parsed(written, path)
    except ConfigurationError as error:
        lines = [str(error), *_another_board(name, given, path)]
        raise ConfigurationError("\n".join(lines)) from error


def _with_a_board(
    name: str, given: Mapping[str, Any], path: Path
) -> tuple[label.Written, schema.Drive]:
    """Return a label's file and its drive, with the first proposed board that accepts it."""
    refused: dict[str, ConfigurationError] = {}
    while True:
        written = label.short_file(name, given, refused)
        try:
            return written, _parsed(written, path)
        except ConfigurationError as error:
            refused[written.board] = error
            if written.board == label.OWN_BOARD:
                raise next(iter(refused.values())) from error


def _another_board(name: str, given: Mapping[str, Any], path: Path) -> Iterator[str]:
    """Say which board accepts what the given one refuses."""
    unnamed = {key: value for key, value in given.items() if key != "board"}
    try:
        accepts = _with_a_board(name, unnamed, path)[0].board
    except ConfigurationError:
        return
    yield f"{path}: --board: {given['board']}, accepted for this motor: {accepts}"


def _parsed(written: label.Written, path: Path) -> schema.Drive:
    drive = schema.parse(tomllib.loads(written.text), path.stem, str(path), beside=path.parent)
    return drive.found_in(path.parent)


def run_explain(options: argparse.Namespace) -> int:
    """Print what keys mean."""
    for key in [key for word in options.keys for key in explain.matching(word)]:
        print(explain.text(key))
    return 0


def _print_assumptions(drive: schema.Drive) -> None:
    for assumption in filling.assumptions(drive):
        print(f"assumed: {assumption}")


def run_calibrate(options: argparse.Namespace) -> int:
    """Print the [rotor] section that belongs to a recording."""
    with _about(options.recording):
        found = calibrate.calibrate(calibrate.load(options.recording))
    if not found.both_directions:
        print(
            f"{options.recording}: warning: turned in one direction only, so half the sensors'"
            " hysteresis, some degrees of hall sensors, is in the angles; record both directions",
            file=sys.stderr,
        )
    print(calibrate.as_toml(found))
    return 0


def run_key(options: argparse.Namespace) -> int:
    """Write a new key."""
    service_key.write(options.file, service_key.draw())
    print(
        f"{options.file}: a new key; keep it out of every repository, name it as [service] key",
    )
    return 0


def run_fit(options: argparse.Namespace) -> int:
    """Print the loss parameters of measurements; write them as keys, JSON and picture."""
    # Matplotlib takes longer to load than all else takes to run.
    from regen_table import loss_report, plotting  # noqa: PLC0415

    if options.output is not None and options.drive is None:
        raise ConfigurationError("-o: accepted: together with --drive, of pole pairs and inverter")
    for path in filter(None, (options.output, options.json, options.picture)):
        outputs.check_writable(path)
    drive = None if options.drive is None else schema.load(options.drive)
    rows = measured.joined(
        [measured.load(path, options.inertia_kg_m2) for path in options.measurements]
    )
    if options.max_speed_rpm is not None:
        rows = rows.where(rows.speed_rad_s <= options.max_speed_rpm * measured.RPM + 1e-9)
    known = {} if drive is None else loss_fit.temperature_law(drive)
    with _about(options.measurements[0]):
        found = loss_fit.fit(rows, options.winding_temperature_c, **known)
    files: dict[Path, bytes] = {}
    if options.output is not None and drive is not None:
        with _about(options.drive):
            files[options.output] = loss_report.toml(found, drive).encode()
    if options.json is not None:
        content = json.dumps(loss_report.record(found), indent=1, allow_nan=False) + "\n"
        files[options.json] = content.encode()
    if options.picture is not None:
        title = ", ".join(path.stem for path in options.measurements)
        drawn = plotting.rendered({"": loss_report.figure(found, title)})
        files[options.picture] = drawn[options.picture.suffix or ".svg"]
    outputs.write_files(files)
    print(loss_report.text(found))
    return 0


def run_flux(options: argparse.Namespace) -> int:
    """Check a flux map; print and write the constants that make a torque exact."""
    pairs = options.pole_pairs
    for path in filter(None, (options.output, options.json)):
        outputs.check_writable(path)
    found, checks = flux_files.load(options.map)
    with _about(options.map):
        if options.max_current_a is not None:
            flux_map.refuse_short(found, options.max_current_a)
        chosen = flux_map.constants(found, pairs, options.torque_nm)
    errors = flux_map.torque_errors(found, chosen, pairs)
    files: dict[Path, bytes] = {}
    if options.output is not None:
        files[options.output] = flux_map.toml(chosen).encode()
    if options.json is not None:
        content = {
            "checks": asdict(checks),
            "constants": asdict(chosen),
            "torque_errors": [asdict(error) for error in errors],
        }
        files[options.json] = (json.dumps(content, indent=1, allow_nan=False) + "\n").encode()
    outputs.write_files(files)
    print(flux_map.text(found, checks, chosen, errors))
    return 0


def run_generate(options: argparse.Namespace) -> int:
    """Write C source and image, a report and figures on request, and print what was found."""
    drive = schema.load(options.config, options.settings)
    with _about(options.config):
        found = generate.make_report(drive)
        made = generate.artefacts(drive)
    directory = options.output or generate.GENERATED
    files = {directory / name: content for name, content in made.files.items()}
    if options.report:
        origin = installation.provenance(drive.name, made.image, date=options.date)
        files[options.report] = generate.report_json(found, origin)
    paths = outputs.write_files(files, make_directories=True)
    if options.plots:
        # Matplotlib takes longer to load than all else takes to run.
        from regen_table import figures  # noqa: PLC0415

        with _about(options.config):
            paths += figures.draw_all(drive, options.output or generate.FIGURES)
    for warning in generate.warnings(drive, found):  # last: an error is one line
        print(f"{options.config}: warning: {warning}", file=sys.stderr)
    print(generate.report_text(found))
    _print_assumptions(drive)
    for path in paths:
        print(path)
    return 0


def run_check(options: argparse.Namespace) -> int:
    """Compare the files of configurations with what their TOML files generate."""
    for path in options.configs:
        with _about(path):
            generate.check(schema.load(path), options.output or generate.GENERATED)
    print(f"{len(options.configs)} configuration(s) up to date")
    return 0


def run_solve(options: argparse.Namespace) -> int:
    """Print the best braking at speeds and winding temperatures."""
    drive = schema.load(options.config)
    with _about(options.config):
        how = points.setting(drive, options.joint, options.soc)
        temperatures = _temperatures(drive, options.winding_temperature_c)
        records = [
            points.solve(drive, speed, warm, how)
            for warm in temperatures
            for speed in options.speed_rpm
        ]
    _answer(
        options,
        drive,
        records,
        [
            "speed_rpm",
            "winding_temperature_c",
            "torque_optimal_nm",
            "torque_zero_nm",
            "torque_idle_nm",
            "torque_optimal_limited_nm",
            "current_d_a",
            "current_q_a",
            "dc_power_w",
        ],
    )
    return 0


def run_evaluate(options: argparse.Namespace) -> int:
    """Print operating points."""
    drive = schema.load(options.config)
    with _about(options.config):
        how = points.setting(drive, options.joint, options.soc)
        temperatures = _temperatures(drive, options.winding_temperature_c)
        records = [
            points.evaluate(drive, speed, torque, warm, how)
            for warm in temperatures
            for speed in options.speed_rpm
            for torque in options.torque_nm
        ]
    _answer(
        options,
        drive,
        records,
        [
            "speed_rpm",
            "torque_nm",
            "winding_temperature_c",
            "current_d_a",
            "current_q_a",
            "dc_power_w",
            "loss_copper_w",
            "loss_iron_w",
            "loss_inverter_w",
            "loss_battery_w",
            "region",
        ],
    )
    return 0


def run_stop(options: argparse.Namespace) -> int:
    """Print ideal stops."""
    drive = schema.load(options.config)
    _warn_of_constants(options.config, drive)
    strategy = options.strategy or drive.brake.strategy
    warm = _one_temperature(drive, options.winding_temperature_c)
    if options.limits is not None and options.battery != DYNAMIC:
        raise ConfigurationError(f"--limits: accepted: with --battery {DYNAMIC}")
    if options.open_circuit_voltage_v is not None:
        drive = _with_voltage(drive, options.open_circuit_voltage_v)

    def one(name: str, demand: float) -> ideal.Stop | limited_stop.LimitedStop:
        at = (drive, name, demand, options.initial_speed_kmh, warm, options.soc)
        if options.limits is None:
            return ideal.stop(*at, options.battery)
        return limited_stop.stop(*at, options.limits)

    with _about(options.config):
        found = [
            one(name, demand)
            for name in (STRATEGIES if strategy == "all" else [strategy])
            for demand in options.demand_nm
        ]
    _answer(
        options,
        drive,
        [result.as_dict() for result in found],
        [
            "strategy",
            "demand_nm",
            "stop_distance_m",
            "stop_time_s",
            "kinetic_energy_j",
            "stored_share_of_kinetic",
        ],
    )
    return 0


def _warn_of_constants(path: Path, drive: schema.Drive) -> None:
    """Say that an answer is of the constants that stand for a flux map."""
    line = flux_constants.warning(drive)
    if line is not None:
        print(f"{path}: warning: {line}; these answers are the constants'", file=sys.stderr)


def _with_voltage(drive: schema.Drive, voltage_v: float) -> schema.Drive:
    """Return the drive with another open-circuit voltage, where that is one number."""
    if not isinstance(drive.battery.open_circuit_voltage_v, float | int):
        raise ConfigurationError(
            "--open-circuit-voltage-v: accepted: with a drive whose open_circuit_voltage_v does "
            "not depend on the state of charge; with others: --soc"
        )
    battery = drive.battery.model_copy(update={"open_circuit_voltage_v": voltage_v})
    return drive.model_copy(update={"battery": battery})


def run_cycle(options: argparse.Namespace) -> int:
    """Print an ideal cycle under every strategy."""
    drive = schema.load(options.config)
    _warn_of_constants(options.config, drive)
    warm = _one_temperature(drive, options.winding_temperature_c)
    trace = ideal_cycles.load(options.trace, options.top_speed_kmh)
    with _about(options.config):
        found = [
            ideal_cycles.run(drive, trace, strategy, warm, options.soc, ideal.production(drive))
            for strategy in STRATEGIES
        ]
    _answer(
        options,
        drive,
        [result.as_dict() for result in found],
        ["cycle", "strategy", "braking_share_stored", "residual_relative"],
    )
    return 0


def run_figures(options: argparse.Namespace) -> int:
    """Draw the figures of the paper."""
    from regen_table import figures  # noqa: PLC0415, as above

    drive = schema.load(options.config)
    _warn_of_constants(options.config, drive)
    with _about(options.config):
        for path in figures.draw_all(drive, options.output):
            print(path)
    return 0


def _temperatures(drive: schema.Drive, given: list[float] | None) -> list[float]:
    """Return the winding temperatures, refusing those at which the copper law is meaningless."""
    found = [drive.motor.reference_temperature_c] if given is None else given
    return [_one_temperature(drive, value) for value in found]


def _one_temperature(drive: schema.Drive, given: float | None) -> float:
    value = drive.motor.reference_temperature_c if given is None else given
    share = 1.0 + drive.motor.resistance_temperature_coefficient_per_k * (
        value - drive.motor.reference_temperature_c
    )
    if share <= 0.0:
        raise ConfigurationError(
            f"--winding-temperature-c: {value:g} degC leaves no resistance, accepted: temperatures"
            " that leave some"
        )
    return value


def _answer(
    options: argparse.Namespace, drive: schema.Drive, records: Sequence[Any], columns: list[str]
) -> None:
    """Print records as JSON, or some of their keys as a table; write them on request."""
    if options.output is not None:
        outputs.check_writable(options.output)
        content = {"provenance": _origin(drive, options.date), "results": records}
        text = json.dumps(content, indent=1, allow_nan=False) + "\n"
        outputs.write_text(options.output, text)
    if options.json:
        print(json.dumps(records, indent=1, allow_nan=False))
        return
    rows = [columns] + [[_cell(record[name]) for name in columns] for record in records]
    widths = [max(len(row[k]) for row in rows) for k in range(len(columns))]
    for row in rows:
        print("  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)))


def _origin(drive: schema.Drive, date: str | None) -> dict[str, Any]:
    """Return the provenance of a result; without a CRC where no configuration can be generated."""
    try:
        raw = image.build(drive)
    except ConfigurationError:
        raw = None
    return installation.provenance(drive.name, raw, date=date)


def _cell(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else "-" if value is None else str(value)


class _about:  # noqa: N801, reads as a word: with _about(path)
    """Begin the message of a ConfigurationError with the file it is about, once."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if isinstance(error, ConfigurationError) and not str(error).startswith(str(self.path)):
            raise ConfigurationError(f"{self.path}: {error}") from error
