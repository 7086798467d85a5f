# SPDX-License-Identifier: Apache-2.0
"""Jerk of stops through the blend-out, and standing still on a slope.

Demands of 0.1 to 3 times the rated torque, slopes of -10 to 10 %, every drive that comes along; one
wheel with its share of mass and battery stands for the vehicle (stops), without air drag and
rolling resistance. With --hill-hold also 120 stops of vehicles with a hold torque on slopes that
the demand does not hold. Exit status 1 if a stop is not as it should be.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path

import numpy as np
from hubsim import configuration, reasons, run
from hubsim.engine import Rows
from hubsim.run import stops
from hubsim.run.plant import STANDARD_GRAVITY_M_PER_S2
from hubsim.scenario import Scenario
from hubsim.sweep import cases
from hubsim.sweep.drives import DRIVES, drive_named
from matplotlib.figure import Figure
from regen_table import plotting
from regen_table.cli import Parser
from regen_table.schema import Drive
from studies.common import Study, markdown, percent

DEMAND_SHARE = (0.1, 3.0)  # of the rated torque
SLOPE_PERCENT = (-10.0, 10.0)
HOLDS_FROM = 1.1  # times the pull of the slope: smaller demands neither stop downhill nor hold
JERK_MAX = 1.0  # m/s3
JERK_S = 0.05  # over which the slope of the torque is taken
MEAN_S = 0.01
SLOWEST_M_PER_S = 0.1  # below it, the final stop
DRIVES_SHARE = 0.02  # of the rated torque: more against the demand is a reversal
MOVED_MAX_M = 0.02
HOLD_SHARE = 1.3
HILL_SLOPES_PERCENT = (2.0, 4.0, 6.0, 8.0, 10.0)
HILL_PULL_SHARES = (0.1, 0.3, 0.5, 0.7, 0.9, 1.05)
RECORD_S = 0.001
BEFORE_S = 0.6  # from the demand on: both brakes have settled
FAST_S = 1.0  # of braking before the blend-out begins
STANDS_S = 2.0
LONGEST_S = 60.0
SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "vehicle.distance_m",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "wheel0.first_fault_reason",
)


@dataclass(frozen=True)
class Case:
    """One stop at constant demand; a positive slope goes up. ``hold_nm``: 0 without hill hold."""

    drive: str
    demand_share: float
    slope_percent: float
    hold_nm: float = 0.0


@dataclass(frozen=True)
class Outcome:
    """What a stop did.

    Attributes
    ----------
    jerk_m_per_s3 : float
        Largest slope of the sum of both brakes over JERK_S, by mass and radius, and at what speed.
    drives_share : float
        Largest motor torque along the motion, of the rated torque.
    hold_nm : float
        Hold torque of the configuration; with one, only standing still counts.
    holds : bool as int
        Whether the vehicle is to stand: by a demand larger than the pull of the slope, or a hold.
    moved_m : float
        How far the vehicle moves within STANDS_S of its first standstill; infinite without one.
    """

    number: int
    drive: str
    demand_share: float
    slope_percent: float
    hold_nm: float
    jerk_m_per_s3: float
    jerk_speed_m_per_s: float
    drives_share: float
    holds: int
    moved_m: float
    first_fault: str

    @property
    def within(self) -> bool:
        """Whether the stop is as it should be."""
        smooth = abs(self.jerk_m_per_s3) <= JERK_MAX and self.drives_share <= DRIVES_SHARE
        stands = not self.holds or self.moved_m <= MOVED_MAX_M
        return (smooth or self.hold_nm > 0.0) and stands and not self.first_fault


def draw(drives: Sequence[str], count: int, seed: int) -> list[Case]:
    """Return so many stops, drives in turn. A slope that a demand cannot stop on goes up."""
    return cases.hypercube(drives, count, seed, 2, _case)


def _case(name: str, _number: int, share: Rows) -> Case:
    drive = drive_named(name)
    low, high = DEMAND_SHARE
    demand = round(float(low + (high - low) * share[0]), 4)
    low, high = SLOPE_PERCENT
    slope = round(float(low + (high - low) * share[1]), 3)
    stops_there = demand * drive.motor.rated_torque_nm > HOLDS_FROM * abs(pull_nm(drive, slope))
    return Case(name, demand, slope if stops_there else abs(slope))


def pull_nm(drive: Drive, slope_percent: float) -> float:
    """Return the torque with which a slope holds a wheel back."""
    sine = np.sin(np.arctan(slope_percent / 100.0))
    return float(_inertia(drive) * STANDARD_GRAVITY_M_PER_S2 * sine)


def _inertia(drive: Drive) -> float:
    """Torque at a wheel for a deceleration of 1 m/s2, N m."""
    return drive.vehicle.mass_kg / drive.vehicle.driven_wheels * drive.vehicle.wheel_radius_m


def measure(number: int, case: Case) -> Outcome:
    """Simulate one stop."""
    drive = drive_named(case.drive)
    rows = simulated(drive, case)
    time_s, speed, distance, motor, hydraulic, fault = rows.T
    rated = drive.motor.rated_torque_nm
    jerk = jerks(hydraulic - motor, _inertia(drive))
    stands = np.flatnonzero(speed <= 0.0)
    first = int(stands[0]) if len(stands) else len(rows) - 1
    below = np.flatnonzero(speed < SLOWEST_M_PER_S)
    counted = np.arange(len(jerk)) < int(below[0] if len(below) else len(rows)) - round(
        JERK_S / RECORD_S
    )
    counted &= time_s[: len(jerk)] > BEFORE_S
    k = int(np.argmax(np.where(counted, np.abs(jerk), -1.0)))
    moving = (speed > 0.0) & (time_s > BEFORE_S) & (np.arange(len(rows)) < first)
    kernel = np.ones(round(MEAN_S / RECORD_S)) * RECORD_S / MEAN_S
    smooth = np.convolve(motor, kernel, "same")
    return Outcome(
        number=number,
        **asdict(case),
        jerk_m_per_s3=float(jerk[k]),
        jerk_speed_m_per_s=float(speed[k]),
        drives_share=float(np.max(smooth[moving], initial=0.0)) / rated,
        holds=int(
            case.hold_nm > 0.0
            or case.demand_share * rated > HOLDS_FROM * abs(pull_nm(drive, case.slope_percent))
        ),
        moved_m=float(np.ptp(distance[first:])) if len(stands) else np.inf,
        first_fault=reasons.shown(fault[-1]),
    )


def jerks(torque_nm: Rows, inertia: float) -> Rows:
    """Return the jerk over JERK_S from each row on, m/s3, of means over MEAN_S."""
    kernel = np.ones(round(MEAN_S / RECORD_S)) * RECORD_S / MEAN_S
    smooth = np.convolve(torque_nm, kernel, "same")
    rows = round(JERK_S / RECORD_S)
    return np.asarray((smooth[rows:] - smooth[:-rows]) / JERK_S / inertia)


def hill_case(name: str, slope_percent: float, pull_share: float) -> Case:
    """Return a stop of a vehicle with hill hold on an upward slope.

    The demand is a share of what the slope pulls with, the hold torque HOLD_SHARE of the pull of
    the steepest slope.
    """
    drive = drive_named(name)
    demand_share = pull_share * pull_nm(drive, slope_percent) / drive.motor.rated_torque_nm
    return Case(name, demand_share, slope_percent, HOLD_SHARE * pull_nm(drive, SLOPE_PERCENT[1]))


def simulated(drive: Drive, case: Case) -> Rows:
    """Return the recorded SIGNALS until STANDS_S after the first standstill."""
    demand_nm = case.demand_share * drive.motor.rated_torque_nm
    slowing = (demand_nm + pull_nm(drive, case.slope_percent)) / _inertia(drive)
    per_rpm = np.pi / 30.0 * drive.vehicle.wheel_radius_m
    begins = drive.control.handover_start_rpm * per_rpm
    fast = min(1.5 * begins + FAST_S * slowing, 0.9 * drive.motor.max_speed_rpm * per_rpm)
    scenario = Scenario(
        initial_speed_kmh=3.6 * fast,
        demand_nm=demand_nm,
        slope_percent=case.slope_percent,
        drag=False,
        max_duration_s=LONGEST_S,
        record_interval_s=RECORD_S,
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        stops.as_one_wheel(engine, drive)
        if case.hold_nm > 0.0:
            changed = {("battery", "driven_wheels"): 1}
            changed["driver", "hold_torque_mNm"] = round(1e3 * case.hold_nm)
            engine.load_config(configuration.changed_image(configuration.image_of(drive), changed))
        engine.start()
        engine.choose(SIGNALS)
        parts = [engine.run(0.1)]
        stood_s = np.inf
        while parts[-1][-1, 0] < min(stood_s + STANDS_S, LONGEST_S - 0.1):
            parts.append(engine.run(0.1))
            stands = parts[-1][:, 1] <= 0.0
            if np.any(stands):
                stood_s = min(stood_s, float(parts[-1][np.argmax(stands), 0]))
        return np.concatenate(parts)


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say, a line for each drive and the worst five."""
    lines = []
    plain = [o for o in outcomes if o.hold_nm == 0.0]
    for name in dict.fromkeys(o.drive for o in plain):
        here = [o for o in plain if o.drive == name]
        lines.append(
            f"{name}: {sum(o.within for o in here)} of {len(here)} stops within; jerk at most "
            f"{max(abs(o.jerk_m_per_s3) for o in here):.2f} m/s3, motor torque along the motion at "
            f"most {max(o.drives_share for o in here):.2%} of rated, moved at most "
            f"{100.0 * _most_moved_m(here):.2f} cm where the "
            f"demand holds; {sum(bool(o.first_fault) for o in here)} with a fault"
        )
    for o in sorted(plain, key=lambda o: -abs(o.jerk_m_per_s3))[:5]:
        lines.append(
            f"worst: stop {o.number}, {o.drive}, {o.demand_share:.2f} of rated, slope "
            f"{o.slope_percent:.1f} %: {o.jerk_m_per_s3:.2f} m/s3 at {o.jerk_speed_m_per_s:.2f} m/s"
        )
    with_hold = [o for o in outcomes if o.hold_nm > 0.0]
    for name in dict.fromkeys(o.drive for o in with_hold):
        moved_m = _most_moved_m([o for o in with_hold if o.drive == name])
        lines.append(
            f"{name}: moves {100.0 * moved_m:.2f} cm at most on slopes that the demand does not "
            "hold"
        )
    return lines


