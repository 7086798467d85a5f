# SPDX-License-Identifier: Apache-2.0
"""Two results side by side.

How far figures and signals lie apart, and whether that is within tolerances.

A side is a result that was written (JSON of ``hubsim run``, a recording as CSV or Parquet), or a
run that is done now (a built-in scenario or a TOML file). Signals are compared on the times of the
first side within the second side's, along straight lines; codes (modes, reasons) by their names;
figures one by one.
"""

import csv
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hubsim import files
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run import recordings

TIME = "time_s"
DIGITS = 1e-8  # what the digits of a recording leave of equal times
# How long the computer took is no property of what was computed, and the rounding that a residual
# is made of none of the vehicle.
_NOT_COMPARED = ("realtime_factor", "residual_relative", "energy.residual_j", "braking.residual_j")
_NOT_A_FIGURE = ("provenance", "observed")


@dataclass(frozen=True)
class Side:
    """One of two results: figures by name, signals of equal length by name, provenance if known."""

    name: str
    figures: Mapping[str, float]
    signals: Mapping[str, Rows]
    origin: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Tolerance:
    """What may lie between two values.

    ``absolute`` in their unit, and ``relative`` to the larger one (a signal: its peak; a code: the
    share of times).
    """

    absolute: float = 0.0
    relative: float = 0.0


@dataclass(frozen=True)
class Difference:
    """One figure or signal of both sides.

    Of a signal: means of both, the largest distance, its time, and the rms distance. Of a code
    (mode, reason), of which there is no mean: both names where they first differ, that time, and as
    the distance the share of times at which they differ.
    """

    name: str
    first: float | str
    second: float | str
    largest: float
    at_s: float | None
    rms: float | None
    within: bool

    def as_object(self) -> dict[str, Any]:
        """Return it for a JSON file, which has no NaN."""
        return {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in vars(self).items()
        }


def read(path: Path) -> Side:
    """Read a result that was written."""
    readers = {".json": _read_json, ".csv": _read_csv, ".parquet": _read_parquet}
    if path.suffix not in readers:
        raise HubsimError(f"{path}: accepted: {', '.join(readers)}, or a scenario")
    try:
        return readers[path.suffix](path)
    except HubsimError:
        raise
    except FileNotFoundError:
        raise HubsimError(f"{path}: file not found") from None
    except OSError as error:
        raise HubsimError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise HubsimError(
            f"{path}: no {path.suffix[1:]} file of a run: {' '.join(str(error).split())[:120]}"
        ) from error


def _read_json(path: Path) -> Side:
    found = json.loads(files.read_text(path))
    if not isinstance(found, dict):
        raise ValueError("an object is needed")
    return Side(str(path), figures_of(found), {}, found.get("provenance"))


def figures_of(found: Mapping[str, object]) -> dict[str, float]:
    """Return every number of an object, inner ones by dotted names."""
    out: dict[str, float] = {}
    for key, value in found.items():
        if isinstance(value, Mapping) and key not in _NOT_A_FIGURE:
            out |= {f"{key}.{name}": figure for name, figure in figures_of(value).items()}
        elif (
            isinstance(value, int | float)
            and not isinstance(value, bool)
            and key not in _NOT_COMPARED
        ):
            out[key] = float(value)
    return out


def _read_csv(path: Path) -> Side:
    lines = files.read_text(path).splitlines()
    names = next(csv.reader(lines[:1]), [])
    rows = np.loadtxt(lines[1:], delimiter=",", ndmin=2) if names else np.empty((0, 0))
    if rows.size and rows.shape[1] != len(names):
        raise ValueError(f"{rows.shape[1]} columns under {len(names)} headings")
    return _recorded(
        path, {name: rows[:, k] if rows.size else np.empty(0) for k, name in enumerate(names)}
    )


