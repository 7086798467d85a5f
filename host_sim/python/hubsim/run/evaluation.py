# SPDX-License-Identifier: Apache-2.0
"""The criteria of a scenario, evaluated for a finished run."""

import math
from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from regen_table.schema import Drive
from regen_table.suggest import suggestion

from hubsim import engine, reasons
from hubsim.errors import HubsimError
from hubsim.run import ideal_stop, unguarded
from hubsim.run.results import RunResult
from hubsim.scenario import Scenario, expression, fitting
from hubsim.scenario.criteria import Criterion
from hubsim.scenario.expression import EmptyWindow, ExpressionError, Value
from hubsim.scenario.quantities import Quantities

RESIDUAL_MOST = 1e-4  # of the energy turned over: a larger residual is an error of the simulation
_ACCOUNTS = ("energy.", "braking.")
_WHEELS = "wheels."


@dataclass(frozen=True)
class CriterionResult:
    """Value and result of one criterion; ``value`` is NaN where the window held no row.

    One that does not apply to the drive has passed; ``remark`` says why it does not.
    """

    name: str
    passed: bool
    value: float
    at_least: float | None = None
    at_most: float | None = None
    unit: str = ""
    text: str = ""
    remark: str = ""
    applies: bool = True

    def as_object(self) -> dict[str, Any]:
        """Return it for a JSON file, which has neither NaN nor infinity."""
        return {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in vars(self).items()
        }


# What formulas call run.*: figures of the run as a whole.
RUN_FIGURES: Mapping[str, Callable[[RunResult], float]] = {
    "duration_s": lambda r: r.duration_s,
    "distance_m": lambda r: r.distance_m,
    "kinetic_energy_j": lambda r: r.kinetic_energy_j,
    "soc_initial": lambda r: r.soc[0],
    "soc_final": lambda r: r.soc[1],
    "returned_j": lambda r: r.returned_j,
    "braking_work_j": lambda r: r.braking_work_j,
    "braking_share_stored": lambda r: r.braking_share_stored,
    "traction_j": lambda r: r.driving_j("chemical"),
    "residual_relative": lambda r: r.residual_relative,
    "stopped": lambda r: float(bool(r.stopped)),
    "faults": lambda r: float(len(r.faults)),
    "series_optimal": lambda r: float(r.strategy == "series_optimal"),
}
# Worked out where a formula names them: hubsim.run.unguarded, hubsim.run.ideal_stop.
KEPT_SHARE, IDEAL_SHARE = "run.kept_share", "run.ideal_share"


def constants(scenario: Scenario, drive: Drive) -> Mapping[str, float]:
    """Return what formulas may name that is known before the run.

    Numbers of the scenario, and what quantities.py knows of the drive.
    """
    return ChainMap(scenario.constants, cast(dict[str, float], Quantities(drive)))


def missing(criterion: Criterion, scenario: Scenario, drive: Drive) -> list[str]:
    """Return what a criterion needs and the drive does not have, in words."""
    return fitting.missing(criterion.needs, scenario.source, constants(scenario, drive))


def scalars(scenario: Scenario, drive: Drive, known: Sequence[str]) -> set[str]:
    """Return every name of a formula that is one number for a whole run.

    ``known`` are the signals.
    """
    own = {
        *constants(scenario, drive),
        *(f"plant.{name}" for name in engine.parameters()),
        *(f"run.{name}" for name in RUN_FIGURES),
        KEPT_SHARE,
        IDEAL_SHARE,
    }
    return own | {name for name in known if name.startswith(_ACCOUNTS)}


def signals_of(
    scenario: Scenario, drive: Drive, known: Sequence[str], formulas: Iterable[str] = ()
) -> list[str]:
    """Return the signals that the criteria of a scenario and further formulas use.

    An unknown name is refused.
    """
    single = scalars(scenario, drive, known)
    wanted: set[str] = set()
    looked_at = [
        (f"criteria.{name}.{key}", f)
        for name, criterion in scenario.criteria.items()
        if not missing(criterion, scenario, drive)
        for key, f in criterion.formulas.items()
    ]
    for place, formula in [*looked_at, *((text, expression.read(text)) for text in formulas)]:
        try:
            wanted |= {"time_s", *signals_named(formula.names, known, single)}
            if KEPT_SHARE in formula.names:
                wanted |= set(unguarded.SIGNALS)
        except ExpressionError as error:
            raise HubsimError(f"{scenario.source}: {place}: {error}") from error
    return [name for name in known if name in wanted]


