# SPDX-License-Identifier: Apache-2.0
"""Writing a configuration: <name>.c and <name>.bin together, or neither; and its report.

The C source is one constant with designated initialisers, the same bytes as the binary image. The
report is what was computed to accept the drive: margins, number formats, what the grid loses.
"""

import json
import re
import textwrap
import zlib
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from regen_table import (
    __version__,
    audit,
    boards,
    bus_capacitor,
    current_audit,
    current_map,
    defaults,
    derived,
    envelope,
    flux_constants,
    image,
    installation,
    layout,
    loops,
    margins,
    outputs,
    refusals,
    schema,
    service_key,
    shortcomings,
    thermometers,
)
from regen_table.errors import CheckFailedError
from regen_table.schema import Drive

# In the repository, where its build looks for them; elsewhere, where the caller is.
GENERATED = (
    Path() if installation.INSTALLED else installation.ROOT / "firmware" / "config" / "generated"
)
FIGURES = Path("figures") if installation.INSTALLED else installation.ROOT / "build/report/figures"
_COLUMNS = 100
_HEAD = """\
/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "{name}": {motor}.
 *
 * Written by tools/regen_table {version}; the same bytes as {name}.bin. Do not edit:
 * change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t {symbol};

CONFIG_SECTION const config_t {symbol} = {{
    .magic = CONFIG_MAGIC,
    .format_version = {format_version},
    .size_bytes = sizeof(config_t),
    .generator_version = 0x{generator_version:08X},
    .name = "{name}",
"""


@dataclass(frozen=True)
class Artefacts:
    """The files of one configuration, by their names below the output directory, and the image."""

    files: dict[str, bytes]
    image: bytes


def artefacts(drive: Drive) -> Artefacts:
    """Compute both files of a drive."""
    raw = service_key.with_key(image.build(drive), service_key.of(drive))
    return Artefacts(
        {f"{drive.name}.c": c_source(drive, raw).encode("ascii"), f"{drive.name}.bin": raw}, raw
    )


def write(drive: Drive, directory: Path) -> list[Path]:
    """Write both files of a drive and return their paths."""
    return write_all(artefacts(drive).files, directory)


def write_all(files: dict[str, bytes], directory: Path) -> list[Path]:
    """Put files into a directory all together or not at all."""
    found = {directory / name: content for name, content in files.items()}
    return outputs.write_files(found, make_directories=True)


def check(drive: Drive, directory: Path) -> None:
    """Compare both files of a drive with what a directory holds.

    Raises CheckFailedError with one line.
    """
    for name, content in artefacts(drive).files.items():
        path = directory / name
        try:
            same = path.read_bytes() == content
        except FileNotFoundError:
            raise CheckFailedError(f"{path}: missing; write it with ./tools/dev table") from None
        except OSError as error:
            raise CheckFailedError(f"{path}: cannot be read: {error.strerror}") from error
        if not same:
            raise CheckFailedError(
                f"{path}: differs from what its TOML file generates; renew it with ./tools/dev"
                " table"
            )


def symbol(drive: Drive) -> str:
    """Return the name of the C constant."""
    return "CONFIG_" + re.sub(r"\W", "_", drive.name).upper()


def c_source(drive: Drive, raw: bytes) -> str:
    """Return the C file of a drive whose image is ``raw``.

    Depends on nothing else, so its bytes repeat.
    """
    header = layout.load()
    lines = [
        _HEAD.format(
            name=drive.name,
            motor=re.sub(r"[^ -~]|[\\*/]", "?", drive.motor.name),
            version=__version__,
            symbol=symbol(drive),
            format_version=header.constants["CONFIG_FORMAT_VERSION"],
            generator_version=image.generator_version(),
        )
    ]
    packed: Any = header.ffi.from_buffer("config_t *", raw)
    for section, fields in header.sections.items():
        lines.append(f"    .{section} = {{\n")
        width = max(len(name) for name, info in fields.items() if not info.count)
        for name, info in fields.items():
            value = getattr(getattr(packed, section), name)
            if info.count:
                lines += _array(name, [int(item) for item in value], packed)
            else:
                lines += _scalar(f".{name:<{width}} = {int(value)},", info)
        lines.append("    },\n")
    body = raw[: header.ffi.offsetof("config_t", "crc32")]
    lines.append(f"    .crc32 = 0x{zlib.crc32(body):08X},\n")
    if any(packed.service_key):
        key = ", ".join(f"0x{word:08X}" for word in packed.service_key)
        lines.append(f"    .service_key = {{{key}}},\n")
    lines.append("};\n")
    return "".join(lines)


