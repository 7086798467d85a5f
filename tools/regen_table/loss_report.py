# SPDX-License-Identifier: Apache-2.0
"""A loss fit as text, as JSON, as lines of a drive's TOML file and as a picture."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from regen_table import loss_fit, loss_model, models, plotting
from regen_table.errors import ConfigurationError
from regen_table.loss_fit import Fit
from regen_table.loss_model import BEND, CONSTANT, COPPER, GROWTH, INVERTER, NAMES, SLOPE
from regen_table.measured import RPM
from regen_table.models import Array
from regen_table.schema import Drive

UNITS = ("W/(N m)^2", "W/(N m)", "N m", "N m s", "s", "W/(N m)^4")
MEANINGS = (
    "winding and switches, by the square of the torque",
    "switching and diodes, by the torque",
    "hysteresis and Coulomb friction",
    "eddy currents and viscous friction, at low speed",
    "the drag's slope falls by 1 + bend x speed",
    "saturation or heating, by the fourth power of the torque",
)
MOST_LINES = 12  # speeds of the picture


def residual_shares(found: Fit) -> Array:
    """Return the residuals as shares of the measured losses."""
    return found.residual_w / found.points.loss_w


def residual_shaft_shares(found: Fit) -> Array:
    """Return the residuals as shares of the shaft power, without the points that have none."""
    power = found.points.shaft_power_w
    return np.asarray(found.residual_w[power != 0.0] / power[power != 0.0])


def record(found: Fit) -> dict[str, Any]:
    """Return everything that was found, for JSON."""
    points = found.points
    by_current = found.torque_per_ampere
    return {
        "points": len(points),
        "driving": int(np.sum(points.torque_nm > 0.0)),
        "braking": int(np.sum(points.torque_nm < 0.0)),
        "speed_range_rpm": [float(v) / RPM for v in _range(points.speed_rad_s)],
        "torque_range_nm": list(_range(points.torque_nm)),
        "parameters": {
            NAMES[k]: {
                "value": found.value(k),
                "standard_deviation": float(found.deviations[k]),
                "unit": UNITS[k],
                "meaning": MEANINGS[k],
            }
            for k in found.fitted
        },
        "torque_per_ampere": None if by_current is None else asdict(by_current),
        "scatter_share_of_loss": found.scatter,
        "residual_of_loss": _quantiles(residual_shares(found)),
        "residual_of_shaft_power": _quantiles(residual_shaft_shares(found)),
        "winding_temperature_known": found.temperature_known,
        "best_braking": [asdict(best) for best in _optima(found)],
        "cannot_tell": [asdict(point) for point in found.cannot_tell],
        "rows": [
            {
                "speed_rpm": float(speed) / RPM,
                "torque_nm": float(torque),
                "loss_w": float(loss),
                "residual_w": float(left),
            }
            for speed, torque, loss, left in zip(
                points.speed_rad_s, points.torque_nm, points.loss_w, found.residual_w, strict=True
            )
        ],
    }


def _quantiles(shares: Array) -> dict[str, float] | None:
    """Return median and 90th percentile of magnitudes; None without any."""
    if len(shares) == 0:
        return None
    median, most = np.percentile(np.abs(shares), (50.0, 90.0))
    return {"median": float(median), "90th_percentile": float(most)}


def _range(values: Array) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))


def _speeds_rpm(found: Fit) -> Array:
    """Return the measured speeds, at most so many as the picture shows."""
    speeds = np.unique(np.round(found.points.speed_rad_s / RPM, 3))
    chosen = np.unique(np.linspace(0, len(speeds) - 1, min(len(speeds), MOST_LINES)).round())
    return np.asarray(speeds[chosen.astype(np.int64)])


def _optima(found: Fit) -> list[loss_fit.Best]:
    if found.value(COPPER) == 0.0:
        return []
    return [loss_fit.best_braking(found, float(speed)) for speed in _speeds_rpm(found)]


def text(found: Fit) -> str:
    """Return what was found, for people."""
    points = found.points
    low, high = (value / RPM for value in _range(points.speed_rad_s))
    least, most = _range(points.torque_nm)
    lines = [
        f"{len(points)} points, {low:.4g} to {high:.4g} r/min, {least:.4g} to {most:.4g} N m",
        *(
            f"residual of the {what}: {found_shares['median']:.2%} median,"
            f" {found_shares['90th_percentile']:.2%} 90th percentile"
            for what, shares in (
                ("loss", residual_shares(found)),
                ("shaft power", residual_shaft_shares(found)),
            )
            if (found_shares := _quantiles(shares)) is not None
        ),
    ]
    lines += [
        f"{NAMES[k]:24} {found.value(k):10.4g} +- {found.deviations[k]:<9.2g} {UNITS[k]:10}"
        f" {MEANINGS[k]}"
        for k in found.fitted
    ]
    by_current = found.torque_per_ampere
    if by_current is not None:
        factor, fall = by_current.deviations
        lines += [
            f"{'torque_per_ampere':24} {by_current.factor_nm_per_a:10.4g} +- {factor:<9.2g} N m/A",
            f"{'torque_fall':24} {by_current.fall_per_a2:10.4g} +- {fall:<9.2g} 1/A^2",
        ]
    lines += [
        f"best braking at {best.speed_rpm:.4g} r/min: {best.torque_nm:.4g} +-"
        f" {best.torque_deviation_nm:.2g} N m, {best.power_w:.4g} W"
        + ("" if best.torque_nm <= max(-least, most) else ", beyond the torques measured")
        for best in _optima(found)
    ]
    return "\n".join([*lines, *(f"cannot tell: {point.text}" for point in found.cannot_tell)])


def toml(found: Fit, drive: Drive) -> str:
    """Return the keys of [motor] and [inverter] that the data hold, deviations as comments.

    The drive supplies pole pairs and, without measured currents, the flux linkage; of its inverter
    what cannot be told from the fit: switches, diodes, dead time.
    """
    pairs, by_current = drive.motor.pole_pairs, found.torque_per_ampere
    flux = drive.motor.flux_linkage_wb
    motor, inverter = [], []
    if by_current is not None:
        flux = by_current.factor_nm_per_a / (1.5 * pairs)
        motor.append(
            _line("flux_linkage_wb", flux, by_current.deviations[0] / (1.5 * pairs), "peak phase")
        )
    per_ampere = 1.5 * pairs * flux  # N m/A
    if COPPER in found.fitted:
        switches = models.bridge(drive).square_w_per_a2 / 1.5
        scale = per_ampere**2 / 1.5
        copper, deviation, at = _copper(found)
        resistance = copper * scale - switches
        if resistance <= 0.0:
            raise ConfigurationError(
                f"inverter.switch_resistance_ohm: {drive.inverter.switch_resistance_ohm:g} ohm is"
                " more than all that the fit has for winding and switches, accepted: less than"
                f" {copper * scale:.3g} ohm"
            )
        how = (
            "at reference_temperature_c"
            if found.temperature_known
            else "at the unknown winding temperature of the measurement"
        )
        note = f"{how}{at}, less the file's switches"
        motor.append(_line("phase_resistance_ohm", resistance, deviation * scale, note))
    motor += _drag_lines(found, per_ampere, pairs)
    if INVERTER in found.fitted:
        inverter = _switching_lines(found, drive, per_ampere)
    comments = [f"# cannot tell: {point.text}" for point in found.cannot_tell]
    sections = [["[motor]", *motor], ["[inverter]", *inverter] if inverter else []]
    return "\n\n".join("\n".join(part) for part in (comments, *sections) if part) + "\n"


def _copper(found: Fit) -> tuple[float, float, str]:
    """Return the copper loss over the torque's square with its deviation, and where it holds.

    There is no key of a loss that grows faster: the largest torque measured counts, where the
    currents are that an optimum beyond them would need.
    """
    if GROWTH not in found.fitted:
        return found.value(COPPER), float(found.deviations[COPPER]), ""
    torque = float(np.max(np.abs(found.points.torque_nm)))
    gradient = np.zeros(len(NAMES))
    gradient[COPPER], gradient[GROWTH] = 1.0, torque**2
    deviation = math.sqrt(float(gradient @ found.covariance @ gradient))
    copper = float(gradient @ found.values)
    at = f", at {torque:.4g} N m ({found.value(COPPER) / copper:.0%} of it at small torques)"
    return copper, deviation, at


def _line(key: str, value: float, deviation: float, note: str) -> str:
    return f"# {note}\n{key} = {value:.5g}  # +- {deviation:.2g}"


def _drag_lines(found: Fit, per_ampere: float, pairs: int) -> list[str]:
    """Return iron loss and friction: slope / (1 + bend Omega) = per_ampere^2/1.5 / (a0 + a1 omega).

    The friction takes the constant part, and the viscous one nothing.
    """
    lines = []
    slope, bend = found.value(SLOPE), found.value(BEND)
    if SLOPE in found.fitted and slope > 0.0:
        a0 = per_ampere**2 / 1.5 / slope
        a1 = a0 * bend / pairs
        a0_deviation = a0 * found.deviations[SLOPE] / slope
        gradient = np.zeros(len(NAMES))
        gradient[SLOPE], gradient[BEND] = -a1 / slope, a0 / pairs
        a1_deviation = math.sqrt(max(float(gradient @ found.covariance @ gradient), 0.0))
        lines.append(
            "# contains viscous friction\n"
            f"iron_loss_resistance_ohm = [{a0:.5g}, {a1:.5g}]"
            f"  # +- {a0_deviation:.2g}, {a1_deviation:.2g}"
        )
    if CONSTANT in found.fitted:
        lines.append(
            _line(
                "friction_torque_nm",
                found.value(CONSTANT),
                float(found.deviations[CONSTANT]),
                "contains hysteresis",
            )
        )
    lines.append("viscous_friction_nm_s = 0.0  # contained in iron_loss_resistance_ohm")
    return lines


def _switching_lines(found: Fit, drive: Drive, per_ampere: float) -> list[str]:
    """Return the switching losses: the part by current less what the file's diodes take of it."""
    bridge = drive.inverter
    per_joule = 3.0 * bridge.pwm_frequency_hz / math.pi  # of k_on + k_off
    dead_share = 2.0 * bridge.dead_time_s * bridge.pwm_frequency_hz
    diodes = 6.0 / math.pi * bridge.diode_forward_voltage_v * dead_share
    each = max(found.value(INVERTER) * per_ampere - diodes, 0.0) / per_joule / 2.0
    deviation = float(found.deviations[INVERTER]) * per_ampere / per_joule / 2.0
    note = "both alike; less the file's diodes"
    return [
        _line("turn_on_loss_j_per_a", each, deviation, note),
        _line("turn_off_loss_j_per_a", each, deviation, note),
    ]


