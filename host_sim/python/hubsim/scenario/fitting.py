# SPDX-License-Identifier: Apache-2.0
"""A scenario's file, fitted to a drive: formulas in place of numbers are worked out.

A text where a number belongs that names ``drive.`` or ``scenario.`` quantities is a formula:
``initial_speed_kmh = "0.5 * drive.top_speed_kmh"``. Keys of the scenario itself may be named after
they were given, in the file's order.
"""

from collections import ChainMap
from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np
from regen_table import schema
from regen_table.schema import Drive
from regen_table.suggest import suggestion

from hubsim.errors import HubsimError
from hubsim.scenario import expression
from hubsim.scenario.expression import ExpressionError
from hubsim.scenario.quantities import Quantities

SECTIONS = ("plant", "events")  # after the keys at the top; criteria keep their formulas
APART = ("drive", "criteria", "needs", *SECTIONS)
_OWN = ("drive.", "scenario.")
Known = dict[str, float]


def fitted(
    data: Mapping[str, Any], source: str, drive: Drive, change: Callable[[Mapping[str, Any]], Drive]
) -> dict[str, Any]:
    """Return a scenario's keys with numbers for formulas.

    Parameters
    ----------
    data : mapping
        As read, with the command line's settings.
    source : str
        Where it was read, for messages.
    drive : Drive
        As its file and the command line have it; formulas under ``[drive]`` name its quantities.
    change : callable
        Returns the drive with the scenario's ``[drive]``, whose quantities all others name.
    """
    out = dict(data)
    if isinstance(data.get("drive"), Mapping):
        out["drive"] = _worked_out(data["drive"], "drive", source, Quantities(drive), {})
        drive = change(out["drive"])
    known, own = Quantities(drive), Known()
    for key in data:
        if key not in APART:
            out[key] = _worked_out(data[key], key, source, known, own)
            if isinstance(out[key], int | float) and not isinstance(out[key], bool):
                own[f"scenario.{key}"] = float(out[key])
    for key in SECTIONS:
        if key in data:
            out[key] = _worked_out(data[key], key, source, known, own)
    return out


def missing(needs: object, source: str, known: Mapping[str, float]) -> list[str]:
    """Return which of some conditions, by their words, do not hold for known quantities."""
    lacking = []
    for words, text in needs.items() if isinstance(needs, Mapping) else ():
        formula = expression.read(str(text))
        _check_names(formula, f"{source}: needs", known)
        if not formula.value(lambda name: np.asarray(known[name])):
            lacking.append(str(words))
    return lacking


def _check_names(formula: expression.Formula, place: str, known: Mapping[str, float]) -> None:
    for name in formula.names:
        if name not in known:
            everything = "'hubsim list --criteria' shows the figures of a drive"
            hint = suggestion(name, list(known), everything)
            raise HubsimError(f"{place}: no quantity {name!r}, {hint}")


def named(value: object) -> set[str]:
    """Return the names of all quantities in the formulas of a scenario's keys."""
    if isinstance(value, str):
        formula = _formula(value)
        return set(formula.names) if formula is not None else set()
    if isinstance(value, Mapping):
        value = list(value.values())
    return set().union(*map(named, value)) if isinstance(value, list) else set()


def _formula(text: str) -> expression.Formula | None:
    """Read a text that names quantities of the drive or the scenario; None for any other."""
    if not any(own in text for own in _OWN):
        return None
    try:
        found = expression.read(text)
    except ExpressionError:
        return None
    return found if any(name.startswith(_OWN) for name in found.names) else None


def _worked_out(
    value: Any,  # noqa: ANN401, whatever TOML can say
    key: str,
    source: str,
    known: Mapping[str, float],
    own: Known,
) -> Any:  # noqa: ANN401
    if isinstance(value, Mapping):
        return {k: _worked_out(v, f"{key}.{k}", source, known, own) for k, v in value.items()}
    if isinstance(value, list):
        return [_worked_out(v, key, source, known, own) for v in value]
    formula = _formula(value) if isinstance(value, str) else None
    if formula is None:
        return value
    everything = ChainMap(own, cast(Known, known))
    _check_names(formula, f"{source}: {key}", everything)
    return float(formula.value(lambda name: np.asarray(everything[name])))


def changed(drive: Drive, changes: Mapping[tuple[str, str], Any], source: str) -> Drive:
    """Return a drive with other values of some keys, checked as a file is.

    ``changes`` are by (section, key).
    """
    if not changes:
        return drive
    data = drive.model_dump(exclude_none=True, exclude_unset=True)
    for (section, name), value in changes.items():
        data.setdefault(section, {})[name] = value
    return schema.parse(data, name=drive.name, source=source)