def _most_moved_m(outcomes: Sequence[Outcome]) -> float:
    return max((o.moved_m for o in outcomes if o.holds), default=0.0)


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: a line for each drive."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name and o.hold_nm == 0.0]
        with_hold = [o for o in outcomes if o.drive == name and o.hold_nm > 0.0]
        rows.append(
            (
                name,
                f"{sum(o.within for o in here)} of {len(here)}",
                f"{max(abs(o.jerk_m_per_s3) for o in here):.2f}",
                percent(max(o.drives_share for o in here), 1),
                f"{100.0 * _most_moved_m(here):.1f}",
                f"{100.0 * _most_moved_m(with_hold):.1f}",
            )
        )
    columns = (
        "drive",
        "within",
        "jerk at most, m/s3",
        "motor torque along the motion, of rated",
        "moved where the demand holds, cm",
        "moved with hill hold, cm",
    )
    return {"drives": markdown(columns, rows)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the jerk over the demand, a panel for each drive."""
    outcomes = [o for o in outcomes if o.hold_nm == 0.0]
    names = list(dict.fromkeys(o.drive for o in outcomes))
    made, panels = plotting.figure(
        "Largest jerk of both brakes together over the demand", 2, (len(names) + 1) // 2, 10.0, 7.0
    )
    groups = (("up", False, plotting.ORANGE), ("down", True, plotting.BLUE))
    for name, axes in zip(names, panels, strict=False):
        for text, down, colour in groups:
            here = [o for o in outcomes if o.drive == name and (o.slope_percent < 0.0) == down]
            axes.plot(
                [o.demand_share for o in here],
                [abs(o.jerk_m_per_s3) for o in here],
                ".",
                color=colour,
                label=text,
            )
        axes.axhline(JERK_MAX, color="gray", linewidth=0.8)
        axes.set(title=name, xlabel="demand, of the rated torque", ylabel="m/s3")
        axes.set_ylim(0.0, 1.2)
    plotting.legend_below(made, panels[0], 2)
    return made


def hill_hold_option(parser: Parser) -> None:
    """Add the choice of vehicles with a hold torque."""
    parser.add_argument("--hill-hold", action="store_true", help="also with hill hold: 120 stops")


def chosen(options: argparse.Namespace) -> list[Case]:
    """Return the stops that are drawn, and those with hill hold."""
    drawn = draw(DRIVES, options.count, options.seed)
    if options.hill_hold or options.refresh:
        drawn += [hill_case(*c) for c in product(DRIVES, HILL_SLOPES_PERCENT, HILL_PULL_SHARES)]
    return drawn


STUDY = Study(
    name="blend_out",
    text=__doc__,
    outcome=Outcome,
    cases=chosen,
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    count=400,
    options=hill_hold_option,
)
main = STUDY.main
