# SPDX-License-Identifier: Apache-2.0
"""What the optimum stores beside a motor that brakes first, for ten drives.

Stops from two thirds of the top speed with a tenth to all of the largest torque, cold windings and
hot ones just below their derating; one wheel with its share of mass and battery stands for the
vehicle, without air drag and rolling resistance. Motor first takes all of the demand as far as its
torque reaches, the series brake up to the optimum. A drive without a commanded brake gets one of
three times the motor's torque, so that both make the demand. Exit status 1 if the series brake
anywhere stores less.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from hubsim import run
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep.drives import drive_named
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from regen_table import derived, plotting
from regen_table.cli import Parser
from regen_table.schema import Drive
from studies.common import Study, markdown

VEHICLES = (
    *("leaf", "ipm400v", "qs273", "lu2013", "scooter48v"),
    *("elaphe700", "mxus3k", "m365", "hoverboard", "ebike36v"),
)
DEMANDS = (0.1, 0.25, 0.5, 0.75, 1.0)  # of the motor's largest torque
COLD_C = 25.0
BELOW_DERATING_K = 5.0
SPEED_SHARE = 2.0 / 3.0  # of the top speed
BRAKE_SHARE = 3.0  # hydraulic torque of a drive that commands none, of the motor's
LONGEST_S = 1000.0
CHUNK_S = 10.0
TOLERANCE = 0.001  # of the kinetic energy: noise and the moment at which a run ends
SHOWN = ("lu2013", "ebike36v")  # whose shares over the demand are drawn


@dataclass(frozen=True)
class Case:
    """One stop; ``hot``: the windings are just below their derating."""

    drive: str
    hot: int
    demand_share: float


@dataclass(frozen=True)
class Outcome:
    """What both ways to brake store of the kinetic energy."""

    number: int
    drive: str
    hot: int
    demand_share: float
    winding_temperature_c: float
    initial_speed_kmh: float
    motor_first: float
    series: float

    @property
    def gain(self) -> float:
        """What the optimum adds, of the kinetic energy."""
        return self.series - self.motor_first


def drawn(drives: Sequence[str]) -> list[Case]:
    """Return all stops of some drives."""
    return [Case(name, hot, share) for name in drives for hot in (0, 1) for share in DEMANDS]


def vehicle(name: str, strategy: str) -> Drive:
    """Return a drive with a strategy; motor first has all of the motor's torque."""
    drive = drive_named(name)
    torque_nm = drive.motor.max_torque_nm
    hydraulic_nm = drive.brake.max_hydraulic_torque_nm or BRAKE_SHARE * torque_nm
    brake = drive.brake.model_copy(
        update={
            "strategy": strategy,
            "electric_rated_torque_nm": torque_nm,
            "max_hydraulic_torque_nm": hydraulic_nm,
            "hydraulic_rate_nm_per_s": max(drive.brake.hydraulic_rate_nm_per_s, 5.0 * hydraulic_nm),
        }
    )
    return drive.model_copy(update={"brake": brake}).named(drive.name)


def measure(number: int, case: Case) -> Outcome:
    """Simulate one stop with either strategy."""
    drive = drive_named(case.drive)
    warm_c = derived.derate_winding_temperature_c(drive) - BELOW_DERATING_K
    top_m_per_s = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=round(3.6 * SPEED_SHARE * top_m_per_s, 1),
        demand_nm=case.demand_share * drive.motor.max_torque_nm,
        drag=False,
        stop_at_standstill=True,
        winding_temperature_c=warm_c if case.hot else COLD_C,
    )
    return Outcome(
        number=number,
        **asdict(case),
        winding_temperature_c=scenario.winding_temperature_c,
        initial_speed_kmh=scenario.initial_speed_kmh,
        motor_first=stored(vehicle(case.drive, "parallel_free_travel"), scenario),
        series=stored(vehicle(case.drive, "series_optimal"), scenario),
    )


