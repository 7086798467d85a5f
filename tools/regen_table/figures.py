# SPDX-License-Identifier: Apache-2.0
"""The figures of the paper, drawn for any configuration.

3, 4, 5, 11, 12 and 13 are here, those of the whole vehicle in figures_vehicle.
"""

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from regen_table import braking, figures_vehicle, ideal, models, plotting
from regen_table.models import Array
from regen_table.plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, RED
from regen_table.schema import Drive

POINTS = 400
SHARES = ((1.0, PURPLE), (2.0, GREEN), (3.5, BLUE), (5.0, RED))  # of a tenth of the top speed


def draw_all(drive: Drive, directory: Path) -> list[Path]:
    """Draw every figure into a directory, as <name>_figNN.svg and .png; returns the paths."""
    drawn = {
        3: power_over_current(drive),
        4: current_over_speed(drive),
        5: regions(drive),
        7: figures_vehicle.electric_share(drive),
        8: figures_vehicle.pedal(drive),
        10: figures_vehicle.energy_flow(drive),
        11: efficiency_map(drive),
        12: torque_ramp(drive),
        13: boundary_lines(drive),
        14: figures_vehicle.stored_share(drive),
    }
    return plotting.save(
        {f"{drive.name}_fig{number:02d}": made for number, made in drawn.items()}, directory
    )


def reference(drive: Drive) -> tuple[models.Machine, models.Bridge, float]:
    """Return motor and bridge at the reference temperature, and top speed (mechanical rad/s)."""
    return (
        models.machine(drive, drive.motor.reference_temperature_c),
        models.bridge(drive),
        drive.motor.max_speed_rpm * math.pi / 30.0,
    )


def rpm(speed_rad_s: Array) -> Array:
    """Mechanical rad/s to r/min."""
    return speed_rad_s * (30.0 / math.pi)


def power_over_current(drive: Drive) -> Figure:
    """Fig. 3: input power over braking current at fixed speeds.

    For a salient motor along the angle of least loss.
    """
    motor, inverter, top = reference(drive)
    made, (axes,) = plotting.figure(
        plotting.title(drive, 3, "Power over braking current at constant speed"), width=8.4
    )
    scale, unit = (1.0, "W") if ideal.salient(drive) else power_unit(drive)
    most = 0.35 * ideal.meeting_rad_s(drive, motor, inverter) if ideal.salient(drive) else 0.1 * top
    for factor, colour in (
        ((1.0, PURPLE), (1.6, GREEN), (2.2, BLUE), (2.8, RED)) if ideal.salient(drive) else SHARES
    ):
        speed = factor * most
        line = ideal.lines(drive, motor, inverter, speed)
        strongest = (
            float(np.nanmin([1.1 * line.zero_nm, 1.5 * drive.motor.max_torque_nm]))
            if ideal.salient(drive)
            else 1.07 * line.zero_nm
        )
        state = ideal.state(
            drive, motor, inverter, speed, np.linspace(-strongest, 0.0, _points(drive))
        )
        current = -state.current_a if ideal.salient(drive) else state.current_q_a
        braked = current <= 0.0  # no torque takes a little current, the iron's
        axes.plot(
            current[braked],
            state.dc_power_w[braked] / scale,
            color=colour,
            label=f"{float(rpm(np.array(speed))):.0f} r/min",
        )
        axes.plot(
            current[braked],
            state.motor_power_w[braked] / scale,
            color=colour,
            linestyle=":",
            linewidth=1.0,
        )
        if np.isfinite(line.optimal_nm):
            lowest = ideal.state(drive, motor, inverter, speed, -line.optimal_nm)
            axes.plot(
                -float(line.optimal_a),
                float(lowest.dc_power_w) / scale,
                "o",
                color=colour,
                markersize=5,
            )
        if line.zero_nm <= strongest:
            axes.plot(-float(line.zero_a), 0.0, "s", color=colour, markersize=4)
    axes.axhline(0.0, color="black", linewidth=0.8)
    what = (
        "phase current (peak) at the angle of least loss, braking, A"
        if ideal.salient(drive)
        else "q-axis current (peak phase), A"
    )
    axes.set(xlabel=what, ylabel=f"power taken from the bus, {unit}")
    axes.plot([], [], color="black", label="motor and inverter")
    axes.plot([], [], color="black", linestyle=":", linewidth=1.0, label="motor alone")
    axes.plot([], [], "o", color="black", markersize=5, label="most power returned")
    axes.plot([], [], "s", color="black", markersize=4, label="boundary to plugging")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=9)
    return made


