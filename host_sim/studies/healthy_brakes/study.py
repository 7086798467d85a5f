# SPDX-License-Identifier: Apache-2.0
"""Healthy hydraulic brakes that the deceleration names wrong.

Every ride drives, coasts, brakes, and brakes with another demand, on one wheel with its share of
mass and battery (stops). Gain 0.8 to 1.2, delay and lag 0.5 to 2 times, mass and air drag 0.85 to
1.15 times what the controller is told, slopes to 8 % that change by up to 0.001 a metre, all of it
at once: then a gain of 1.2 with a mass of 0.85 is a brake that makes 1.4 times its command, and not
every finding is avoided. Exit status 1 if more than 8 % of the rides are named; rides with --steps
count only with --reports.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from hubsim import reasons, run
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep import faults_sweep
from matplotlib.figure import Figure
from regen_table import plotting
from regen_table.cli import Parser
from studies.common import Study, markdown
from studies.total_torque import runs as total_torque

VEHICLES = tuple(vehicle for vehicle in faults_sweep.VEHICLES if vehicle != ("lu2013", "angle"))
SPEED_SHARE = (0.25, 0.85)  # of the largest
DEMAND_SHARES = (0.8, 1.5, 2.5, 4.0)  # of the rated torque
GAIN, LATENESS, FACTOR = (0.8, 1.2), (0.5, 2.0), (0.85, 1.15)
SLOPE, SLOPES_PER_M = 0.08, (0.0, 0.0005, 0.001)
TURNS_A_STEP = 0.01  # how often the slope begins to change the other way
STEP_S, LONGEST_S = 0.05, 40.0
MOST = 0.08
WEAK = ("HYDRAULIC_WEAK", "HYDRAULIC_DEAD", "HYDRAULIC_LATE")
STRONG = ("HYDRAULIC_STRONG", "HYDRAULIC_STUCK")
LIMITS = {"HYDRAULIC_LIMIT"}  # what a healthy brake may show
SLOPE_STEP, STEP_LASTS_S = (0.02, 0.06), (0.5, 3.0)
STEP_BEFORE_S, STEP_AFTER_S = 1.0, 4.0  # the braking demand
REFRESHED_STEPS = 160  # rides with a step in the stored table, with and without reports
PLAIN, STEPS = "slopes that change slowly", "the slope steps"
PLAIN_REPORTS, STEPS_REPORTS = f"{PLAIN}, with reports", f"{STEPS}, with reports"
KINDS = {
    (False, False): PLAIN,
    (False, True): PLAIN_REPORTS,
    (True, False): STEPS,
    (True, True): STEPS_REPORTS,
}
"""By whether the slope steps, and whether the brake reports its torque."""
SIGNALS = ("time_s", "vehicle.speed_m_per_s", "wheel0.warning_reason")


@dataclass(frozen=True)
class Ride:
    """One ride; demands in shares of the rated torque, factors of what the controller is told."""

    drive: str
    rotor_sensor: str
    speed_share: float
    drive_share: float
    brake_s: float
    demand_share: float
    then_s: float
    then_share: float
    gain: float = 1.0
    lateness: float = 1.0
    mass: float = 1.0
    drag: float = 1.0
    slope: float = 0.0
    slope_per_m: float = 0.0
    seed: int = 0
    step: float = 0.0
    step_s: float = 0.0
    step_lasts_s: float = 0.0
    reports: bool = False


@dataclass(frozen=True)
class Outcome:
    """A ride, and the first finding about its hydraulic brake; empty: none."""

    number: int
    drive: str
    rotor_sensor: str
    speed_share: float
    drive_share: float
    brake_s: float
    demand_share: float
    then_s: float
    then_share: float
    gain: float
    lateness: float
    mass: float
    drag: float
    slope: float
    slope_per_m: float
    seed: int
    step: float
    step_s: float
    step_lasts_s: float
    reports: int
    finding: str

    @property
    def kind(self) -> str:
        """In words: with a step of the slope, with reports of the brake."""
        return KINDS[self.step != 0.0, bool(self.reports)]


def stepped(ride: Ride, seed: int) -> Ride:
    """Return a ride with a step of the slope."""
    random = np.random.default_rng((seed, ride.seed))
    step = float(random.uniform(*SLOPE_STEP) * random.choice((-1.0, 1.0)))
    step_s = ride.brake_s + random.uniform(-STEP_BEFORE_S, STEP_AFTER_S)
    return replace(ride, step=step, step_s=step_s, step_lasts_s=random.uniform(*STEP_LASTS_S))


def drawn(count: int, seed: int) -> Iterator[Ride]:
    """Draw rides, the vehicles in turn."""
    random = np.random.default_rng(seed)
    for k in range(count):
        name, sensor = VEHICLES[k % len(VEHICLES)]
        demand = float(random.choice(DEMAND_SHARES))
        brake_s = round(random.uniform(1.5, 4.0), 3)
        yield Ride(
            name,
            sensor,
            random.uniform(*SPEED_SHARE),
            random.uniform(0.0, 0.8),
            brake_s,
            demand,
            round(brake_s + random.uniform(1.0, 4.0), 3),
            demand * random.uniform(0.2, 1.0),
            random.uniform(*GAIN),
            random.uniform(*LATENESS),
            random.uniform(*FACTOR),
            random.uniform(*FACTOR),
            random.uniform(-SLOPE, SLOPE),
            float(random.choice(SLOPES_PER_M)),
            k,
        )


def named(ride: Ride) -> str:
    """Return the first finding about the hydraulic brake, empty: none."""
    drive = faults_sweep.drive_of(ride.drive, ride.rotor_sensor)
    rated_nm, vehicle = drive.motor.rated_torque_nm, drive.vehicle
    top_m_per_s = drive.motor.max_speed_rpm * np.pi / 30.0 * vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=3.6 * ride.speed_share * top_m_per_s,
        slope_percent=100.0 * ride.slope,
        stop_at_standstill=True,
        record_interval_s=0.01,
    )
    plant = total_torque.weak_and_late(drive, ride.gain, ride.lateness)
    if ride.reports:
        plant |= total_torque.FEEDBACK
    engine, _ = run.prepare(drive, scenario, Path(), plant)
    demands = {
        0.0: (ride.drive_share, 0.0),
        0.5 * ride.brake_s: (0.0, 0.0),
        ride.brake_s: (0.0, ride.demand_share),
        ride.then_s: (0.0, ride.then_share),
    }
    random = np.random.default_rng(ride.seed)
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.set("vehicle.mass_kg", ride.mass * engine.get("vehicle.mass_kg"))
        engine.set("vehicle.frontal_area_m2", ride.drag * engine.get("vehicle.frontal_area_m2"))
        engine.start()
        engine.choose(SIGNALS)
        slope, way = ride.slope, 1.0
        for at_s in np.arange(0.0, LONGEST_S, STEP_S):
            for from_s, (drive_share, brake_share) in demands.items():
                if at_s - STEP_S < from_s <= at_s:
                    engine.set("driver.drive_demand_nm", drive_share * rated_nm)
                    engine.set("driver.brake_demand_nm", brake_share * rated_nm)
            rows = engine.run(STEP_S)
            found = {reasons.identifier(code) for code in np.unique(rows[:, 2])} - LIMITS
            wrong = sorted(name for name in found if name.startswith("HYDRAULIC_"))
            if wrong:
                return wrong[0]
            if engine.ended:
                break
            way = -way if random.random() < TURNS_A_STEP or abs(slope) > SLOPE else way
            slope += way * ride.slope_per_m * abs(float(rows[-1, 1])) * STEP_S
            on_step = ride.step_s <= at_s + STEP_S < ride.step_s + ride.step_lasts_s
            engine.set("road.slope", slope + (ride.step if on_step else 0.0))
    return ""


def measure(number: int, ride: Ride) -> Outcome:
    """Make one ride."""
    plain = asdict(ride) | {"reports": int(ride.reports)}
    return Outcome(number=number, **plain, finding=named(ride))


def _by_kind(outcomes: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    found = {kind: [o for o in outcomes if o.kind == kind] for kind in KINDS.values()}
    return {kind: here for kind, here in found.items() if here}


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each ride that is named, and their number."""
    lines = [
        f"{o.finding}: ride {o.number}, {o.drive}, {o.rotor_sensor}, {o.kind}, gain {o.gain:.2f}, "
        f"lateness {o.lateness:.2f}, mass {o.mass:.2f}, drag {o.drag:.2f}, slope {o.slope:.3f}, "
        f"{o.slope_per_m:g} a metre, step {o.step:.3f}"
        for o in outcomes
        if o.finding
    ]
    lines.extend(
        f"{kind}: {sum(bool(o.finding) for o in here)} of {len(here)} rides with a healthy brake "
        "have a finding"
        for kind, here in _by_kind(outcomes).items()
    )
    return lines