def figure(found: Fit, title: str) -> Figure:
    """Draw losses and model, residuals, and the best braking torque or the drag."""
    made, (losses, left, best) = plotting.figure(title, 3, width=13.0, height=4.6)
    points = found.points
    rpm = points.speed_rad_s / RPM
    speeds = _speeds_rpm(found)
    colours = plotting.speed_colours(len(speeds))
    shares = 100.0 * residual_shares(found)
    with_torque = bool(np.any(points.torque_nm != 0.0))
    for speed, colour in zip(speeds, colours, strict=True):
        here = np.abs(rpm - speed) < 0.5e-2
        if with_torque:
            torque = np.linspace(*_range(points.torque_nm[here]), 200)
            losses.plot(points.torque_nm[here], points.loss_w[here], ".", color=colour)
            fitted = loss_fit.loss_w(found, np.array(RPM * speed), torque)
            losses.plot(torque, fitted, color=colour, linewidth=1.0, label=f"{speed:.4g} r/min")
            left.plot(points.torque_nm[here], shares[here], ".", color=colour)
    if with_torque:
        losses.set(
            xlabel="shaft torque, N m", ylabel="loss, W", title="points measured, lines fitted"
        )
        left.set(xlabel="shaft torque, N m", ylabel="measured less fitted, % of the loss")
        losses.legend(fontsize=7)
    else:
        order = np.argsort(rpm)
        losses.plot(rpm, points.loss_w, ".", color=plotting.BLUE, label="measured")
        losses.plot(
            rpm[order],
            (points.loss_w - found.residual_w)[order],
            color=plotting.ORANGE,
            label="fit",
        )
        losses.set(xlabel="r/min", ylabel="loss, W", title="loss without load")
        losses.legend(fontsize=8)
        left.plot(rpm, shares, ".", color=plotting.BLUE)
        left.set(xlabel="r/min", ylabel="measured less fitted, % of the loss")
    left.set_ylim(*_readable(shares))
    left.set_title("residuals" + _outside(shares))
    _draw_third(found, best, speeds)
    return made


