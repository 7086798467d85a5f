# SPDX-License-Identifier: Apache-2.0
"""The loss model beside public measurements of motors, predicted and measured.

An in-wheel motor's motoring and regenerating efficiency maps (fit to the one, prediction of the
other), another one's motoring map (every second speed fitted, the others predicted), a measured
flux map beside constant inductances, and what the paper states in numbers. --data names the folder
of the files, which are not part of this repository; what is missing is named with its source. Exit
status 1 if an error is larger than accepted.
"""

import argparse
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.sweep.drives import drive_named
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from regen_table import flux_files, loss_fit, measured, plotting
from regen_table.cli import Parser
from regen_table.flux_map import Checks, FluxMap
from regen_table.loss_fit import Fit
from regen_table.measured import RPM, Losses
from studies.common import Study, markdown, percent
from studies.measured import maps

FASTEST_RPM = 680.0  # above it the field of the in-wheel motor is weakened
SPEEDS_RPM = (80.0, 155.0, 230.0, 305.0, 380.0, 455.0, 530.0, 605.0, 680.0)  # of the braking map
OPTIMUM_RPM = (80.0, 155.0, 230.0)  # where it holds the torque of most power
FACTOR_RPM = (230.0, 530.0)  # whose braking points give the copper factor
EQUAL_TORQUE_NM = 40.0  # from which on the losses of both maps are compared
ALONE, FACTOR, BOTH = "motoring map", "motoring map, one copper factor", "both maps"
FITS = (ALONE, FACTOR, BOTH)
WHEEL, OTHER, FLUX, PAPER = "GEM 1.3 wheel", "GEM 2.6 wheel", "Baldor flux map", "Lu 2013"
# The constants whose torque is compared with the flux map: magnet flux linkage, L_d and L_q of
# chords at a middle torque.
FLUX_WB, D_H, Q_H, PAIRS = 0.4441, 0.017, 0.1012, 2
FLUX_TORQUES_NM = (10.0, 30.0, 44.0)
PAPER_VOLTAGE_V, PAPER_CURRENT_A = 53.0, 30.0
NO_BOUND = math.inf

# What an error may be at most: of the fit to the motoring map, and with the copper factor.
MEDIAN, PERCENTILE_90 = 0.03, 0.08  # of the shaft power
OPTIMUM = {ALONE: {80.0: 0.14, 155.0: 0.14}, FACTOR: {80.0: 0.06, 155.0: 0.02}, BOTH: {}}
STOP_LOST = {FACTOR: 0.002}  # of the energy of a stop


@dataclass(frozen=True)
class Case:
    """One comparison; ``data`` is the folder of the files, '' where none is read."""

    data: str
    source: str
    fitted_to: str
    quantity: str
    speed_rpm: float = 0.0
    accepted: float = NO_BOUND


@dataclass(frozen=True)
class Outcome:
    """What a model says and what was measured.

    Attributes
    ----------
    fitted_to : str
        What its parameters are from.
    speed_rpm : float
        0 where the quantity is of all speeds.
    predicted, measured : float
        In ``unit``; not a number where the quantity is an error itself.
    error : float
        Relative, signed; of quantities that are errors: their value.
    accepted : float
        Largest magnitude of the error, infinite without a bound.
    """

    number: int
    source: str
    fitted_to: str
    quantity: str
    speed_rpm: float
    unit: str
    predicted: float
    measured: float
    error: float
    accepted: float

    @property
    def within(self) -> bool:
        """Whether the error is accepted."""
        return abs(self.error) <= self.accepted


MEDIAN_ERROR = "error of the regenerated power, median"
PERCENTILE_ERROR = "error of the regenerated power, 90th percentile"
BEST_TORQUE = "torque of most regenerated power"
STOP = "energy of a stop to 80 r/min"
COPPER = "copper loss while braking over driving"
EQUAL_LOSS = "loss while braking over driving, equal torque"
MIRRORED = "torque of most power, driving loss as measured"
STEP = "torque of a step of current, last over first"
CROSS_MEDIAN = "error of the loss at the other speeds, median"
CROSS_PERCENTILE = "error of the loss at the other speeds, 90th percentile"
FLUX_TORQUE = "torque of constant inductances at {:g} N m"
RECIPROCITY = "difference of the cross inductances"
RATED = "torque of 30 A rms"
TOP_SPEED = "speed that 53 V reach"


