# SPDX-License-Identifier: Apache-2.0
"""Formulas over signals, parameters and energies, as criteria and sweeps use them.

The grammar is Python's own (its parser reads them), with dotted names for quantities and a handful
of functions::

    max(abs(total(wheels.motor_torque_nm) + total(wheels.hydraulic_torque_nm)))
    0.5 * plant.vehicle.mass_kg * plant.run.initial_speed_m_per_s ** 2

A value is a number, a row over time of shape (times,), or one row for each wheel of shape (wheels,
times). Rows hold NaN outside the window of a criterion; the reductions ignore it.

Only the syntax listed in ``_check`` is accepted, before the run, and every name is known before the
run, so that the signals it needs are recorded. That, element-wise logic and NaN windows are why no
evaluator from a package is used. simpleeval refuses arrays in ``*``, ``**``, ``and`` and ``not``.
numexpr knows neither dotted names nor reductions that ignore NaN. asteval accepts a language with
loops, calls and attributes, which would have to be forbidden one by one, and its ``and`` asks an
array for a single truth value.
"""

import ast
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
import numpy.typing as npt

Value = npt.NDArray[Any]
Lookup = Callable[[str], Value]

MAX_LENGTH = 1000


class ExpressionError(ValueError):
    """A formula that cannot be read or evaluated; one line."""


class EmptyWindow(ValueError):  # noqa: N818, not every exception is an error: a window may be empty
    """The window holds no row to reduce."""


def _seen(x: Value) -> Value:
    flat = x[~np.isnan(x)]
    if flat.size == 0:
        raise EmptyWindow
    return flat


def _extreme(
    pick: Callable[[Value], Any], pairwise: Callable[[Value, Value], Value]
) -> Callable[..., Value]:
    def function(*rows: Value) -> Value:
        return np.asarray(pick(_seen(rows[0]))) if len(rows) == 1 else reduce(pairwise, rows)

    return function


def _end(which: int) -> Callable[[Value], Value]:
    """First or last instant of the window; the mean over the wheels where there are several."""

    def function(x: Value) -> Value:
        rows = np.atleast_2d(x)
        kept = rows[:, ~np.any(np.isnan(rows), axis=0)]
        if kept.shape[1] == 0:
            raise EmptyWindow
        return np.asarray(np.mean(kept[:, which]))

    return function


def _at(pick: Callable[[Value], Any]) -> Callable[[Value, Value], Value]:
    """Say what x is where y is extreme."""

    def function(x: Value, y: Value) -> Value:
        x, y = np.broadcast_arrays(x, y)
        both = ~np.isnan(x) & ~np.isnan(y)
        if not np.any(both):
            raise EmptyWindow
        return np.asarray(x[both][pick(y[both])])

    return function


@dataclass(frozen=True)
class Function:
    """A function of formulas.

    Its largest number of arguments, what it computes, and its description.
    """

    arguments: int
    compute: Callable[..., Value]
    text: str


FUNCTIONS: dict[str, Function] = {
    "abs": Function(1, np.abs, "magnitude"),
    "sqrt": Function(1, np.sqrt, "square root"),
    "round": Function(1, np.round, "nearest whole number"),
    "exp": Function(1, np.exp, "exponential"),
    "min": Function(
        9,
        _extreme(np.min, np.minimum),
        "smallest in the window; of several values the smaller, instant by instant",
    ),
    "max": Function(
        9,
        _extreme(np.max, np.maximum),
        "largest in the window; of several values the larger, instant by instant",
    ),
    "mean": Function(1, lambda x: np.asarray(np.mean(_seen(x))), "mean of the window's rows"),
    "rms": Function(
        1, lambda x: np.asarray(np.sqrt(np.mean(_seen(x) ** 2))), "root of the mean square"
    ),
    "span": Function(1, lambda x: np.asarray(np.ptp(_seen(x))), "largest less smallest"),
    "initial": Function(1, _end(0), "at the window's first row, mean of the wheels"),
    "final": Function(1, _end(-1), "at the window's last row, mean of the wheels"),
    "total": Function(
        1, lambda x: np.sum(np.atleast_2d(x), axis=0), "sum over the wheels, instant by instant"
    ),
    "at_min": Function(2, _at(np.argmin), "at_min(x, y): x where y is smallest"),
    "at_max": Function(2, _at(np.argmax), "at_max(x, y): x where y is largest"),
    "change": Function(1, lambda x: np.diff(x, axis=-1, prepend=np.nan), "from row to row"),
    "integral": Function(
        1, lambda x: np.asarray(np.nan), "over time, of the window's rows; a rate's is exact"
    ),
}
_ARITHMETIC: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.Pow: operator.pow,
}  # fmt: skip
_COMPARISONS: Mapping[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
    ast.Eq: operator.eq, ast.NotEq: operator.ne,
}  # fmt: skip


