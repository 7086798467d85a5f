# SPDX-License-Identifier: Apache-2.0
"""Loss parameters of a motor with its inverter from measured losses, and what these cannot tell."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from regen_table import least_squares, loss_model
from regen_table.errors import ConfigurationError
from regen_table.loss_model import BEND, CONSTANT, COPPER, GROWTH, INVERTER, NAMES, SLOPE, Rows
from regen_table.measured import RPM, Losses
from regen_table.models import Array
from regen_table.schema import Drive

BASE = (COPPER, CONSTANT, INVERTER, SLOPE)  # in the order in which a doubtful one is left out last
COPPER_PER_K = 0.00393
REFERENCE_C = 25.0
STARTING_SCATTER, LEAST_SCATTER = 0.05, 1e-6  # shares of the loss
FAR = 2.5  # standard deviations
FAR_SHARE = 0.977  # of a normal variance is left when its errors are cut off there
PASSES = 40  # at most, of weights and parameters in turn
STEPS = 30  # of Gauss and Newton
BEND_TRIALS = 13
LEAST_SHARE = 0.2  # of the measured loss, below which a fitted one does not count
INDEPENDENT = 1e-3  # share of a column that others must leave for its parameter to be fitted
TAKES_PART = 0.05  # share of such a column that another one must make up to be named
CORRELATED = 0.95
UNDETERMINED = 0.5  # standard deviation over value
SPARE_ROWS = 2
TORQUES = 20001  # among which the best is looked for, before a parabola through three of them


@dataclass(frozen=True)
class TorquePerAmpere:
    """T_e = factor i (1 - fall i^2), i the peak phase current; with standard deviations."""

    factor_nm_per_a: float
    fall_per_a2: float
    deviations: tuple[float, float]


@dataclass(frozen=True)
class CannotTell:
    """Something that the data leave open; ``parameters`` names what is confounded."""

    parameters: tuple[str, ...]
    text: str


@dataclass(frozen=True)
class Fit:
    """What was found.

    Attributes
    ----------
    values : array
        By the order of NAMES; zero where a parameter was not fitted.
    covariance : array
        Of the same order, from the residuals themselves (sandwich estimator), zero for what was not
        fitted.
    fitted : tuple of int
        Which were.
    scatter : float
        Standard deviation of a loss beyond the file's resolution, a share of it.
    points : Losses
        What it was fitted to.
    residual_w : array
        Measured less fitted loss.
    torque_per_ampere : TorquePerAmpere or None
        Where currents were measured.
    cannot_tell : tuple of CannotTell
    temperature_known : bool
        Whether ``copper`` holds at the reference temperature, or at the rows' unknown one.
    """

    values: Array
    covariance: Array
    fitted: tuple[int, ...]
    scatter: float
    points: Losses
    residual_w: Array
    torque_per_ampere: TorquePerAmpere | None
    cannot_tell: tuple[CannotTell, ...]
    temperature_known: bool

    @property
    def deviations(self) -> Array:
        """Standard deviations, in the order of NAMES."""
        return np.sqrt(np.diag(self.covariance))

    def value(self, parameter: int) -> float:
        """Return one parameter."""
        return float(self.values[parameter])

    def with_copper(self, factor: float) -> "Fit":
        """Return the fit with all its losses by current as of a warmer winding."""
        values = self.values.copy()
        values[[COPPER, GROWTH]] *= factor
        return replace(self, values=values)


def temperature_law(drive: Drive) -> dict[str, float]:
    """Return a drive's reference temperature and copper coefficient, as ``fit`` takes them."""
    return {
        "reference_temperature_c": drive.motor.reference_temperature_c,
        "copper_per_k": drive.motor.resistance_temperature_coefficient_per_k,
    }


def loss_w(found: Fit, speed_rad_s: Array, torque_nm: Array) -> Array:
    """Return the loss at shaft speeds and torques, at the temperature of the fit."""
    return loss_model.evaluate(found.values, loss_model.rows_at(speed_rad_s, torque_nm))[0]