def _readable(shares: Array) -> tuple[float, float]:
    """Return limits that hold 95 % of the residuals, so that single ones do not hide the others."""
    most = 1.2 * max(float(np.percentile(np.abs(shares), 95.0)), 1e-9)
    return -most, most


def _outside(shares: Array) -> str:
    count = int(np.sum(np.abs(shares) > _readable(shares)[1]))
    return f" ({count} beyond the picture)" if count else ""


def _draw_third(found: Fit, axes: Any, speeds: Array) -> None:  # noqa: ANN401, matplotlib's
    """Draw the best braking torque, or the drag where no copper loss is known."""
    grid = np.linspace(float(speeds[0]), float(speeds[-1]), 24)
    if found.value(COPPER) == 0.0:
        axes.plot(grid, loss_model.drag_nm(found.values, RPM * grid), color=plotting.BLUE)
        axes.set(xlabel="r/min", ylabel="N m", title="drag of iron and friction")
        return
    optima = [loss_fit.best_braking(found, float(speed)) for speed in grid]
    torque = np.array([best.torque_nm for best in optima])
    deviation = np.array([best.torque_deviation_nm for best in optima])
    axes.fill_between(grid, torque - deviation, torque + deviation, color=plotting.BLUE, alpha=0.2)
    axes.plot(grid, torque, color=plotting.BLUE, label="best braking, one standard deviation")
    largest = float(np.max(np.abs(found.points.torque_nm)))
    axes.axhline(largest, color=plotting.GREY, linewidth=0.8, label="largest torque measured")
    axes.set(xlabel="r/min", ylabel="shaft torque, N m", title="torque that returns the most power")
    axes.set_ylim(0.0, 2.0 * largest)
    axes.legend(fontsize=8)