def stored(drive: Drive, scenario: Scenario) -> float:
    """Return the share of the kinetic energy that the cells take in."""
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose([])
        while not engine.ended:
            engine.run(CHUNK_S)
            if engine.value("time_s") > LONGEST_S:
                raise HubsimError(f"{drive.name}: {scenario.demand_nm:g} N m do not stop it")
        return engine.value("energy.chemical_j") / engine.value("energy.kinetic_j")


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each drive."""
    lines = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name]
        most = max(here, key=lambda o: o.gain)
        lines.append(
            f"{name}: {100.0 * min(o.gain for o in here):+.1f} to {100.0 * most.gain:+.1f} points, "
            f"at most with {most.demand_share:g} of the largest torque at "
            f"{most.winding_temperature_c:g} degC: {100.0 * most.series:.1f} beside "
            f"{100.0 * most.motor_first:.1f} %"
        )
    return lines


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: shares of motor first and series, cold and hot."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        cells = [name]
        for hot in (0, 1):
            here = [o for o in outcomes if o.drive == name and o.hot == hot]
            cells += [
                f"{100.0 * o.motor_first:.1f}, {100.0 * o.series:.1f}"
                for o in here
                if o.demand_share in {0.25, 0.5, 1.0}
            ]
        rows.append(cells)
    columns = ("drive", *(f"{warm}, {x}" for warm in ("cold", "hot") for x in ("1/4", "1/2", "1")))
    return {"drives": markdown(columns, rows)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw what the optimum adds in hard stops, and two drives over the demand."""
    made, panels = plotting.figure(
        "What the optimum adds to a motor that brakes first", 3, 1, 11.0, 4.4
    )
    _gains(panels[0], outcomes)
    for axes, name in zip(panels[1:], SHOWN, strict=True):
        for hot, dashes, text in ((0, "-", "cold"), (1, "--", "hot")):
            here = [o for o in outcomes if o.drive == name and o.hot == hot]
            demand = [o.demand_share for o in here]
            first, best = ([100.0 * v for v in values] for values in _shares(here))
            axes.plot(demand, best, dashes, color=plotting.BLUE, label=f"optimum, {text}")
            axes.plot(demand, first, dashes, color=plotting.ORANGE, label=f"motor first, {text}")
            axes.fill_between(demand, first, best, color=plotting.BLUE, alpha=0.12, linewidth=0.0)
        axes.set(title=name, xlabel="demand, of the largest motor torque", ylabel="stored, %")
    plotting.legend_below(made, panels[1], 4)
    return made


def _shares(outcomes: Sequence[Outcome]) -> tuple[list[float], list[float]]:
    return [o.motor_first for o in outcomes], [o.series for o in outcomes]


def _gains(axes: Axes, outcomes: Sequence[Outcome]) -> None:
    """Draw the gain in stops with half and with all of the largest torque, hot windings."""
    names = list(dict.fromkeys(o.drive for o in outcomes))
    at = {
        share: [
            100.0
            * sum(o.gain for o in outcomes if (o.drive, o.hot, o.demand_share) == (n, 1, share))
            for n in names
        ]
        for share in (0.5, 1.0)
    }
    place = np.arange(len(names))
    axes.barh(place + 0.2, at[1.0], 0.38, color=plotting.BLUE, label="all of the torque")
    axes.barh(place - 0.2, at[0.5], 0.38, color=plotting.GREY, label="half of it")
    axes.set(title="hot windings", xlabel="points of the kinetic energy")
    axes.set_yticks(place, names)
    axes.legend(loc="lower right", fontsize=8)


def add_drives(parser: Parser) -> None:
    """Add the drives to measure."""
    parser.add_argument(
        "drives", nargs="*", type=_known, default=VEHICLES, metavar="DRIVE",
        help=f"default: {', '.join(VEHICLES)}",
    )  # fmt: skip


def _known(name: str) -> str:
    if name not in VEHICLES:
        accepted = ", ".join(VEHICLES)
        raise argparse.ArgumentTypeError(f"no {name!r}, accepted: {accepted}")
    return name


def _cases(options: argparse.Namespace) -> list[Case]:
    return drawn(options.drives)


STUDY = Study(
    name="worth",
    text=__doc__,
    outcome=Outcome,
    cases=_cases,
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.gain >= -TOLERANCE for o in outcomes),
    options=add_drives,
)
main = STUDY.main