def fit(
    points: Losses,
    winding_temperature_c: float | None = None,
    reference_temperature_c: float = REFERENCE_C,
    copper_per_k: float = COPPER_PER_K,
) -> Fit:
    """Fit the parameters that the points hold.

    Parameters
    ----------
    winding_temperature_c : float or None
        Of rows that have none of their own.
    reference_temperature_c, copper_per_k : float
        Where the copper loss is to hold, and its relative growth per K there.

    Raises
    ------
    ConfigurationError
        Too few points.
    """
    if len(points) <= SPARE_ROWS:
        raise ConfigurationError(f"{len(points)} points, accepted: at least {SPARE_ROWS + 1}")
    torque_per_ampere = _torque_per_ampere(points)
    rows, temperature_known = _rows(
        points, torque_per_ampere, winding_temperature_c, reference_temperature_c, copper_per_k
    )
    base, left_out = _excited(points, rows)
    least = len(base) + SPARE_ROWS
    if len(points) < least:
        raise ConfigurationError(f"{len(points)} points, accepted: at least {least}")
    best = _best_form(points, rows, base)
    left = points.loss_w - loss_model.evaluate(best.values, rows)[0]
    made = Fit(
        values=best.values,
        covariance=_covariance(best, points, rows, left),
        fitted=tuple(sorted(best.chosen)),
        scatter=best.scatter,
        points=points,
        residual_w=left,
        torque_per_ampere=torque_per_ampere,
        cannot_tell=(),
        temperature_known=temperature_known,
    )
    return replace(made, cannot_tell=(*left_out, *_confounded(made), *_by_nature(made)))


def _rows(
    points: Losses,
    torque_per_ampere: TorquePerAmpere | None,
    winding_temperature_c: float | None,
    reference_c: float,
    per_k: float,
) -> tuple[Rows, bool]:
    """Return the points as the model needs them, and whether their temperatures are known."""
    given = np.nan if winding_temperature_c is None else winding_temperature_c
    temperature = np.where(
        np.isfinite(points.winding_temperature_c), points.winding_temperature_c, given
    )
    known = np.isfinite(temperature)
    warmth = np.where(known, 1.0 + per_k * (np.where(known, temperature, 0.0) - reference_c), 1.0)
    for k in np.flatnonzero(warmth <= 0.0)[:1]:
        raise ConfigurationError(
            f"winding temperature {temperature[k]:g} degC leaves no resistance, accepted: one that"
            " leaves some"
        )
    factor = np.nan if torque_per_ampere is None else torque_per_ampere.factor_nm_per_a
    rows = Rows(
        points.speed_rad_s,
        points.torque_nm,
        points.switching.astype(np.float64),
        factor * points.current_a,
        warmth,
    )
    return rows, bool(np.all(known | ~points.switching))


def _torque_per_ampere(points: Losses) -> TorquePerAmpere | None:
    """Fit T = factor (i - fall i^3) - constant - slope Omega, i signed as the torque."""
    known = points.where(np.isfinite(points.current_a) & (points.torque_nm != 0.0))
    if len(known) == 0:
        return None
    signed = known.current_a * np.sign(known.torque_nm)
    full = [signed, -(signed**3), -np.ones(len(known)), -known.speed_rad_s]
    several_speeds = len(np.unique(np.round(known.speed_rad_s, 6))) > 1
    design = np.stack(full if several_speeds else full[:3], axis=1)
    if len(known) < design.shape[1] + SPARE_ROWS:
        raise ConfigurationError(
            f"{len(known)} rows with current_a, accepted: none, or at least"
            f" {design.shape[1] + SPARE_ROWS}"
        )
    scale = np.max(np.abs(design), axis=0)
    found = np.linalg.lstsq(design / scale, known.torque_nm, rcond=None)[0] / scale
    spread = least_squares.sandwich(design, known.torque_nm - design @ found)
    factor, cubic = float(found[0]), float(found[1])
    fall = cubic / factor
    gradient = np.array([[1.0, 0.0], [-fall / factor, 1.0 / factor]])
    deviations = np.sqrt(np.diag(gradient @ spread[:2, :2] @ gradient.T))
    return TorquePerAmpere(factor, fall, (float(deviations[0]), float(deviations[1])))


