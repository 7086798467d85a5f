# SPDX-License-Identifier: Apache-2.0
"""What is missing of the demand where the motor must give up its torque at once.

The charge limit falls to zero without a limit for a short time, or the contactor opens, in a stop
at three demands with every drive that comes along. Beside each measured dip of both brakes
together the one that follows from what the motor may keep and how fast the hydraulic brake can
come. One wheel with its share of mass and battery stands for the vehicle (stops). Exit status 1 if
a dip is larger or longer than the derived one.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from hubsim import run
from hubsim.engine import Rows
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep.drives import drive_named
from matplotlib.figure import Figure
from regen_table import models, plotting, stop_limits
from regen_table.schema import Drive
from studies import least_torque
from studies.common import Study, add_drives, markdown, percent

DEMAND_SHARES = (0.33, 1.0, 2.0)  # of the rated torque
SPEED_SHARE = 0.6  # of the largest speed
NO_CHARGING, CONTACTOR = "charge limit to zero", "contactor opens"
EVENTS = {
    NO_CHARGING: ("battery.max_charge_current_a", 0.0),
    CONTACTOR: ("bus.contactor_open", 1.0),
}
AT_S, AFTER_S = 0.8, 0.6
RECORD_S = 0.001
MEAN_ROWS = 5
OVER_SHARE = 0.1  # a dip is over where less of the demand is missing
WINDING_C = 25.0
POINTS = 240
TOLERANCE = 0.025  # of the demand: means of MEAN_ROWS, and a bus that is filled in less
LATER_S = 0.01
SIGNALS = (
    "driver.brake_nm",
    "vehicle.speed_m_per_s",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "bus.voltage_v",
)


@dataclass(frozen=True)
class Dip:
    """Largest missing share of the demand, and for how long more than OVER_SHARE is missing."""

    share: float
    seconds: float


@dataclass(frozen=True)
class Case:
    """One event in one stop; ``demand_share`` of the rated torque."""

    drive: str
    event: str
    demand_share: float


@dataclass(frozen=True)
class Outcome:
    """A measured dip beside the derived one: largest missing share, and for how long.

    ``kept_nm``: what the motor may keep.
    """

    number: int
    drive: str
    event: str
    demand_nm: float
    measured_share: float
    measured_s: float
    derived_share: float
    derived_s: float
    kept_nm: float

    @property
    def within(self) -> bool:
        """Whether the dip is no more than physics leaves."""
        return (
            self.measured_share <= self.derived_share + TOLERANCE
            and self.measured_s <= self.derived_s + LATER_S
        )


def lossy_braking_nm(drive: Drive, speed_rad_s: float, bus_v: float) -> float:
    """Return the largest braking torque (airgap, N m) that returns nothing: loss braking.

    Over all currents inside the phase current and the voltage; the model of ``regen_table``.
    """
    machine = models.machine(drive, WINDING_C)
    omega = np.array(machine.pole_pairs * speed_rad_s)
    voltage = float(stop_limits.largest_voltage_v(drive, omega, np.array(bus_v)))
    amperes = drive.motor.max_phase_current_a * np.linspace(0.0, 1.0, POINTS // 4)[:, np.newaxis]
    angle = np.linspace(0.5 * math.pi, 1.5 * math.pi, POINTS)
    state = models.evaluate(
        machine, models.bridge(drive), omega, amperes * np.cos(angle), amperes * np.sin(angle)
    )
    possible = (state.dc_power_w >= 0.0) & (state.voltage_v <= voltage)
    return float(np.max(-state.torque_nm, where=possible, initial=0.0))


def derived(
    drive: Drive, demand_nm: float, motor_nm: float, kept_nm: float, rate_nm_per_s: float
) -> Dip:
    """Return the dip where the motor falls from ``motor_nm`` to what it may keep at this rate.

    The hydraulic brake, which made the rest, is commanded what will be missing at the same instant
    and follows after its dead time with its lag:

        M(t) = max(kept, motor - rate t),  H(t) = demand - motor + (motor - kept) (1 - e^-(t - d)/l)
    """
    kept = min(kept_nm, motor_nm)
    t = np.arange(0.0, AFTER_S, 1e-4)
    late = np.maximum(t - drive.brake.hydraulic_dead_time_s, 0.0)
    come = -np.expm1(-late / drive.brake.hydraulic_time_constant_s)
    total = np.maximum(kept, motor_nm - rate_nm_per_s * t) + (motor_nm - kept) * come
    missing = (motor_nm - total) / demand_nm
    return Dip(float(np.max(missing)), float(np.sum(missing > OVER_SHARE)) * 1e-4)


def measure(number: int, case: Case) -> Outcome:
    """Simulate one and derive the other from the state before the event."""
    drive = drive_named(case.drive)
    demand_nm = case.demand_share * drive.motor.rated_torque_nm
    rows, at = simulated(drive, case.event, demand_nm)
    before = rows[at - MEAN_ROWS : at].mean(axis=0)
    speed = float(before[1]) / drive.vehicle.wheel_radius_m
    if case.event == NO_CHARGING:
        kept = lossy_braking_nm(drive, speed, float(before[4]))
        rate = drive.control.torque_rate_nm_per_s
    else:  # nothing holds the bus: the bridge opens, what is left is the iron's drag
        kept = float(least_torque.iron_drag_nm(drive, np.array([speed]))[0])
        rate = math.inf
    dip = measured(rows[at:], drive)
    least = derived(drive, demand_nm, -float(before[2]), kept, min(rate, 1e9))
    return Outcome(
        number=number,
        drive=case.drive,
        event=case.event,
        demand_nm=demand_nm,
        measured_share=dip.share,
        measured_s=dip.seconds,
        derived_share=least.share,
        derived_s=least.seconds,
        kept_nm=kept,
    )


def simulated(drive: Drive, event: str, demand_nm: float) -> tuple[Rows, int]:
    """Return the recorded SIGNALS and the row of the event."""
    top_m_per_s = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=3.6 * SPEED_SHARE * top_m_per_s,
        demand_nm=demand_nm,
        max_duration_s=AT_S + AFTER_S,
        winding_temperature_c=WINDING_C,
        record_interval_s=RECORD_S,
        plant={"bus.capacitance_f": drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f},
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(SIGNALS)
        rows = engine.run(AT_S)
        engine.set(*EVENTS[event])
        return np.concatenate([rows, engine.run(AFTER_S)]), len(rows)


def measured(rows: Rows, drive: Drive) -> Dip:
    """Return the dip of the sum of both brakes, in means of MEAN_ROWS."""
    demand, speed, airgap, hydraulic, _ = rows.T
    turning = speed / drive.vehicle.wheel_radius_m
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * turning
    missing = 1.0 - (hydraulic - airgap + friction) / demand
    missing = np.convolve(missing, np.ones(MEAN_ROWS) / MEAN_ROWS, "valid")
    return Dip(float(np.max(missing, initial=0.0)), float(np.sum(missing > OVER_SHARE)) * RECORD_S)


def line(o: Outcome) -> str:
    """Return an outcome as a line."""
    parts = (
        f"{100.0 * share:3.0f} % for {1000.0 * seconds:3.0f} ms"
        for share, seconds in (
            (o.measured_share, o.measured_s),
            (o.derived_share, o.derived_s),
        )
    )
    return (
        f"{o.drive:11} {o.event:21} {o.demand_nm:6.1f} N m: dip "
        + ", derived ".join(parts)
        + f" (the motor may keep {o.kept_nm:.1f} N m)"
    )


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: the dips of each drive, its demands side by side."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        cells = [name]
        for event in EVENTS:
            here = [o for o in outcomes if (o.drive, o.event) == (name, event)]
            shares = (
                f"{100.0 * o.measured_share:.0f} / {100.0 * o.derived_share:.0f}" for o in here
            )
            cells.append(", ".join(shares))
            longest = max(here, key=lambda o: o.measured_s)
            cells.append(f"{1e3 * longest.measured_s:.0f} / {1e3 * longest.derived_s:.0f} ms")
        rows.append(cells)
    columns = ["drive"]
    for event in EVENTS:
        columns += [f"{event}: measured / derived, %", "longest"]
    return {"drives": markdown(columns, rows)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw measured over derived dips, a panel for their size and one for how long they last."""
    made, panels = plotting.figure("Measured dips over derived ones", 2, 1, 10.0, 4.6)
    quantities = (
        ("missing share of the demand, %", 100.0, "measured_share", "derived_share"),
        (f"more than {percent(OVER_SHARE)} missing, ms", 1e3, "measured_s", "derived_s"),
    )
    for axes, (title, scale, mine, ideal) in zip(panels, quantities, strict=True):
        for event, colour in zip(EVENTS, (plotting.BLUE, plotting.ORANGE), strict=True):
            here = [o for o in outcomes if o.event == event]
            axes.plot(
                [scale * getattr(o, ideal) for o in here],
                [scale * getattr(o, mine) for o in here],
                "o",
                color=colour,
                label=event,
            )
        most = scale * max(getattr(o, ideal) for o in outcomes)
        axes.plot([0.0, most], [0.0, most], color="gray", linewidth=0.8)
        axes.set(title=title, xlabel="derived", ylabel="measured")
    plotting.legend_below(made, panels[0], 2)
    return made


def chosen(options: argparse.Namespace) -> list[Case]:
    """Return every event at every demand, of these drives."""
    return [Case(*case) for case in product(options.drives, EVENTS, DEMAND_SHARES)]


STUDY = Study(
    name="dips",
    text=__doc__,
    outcome=Outcome,
    cases=chosen,
    measure=measure,
    summary=lambda outcomes: [line(o) for o in outcomes],
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    options=add_drives,
)
main = STUDY.main