def signals_named(names: Iterable[str], known: Sequence[str], scalars: Iterable[str]) -> set[str]:
    """Return the signals that the names of a formula stand for."""
    wheels: dict[str, set[str]] = {}
    for signal in known:
        head, _, tail = signal.partition(".")
        if head.startswith("wheel"):
            wheels.setdefault(f"{_WHEELS}{tail}", set()).add(signal)
    wanted: set[str] = set()
    for name in names:
        if name in wheels:
            wanted |= wheels[name]
        elif name in known and not name.startswith(_ACCOUNTS):
            wanted.add(name)
        elif name not in scalars:
            everything = "'hubsim list --signals' and '--parameters' show what there is"
            hint = suggestion(name, [*known, *wheels, *scalars], everything)
            raise ExpressionError(f"no quantity {name!r}, {hint}")
    return wanted


class Evaluator:
    """Values of names for the formulas of one run.

    Parameters
    ----------
    result : RunResult
        Every signal used by the formulas is recorded.
    scenario, drive
        Of the run: formulas may name their keys and the times of events.
    """

    def __init__(self, result: RunResult, scenario: Scenario, drive: Drive) -> None:
        self._result, self._drive, self._scenario = result, drive, scenario
        self._time_s = result.signal("time_s") if "time_s" in result.names else np.empty(0)
        self._constants = constants(scenario, drive)
        self._scalars = {
            **{f"plant.{name}": value for name, value in result.parameters.items()},
            **result.account_j,
            **{f"run.{name}": figure(result) for name, figure in RUN_FIGURES.items()},
        }
        self._window: Value | None = None

    def number(self, text: float | str) -> float:
        """Evaluate a limit or a time: a number, or a formula whose value is one."""
        return (
            float(text)
            if isinstance(text, float | int)
            else self._single(expression.read(text).value(self._lookup), text)
        )

    def value(self, text: str) -> Value:
        """Evaluate a formula in the present window."""
        return expression.read(text).value(self._lookup)

    def single(self, text: str) -> float:
        """Evaluate a formula whose value must be one number in the present window."""
        return self._single(self.value(text), text)

    @staticmethod
    def _single(value: Value, text: str) -> float:
        if value.ndim != 0:
            raise ExpressionError(
                f"{text!r} changes over time, accepted: one number, as of max(), min(), mean(), "
                "final(), ..."
            )
        return float(value)

    def set_window(self, criterion: Criterion) -> None:
        """Set the window of a criterion."""
        self._window = None
        first = self.number(criterion.from_s)
        last = math.inf if criterion.until_s is None else self.number(criterion.until_s)
        seen: Value = (self._time_s >= first - 1e-9) & (self._time_s <= last + 1e-9)
        if criterion.where is not None:
            seen = seen & self.value(criterion.where).astype(bool)
        self._window = seen

    def _lookup(self, name: str) -> Value:
        if name == "":
            return np.diff(self._time_s, prepend=self._time_s[:1])
        if name == KEPT_SHARE:
            signals = {signal: self._result.signal(signal) for signal in unguarded.SIGNALS}
            return np.asarray(
                unguarded.kept_share(
                    self._drive, signals, self._result.returned_j, self._result.wheels
                )
            )
        if name == IDEAL_SHARE:
            return np.asarray(ideal_stop.stored_share(self._drive, self._scenario))
        for known in (self._constants, self._scalars):
            if name in known:
                return np.asarray(known[name])
        rows = self._rows(name)
        if self._window is None:
            return rows
        wide = rows.shape if rows.ndim >= self._window.ndim else self._window.shape
        return np.where(self._window, np.broadcast_to(rows, wide), np.nan)

    def _rows(self, name: str) -> Value:
        if name.startswith(_WHEELS):
            own = [f"wheel{k}.{name.removeprefix(_WHEELS)}" for k in range(self._result.wheels)]
            return np.stack([self._result.signal(signal) for signal in own])
        return self._result.signal(name)