def _excited(points: Losses, rows: Rows) -> tuple[tuple[int, ...], list[CannotTell]]:
    """Return the parameters that these points can tell from each other, and what is left out."""
    loaded = points.switching & (points.torque_nm != 0.0)
    start = np.zeros(len(NAMES))
    start[CONSTANT] = 1e-3
    columns = loss_model.evaluate(start, rows)[1] / points.loss_w[:, np.newaxis]
    chosen: list[int] = []
    left_out = []
    if not np.any(loaded):
        text = "no row has a torque: the losses by current are not in these data"
        left_out.append(CannotTell((NAMES[COPPER], NAMES[INVERTER]), text))
    for parameter in BASE:
        if parameter in (COPPER, INVERTER) and not np.any(loaded):
            continue
        norm = np.linalg.norm(columns[:, parameter])
        if norm == 0.0:
            left_out.append(
                CannotTell((NAMES[parameter],), f"{NAMES[parameter]}: no current flows")
            )
            continue
        column = columns[:, parameter] / norm
        others = columns[:, chosen] / np.linalg.norm(columns[:, chosen], axis=0)
        shares = np.linalg.lstsq(others, column, rcond=None)[0] if chosen else np.zeros(0)
        if np.linalg.norm(column - others @ shares) >= INDEPENDENT:
            chosen.append(parameter)
            continue
        with_it = [k for k, share in zip(chosen, shares, strict=True) if abs(share) > TAKES_PART]
        names = (NAMES[parameter], *(NAMES[k] for k in with_it))
        how = "one speed" if parameter in (CONSTANT, SLOPE) else "one torque"
        text = (
            f"{how} alone: {names[0]} is taken as zero, what it stands for is contained in"
            f" {' and '.join(names[1:])}"
        )
        left_out.append(CannotTell(names, text))
    return tuple(chosen), left_out


def _optional(points: Losses, rows: Rows, base: tuple[int, ...]) -> set[int]:
    """Return the parameters that are fitted only where the data show them."""
    optional = set()
    if {CONSTANT, SLOPE} <= set(base) and len(np.unique(np.round(points.speed_rad_s, 3))) > 3:
        optional.add(BEND)
    unmeasured = points.torque_nm[points.switching & ~np.isfinite(rows.load_nm)]
    if {COPPER, INVERTER} <= set(base) and len(np.unique(np.round(np.abs(unmeasured), 6))) > 3:
        optional.add(GROWTH)
    return optional if len(points) >= len(base) + len(optional) + SPARE_ROWS else set()


@dataclass(frozen=True)
class _Solution:
    values: Array
    chosen: tuple[int, ...]
    scatter: float
    sigma_w: Array
    criterion: float  # Bayesian information criterion: the least is the best


def _best_form(points: Losses, rows: Rows, base: tuple[int, ...]) -> _Solution:
    """Return the best set of parameters, beginning with the base, one more at a time."""
    best = _solved(points, rows, base)
    left = _optional(points, rows, base)
    while left:
        tried = [_solved(points, rows, (*best.chosen, extra)) for extra in sorted(left)]
        found = min(tried, key=lambda solution: solution.criterion)
        if found.criterion >= best.criterion:
            return best
        best = found
        left -= set(best.chosen)
    return best


def _solved(points: Losses, rows: Rows, chosen: tuple[int, ...]) -> _Solution:
    """Return the parameters of a form: deviations of the points and parameters in turn.

    The deviations follow the fitted loss, not the measured one, whose error would be in them.
    Residuals beyond FAR deviations count linearly (Huber's proposal 2: Annals of Mathematical
    Statistics 35, 1964), so that single wrong points do not move the others.
    """
    straight = tuple(k for k in chosen if k != BEND)
    scatter = STARTING_SCATTER
    sigma = _sigma(points, points.loss_w, scatter)
    values = np.zeros(len(NAMES))
    values[CONSTANT] = 1e-3
    values = _least_squares(points, rows, straight, values, sigma)
    if BEND in chosen:
        values = _bent(points, rows, straight, values, sigma)
    for _ in range(PASSES):
        fitted = loss_model.evaluate(values, rows)[0]
        scale = _scale(points, fitted)
        sigma = _sigma(points, scale, scatter)
        left = np.abs(points.loss_w - fitted)
        near = np.square(np.minimum(left, FAR * sigma)) / FAR_SHARE - np.square(points.resolution_w)
        excess = float(np.sum(near / np.square(scale))) / (len(points) - len(chosen))
        before, scatter = scatter, math.sqrt(max(excess, LEAST_SCATTER**2))
        counted = sigma * np.sqrt(np.maximum(left / (FAR * sigma), 1.0))
        values = _least_squares(points, rows, chosen, values, counted)
        if abs(scatter - before) < 1e-4 * before:
            break
    distance = np.abs(points.loss_w - loss_model.evaluate(values, rows)[0]) / sigma
    squares = np.where(distance < FAR, distance**2, 2.0 * FAR * distance - FAR**2)
    likelihood = float(np.sum(squares + 2.0 * np.log(sigma / points.loss_w)))
    criterion = likelihood + len(chosen) * math.log(len(points))
    return _Solution(values, chosen, scatter, counted, criterion)


