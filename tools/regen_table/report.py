# SPDX-License-Identifier: Apache-2.0
"""What a generation found out besides the tables: margins, number formats, what the grid loses."""

import json
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

from regen_table import (
    __version__,
    audit,
    current_audit,
    current_map,
    envelope,
    loops,
    margins,
    relations,
)
from regen_table.schema import Drive


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


def collect(drive: Drive) -> Report:
    """Compute the report of a drive; refuses what must not be generated."""
    stability = margins.current_loop(drive)
    margins.refuse_thin_margins(drive, stability)
    formats = envelope.proofs(drive)
    envelope.refuse_overflow(formats)
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
    )


def warnings(drive: Drive, found: Report) -> list[str]:
    """Return one line for everything that is accepted, but works worse than its numbers promise."""
    lines = relations.warnings(drive)
    weakening = loops.weakening_warning(drive)
    if weakening is not None:
        lines.append(weakening)
    if found.power_loss_worst > audit.POWER_LOSS_MAX:
        lines.append(
            "table.speed_points, table.temperature_points: at one speed above"
            f" {found.power_loss_from_rpm:g} r/min the grid loses {found.power_loss_worst:.1%} of"
            " the braking power; more points lose less"
        )
    return lines


def as_json(report: Report, origin: dict[str, Any]) -> bytes:
    """Return the report as JSON; ``origin`` is its provenance."""
    return (json.dumps({"provenance": origin} | asdict(report), indent=1) + "\n").encode()


def as_text(report: Report) -> str:
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
    dear = max(report.d_current_losses, key=lambda loss: loss.without_d_current)
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
        f"{report.name}: i_d: i_d = 0 would lose {dear.without_d_current:.2%} ({dear.manoeuvre}),"
        f" bus voltage as an axis would save {report.bus_voltage_loss:.3%}"
    )
    return "\n".join(lines)


def _filled(proof: envelope.Proof) -> float:
    return max(
        proof.found.high / proof.allowed.high,
        proof.found.low / proof.allowed.low if proof.allowed.low < 0.0 else 0.0,
    )