def evaluate(scenario: Scenario, drive: Drive, result: RunResult) -> list[CriterionResult]:
    """Return the result of every criterion and of the energy residual; empty without criteria.

    Raises
    ------
    HubsimError
        For a formula with an unknown name, or whose value is no number; one line with source
        and key.
    """
    evaluator = Evaluator(result, scenario, drive)
    out = []
    for name, criterion in scenario.criteria.items():
        if lacking := missing(criterion, scenario, drive):
            remark = f"does not apply: needs {', '.join(lacking)}"
            out.append(
                CriterionResult(
                    name,
                    True,
                    math.nan,
                    unit=criterion.unit,
                    text=criterion.text,
                    remark=remark,
                    applies=False,
                )
            )
            continue
        try:
            evaluator.set_window(criterion)
            out.append(_evaluate(name, criterion, evaluator))
        except EmptyWindow:
            out.append(
                CriterionResult(
                    name,
                    False,
                    math.nan,
                    unit=criterion.unit,
                    text=criterion.text,
                    remark="no row in the window",
                )
            )
        except ExpressionError as error:
            raise HubsimError(f"{scenario.source}: criteria.{name}: {error}") from error
    if out:
        residual = result.residual_relative
        text = "energy: sources less sinks less storage, over the energy turned over"
        out.append(
            CriterionResult(
                "residual",
                residual <= RESIDUAL_MOST,
                residual,
                at_most=RESIDUAL_MOST,
                unit="1",
                text=text,
            )
        )
    return out


def _evaluate(name: str, criterion: Criterion, evaluator: Evaluator) -> CriterionResult:
    if criterion.reasons is not None:
        return _evaluate_reasons(name, criterion, evaluator.value(criterion.reasons))
    assert criterion.value is not None
    if criterion.settles_to is not None:
        return _evaluate_settling(name, criterion, evaluator)
    value = evaluator.single(criterion.value)
    low = None if criterion.at_least is None else evaluator.number(criterion.at_least)
    high = None if criterion.at_most is None else evaluator.number(criterion.at_most)
    passed = (
        math.isfinite(value) and (low is None or value >= low) and (high is None or value <= high)
    )
    return CriterionResult(name, passed, value, low, high, criterion.unit, criterion.text)


def _evaluate_settling(name: str, criterion: Criterion, evaluator: Evaluator) -> CriterionResult:
    """Evaluate the settling time.

    From the window's beginning to the first row after which the value stays in the band.
    """
    assert (
        criterion.value is not None
        and criterion.settles_to is not None
        and criterion.band is not None
        and criterion.within_s is not None
    )
    rows = np.atleast_2d(evaluator.value(criterion.value))
    time_s = evaluator.value("time_s")
    time_s = time_s if time_s.ndim == 1 else time_s[0]
    away = np.abs(rows - evaluator.number(criterion.settles_to)) > evaluator.number(criterion.band)
    seen = np.flatnonzero(~np.all(np.isnan(rows), axis=0) & ~np.isnan(time_s))
    if seen.size == 0:
        raise EmptyWindow
    outside = np.flatnonzero(np.any(away, axis=0))
    most = evaluator.number(criterion.within_s)
    if outside.size and outside[-1] == seen[-1]:
        last = rows[:, outside[-1]]
        remark = f"never settles: {last[np.argmax(np.abs(last))]:.4g} at the end"
        return CriterionResult(
            name, False, math.nan, at_most=most, unit="s", text=criterion.text, remark=remark
        )
    after = seen[seen > outside[-1]][0] if outside.size else seen[0]
    settled_s = float(time_s[after]) - evaluator.number(criterion.from_s)
    return CriterionResult(
        name, settled_s <= most, settled_s, at_most=most, unit="s", text=criterion.text
    )


def _evaluate_reasons(name: str, criterion: Criterion, codes: Value) -> CriterionResult:
    rows = np.atleast_2d(codes)
    rows = rows[:, ~np.all(np.isnan(rows), axis=0)]
    if rows.shape[1] == 0:
        raise EmptyWindow
    present = {int(code) for code in rows[~np.isnan(rows)]}
    shown = {
        wanted: float(np.mean(np.any(np.isin(rows, list(reasons.meant(wanted))), axis=0)))
        for wanted in criterion.must_appear
    }
    absent = [wanted for wanted, share in shown.items() if share <= 0.0 or share < criterion.share]
    unwanted = sorted(
        {
            reasons.identifier(code)
            for bad in criterion.must_not_appear
            for code in reasons.meant(bad) & present
        }
    )
    remarks = [f"missing: {', '.join(absent)}"] if absent else []
    remarks += [f"appeared: {', '.join(unwanted)}"] if unwanted else []
    found = ", ".join(reasons.identifier(code) for code in sorted(present))
    return CriterionResult(name, not remarks, float(len(absent) + len(unwanted)), at_most=0.0,
        text=criterion.text,
                   remark="; ".join([*remarks, f"seen: {found}"]))  # fmt: skip