def _scale(points: Losses, fitted_w: Array) -> Array:
    """Return the loss that a point's deviation is a share of: the fitted one."""
    return np.maximum(fitted_w, LEAST_SHARE * points.loss_w)


def _sigma(points: Losses, loss_w: Array, scatter: float) -> Array:
    return np.hypot(points.resolution_w, scatter * loss_w)


def _bent(
    points: Losses, rows: Rows, straight: tuple[int, ...], start: Array, sigma: Array
) -> Array:
    """Return the best of some bends, each with the other parameters that belong to it."""
    low, high = 0.1 / np.max(rows.speed), 10.0 / np.min(rows.speed)
    best, least = start, np.inf
    for bend in np.geomspace(low, high, BEND_TRIALS):
        values = start.copy()
        values[BEND] = bend
        values[SLOPE] *= 1.0 + bend * float(np.mean(rows.speed))
        values = _least_squares(points, rows, straight, values, sigma)
        squares = _squares(points, rows, values, sigma)
        if squares < least:
            best, least = values, squares
    return best


def _squares(points: Losses, rows: Rows, values: Array, sigma: Array) -> float:
    left = points.loss_w - loss_model.evaluate(values, rows)[0]
    return float(np.sum(np.square(left / sigma)))


def _least_squares(
    points: Losses, rows: Rows, chosen: Sequence[int], start: Array, sigma: Array
) -> Array:
    """Return the chosen parameters that leave the least weighted squares, none below zero.

    Steps of Gauss and Newton; one that would not lower the sum is halved.
    """
    weight = 1.0 / sigma
    values, squares = start, _squares(points, rows, start, sigma)
    columns = list(chosen)
    highest_bend = 10.0 / float(np.min(rows.speed))
    for _ in range(STEPS):
        loss, jacobian = loss_model.evaluate(values, rows)
        part = jacobian[:, columns]
        wanted = points.loss_w - loss + part @ values[columns]
        goal = values.copy()
        goal[columns] = least_squares.non_negative(part * weight[:, np.newaxis], wanted * weight)
        goal[BEND] = min(goal[BEND], highest_bend)
        share = 1.0
        while share > 1e-3:
            trial = values + share * (goal - values)
            left = _squares(points, rows, trial, sigma)
            if left < squares:
                break
            share *= 0.5
        else:
            return values
        gain, values, squares = squares - left, trial, left
        if gain <= 1e-10 * squares:
            return values
    return values


def _covariance(solution: _Solution, points: Losses, rows: Rows, left: Array) -> Array:
    """Return the parameters' covariance, zero for what was not fitted."""
    weight = 1.0 / solution.sigma_w
    chosen = [k for k in solution.chosen if k != BEND or solution.values[SLOPE] > 0.0]
    design = loss_model.evaluate(solution.values, rows)[1][:, chosen] * weight[:, np.newaxis]
    covariance = np.zeros((len(NAMES), len(NAMES)))
    covariance[np.ix_(chosen, chosen)] = least_squares.sandwich(design, left * weight)
    return covariance


def _confounded(found: Fit) -> list[CannotTell]:
    """Return the pairs whose estimates move together, and what is not determined at all."""
    left_open = []
    deviations = found.deviations
    for one, other in combinations(found.fitted, 2):
        if deviations[one] > 0.0 and deviations[other] > 0.0:
            ratio = found.covariance[one, other] / (deviations[one] * deviations[other])
            if abs(ratio) >= CORRELATED:
                names = NAMES[one], NAMES[other]
                text = f"{names[0]} and {names[1]} move together (correlation {ratio:+.2f})"
                left_open.append(CannotTell(names, text))
    for k in found.fitted:
        if deviations[k] > UNDETERMINED * found.values[k]:
            text = f"{NAMES[k]} is not determined: {found.values[k]:.3g} +- {deviations[k]:.2g}"
            left_open.append(CannotTell((NAMES[k],), text))
    return left_open


