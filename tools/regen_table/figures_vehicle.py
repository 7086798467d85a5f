# SPDX-License-Identifier: Apache-2.0
"""The figures of the paper that need the whole vehicle: 7, 8, 10 and 14."""

import math
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline

from regen_table import STRATEGIES, braking, ideal, ideal_cycles, models, plotting
from regen_table.plotting import BLUE, GREEN, GREY, ORANGE, RED, STRATEGY_COLOURS, STRATEGY_NAMES
from regen_table.schema import Drive

# the paper drives the urban cycle slowed by 60/80: a car of 80 km/h would drive it as it is
URBAN_CYCLE_TOP_KMH = 80.0


def _reference(drive: Drive) -> tuple[models.Machine, models.Bridge, float]:
    return (
        models.machine(drive, drive.motor.reference_temperature_c),
        models.bridge(drive),
        drive.motor.max_speed_rpm * math.pi / 30.0,
    )


def electric_share(drive: Drive) -> Figure:
    """Fig. 7: electric braking torque of the three strategies over speed and demand."""
    motor, inverter, top = _reference(drive)
    most = drive.motor.max_torque_nm
    corner = drive.motor.max_power_w / most  # where the power limit takes over
    speed = np.unique(np.append(np.linspace(1e-3 * top, top, 400), min(corner, top)))
    demand = np.unique(np.append(np.linspace(0.0, 3.0 * most, 301), most))[:, np.newaxis]
    capability = ideal.production(drive).capability_nm(drive, motor, inverter, speed)
    made, panels = plotting.figure(
        plotting.title(drive, 7, "Electric braking torque, N·m"), columns=3, width=11.0, height=4.6
    )
    bands = np.linspace(0.0, most, 41)
    drawn, edge, reached = [], 0.999 * most, False
    for axes, strategy in zip(panels, STRATEGIES, strict=True):
        electric = braking.electric_torque_nm(drive, strategy, demand, speed, capability)
        x, y, z = np.broadcast_arrays(speed * 30.0 / math.pi, demand, electric)
        drawn.append(axes.contourf(x, y, z, levels=bands, cmap="Blues"))
        axes.contour(x, y, z, levels=bands[4:-1:4], colors="white", linewidths=0.5)
        if np.max(z) > edge:
            reached = True
            axes.contour(x, y, z, levels=[edge], colors=ORANGE, linewidths=1.6)
        axes.grid(visible=False)
        axes.xaxis.set_major_locator(plotting.ticks(8))
        axes.yaxis.set_major_locator(plotting.ticks(7))
        axes.set(title=STRATEGY_NAMES[strategy], xlabel="speed, r/min")
    if reached:
        label = f"the motor's full {most:g} N·m inside"
        panels[0].plot([], [], color=ORANGE, linewidth=1.6, label=label)
    panels[0].plot([], [], color="#9db7d5", linewidth=0.8, label=f"every {most / 10.0:g} N·m")
    plotting.legend_below(made, panels[0], columns=2)
    panels[0].set_ylabel("braking demand at the wheel, N·m")
    made.colorbar(
        drawn[0], ax=panels, label="electric torque, N·m", ticks=np.linspace(0.0, most, 11)
    )
    return made


def pedal(drive: Drive) -> Figure:
    """Fig. 8: how the pedal is shared; for the series strategy it depends on speed."""
    motor, inverter, top = _reference(drive)
    full = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    meeting = ideal.meeting_rad_s(drive, motor, inverter)
    travel = np.linspace(0.0, 1.0, 301)
    demand = travel * full
    made, panels = plotting.figure(
        plotting.title(drive, 8, "What the brake pedal means for motor and mechanical brake"),
        columns=3,
        width=11.0,
        height=4.2,
    )
    for axes, strategy in zip(panels, STRATEGIES, strict=True):
        # Twice where the optimum decides, and once where the limits do.
        speeds = (
            (0.4 * meeting, 0.8 * meeting, 0.9 * top)
            if strategy == "series_optimal"
            else (0.5 * top,)
        )
        for speed, style in zip(speeds, ("-", "--", ":"), strict=False):
            capability = ideal.production(drive).capability_nm(
                drive, motor, inverter, np.array([speed])
            )
            electric = braking.electric_torque_nm(drive, strategy, demand, speed, capability)
            at = f" at {speed * 30.0 / math.pi:.0f} r/min" if len(speeds) > 1 else ""
            axes.plot(100.0 * travel, electric, color=BLUE, linestyle=style, label=f"motor{at}")
            axes.plot(
                100.0 * travel,
                demand - electric,
                color=RED,
                linestyle=style,
                label=f"mechanical{at}",
            )
        axes.plot(100.0 * travel, demand, color="black", linewidth=0.9, label="demand")
        axes.set(
            title=STRATEGY_NAMES[strategy],
            xlabel="brake pedal, %",
            xlim=(0.0, 100.0),
            ylim=(0.0, full),
        )
        axes.legend(loc="upper left", fontsize=8 if len(speeds) > 1 else 9)
    panels[0].set_ylabel("braking torque at one wheel, N·m")
    return made


