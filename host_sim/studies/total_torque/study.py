# SPDX-License-Identifier: Apache-2.0
"""Motor and hydraulic brake together beside the demand, for wrong brakes.

Stops from half and two thirds of the largest speed at four demands, the hydraulic brake a fifth
weaker or stronger, half or twice as late, with and without reports of its torque; and the urban
cycles with reports. Every drive that comes along, one wheel with its share of mass and battery
(stops). Exit status 1 if a run with reports is more than 3 % rms or 10 % at its peak beside the
demand, or a run has a fault.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product

import numpy as np
from hubsim import reasons
from hubsim.scenario import Scenario, cycles
from hubsim.sweep.drives import drive_named
from matplotlib.figure import Figure
from regen_table import plotting
from regen_table.cli import Parser
from regen_table.schema import Drive
from studies.common import Study, add_drives, markdown, percent
from studies.total_torque import runs

STOP, CYCLES = "stop", ("ece15", "udds")
START_SHARES = (0.5, 0.66)  # of the largest speed
DEMAND_SHARES = (0.33, 1.0, 2.0, 4.0)  # of the rated torque
GAINS, LATENESSES = (0.8, 1.0, 1.2), (0.5, 1.0, 2.0)
CYCLE_SPEED_SHARE = 0.9  # of the largest speed, the cycle's fastest
LONGEST_STOP_S = 60.0
RMS_MAX, PEAK_MAX = 0.03, 0.1  # with reports


@dataclass(frozen=True)
class Case:
    """One run with a hydraulic brake of another gain and lateness; ``reports`` 1: of its torque.

    ``start_share`` of the largest speed and ``demand_share`` of the rated torque are a stop's.
    """

    drive: str
    kind: str
    start_share: float
    demand_share: float
    gain: float
    lateness: float
    reports: int


@dataclass(frozen=True)
class Outcome:
    """How far the sum was from the demand, as a share of it, counted for so long."""

    number: int
    drive: str
    kind: str
    start_share: float
    demand_share: float
    gain: float
    lateness: float
    reports: int
    rms: float
    peak: float
    counted_s: float
    first_fault: str

    @property
    def within(self) -> bool:
        """Whether the sum is as it should be; without reports only a fault is not."""
        near = self.rms <= RMS_MAX and self.peak <= PEAK_MAX
        return (near or not self.reports) and not self.first_fault


def scenario_of(drive: Drive, case: Case) -> Scenario:
    """Return the stop or the cycle of a case."""
    top_kmh = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    if case.kind == STOP:
        return Scenario(
            initial_speed_kmh=case.start_share * top_kmh,
            demand_nm=case.demand_share * drive.motor.rated_torque_nm,
            stop_at_standstill=True,
            max_duration_s=LONGEST_STOP_S,
        )
    fastest_kmh = max(cycles.load(case.kind).speed_kmh)
    return Scenario(cycle=case.kind, speed_scale=CYCLE_SPEED_SHARE * top_kmh / fastest_kmh)


def measure(number: int, case: Case) -> Outcome:
    """Make one run."""
    drive = drive_named(case.drive)
    brake = runs.weak_and_late(drive, case.gain, case.lateness)
    reports = runs.FEEDBACK if case.reports else {}
    found = runs.simulate(drive, scenario_of(drive, case), reports | brake)
    return Outcome(
        number=number,
        **asdict(case),
        rms=found.rms,
        peak=found.peak,
        counted_s=found.counted_s,
        first_fault=reasons.shown(found.fault),
    )


def chosen(options: argparse.Namespace) -> list[Case]:
    """Return all stops, with reports and without, and the cycles unless they are left out."""
    stops = product(options.drives, [STOP], START_SHARES, DEMAND_SHARES, GAINS, LATENESSES, (1, 0))
    rides = product(options.drives, CYCLES, [0.0], [0.0], GAINS, [1.0], [1])
    every = [Case(*case) for case in (*stops, *(() if options.only_stops else rides))]
    if options.count is None or options.count >= len(every):
        return every
    some = np.random.default_rng(options.seed).choice(len(every), options.count, replace=False)
    return [every[k] for k in sorted(some)]


def _groups(outcomes: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """Return the runs by what the table has side by side."""
    groups = {
        "stops with reports": [o for o in outcomes if o.kind == STOP and o.reports],
        "stops without": [o for o in outcomes if o.kind == STOP and not o.reports],
        **{kind: [o for o in outcomes if o.kind == kind] for kind in CYCLES},
    }
    return {name: here for name, here in groups.items() if here}


def _worst(outcomes: Sequence[Outcome]) -> str:
    rms = max((o.rms for o in outcomes), default=0.0)
    peak = max((o.peak for o in outcomes), default=0.0)
    return f"{percent(rms, 1)}, {percent(peak, 1)}"


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each drive, and one for each run that misses."""
    lines = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name]
        groups = ", ".join(f"{text} {_worst(some)}" for text, some in _groups(here).items())
        lines.append(f"{name}: worst rms and peak: {groups}")
    lines.extend(
        f"misses: {o.drive}, {o.kind} from {o.start_share:g} at {o.demand_share:g} of rated, gain "
        f"{o.gain:g}, lateness {o.lateness:g}: {o.rms:.1%} rms, {o.peak:.1%} peak {o.first_fault}"
        for o in outcomes
        if not o.within
    )
    return lines


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: worst rms and peak of each drive."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        groups = _groups([o for o in outcomes if o.drive == name])
        rows.append((name, *(_worst(groups.get(text, ())) for text in _groups(outcomes))))
    return {"drives": markdown(("drive", *_groups(outcomes)), rows)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the peaks over the demand, a panel for each drive."""
    names = list(dict.fromkeys(o.drive for o in outcomes))
    made, panels = plotting.figure(
        "Largest distance of the sum from the demand, stops", 2, (len(names) + 1) // 2, 10.0, 7.0
    )
    for name, axes in zip(names, panels, strict=False):
        for text, reports, colour in (
            ("without reports", 0, plotting.GREY),
            ("with reports", 1, plotting.BLUE),
        ):
            here = [o for o in outcomes if (o.drive, o.kind, o.reports) == (name, STOP, reports)]
            axes.plot(
                [o.demand_share for o in here],
                [100.0 * o.peak for o in here],
                ".",
                color=colour,
                label=text,
            )
        axes.axhline(100.0 * PEAK_MAX, color="gray", linewidth=0.8)
        axes.set(title=name, xlabel="demand, of the rated torque", ylabel="% of the demand")
    plotting.legend_below(made, panels[0], 2)
    return made


def more_options(parser: Parser) -> None:
    """Add which runs are made."""
    add_drives(parser)
    parser.add_argument(
        "--count", type=int, metavar="N", help="so many of the runs, drawn; default: all"
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="of what is drawn; default: 1"
    )
    parser.add_argument("--only-stops", action="store_true", help="not the urban cycles")


STUDY = Study(
    name="total_torque",
    text=__doc__,
    outcome=Outcome,
    cases=chosen,
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    options=more_options,
)
main = STUDY.main