def _by_nature(found: Fit) -> list[CannotTell]:
    """Return what no measurement of this kind can tell, however exact."""
    left_open = []
    fitted, points = set(found.fitted), found.points
    if COPPER in fitted:
        left_open.append(
            CannotTell(
                ("phase_resistance_ohm", "switch_resistance_ohm"),
                "resistance of winding and of switches: both losses grow with the current's square",
            )
        )
        if found.torque_per_ampere is None:
            left_open.append(
                CannotTell(
                    ("phase_resistance_ohm", "flux_linkage_wb"),
                    "resistance and flux linkage: without current_a only resistance over the"
                    " square of the flux",
                )
            )
        if not found.temperature_known:
            left_open.append(
                CannotTell(
                    ("phase_resistance_ohm", "winding_temperature_c"),
                    "the winding's temperature: the copper loss holds for the unknown one of these"
                    " rows",
                )
            )
        if not np.any(points.torque_nm < 0.0):
            left_open.append(
                CannotTell(
                    (NAMES[COPPER],),
                    "no row brakes: that the winding is as warm while braking, and the torque per"
                    " ampere the same, is an assumption",
                )
            )
    if GROWTH in fitted:
        left_open.append(
            CannotTell(
                ("torque_per_ampere", "winding_temperature_c"),
                "why the copper loss grows faster than the torque's square: torque per ampere that"
                " falls, or a winding that was warmer at large torque",
            )
        )
    left_open.append(
        CannotTell(
            ("hysteresis", "friction_torque_nm"),
            "hysteresis and Coulomb friction: both are a drag that does not depend on speed",
        )
    )
    if SLOPE in fitted:
        left_open.append(
            CannotTell(
                ("iron_loss_resistance_ohm", "viscous_friction_nm_s"),
                "eddy currents and viscous friction: both drags grow with speed",
            )
        )
    return left_open


@dataclass(frozen=True)
class Best:
    """Best braking at one speed, shaft quantities, magnitudes; zero where none returns energy."""

    speed_rpm: float
    torque_nm: float
    torque_deviation_nm: float
    power_w: float


def best_braking(found: Fit, speed_rpm: float) -> Best:
    """Return the shaft torque that returns the most power, with what the parameters leave open."""
    torque, power = _best(found, speed_rpm)
    gradient = np.zeros(len(NAMES))
    for k in found.fitted:
        step = max(1e-4 * found.values[k], 1e-3 * found.deviations[k])
        if step > 0.0:
            values = found.values.copy()
            values[k] += step
            gradient[k] = (_best(replace(found, values=values), speed_rpm)[0] - torque) / step
    deviation = math.sqrt(max(float(gradient @ found.covariance @ gradient), 0.0))
    return Best(speed_rpm, torque, deviation, power)


def _best(found: Fit, speed_rpm: float) -> tuple[float, float]:
    speed = RPM * speed_rpm
    copper = found.value(COPPER)
    if copper <= 0.0:
        return 0.0, 0.0
    # Without any other loss it lies at speed / (2 copper); the drag, which the brake need not
    # supply, adds at most itself.
    highest = speed / (2.0 * copper) + float(loss_model.drag_nm(found.values, np.array(speed)))
    torque = np.linspace(0.0, highest, TORQUES)
    power = torque * speed - loss_w(found, np.array(speed), -torque)
    k = int(np.clip(np.argmax(power), 1, TORQUES - 2))
    before, at, after = power[k - 1], power[k], power[k + 1]
    bent = before - 2.0 * at + after
    shift = 0.5 * float(before - after) / float(bent) if bent < 0.0 else 0.0
    if at <= 0.0:
        return 0.0, 0.0
    return float(torque[k] + shift * (torque[1] - torque[0])), float(at)


def copper_factor(found: Fit, braking: Losses) -> tuple[float, float]:
    """Return by what factor the losses by current are larger in other points, with its deviation.

    One parameter, least squares with the weights of the fit.
    """
    rows = loss_model.rows_at(braking.speed_rad_s, braking.torque_nm)
    loss, jacobian = loss_model.evaluate(found.values, rows)
    by_current = jacobian[:, [COPPER, GROWTH]] @ found.values[[COPPER, GROWTH]]
    weight = 1.0 / _sigma(braking, _scale(braking, loss), found.scatter)
    design, wanted = by_current * weight, (braking.loss_w - loss + by_current) * weight
    factor = float(design @ wanted / (design @ design))
    spread = least_squares.sandwich(design[:, np.newaxis], wanted - factor * design)
    return factor, float(np.sqrt(spread[0, 0]))