@dataclass(frozen=True)
class Formula:
    """A formula that has been read; ``names`` are the quantities it needs."""

    text: str
    tree: ast.expr
    names: tuple[str, ...]

    def value(self, lookup: Lookup) -> Value:
        """Work it out.

        ``lookup`` gives the value of a name and, under ``""``, the time from row to row in s.
        """
        with np.errstate(all="ignore"):
            return _evaluate(self.tree, lookup)


def read(text: str) -> Formula:
    """Read a formula, and refuse what is none."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"longer than {MAX_LENGTH} characters")
    try:
        tree = ast.parse(f"({text.strip()})", mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(
            f"{_short(text)} cannot be read, accepted: a formula like "
            "max(abs(vehicle.speed_m_per_s)) / 2"
        ) from None
    names: dict[str, None] = {}
    _check(tree, names)
    return Formula(text, tree, tuple(names))


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")


def dotted(node: ast.expr) -> str | None:
    """Return the dotted name that a node is, or None."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return f"{before}.{node.attr}" if before else None
    return None


def _check(node: ast.expr, names: dict[str, None]) -> None:
    name = dotted(node)
    if name is not None:
        names[name] = None
        return
    children: list[ast.expr]
    match node:
        case ast.Constant(value=value) if isinstance(value, int | float) and not isinstance(
            value, bool
        ):
            children = []
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() | ast.Not(), operand=operand):
            children = [operand]
        case ast.BinOp(op=op, left=left, right=right) if type(op) in _ARITHMETIC:
            children = [left, right]
        case ast.BoolOp(values=values):
            children = values
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
            children = [left, right]
        case ast.Call(func=ast.Name(id=function), args=arguments, keywords=[]):
            _check_call(function, len(arguments))
            children = arguments
        case _:
            known = f"numbers, names, + - * / **, comparisons, and, or, not, {', '.join(FUNCTIONS)}"
            raise ExpressionError(
                f"{_short(ast.unparse(node))} is no part of a formula, accepted: {known}"
            )
    for child in children:
        _check(child, names)


def _check_call(function: str, arguments: int) -> None:
    if function not in FUNCTIONS:
        raise ExpressionError(f"no function {function!r}, accepted: {', '.join(FUNCTIONS)}")
    most = FUNCTIONS[function].arguments
    least = most if most == 2 else 1
    if not least <= arguments <= most:
        raise ExpressionError(
            f"{function} with {arguments} arguments, accepted: {least}"
            + (f" to {most}" if most > least else "")
        )


def _evaluate(node: ast.expr, lookup: Lookup) -> Value:
    name = dotted(node)
    if name is not None:
        return lookup(name)
    match node:
        case ast.Constant(value=value):
            out: Any = value
        case ast.UnaryOp(op=op, operand=operand):
            inner = _evaluate(operand, lookup)
            out = (
                -inner
                if isinstance(op, ast.USub)
                else ~inner.astype(bool)
                if isinstance(op, ast.Not)
                else inner
            )
        case ast.BinOp(op=op, left=left, right=right):
            out = _ARITHMETIC[type(op)](_evaluate(left, lookup), _evaluate(right, lookup))
        case ast.BoolOp(op=op, values=parts):
            join = np.logical_and if isinstance(op, ast.And) else np.logical_or
            out = reduce(join, [_evaluate(part, lookup).astype(bool) for part in parts])
        case ast.Compare(left=left, ops=[comparison], comparators=[right]):
            out = _COMPARISONS[type(comparison)](_evaluate(left, lookup), _evaluate(right, lookup))
        case ast.Call(func=ast.Name(id=function), args=arguments):
            rows = [_evaluate(argument, lookup) for argument in arguments]
            out = (
                _integral(rows[0], lookup(""))
                if function == "integral"
                else FUNCTIONS[function].compute(*rows)
            )
        case _:
            raise AssertionError("read() lets nothing else through")
    return np.asarray(out)


def _integral(x: Value, steps_s: Value) -> Value:
    """Sum of value times the time since the row before.

    The account of a recorded rate. Over all wheels.
    """
    return np.asarray(np.sum(_seen(x * steps_s)))