def stored_share(drive: Drive) -> Figure:
    """Fig. 14: share of the kinetic energy that a stop stores, over the demand."""
    top_kmh = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    initial = min(40.0, 2.0 / 3.0 * top_kmh)
    # Curves have knees where a motor's share reaches its limit: those demands are among the points.
    knees = [drive.motor.max_torque_nm, drive.brake.electric_rated_torque_nm]
    if drive.brake.parallel_electric_share > 0.0:
        knees.append(drive.motor.max_torque_nm / drive.brake.parallel_electric_share)
    lowest, highest = 0.05 * drive.motor.max_torque_nm, 5.0 * drive.motor.max_torque_nm
    demands = np.unique(
        [*np.geomspace(lowest, highest, 60), *(k for k in knees if lowest <= k <= highest)]
    )
    made, (axes,) = plotting.figure(
        plotting.title(drive, 14, f"Kinetic energy stored by a stop from {initial:.3g} km/h")
    )
    for strategy in STRATEGIES:
        stored = [
            100.0
            * ideal.stop(
                drive,
                strategy,
                float(demand),
                initial,
                drive.motor.reference_temperature_c,
                drive.battery.initial_soc,
            ).stored_share_of_kinetic
            for demand in demands
        ]
        axes.plot(
            demands,
            stored,
            color=STRATEGY_COLOURS[strategy],
            linewidth=2.0,
            label=STRATEGY_NAMES[strategy],
        )
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set(
        xlabel="braking demand at each driven wheel, N·m",
        ylabel="stored, % of kinetic energy",
        xlim=(0.0, float(demands[-1])),
        ylim=(-20.0, 100.0),
    )
    axes.xaxis.set_major_locator(plotting.ticks(10))
    axes.legend(loc="upper right")
    return made


def energy_flow(drive: Drive) -> Figure:
    """Fig. 10: where the energy of the urban cycle goes under the three strategies."""
    top_kmh = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    trace = ideal_cycles.load(ideal_cycles.DIRECTORY / "ece15.csv")
    factor = min(1.0, top_kmh / URBAN_CYCLE_TOP_KMH)
    trace = replace(trace, speed_m_s=trace.speed_m_s * factor)
    text = f"Energy flow over the urban cycle (ECE-15, speeds × {factor:.2f})"
    title = plotting.title(drive, 10, text)
    made, panels = plotting.figure(title, rows=3, width=10.5, height=9.5)
    for axes, strategy in zip(panels, STRATEGIES, strict=True):
        result = ideal_cycles.run(
            drive,
            trace,
            strategy,
            drive.motor.reference_temperature_c,
            drive.battery.initial_soc,
            ideal.production(drive),
        )
        axes.set_title(
            f"{STRATEGY_NAMES[strategy]}: {result.braking_share_stored:.1%} of the braking work"
            " stored",
            loc="left",
        )
        _flow(axes, result)
    return made


def _flow(axes: Axes, result: ideal_cycles.CycleResult) -> None:
    """Draw one flow from left to right: the band is what is left, what leaves it bends up."""
    out, back = result.while_driving_j, result.while_braking_j
    exits = [
        ("battery", out.battery, GREY),
        ("inverter", out.inverter, GREY),
        ("copper", out.copper, ORANGE),
        ("iron", out.iron, ORANGE),
    ]
    exits += [
        ("bearings", out.friction + back.friction, GREY),
        ("drag", result.energy_j.drag, GREEN),
        ("mechanical\nbrake", back.hydraulic, RED),
    ]
    exits += [
        ("iron", back.iron, ORANGE),
        ("copper", back.copper, ORANGE),
        ("inverter", back.inverter, GREY),
        ("battery", back.battery, GREY),
    ]
    total, returned = result.energy_j.traction, result.energy_j.battery_returned
    level, x = total, 0.0
    axes.axis("off")
    axes.text(-0.2, level / 2.0, f"from the cells\n{total / 1e3:.3g} kJ", ha="right", va="center")
    for name, energy, colour in [(n, e, c) for n, e, c in exits if e > 1e-3 * total]:
        below = level - energy
        axes.add_patch(Rectangle((x, 0.0), 1.0, below, facecolor=BLUE, edgecolor="none"))
        axes.add_patch(_leaving(x, below, energy, total, colour))
        axes.text(
            x + 0.75,
            1.25 * total,
            f"{name}\n{energy / total:.1%}",
            ha="center",
            va="bottom",
            fontsize=8.5,
        )
        level, x = below, x + 1.0
    axes.add_patch(Rectangle((x, 0.0), 0.6, max(level, 0.0), facecolor=BLUE, edgecolor="none"))
    axes.text(
        x + 0.75,
        level / 2.0,
        f"back into the cells\n{returned / 1e3:.3g} kJ, {returned / total:.1%}",
        ha="left",
        va="center",
    )
    axes.set(xlim=(-1.8, 13.5), ylim=(-0.02 * total, 1.62 * total))


def _leaving(x: float, below: float, energy: float, total: float, colour: str) -> PathPatch:
    """Make the top slice of the band at x bend up and out at the top.

    Its width there shows its share.
    """
    half = 0.45 * max(energy / total, 0.01)
    end, top, middle = x + 0.75, 1.2 * total, 0.5 * (below + 1.2 * total)
    curve = [
        (x, below), (x + 0.5, below), (end + half, below), (end + half, middle), (end + half, top),
        (end - half, top), (end - half, middle + energy), (end - half, below + energy),
        (x + 0.3, below + energy), (x, below + energy), (x, below),
    ]  # fmt: skip
    codes = [
        Outline.MOVETO,
        *[Outline.CURVE4] * 3,
        Outline.LINETO,
        Outline.LINETO,
        Outline.LINETO,
        *[Outline.CURVE4] * 3,
        Outline.CLOSEPOLY,
    ]
    return PathPatch(Outline(curve, codes), facecolor=colour, edgecolor="none")