def holds(outcomes: Sequence[Outcome]) -> bool:
    """Return whether few enough rides are named; a step without reports is that of a brake too."""
    return all(
        sum(bool(o.finding) for o in here) <= MOST * len(here)
        for kind, here in _by_kind(outcomes).items()
        if kind != STEPS
    )


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the tables of the page: kinds of rides, and the vehicles of the first kind."""
    findings = sorted({o.finding for o in outcomes} - {""})
    columns = ("rides", "named", "of", *(f"`{name}`" for name in findings))

    def line(text: str, here: Sequence[Outcome]) -> tuple[object, ...]:
        counts = (sum(o.finding == name for o in here) for name in findings)
        return (text, sum(bool(o.finding) for o in here), len(here), *counts)

    kinds = [line(kind, here) for kind, here in _by_kind(outcomes).items()]
    plain = [o for o in outcomes if o.kind == PLAIN]
    vehicles = [
        line(f"{name}, {sensor}", [o for o in plain if (o.drive, o.rotor_sensor) == (name, sensor)])
        for name, sensor in dict.fromkeys((o.drive, o.rotor_sensor) for o in plain)
    ]
    return {"kinds": markdown(columns, kinds), "vehicles": markdown(columns, vehicles)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw which errors of gain and mass are named, a panel for each kind of rides."""
    by_kind = _by_kind(outcomes)
    made, panels = plotting.figure(
        "Healthy brakes that are named wrong", len(by_kind), 1, 4.0 + 3.0 * len(by_kind), 4.6
    )
    for (kind, here), axes in zip(by_kind.items(), panels, strict=True):
        for text, wanted, marker, colour in (
            ("none", ("",), ".", plotting.GREY),
            ("too little torque", WEAK, "v", plotting.BLUE),
            ("too much torque", STRONG, "^", plotting.RED),
            ("its report", ("HYDRAULIC_FEEDBACK",), "x", plotting.GREEN),
        ):
            some = [o for o in here if o.finding in wanted]
            axes.plot(
                [o.gain for o in some],
                [o.mass for o in some],
                marker,
                color=colour,
                label=text,
            )
        axes.set(title=kind, xlabel="gain of the brake", ylabel="mass, of the configured one")
    plotting.legend_below(made, panels[0], 4)
    return made


def more_options(parser: Parser) -> None:
    """Add the kinds of rides."""
    parser.add_argument("--steps", action="store_true", help="the slope steps as well")
    parser.add_argument("--reports", action="store_true", help="the brake reports its torque")


def chosen(options: argparse.Namespace) -> list[Ride]:
    """Return the rides of the kind that is asked for; for the stored table, of three kinds."""
    rides = [replace(ride, reports=options.reports) for ride in drawn(options.count, options.seed)]
    if options.refresh:
        some = [stepped(ride, options.seed) for ride in rides[:REFRESHED_STEPS]]
        return [*rides, *some, *(replace(ride, reports=True) for ride in some)]
    return [stepped(ride, options.seed) for ride in rides] if options.steps else rides


STUDY = Study(
    name="healthy_brakes",
    text=__doc__,
    outcome=Outcome,
    cases=chosen,
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=holds,
    count=400,
    options=more_options,
)
main = STUDY.main