def power_unit(drive: Drive) -> tuple[float, str]:
    """Return the divisor and the name of a readable unit of power."""
    return (1000.0, "kW") if drive.motor.max_power_w >= 10e3 else (1.0, "W")


def shown_speeds(drive: Drive) -> Array:
    """Mechanical speeds in rad/s for lines without limits.

    A salient motor's optimum runs away at a fraction of its top speed.
    """
    motor, inverter, top = reference(drive)
    last = (
        min(top, 2.5 * ideal.meeting_rad_s(drive, motor, inverter)) if ideal.salient(drive) else top
    )
    return np.linspace(1e-3 * last, last, _points(drive))


def _points(drive: Drive) -> int:
    """Fewer where every point is a search."""
    return 160 if ideal.salient(drive) else POINTS


def current_over_speed(drive: Drive) -> Figure:
    """Fig. 4: current of most returned power and of the boundary to plugging.

    With and without the paper's neglects.
    """
    motor, inverter, _ = reference(drive)
    speed = shown_speeds(drive)
    omega = speed * motor.pole_pairs
    line = ideal.lines(drive, motor, inverter, speed)
    neglecting = -omega * motor.flux_wb / (2.0 * motor.resistance_ohm)
    title = plotting.title(drive, 4, "Braking current over speed")
    made, (axes,) = plotting.figure(title, height=5.2)
    axes.plot(rpm(speed), -line.optimal_a, color=BLUE, label="most power returned")
    axes.plot(rpm(speed), -line.zero_a, color=RED, label="boundary to plugging")
    neglected = (
        "i_d = 0, no iron and inverter loss"
        if ideal.salient(drive)
        else "no iron and inverter loss"
    )
    axes.plot(
        rpm(speed),
        neglecting,
        color=BLUE,
        linestyle="--",
        linewidth=1.0,
        label=f"most power, {neglected}:\nthe paper's −ωψ/2R",
    )
    axes.plot(
        rpm(speed),
        2.0 * neglecting,
        color=RED,
        linestyle="--",
        linewidth=1.0,
        label=f"boundary, {neglected}:\nthe paper's −ωψ/R",
    )
    axes.axhline(
        -drive.motor.max_phase_current_a,
        color="black",
        linewidth=1.0,
        linestyle="-.",
        label="largest phase current of the drive",
    )
    what = (
        "phase current (peak) at the angle of least loss, A"
        if ideal.salient(drive)
        else "q-axis current (peak phase), A"
    )
    axes.set(xlabel="speed, r/min", ylabel=what, xlim=(0.0, float(rpm(speed[-1:])[0])))
    if ideal.salient(drive):
        axes.set_ylim(
            -2.0 * drive.motor.max_phase_current_a, 0.05 * drive.motor.max_phase_current_a
        )
    plotting.legend_below(made, axes, columns=2)
    return made