def _scalar(assignment: str, info: layout.FieldInfo) -> list[str]:
    """Write a field with its unit and meaning, beside it or above it as the width allows."""
    unit = f"[{info.unit}]" if info.unit not in {"", "1"} else ""
    meaning = " ".join(part for part in (unit, info.text) if part)
    line = f"        {assignment}" + (f" /* {meaning} */" if meaning else "")
    if len(line) <= _COLUMNS:
        return [line + "\n"]
    comment = textwrap.wrap(meaning, _COLUMNS - 17)
    above = "\n         * ".join(comment)
    return [f"        /* {above} */\n", f"        {assignment}\n"]


def _array(name: str, values: list[int], packed: Any) -> list[str]:  # noqa: ANN401, a cffi pointer
    """Write an array: a map row by row with what each row stands for, anything else in one line.

    Trailing zeros are implied.
    """
    if name == "torque_lsb":
        grid = packed.regen_map
        temperatures = [
            (grid.temperature_origin_cC + (row << grid.temperature_step_log2)) / 100
            for row in range(grid.temperature_points)
        ]
        step = (1 << grid.speed_step_log2) / 1000
        return _rows(
            name,
            values,
            grid.speed_points,
            f"a column every {step:g} rad/s, mechanical; in {1 << grid.lsb_log2} mN m",
            [f"{t:g} degC" for t in temperatures],
        )
    if name == "current_d_lsb":
        grid = packed.current_map
        speeds = [(row << grid.speed_step_log2) / 1000 for row in range(grid.speed_points)]
        layers = [
            (grid.temperature_origin_cC + (row << grid.temperature_step_log2)) / 100
            for row in range(grid.temperature_points)
        ]
        first, step = (
            -(grid.torque_points // 2 << grid.torque_step_log2) / 1000,
            (1 << grid.torque_step_log2) / 1000,
        )
        head = f"a column every {step:g} N m from {first:g} N m on; in {1 << grid.lsb_log2} mA"
        return _rows(
            name,
            values,
            grid.torque_points,
            head,
            [f"{w:g} rad/s, {t:g} degC" for t in layers for w in speeds],
        )
    if name in {"psi_d_lsb", "psi_q_lsb"} and packed.flux_map.d_points > 0:
        points = packed.flux_map
        currents = [
            (row - points.d_negative_points) * points.d_step_mA / 1000
            for row in range(points.d_points)
        ]
        step = points.q_step_mA / 1000
        return _rows(
            name,
            values,
            points.q_points,
            f"a column every {step:g} A of i_q; in {1 << points.lsb_log2} nWb",
            [f"i_d {current:g} A" for current in currents],
        )
    if not any(values):
        return [f"        .{name} = {{0}},\n"]
    return [f"        .{name} = {{{', '.join(str(value) for value in values)}}},\n"]


def _rows(name: str, values: list[int], columns: int, head: str, labels: list[str]) -> list[str]:
    """Write a map, one labelled row after the other."""
    lines = [f"        .{name} = {{\n", f"            /* {head} */\n"]
    for row, label in enumerate(labels):
        entries = ", ".join(str(value) for value in values[row * columns : (row + 1) * columns])
        lines.append(f"            /* {label} */\n")
        lines += [f"            {part}\n" for part in textwrap.wrap(f"{entries},", _COLUMNS - 12)]
    return [*lines, "        },\n"]


@dataclass(frozen=True)
class Report:
    """Everything that was computed to accept a drive."""

    name: str
    generator_version: str
    bandwidth_hz: float
    margins: list[margins.Margins]
    formats: list[envelope.Proof]
    grid_losses: list[audit.GridLoss]
    power_loss_worst: float
    power_loss_from_rpm: float
    d_current_points: tuple[int, int, int]  # torque, speed, temperature
    d_current_losses: list[current_audit.CurrentLoss]
    d_current_power_loss_worst: float
    bus_voltage_loss: float
    temperature_sensors: list[str]
    boards: str
    towing_kmh: float
    towing_v: float


def make_report(drive: Drive) -> Report:
    """Compute the report of a drive; refuses what must not be generated."""
    refusals.refuse(drive)
    stability = margins.current_loop(drive)
    margins.refuse_thin_margins(drive, stability)
    formats = envelope.proofs(drive)
    currents = current_audit.choose(drive)
    made = current_map.production(currents)
    table = current_audit.braking_table(drive)
    losses = audit.grid_losses(drive, table, made)
    audit.refuse_lossy_grid(losses, partial(current_audit.smallest_grid, drive, free=True))
    layers, rows, columns = currents.current_d_mA.shape
    return Report(
        name=drive.name,
        generator_version=__version__,
        bandwidth_hz=drive.control.current_bandwidth_hz,
        margins=stability,
        formats=formats,
        grid_losses=losses,
        power_loss_worst=audit.worst_power_loss(drive, table, made),
        power_loss_from_rpm=drive.control.handover_end_rpm,
        d_current_points=(columns, rows, layers),
        d_current_losses=current_audit.losses(drive, currents),
        d_current_power_loss_worst=current_audit.worst_power_loss(drive, currents),
        bus_voltage_loss=current_audit.bus_voltage_loss(drive),
        temperature_sensors=thermometers.describe(drive),
        boards=boards.fitting(drive, defaults.OVERCURRENT_MARGIN, schema.refused_with),
        towing_kmh=3.6 * derived.towing_speed_m_per_s(drive),
        towing_v=drive.battery.min_voltage_v,
    )


def warnings(drive: Drive, found: Report) -> list[str]:
    """Return one line for everything that is accepted, but works worse than its numbers promise."""
    lines = shortcomings.warnings(drive)
    saturation = flux_constants.warning(drive)
    if saturation is not None:
        lines.append(saturation)
    weakening = loops.weakening_warning(drive)
    if weakening is not None:
        lines.append(weakening)
    capacitor = bus_capacitor.warning(drive)
    if capacitor is not None:
        lines.append(capacitor)
    if found.power_loss_worst > audit.POWER_LOSS_MAX:
        lines.append(
            "table.speed_points, table.temperature_points: at one speed above"
            f" {found.power_loss_from_rpm:g} r/min the grid loses {found.power_loss_worst:.1%} of"
            " the braking power; more points lose less"
        )
    return lines


def report_json(report: Report, origin: dict[str, Any]) -> bytes:
    """Return the report as JSON; ``origin`` is its provenance."""
    return (json.dumps({"provenance": origin} | asdict(report), indent=1) + "\n").encode()


def report_text(report: Report) -> str:
    """Return the report as a few lines for people."""
    worst = min(report.margins, key=lambda m: m.phase_margin_deg)
    reached = [m.bandwidth_hz for m in report.margins]
    tightest = max(report.formats, key=_filled)
    lines = [
        (
            f"{report.name}: current loop: phase margin {worst.phase_margin_deg:.1f} deg, gain"
            f" margin {min(m.gain_margin for m in report.margins):.2f}, bandwidth"
            f" {max(reached):.0f} Hz with a cold and {min(reached):.0f} Hz with a hot winding,"
            f" {report.bandwidth_hz:g} Hz designed"
        ),
        (
            f"{report.name}: number formats: {len(report.formats)} quantities proved, fullest"
            f" {tightest.quantity} at {_filled(tightest):.0%}"
        ),
    ]
    lines += [
        f"{report.name}: grid: {loss.manoeuvre}: {loss.lost_j:.3g} J of {loss.returned_j:.4g} J"
        f" lost, {loss.relative:.4%}, at worst ({loss.winding_temperature_c:.0f} degC)"
        for loss in report.grid_losses
    ]
    lines.append(
        f"{report.name}: grid: {report.power_loss_worst:.3%} of the power lost at worst above"
        f" {report.power_loss_from_rpm:g} r/min"
    )
    costliest = max(report.d_current_losses, key=lambda loss: loss.without_d_current)
    columns, rows, layers = report.d_current_points
    temperature, stored = (
        max(getattr(loss, name) for loss in report.d_current_losses)
        for name in ("temperature", "stored")
    )
    lines.append(
        f"{report.name}: i_d: {columns} x {rows} x {layers} points over torque, speed and"
        f" temperature lose {stored:.4%} of the energy of any manoeuvre, {temperature:.4%} of it to"
        f" the few temperatures, and {report.d_current_power_loss_worst:.3%} of the braking power"
        " anywhere"
    )
    lines.append(
        f"{report.name}: i_d: i_d = 0 would lose {costliest.without_d_current:.2%}"
        f" ({costliest.manoeuvre}), bus voltage as an axis would save {report.bus_voltage_loss:.3%}"
    )
    lines += [*report.temperature_sensors, f"{report.name}: {report.boards}"]
    lines.append(
        f"{report.name}: towing: up to {report.towing_kmh:.1f} km/h nothing flows; beyond, the"
        f" diodes charge a pack of {report.towing_v:g} V, with nothing to stop them"
    )
    return "\n".join(lines)


def _filled(proof: envelope.Proof) -> float:
    return max(
        proof.found.high / proof.allowed.high,
        proof.found.low / proof.allowed.low if proof.allowed.low < 0.0 else 0.0,
    )
