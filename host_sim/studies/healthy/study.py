# SPDX-License-Identifier: Apache-2.0
"""Healthy rides of drawn vehicles: whether a warning comes, or LIMP.

Vehicles whose parts are wrong within their tolerances, with ordinary lags, noise, filters and
messages, driven on slopes by drawn drivers (``drawn``, ``rides``). Every drive that comes along
with every rotor sensor. Ride N of a seed is always the same. Exit status 1 if a ride has a warning,
a fault or LIMP.

--json has, besides every run: rides, how many; warnings, a list of {ride, reason, time_s}, each
reason of a ride once; limp, how many rides had LIMP (limp_s of the runs: when it began).
"""

import argparse
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from hubsim.errors import HubsimError
from hubsim.swarm.vehicles import top_m_per_s
from hubsim.sweep.drives import DRIVES
from matplotlib.figure import Figure
from regen_table import plotting
from regen_table.cli import Parser
from studies.common import Study, markdown
from studies.healthy import drawn, rides
from studies.healthy.drawn import Ride, drive_of

RIDES = 2000
NOT_STARTED = "NOT_STARTED"
_SEPARATOR = "; "


@dataclass(frozen=True)
class Outcome:
    """What a ride was and what the controller said of it.

    ``reports`` 1: of the hydraulic torque; ``warnings``: reasons, each with the time in s at which
    it came first; ``limp_s``: when LIMP began, NaN never.
    """

    number: int
    drive: str
    sensor: str
    strategy: str
    begins: str
    reports: int
    soc: float
    ambient_c: float
    winding_c: float
    mass_kg: float
    duration_s: float
    distance_m: float
    largest_m_per_s: float
    stops: int
    warnings: str
    limp_s: float

    @property
    def within(self) -> bool:
        """Whether the ride is as it should be."""
        return not self.warnings and math.isnan(self.limp_s)

    @property
    def named(self) -> list[tuple[str, float]]:
        """Every warning and fault with its time."""
        pairs = (text.split(" ") for text in self.warnings.split(_SEPARATOR) if text)
        return [(name, float(time_s)) for name, time_s in pairs]


def measure(_place: int, ride: Ride) -> Outcome:
    """Make one ride."""
    try:
        rows, before = rides.simulated(ride)
        found = rides.shown(rows, before)
    except HubsimError:  # the controller does not come as far as RUN
        rows, found = np.zeros((1, len(rides.SIGNALS))), [(NOT_STARTED, 0.0)]
    return Outcome(
        number=ride.number,
        drive=ride.drive,
        sensor=ride.sensor,
        strategy=ride.strategy,
        begins=ride.begins,
        reports=ride.reports,
        soc=ride.soc,
        ambient_c=ride.ambient_c,
        winding_c=ride.winding_c,
        mass_kg=ride.plant["vehicle.mass_kg"],
        duration_s=float(rows[-1, rides.TIME]),
        distance_m=rides.distance_m(rows),
        largest_m_per_s=float(np.max(np.abs(rows[:, rides.SPEED]))),
        stops=rides.stops_of(rows),
        warnings=_SEPARATOR.join(f"{name} {time_s:.3f}" for name, time_s in found),
        limp_s=rides.limp_s(rows),
    )


def described(o: Outcome) -> str:
    """Return one ride with a warning in words."""
    limp = "" if math.isnan(o.limp_s) else f"; LIMP {o.limp_s:.3f}"
    return (
        f"ride {o.number}, {o.drive}, {o.sensor}, {o.strategy}, {o.begins}, charge "
        f"{100.0 * o.soc:.0f} %, {o.ambient_c:.0f} degC: {o.warnings or 'no warning'}{limp}"
    )


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each drive, and one for each ride that misses."""
    lines = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name]
        lines.append(
            f"{name}: {sum(o.within for o in here)} of {len(here)} rides without a warning or "
            f"LIMP; {sum(o.duration_s for o in here) / 3600.0:.2f} h, "
            f"{sum(o.distance_m for o in here) / 1000.0:.1f} km, "
            f"{sum(o.stops for o in here)} stops"
        )
    lines.extend(f"misses: {described(o)}" for o in outcomes if not o.within)
    return lines


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the tables of the page: drives with their sensors, and reasons."""
    rows = []
    for name in DRIVES:
        for sensor in drawn.SENSORS[name]:
            here = [o for o in outcomes if (o.drive, o.sensor) == (name, sensor)]
            rows.append(
                (
                    name,
                    sensor,
                    len(here),
                    f"{sum(o.duration_s for o in here) / 3600.0:.1f}",
                    f"{sum(o.distance_m for o in here) / 1000.0:.0f}",
                    sum(o.stops for o in here),
                    sum(bool(o.warnings) for o in here),
                    sum(not math.isnan(o.limp_s) for o in here),
                )
            )
    columns = (
        "drive",
        "rotor sensor",
        "rides",
        "h",
        "km",
        "stops",
        "with a warning",
        "with LIMP",
    )
    names = [name for o in outcomes for name, _ in o.named]
    reasons = [(f"`{name}`", names.count(name)) for name in sorted(set(names))]
    return {
        "drives": markdown(columns, rows),
        "reasons": markdown(("reason", "rides"), reasons or [("none", 0)]),
    }


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw largest speed over distance, a panel for each drive, rides with a warning in red."""
    made, panels = plotting.figure("Healthy rides", 2, 2, 10.0, 7.0)
    groups = (
        ("no warning", True, plotting.BLUE),
        ("warning or LIMP", False, plotting.RED),
    )
    for name, axes in zip(DRIVES, panels, strict=True):
        drive = drive_of(name, "hall", "series_optimal", False)
        top = top_m_per_s(drive)
        for text, within, colour in groups:
            here = [o for o in outcomes if o.drive == name and o.within is within]
            axes.plot(
                [o.distance_m for o in here],
                [o.largest_m_per_s / top for o in here],
                ".",
                color=colour,
                label=text,
            )
        axes.set(title=name, xlabel="distance, m", ylabel="fastest, of the largest speed")
    plotting.legend_below(made, panels[0], 2)
    return made


def more(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return what --json has besides."""
    return {
        "rides": len(outcomes),
        "warnings": [
            {"ride": o.number, "reason": name, "time_s": time_s}
            for o in outcomes
            for name, time_s in o.named
        ],
        "limp": sum(not math.isnan(o.limp_s) for o in outcomes),
    }


def some(text: str) -> range:
    """Return the rides A:B, B not among them."""
    found = re.fullmatch(r"(\d+):(\d+)", text)
    if found is None or int(found[1]) >= int(found[2]):
        raise argparse.ArgumentTypeError(f"{text!r}, accepted: A:B, rides A to B - 1, A below B")
    return range(int(found[1]), int(found[2]))


def more_options(parser: Parser) -> None:
    """Add which rides are made."""
    parser.add_argument(
        "--rides",
        type=some,
        default=range(RIDES),
        metavar="A:B",
        help=f"rides A to B - 1; default: 0:{RIDES}",
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="of what is drawn; default: 1"
    )


STUDY = Study(
    name="healthy",
    text=__doc__,
    outcome=Outcome,
    cases=lambda options: [drawn.draw(options.seed, number) for number in options.rides],
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    options=more_options,
    more=more,
)
main = STUDY.main