def regions(drive: Drive) -> Figure:
    """Fig. 5: best braking torque over speed, and the four regions of a braking demand."""
    motor, inverter, _ = reference(drive)
    speed = np.append(0.0, shown_speeds(drive))
    line = ideal.lines(drive, motor, inverter, speed)
    ceiling = 2.5 * drive.motor.max_torque_nm
    # Beyond all that is drawn where it is beyond the search.
    optimal, zero = (
        np.minimum(np.nan_to_num(torque, nan=np.inf), 1.01 * ceiling)
        for torque in (line.optimal_nm, line.zero_nm)
    )
    # The speed at which the limit comes before the optimum belongs to the areas on both its sides.
    beyond = optimal - braking.torque_limit_nm(drive, speed)
    last = int(np.argmax(beyond > 0.0)) - 1 if np.any(beyond > 0.0) else -1
    if last >= 0:
        share = beyond[last] / (beyond[last] - beyond[last + 1])
        speed, optimal, zero = (
            np.insert(values, last + 1, values[last] + share * (values[last + 1] - values[last]))
            for values in (speed, optimal, zero)
        )
    limit, top = braking.torque_limit_nm(drive, speed), float(speed[-1])
    limited = np.arange(speed.size) > (last if last >= 0 else speed.size)
    free = np.arange(speed.size) <= (last + 1 if last >= 0 else speed.size)
    capability = np.minimum(optimal, limit)
    x, below = rpm(speed), np.minimum(zero, ceiling)
    made, (axes,) = plotting.figure(
        plotting.title(drive, 5, "Best braking torque and the regions of a demand"), height=5.2
    )
    for lower, upper, where, colour, alpha in (
        (0.0 * x, capability, free | limited, GREEN, 0.18),
        (capability, below, free, ORANGE, 0.20),
        (capability, below, limited, PURPLE, 0.15),
        (below, 0.0 * x + ceiling, free | limited, RED, 0.18),
    ):
        axes.fill_between(x, lower, upper, where=where, color=colour, alpha=alpha, linewidth=0)
    axes.plot(x, zero, color=RED, linewidth=1.2, label="T_zero: no power flows")
    axes.plot(x, optimal, color=BLUE, linewidth=1.2, linestyle="--", label="T_opt without limits")
    axes.plot(
        x, capability, color=BLUE, linewidth=2.2, label="T_opt inside torque and power limits"
    )
    meeting = float(speed[last + 1]) if last >= 0 else top
    labels = [("III", 0.55 * top, 0.5 * float(np.interp(0.55 * top, speed, capability)))]
    if meeting < 0.95 * top:
        middle = 0.5 * (meeting + top)
        edges = [float(np.interp(middle, speed, edge)) for edge in (limit, below)]
        labels.append(("IV", middle, 0.5 * sum(edges)))
    at = 0.72 * meeting
    edges = [float(np.interp(at, speed, edge)) for edge in (optimal, below)]
    labels += [("II", at, 0.5 * sum(edges)), ("I", 0.35 * meeting, 0.75 * ceiling)]
    for name, speed_rad_s, height in labels:
        at_rpm = float(rpm(np.array(speed_rad_s)))
        axes.text(at_rpm, height, name, fontsize=14, ha="center", va="center")
    axes.set(
        xlabel="speed, r/min", ylabel="braking torque, N·m", xlim=(0.0, x[-1]), ylim=(0.0, ceiling)
    )
    plotting.legend_below(made, axes, columns=2)
    axes.text(0.99, 0.02, "III motor alone · II, I motor gives T_opt, brake the rest · "
              "IV limited motor and brake",
              transform=axes.transAxes, ha="right", fontsize=8)  # fmt: skip
    return made


def efficiency_map(drive: Drive) -> Figure:
    """Fig. 11: share of the braking power at the shaft that reaches the bus."""
    motor, inverter, top = reference(drive)
    # Down to standstill in equal ratios, and through the corner of the torque and power limits; the
    # torques follow the limit, so that the picture's edge is the hyperbola itself.
    corner = drive.motor.max_power_w / drive.motor.max_torque_nm
    speed = np.unique(
        np.concatenate(
            [
                np.geomspace(2e-3 * top, top, 160),
                np.linspace(0.01, 1.0, 200) * top,
                [min(corner, top)],
            ]
        )
    )
    share = np.unique(np.concatenate([np.geomspace(2e-3, 1.0, 100), np.linspace(0.01, 1.0, 150)]))
    torque = share[:, np.newaxis] * braking.torque_limit_nm(drive, speed)
    ways = ideal.production(drive)
    state = ways.state(motor, inverter, speed, -torque)
    friction = state.loss_friction_w
    efficiency = -state.dc_power_w / (torque * speed + friction)
    shown = 100.0 * efficiency
    text = "Efficiency of regenerative braking, motor and inverter, per cent"
    made, (axes,) = plotting.figure(plotting.title(drive, 11, text))
    axes.grid(visible=False)
    x, y = np.broadcast_arrays(rpm(speed), torque)
    filled = axes.contourf(x, y, shown, levels=np.arange(0.0, 101.0, 5.0), cmap="viridis")
    lines = axes.contour(
        x,
        y,
        shown,
        levels=[20.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0, 90.0, 93.0, 95.0],
        colors="white",
        linewidths=0.8,
    )
    axes.clabel(lines, fmt="%g", fontsize=8)
    best = ways.capability_nm(drive, motor, inverter, speed)
    axes.plot(rpm(speed), best, color=RED, linewidth=2.0, label="best torque, inside the limits")
    axes.set(
        xlabel="speed, r/min",
        ylabel="braking torque, N·m",
        ylim=(0.0, drive.motor.max_torque_nm),
        xlim=(0.0, float(rpm(np.array(top)))),
    )
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=9)
    made.colorbar(filled, ax=axes, label="efficiency, %", ticks=np.arange(0.0, 101.0, 20.0))
    return made