@functools.cache
def driving(data: str) -> Losses:
    """Return the in-wheel motor's motoring map."""
    return maps.efficiency_map(maps.DRIVING.under(Path(data)), False, FASTEST_RPM)


@functools.cache
def braking(data: str) -> Losses:
    """Return the in-wheel motor's regenerating map."""
    return maps.efficiency_map(maps.BRAKING.under(Path(data)), True, FASTEST_RPM)


@functools.cache
def fitted(data: str, fitted_to: str) -> Fit:
    """Return the model of the in-wheel motor."""
    if fitted_to == BOTH:
        return loss_fit.fit(measured.joined([driving(data), braking(data)]))
    alone = loss_fit.fit(driving(data))
    return alone if fitted_to == ALONE else alone.with_copper(copper_factor(data)[0])


def copper_factor(data: str) -> tuple[float, float]:
    """Return the factor of the copper loss that braking points of middle speeds ask for."""
    points = braking(data)
    rpm = points.speed_rad_s / RPM
    low, high = FACTOR_RPM
    middle = points.where((rpm > low - 1.0) & (rpm < high + 1.0))
    return loss_fit.copper_factor(loss_fit.fit(driving(data)), middle)


def at_speed(points: Losses, rpm: float) -> Losses:
    """Return the points of one speed, torque magnitudes rising."""
    here = points.where(np.abs(points.speed_rad_s / RPM - rpm) < 1.0)
    order = np.argsort(np.abs(here.torque_nm))
    return here.where(order)


def curve(x: Rows, y: Rows) -> Callable[[Rows], Rows]:
    """Return the cubic Hermite curve through points, slopes of parabolas through three of them."""
    slope = np.gradient(y, x, edge_order=2)

    def at(where: Rows) -> Rows:
        k = np.clip(np.searchsorted(x, where) - 1, 0, len(x) - 2)
        step = x[k + 1] - x[k]
        u = (where - x[k]) / step
        return np.asarray(
            y[k] * (1.0 + 2.0 * u) * (1.0 - u) ** 2
            + y[k + 1] * u * u * (3.0 - 2.0 * u)
            + step * u * (1.0 - u) * (slope[k] * (1.0 - u) - slope[k + 1] * u)
        )

    return at


def returned(data: str, rpm: float) -> tuple[Rows, Rows]:
    """Return torques and the power that the measured map returns there, W."""
    here = at_speed(braking(data), rpm)
    torque = np.linspace(-here.torque_nm[0], -here.torque_nm[-1], 20001)
    return torque, curve(-here.torque_nm, -here.electrical_power_w)(torque)


def power_errors(case: Case) -> Rows:
    """Return the magnitudes of the errors of the regenerated power, of the shaft power."""
    points = braking(case.data)
    if case.speed_rpm > 0.0:
        points = at_speed(points, case.speed_rpm)
    loss = loss_fit.loss_w(fitted(case.data, case.fitted_to), points.speed_rad_s, points.torque_nm)
    return np.abs((loss - points.loss_w) / points.shaft_power_w)


def _median_error(case: Case) -> tuple[str, float, float, float]:
    return "of shaft power", math.nan, math.nan, float(np.median(power_errors(case)))


def _percentile_error(case: Case) -> tuple[str, float, float, float]:
    return "of shaft power", math.nan, math.nan, float(np.percentile(power_errors(case), 90.0))


def _best_torque(case: Case) -> tuple[str, float, float, float]:
    torque, power = returned(case.data, case.speed_rpm)
    found = loss_fit.best_braking(fitted(case.data, case.fitted_to), case.speed_rpm).torque_nm
    return _pair("N m", found, float(torque[np.argmax(power)]))


def _stop(case: Case) -> tuple[str, float, float, float]:
    """Decelerate constantly from FASTEST_RPM; the hydraulic brake takes what the motor does not.

    The demand is larger than any torque measured, so that the optimum counts at every speed; time
    passes in proportion to speed. Powers are those of the measured map.
    """
    found, best = [], []
    for rpm in SPEEDS_RPM:
        torque, power = returned(case.data, rpm)
        ours = loss_fit.best_braking(fitted(case.data, case.fitted_to), rpm).torque_nm
        found.append(float(np.interp(ours, torque, power)))
        best.append(float(np.max(power)))
    speeds = np.array(SPEEDS_RPM)
    energies = [float(np.trapezoid(power, speeds)) / np.ptp(speeds) for power in (found, best)]
    return _pair("W mean", energies[0], energies[1])