def _read_parquet(path: Path) -> Side:
    import pyarrow.parquet as pq  # noqa: PLC0415, a big library that only this needs

    table = pq.read_table(path)
    origin = (table.schema.metadata or {}).get(b"provenance")
    return _recorded(
        path,
        {name: table[name].to_numpy() for name in table.column_names},
        None if origin is None else json.loads(origin),
    )


def _recorded(
    path: Path, signals: dict[str, Rows], origin: Mapping[str, Any] | None = None
) -> Side:
    if TIME not in signals:
        raise ValueError(f"no column {TIME}")
    return Side(str(path), {}, signals, origin)


def compare(first: Side, second: Side, tolerance: Tolerance) -> list[Difference]:
    """Return every figure and signal that both sides have."""
    found = [
        _of_figures(name, value, second.figures[name], tolerance)
        for name, value in first.figures.items()
        if name in second.figures
    ]
    common = [name for name in first.signals if name in second.signals and name != TIME]
    if not common:
        return found
    time_s, other_s = first.signals[TIME], second.signals[TIME]
    if not len(time_s) or not len(other_s):
        raise HubsimError(f"{first.name if not len(time_s) else second.name}: no rows to compare")
    shared = (time_s >= other_s[0]) & (time_s <= other_s[-1])
    if not np.any(shared):
        raise HubsimError(f"{first.name} and {second.name}: no time in common")
    for name in common:
        one, other = first.signals[name][shared], second.signals[name]
        if recordings.is_code(name):
            after = time_s[shared] * (1.0 + DIGITS) + DIGITS
            latest = other[np.searchsorted(other_s, after, side="right") - 1]
            found.append(_of_codes(name, time_s[shared], one, latest, tolerance))
        else:
            types = {one.dtype.type, other.dtype.type}
            other = np.interp(time_s[shared], other_s, other)
            if np.float32 in types:  # as a recording has it
                one, other = one.astype(np.float32), other.astype(np.float32)
            found.append(_of_signals(name, time_s[shared], one, other, tolerance))
    return found


def only_in_one(first: Side, second: Side) -> list[str]:
    """Return the figures and signals that cannot be compared because one side lacks them."""
    return sorted(
        (set(first.figures) ^ set(second.figures)) | (set(first.signals) ^ set(second.signals))
    )


def _of_figures(name: str, one: float, other: float, tolerance: Tolerance) -> Difference:
    apart = abs(one - other)
    within = apart <= tolerance.absolute + tolerance.relative * max(abs(one), abs(other))
    return Difference(name, one, other, apart, None, None, within)


def _of_codes(name: str, time_s: Rows, one: Rows, other: Rows, tolerance: Tolerance) -> Difference:
    apart = np.flatnonzero((one != other) & ~(np.isnan(one) & np.isnan(other)))
    where = int(apart[0]) if len(apart) else 0
    first, second = (
        "nan" if np.isnan(codes[where]) else recordings.code_name(name, codes[where])
        for codes in (one, other)
    )
    share = len(apart) / len(one)
    at_s = float(time_s[where]) if len(apart) else None
    return Difference(name, first, second, share, at_s, None, share <= tolerance.relative)


def _of_signals(
    name: str, time_s: Rows, one: Rows, other: Rows, tolerance: Tolerance
) -> Difference:
    apart = np.abs(one - other)
    apart[np.isnan(one) & np.isnan(other)] = 0.0
    worst = int(np.argmax(np.where(np.isnan(apart), math.inf, apart)))
    peak = max((float(abs(x)) for x in (*one, *other) if not math.isnan(x)), default=0.0)
    within = bool(apart[worst] <= tolerance.absolute + tolerance.relative * peak)
    rms = float(np.sqrt(np.mean(apart**2)))
    means = [
        float(np.mean(rows[~np.isnan(rows)])) if np.any(~np.isnan(rows)) else math.nan
        for rows in (one, other)
    ]
    return Difference(
        name, means[0], means[1], float(apart[worst]), float(time_s[worst]), rms, within
    )