def torque_ramp(drive: Drive) -> Figure:
    """Fig. 12: a slow ramp of braking torque at constant speed.

    The bus current returns to zero and turns positive.
    """
    motor, inverter, top = reference(drive)
    # The paper ran it at 150 of 640 r/min; a salient motor returns power at any torque there.
    speed = (
        0.7 * ideal.meeting_rad_s(drive, motor, inverter)
        if ideal.salient(drive)
        else top * 150.0 / 640.0
    )
    line = ideal.lines(drive, motor, inverter, speed)
    optimal, zero = -float(line.optimal_nm), -float(line.zero_nm)
    time = np.linspace(0.0, 10.0, _points(drive))
    torque = 1.15 * zero * time / time[-1]
    state = ideal.state(drive, motor, inverter, speed, torque)
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    pack = models.battery_steady(models.open_circuit_voltage_v(drive), resistance, state.dc_power_w)
    text = f"Ramp of braking torque at {float(rpm(np.array(speed))):.0f} r/min, limits left out"
    made, (upper, lower) = plotting.figure(
        plotting.title(drive, 12, text),
        rows=2,
        height=5.2,
    )
    upper.plot(time, torque, color=RED)
    upper.set(ylabel="torque, N·m")
    lower.plot(time, pack.current_a, color=BLUE)
    lower.axhline(0.0, color="black", linewidth=0.8)
    for value, text in ((optimal, "T_opt"), (zero, "T_zero")):
        at = time[-1] * value / torque[-1]
        upper.plot(at, value, "o", color=RED)
        upper.annotate(
            f"{text} = −{abs(value):.4g} N·m",
            (at, value),
            textcoords="offset points",
            xytext=(-8, -14),
            ha="right",
        )
        label = "T_opt and T_zero" if text == "T_opt" else None
        lower.axvline(at, color=GREY, linestyle=":", linewidth=1.0, label=label)
    lower.set(xlabel="time, s", ylabel="battery current of one motor, A")
    lower.set_title("below zero, current flows into the battery", fontsize=9)
    lower.legend(loc="upper center", fontsize=9)
    return made


def boundary_lines(drive: Drive) -> Figure:
    """Fig. 13: T_zero and T_opt over speed at three temperatures, with the paper's (20), (21)."""
    _, inverter, _ = reference(drive)
    speed = shown_speeds(drive)
    made, axes_pair = plotting.figure(
        plotting.title(drive, 13, "Lines of most power and of no power"), columns=2, width=9.5
    )
    temperatures = (drive.motor.reference_temperature_c, 75.0, 120.0)
    for axes, title in zip(
        axes_pair, ("T_opt: most power returned", "T_zero: no power flows"), strict=True
    ):
        for temperature, colour in zip(temperatures, (BLUE, ORANGE, RED), strict=True):
            motor = models.machine(drive, temperature)
            line = ideal.lines(drive, motor, inverter, speed)
            exact = line.optimal_nm if "T_opt" in title else line.zero_nm
            axes.plot(rpm(speed), exact, color=colour, label=f"winding at {temperature:g} °C")
        motor = models.machine(drive, temperatures[0])
        paper = (
            braking.paper_optimum_nm(motor, speed)
            if "T_opt" in title
            else braking.paper_zero_nm(motor, speed)
        )
        axes.plot(rpm(speed), paper, color="black", linestyle="--", linewidth=1.2,
                  label=f"paper's (21) and (20), {temperatures[0]:g} °C")  # fmt: skip
        axes.set(title=title, xlabel="speed, r/min", xlim=(0.0, float(rpm(speed[-1:])[0])))
        axes.set_ylim(0.0, 3.0 * drive.motor.max_torque_nm if ideal.salient(drive) else None)
    axes_pair[0].set_ylabel("braking torque, N·m")
    plotting.legend_below(made, axes_pair[0], columns=4)
    return made