def _copper(case: Case) -> tuple[str, float, float, float]:
    return _pair("1", 1.0, copper_factor(case.data)[0])


def _equal_loss(case: Case) -> tuple[str, float, float, float]:
    """Median over the torques that both maps have from EQUAL_TORQUE_NM up."""
    one, other = (at_speed(points(case.data), case.speed_rpm) for points in (driving, braking))
    most = min(float(np.max(np.abs(points.torque_nm))) for points in (one, other))
    torque = np.linspace(EQUAL_TORQUE_NM, most, 200)
    loss, braking_loss = (
        curve(np.abs(points.torque_nm), points.loss_w)(torque) for points in (one, other)
    )
    return _pair("1", 1.0, float(np.median(braking_loss / loss)))


def _mirrored(case: Case) -> tuple[str, float, float, float]:
    """Take the motoring map's own loss at the same torque as that of braking: no model at all."""
    here = at_speed(driving(case.data), case.speed_rpm)
    torque, power = returned(case.data, case.speed_rpm)
    loss = curve(here.torque_nm, here.loss_w)(torque)
    found = float(torque[np.argmax(torque * RPM * case.speed_rpm - loss)])
    return _pair("N m", found, float(torque[np.argmax(power)]))


def _step(case: Case) -> tuple[str, float, float, float]:
    """Compare torques of equal steps of current, which a speed has from its third point on."""
    steps = np.diff(at_speed(driving(case.data), case.speed_rpm).torque_nm)[2:]
    return _pair("N m", float(steps[0]), float(steps[-1]))


@functools.cache
def cross_validation(data: str) -> Rows:
    """Return the errors at every second speed of the fit to the others, of the shaft power."""
    points = maps.efficiency_map(maps.OTHER_DRIVING.under(Path(data)), False, FASTEST_RPM)
    rpm = np.round(points.speed_rad_s / RPM)
    speeds = np.unique(rpm)
    fits = np.isin(rpm, speeds[::2])
    rest = points.where(~fits)
    loss = loss_fit.loss_w(loss_fit.fit(points.where(fits)), rest.speed_rad_s, rest.torque_nm)
    return np.abs((loss - rest.loss_w) / rest.shaft_power_w)


def _cross_median(case: Case) -> tuple[str, float, float, float]:
    return "of shaft power", math.nan, math.nan, float(np.median(cross_validation(case.data)))


def _cross_percentile(case: Case) -> tuple[str, float, float, float]:
    return (
        "of shaft power",
        math.nan,
        math.nan,
        float(np.percentile(cross_validation(case.data), 90.0)),
    )


@functools.cache
def flux_map(data: str) -> tuple[FluxMap, Checks]:
    """Return the flux map, and what its reading checked."""
    return flux_files.load(maps.FLUX_MAP.under(Path(data)))


def _flux_torque(wanted_nm: float) -> Callable[[Case], tuple[str, float, float, float]]:
    def compared(case: Case) -> tuple[str, float, float, float]:
        """Least current for the torque with constants; the map's torque at these currents."""
        found = flux_map(case.data)[0]
        i_d = np.linspace(-18.0, 0.0, 3601)
        i_q = wanted_nm / (1.5 * PAIRS * (FLUX_WB + (D_H - Q_H) * i_d))
        k = int(np.argmin(i_d * i_d + i_q * i_q))
        return _pair("N m", wanted_nm, float(found.torque_nm(PAIRS, i_d[k], i_q[k])))

    return compared


def _reciprocity(case: Case) -> tuple[str, float, float, float]:
    share = flux_map(case.data)[1].reciprocity_share
    return "of the smallest inductance", math.nan, math.nan, share


def _rated(_case: Case) -> tuple[str, float, float, float]:
    motor = drive_named("lu2013").motor
    peak_a = math.sqrt(2.0) * PAPER_CURRENT_A
    found = 1.5 * motor.pole_pairs * motor.flux_linkage_wb * peak_a
    return _pair("N m", found, motor.rated_torque_nm)


