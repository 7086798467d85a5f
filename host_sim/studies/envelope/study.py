# SPDX-License-Identifier: Apache-2.0
"""Every drive at the edges of its speed, torque, battery and temperatures.

Speed to 110 %, driving and braking demand, battery, charge limit and temperatures in a Latin
hypercube for each drive that comes along, from every start: standing, rolling, full, cold, rotor
sensor dead. Exit status 1 if a run with a good sensor has a fault.
"""

from collections.abc import Sequence

from hubsim.sweep import drives
from matplotlib.figure import Figure
from regen_table import plotting
from studies.common import Study, markdown, percent
from studies.envelope import runs
from studies.envelope.runs import NOT_STARTED, SENSOR_STARTS, Outcome

DEVIATION_MAX = 0.01  # of the rated torque
SHOWN = 0.05  # what lies beyond is drawn on the edge


def healthy(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return the runs with a sensor that works, of controllers that got to their speed."""
    return [o for o in outcomes if o.start not in SENSOR_STARTS and o.first_fault != NOT_STARTED]


def worst(outcomes: Sequence[Outcome], count: int = 5) -> list[Outcome]:
    """Return the runs that are furthest from the command, the demand or zero driving torque."""
    return sorted(outcomes, key=badness, reverse=True)[:count]


def badness(o: Outcome) -> float:
    """Return by how much a run misses, in tolerances: a fault counts as ten."""
    missed = max(o.deviation, o.sum_deviation, o.ripple) / DEVIATION_MAX
    return missed + (10.0 if o.first_fault and o.start not in SENSOR_STARTS else 0.0)


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say about a sweep, a line each."""
    lines = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = [o for o in outcomes if o.drive == name]
        sound = healthy(here)
        within = sum(badness(o) <= 1.0 for o in sound)
        lines.append(
            f"{name}: {within} of {len(sound)} runs with a good sensor within 1 % of rated; "
            f"torque - command at most {max(o.deviation for o in sound):.2%}, sum - demand at most "
            f"{max(o.sum_deviation for o in sound):.2%}, ripple at most "
            f"{max(o.ripple for o in sound):.2%} of rated; phase current at most "
            f"{max(o.current_share for o in here):.2f} of its limit, bus at most "
            f"{max(o.bus_share for o in here):.3f} of its; "
            f"{sum(bool(o.first_fault) for o in sound)} with a fault, "
            f"{sum(o.first_fault == NOT_STARTED for o in here)} not started; driving "
            f"under the brake at most {max(o.drove_nm for o in here):.2f} N m, "
            f"{max(o.drove_s for o in here):.3f} s"
        )
    lines.extend(f"worst: {described(o)}" for o in worst(healthy(outcomes)))
    return lines


def described(o: Outcome) -> str:
    """Return one run in words."""
    return (
        f"run {o.number}, {o.drive}, {o.start}, {percent(o.speed_share)} of the largest speed, "
        f"{o.demand_nm:.1f} N m, {o.open_circuit_v:.1f} V, winding {o.winding_c:.0f} degC, switch "
        f"{o.switch_c:.0f} degC, charge {o.charge_share:.2f}: torque {o.torque_nm:.2f}, command "
        f"{o.command_nm:.2f} N m, ripple {percent(o.ripple, 2)}, sum off "
        f"{percent(o.sum_deviation, 2)}, {o.first_fault or o.reason or 'no limit'}"
    )


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the tables of the page: a line for each drive, and the worst runs."""
    rows = []
    for name in dict.fromkeys(o.drive for o in outcomes):
        here = healthy([o for o in outcomes if o.drive == name])
        rows.append(
            (
                name,
                f"{sum(badness(o) <= 1.0 for o in here)} of {len(here)}",
                percent(max(o.deviation for o in here), 1),
                percent(max(o.sum_deviation for o in here), 1),
                percent(max(o.ripple for o in here), 1),
                f"{max(o.current_share for o in here):.2f}",
                f"{max(o.bus_share for o in here):.2f}",
                sum(bool(o.first_fault) for o in here),
            )
        )
    columns = (
        "drive",
        "within 1 %",
        "torque - command",
        "sum - demand",
        "ripple",
        "phase current",
        "bus",
        "faults",
    )
    furthest = [
        (
            o.number,
            o.drive,
            o.start,
            percent(o.speed_share),
            f"{o.demand_nm:.1f}",
            f"{o.open_circuit_v:.1f}",
            f"{o.winding_c:.0f}, {o.switch_c:.0f}",
            f"{o.torque_nm:.2f}",
            f"{o.command_nm:.2f}",
            percent(o.sum_deviation, 1),
            percent(o.ripple, 1),
            o.first_fault or o.reason,
        )
        for o in worst(healthy(outcomes))
    ]
    of_a_run = (
        "run",
        "drive",
        "start",
        "speed",
        "demand, N m",
        "open circuit, V",
        "winding, switch, °C",
        "torque, N m",
        "command, N m",
        "sum - demand",
        "ripple",
        "active bound",
    )
    return {"drives": markdown(columns, rows), "worst": markdown(of_a_run, furthest)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the deviation over speed, driving and braking, a panel for each drive."""
    names = list(dict.fromkeys(o.drive for o in outcomes))
    made, panels = plotting.figure(
        "Largest of |torque - command|, |sum - demand| and ripple over speed", 2,
        (len(names) + 1) // 2, 10.0, 7.0,
    )  # fmt: skip
    for name, axes in zip(names, panels, strict=False):
        for text, brakes, colour in (
            ("driving", False, plotting.BLUE),
            ("braking", True, plotting.ORANGE),
        ):
            here = [
                o for o in healthy(outcomes) if o.drive == name and (o.demand_nm < 0.0) == brakes
            ]
            missed = [min(max(o.deviation, o.sum_deviation, o.ripple), SHOWN) for o in here]
            axes.plot(
                [o.speed_share for o in here],
                [100.0 * m for m in missed],
                ".",
                color=colour,
                label=text,
            )
        axes.axhline(100.0 * DEVIATION_MAX, color="gray", linewidth=0.8)
        axes.set(
            title=name,
            xlabel="share of the largest speed",
            ylabel="% of the rated torque",
        )
        axes.set_ylim(0.0, 105.0 * SHOWN)
    plotting.legend_below(made, panels[0], 2)
    return made


STUDY = Study(
    name="envelope",
    text=__doc__,
    outcome=Outcome,
    cases=lambda options: runs.draw(drives.DRIVES, options.count, options.seed),
    measure=runs.measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: not any(o.first_fault for o in healthy(outcomes)),
    count=480,
)
main = STUDY.main