def _top_speed(_case: Case) -> tuple[str, float, float, float]:
    """Let the EMF reach the inverter's largest peak phase voltage, u_dc / sqrt 3."""
    drive = drive_named("lu2013")
    omega = PAPER_VOLTAGE_V / (math.sqrt(3.0) * drive.motor.flux_linkage_wb)
    found = 3.6 * omega / drive.motor.pole_pairs * drive.vehicle.wheel_radius_m
    return _pair("km/h", found, 60.0)


def _pair(unit: str, predicted: float, found: float) -> tuple[str, float, float, float]:
    return unit, predicted, found, predicted / found - 1.0


COMPARISONS: dict[str, Callable[[Case], tuple[str, float, float, float]]] = {
    MEDIAN_ERROR: _median_error,
    PERCENTILE_ERROR: _percentile_error,
    BEST_TORQUE: _best_torque,
    STOP: _stop,
    COPPER: _copper,
    EQUAL_LOSS: _equal_loss,
    MIRRORED: _mirrored,
    STEP: _step,
    CROSS_MEDIAN: _cross_median,
    CROSS_PERCENTILE: _cross_percentile,
    **{FLUX_TORQUE.format(torque): _flux_torque(torque) for torque in FLUX_TORQUES_NM},
    RECIPROCITY: _reciprocity,
    RATED: _rated,
    TOP_SPEED: _top_speed,
}


def listed(data: str) -> list[Case]:
    """Return every comparison."""

    def wheel(fitted_to: str, quantity: str, rpm: float = 0.0, most: float = NO_BOUND) -> Case:
        return Case(data, WHEEL, fitted_to, quantity, rpm, most)

    found = []
    for name in FITS:
        bounded = name != BOTH
        found += [
            wheel(name, MEDIAN_ERROR, most=MEDIAN if bounded else NO_BOUND),
            wheel(name, PERCENTILE_ERROR, most=PERCENTILE_90 if bounded else NO_BOUND),
            *(
                wheel(name, BEST_TORQUE, rpm, OPTIMUM[name].get(rpm, NO_BOUND))
                for rpm in OPTIMUM_RPM
            ),
            wheel(name, STOP, most=STOP_LOST.get(name, NO_BOUND)),
            *(wheel(name, MEDIAN_ERROR, rpm) for rpm in SPEEDS_RPM),
        ]
    found.append(wheel(ALONE, COPPER))
    found += [wheel("nothing", EQUAL_LOSS, rpm) for rpm in OPTIMUM_RPM]
    found += [wheel("nothing", MIRRORED, rpm) for rpm in OPTIMUM_RPM]
    found.append(wheel("nothing", STEP, SPEEDS_RPM[0]))
    half = "every second speed"
    found += [Case(data, OTHER, half, name) for name in (CROSS_MEDIAN, CROSS_PERCENTILE)]
    constants = "magnet flux and two inductances"
    found += [Case(data, FLUX, constants, FLUX_TORQUE.format(t)) for t in FLUX_TORQUES_NM]
    found.append(Case(data, FLUX, "nothing", RECIPROCITY))
    found += [Case("", PAPER, "Table 1", RATED), Case("", PAPER, "Table 1", TOP_SPEED)]
    return found


def measure(number: int, case: Case) -> Outcome:
    """Make one comparison."""
    unit, predicted, found, error = COMPARISONS[case.quantity](case)
    return Outcome(
        number=number,
        source=case.source,
        fitted_to=case.fitted_to,
        quantity=case.quantity,
        speed_rpm=case.speed_rpm,
        unit=unit,
        predicted=predicted,
        measured=found,
        error=error,
        accepted=case.accepted,
    )


def named(outcome: Outcome) -> str:
    """Return a quantity with its speed."""
    at = f" at {outcome.speed_rpm:g} r/min" if outcome.speed_rpm > 0.0 else ""
    return outcome.quantity + at


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each error that is bounded, and for each that is not within."""
    return [
        f"{o.source}, fitted to {o.fitted_to}: {named(o)}: error {percent(o.error, 2)}, accepted"
        f" {percent(o.accepted, 1)}{'' if o.within else ', NOT within'}"
        for o in outcomes
        if o.accepted < NO_BOUND
    ]


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the tables of the page: what is bounded, speeds, why, and the other sources."""
    wheel = [o for o in outcomes if o.source == WHEEL]
    whole = [o for o in wheel if o.fitted_to in FITS and o.quantity != COPPER]
    by_speed = [o for o in whole if o.quantity == MEDIAN_ERROR and o.speed_rpm > 0.0]
    reasons = [o for o in wheel if o not in whole]
    rest = [o for o in outcomes if o.source != WHEEL]
    speeds = [
        (f"{rpm:g}", *(percent(o.error, 1) for o in by_speed if o.speed_rpm == rpm))
        for rpm in SPEEDS_RPM
    ]
    return {
        "wheel": _lines([o for o in whole if o not in by_speed], "fitted to"),
        "speeds": markdown(("r/min", *FITS), speeds),
        "reasons": _lines(reasons),
        "others": _lines(rest, "source", "fitted to"),
    }


def _lines(outcomes: Sequence[Outcome], *before: str) -> str:
    texts = {"source": lambda o: o.source, "fitted to": lambda o: o.fitted_to}
    rows = [
        (
            *(texts[name](o) for name in before),
            named(o),
            _number(o.predicted, o.unit),
            _number(o.measured, o.unit),
            percent(o.error, 1),
            "" if math.isinf(o.accepted) else percent(o.accepted, 1),
        )
        for o in outcomes
    ]
    return markdown((*before, "quantity", "predicted", "measured", "error", "accepted"), rows)


def _number(value: float, unit: str) -> str:
    if math.isnan(value):
        return ""
    return f"{value:.4g}" + ("" if unit == "1" else f" {unit}")


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the torque of most power and the errors of the power over speed."""
    made, (best, errors) = plotting.figure(
        "An in-wheel motor's braking, predicted from its driving", 2, width=10.0, height=4.4
    )
    colours = dict(zip(FITS, (plotting.ORANGE, plotting.BLUE, plotting.GREEN), strict=True))
    wheel = [o for o in outcomes if o.source == WHEEL]
    optima = [o for o in wheel if o.quantity == BEST_TORQUE]
    _draw(best, [o for o in optima if o.fitted_to == ALONE], "measured", plotting.GREY, "o")
    mirrored = [o for o in wheel if o.quantity == MIRRORED]
    _draw(best, mirrored, "driving loss as measured, no model", plotting.RED, "x", predicted=True)
    for name, colour in colours.items():
        here = [o for o in optima if o.fitted_to == name]
        _draw(best, here, f"fitted to {name}", colour, "_", predicted=True)
        median = [
            o
            for o in wheel
            if o.quantity == MEDIAN_ERROR and o.fitted_to == name and o.speed_rpm > 0.0
        ]
        errors.plot(
            [o.speed_rpm for o in median],
            [100.0 * o.error for o in median],
            ".-",
            color=colour,
            label=f"fitted to {name}",
        )
    best.set(xlabel="r/min", ylabel="N m", title="torque of most regenerated power")
    best.set_ylim(0.0, None)
    errors.set(
        xlabel="r/min", ylabel="% of the shaft power", title="error of regenerated power, median"
    )
    errors.set_ylim(0.0, None)
    plotting.legend_below(made, best, 3)
    return made


def _draw(
    axes: Axes,
    outcomes: Sequence[Outcome],
    label: str,
    colour: str,
    mark: str,
    predicted: bool = False,
) -> None:
    axes.plot(
        [o.speed_rpm for o in outcomes],
        [o.predicted if predicted else o.measured for o in outcomes],
        mark,
        color=colour,
        markersize=12.0 if mark == "_" else 6.0,
        markeredgewidth=2.0,
        label=label,
    )


def data_option(parser: Parser) -> None:
    """Add the folder of the files."""
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the files")


def chosen(options: argparse.Namespace) -> list[Case]:
    """Return every comparison, refusing without all files."""
    if options.data is None:
        wanted = "; ".join(source.origin for source in maps.SOURCES)
        raise HubsimError(f"--data: missing, accepted: a folder with {wanted}")
    for source in maps.SOURCES:
        source.under(options.data)
    return listed(str(options.data))


STUDY = Study(
    name="measured",
    text=__doc__,
    outcome=Outcome,
    cases=chosen,
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    options=data_option,
)
main = STUDY.main
