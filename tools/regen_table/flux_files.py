# SPDX-License-Identifier: Apache-2.0
"""Flux maps from files.

CSV, Parquet    columns i_d_a, i_q_a, psi_d_wb, psi_q_wb; a row for each point of a grid
NPZ             arrays i_d_a, i_q_a (axes or grids) and psi_d_wb, psi_q_wb (grids); or complex
                grids i_s_dq and psi_s_dq, as motulator writes them
"""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from regen_table import inputs, installation
from regen_table.errors import ConfigurationError
from regen_table.flux_map import SAME_A, Checks, FluxMap, checked
from regen_table.models import Array

COLUMNS = ("i_d_a", "i_q_a", "psi_d_wb", "psi_q_wb")
WHAT = f"a table with the columns {', '.join(COLUMNS)}"
ARRAYS = f"an NPZ file with {', '.join(COLUMNS)}, or with i_s_dq and psi_s_dq"


def load(path: Path) -> tuple[FluxMap, Checks]:
    """Read a map, check it and make it symmetrical in i_q.

    Raises
    ------
    ConfigurationError
        One line: file, line or place with its value, what is accepted.
    """
    if path.suffix == ".npz":
        found = _from_npz(path)
    elif path.suffix == ".parquet":
        found = _from_columns(path, _parquet_columns(path), None)
    else:
        text, lines = inputs.read_numbered_table(
            path, WHAT, lambda names: set(COLUMNS) <= set(names)
        )
        found = _from_columns(path, _numbers(path, text, lines), lines)
    try:
        return checked(found)
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def _numbers(path: Path, text: dict[str, list[str]], lines: list[int]) -> dict[str, Array]:
    columns = {}
    for name in COLUMNS:
        values = []
        for line, cell in zip(lines, text[name], strict=True):
            try:
                values.append(float(cell))
            except ValueError:
                values.append(np.nan)
            if not np.isfinite(values[-1]):
                raise ConfigurationError(
                    f"{path}:{line}: {name} {cell.strip()!r}, accepted: a finite number"
                )
        columns[name] = np.array(values, dtype=np.float64)
    return columns


def _parquet_columns(path: Path) -> dict[str, Array]:
    try:
        import pyarrow as pa  # noqa: PLC0415, an optional package
        from pyarrow import parquet  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise ConfigurationError(installation.missing(error)) from error
    try:
        table = parquet.read_table(path, columns=list(COLUMNS))
        columns = {name: np.asarray(table[name].to_numpy(), np.float64) for name in COLUMNS}
    except (OSError, pa.ArrowException, KeyError, ValueError, TypeError) as error:
        raise ConfigurationError(f"{path}: accepted: {WHAT}, numbers alone") from error
    _refuse_infinite(path, columns)
    return columns


def _refuse_infinite(path: Path, columns: dict[str, Array]) -> None:
    for name, values in columns.items():
        if not np.all(np.isfinite(values)):
            raise ConfigurationError(
                f"{path}: {name} has a value that is not finite, accepted: none"
            )


def _from_columns(path: Path, columns: dict[str, Array], lines: list[int] | None) -> FluxMap:
    """Return the grid of a list of points, each of which must occur once."""
    axes = [_axis(columns[name]) for name in COLUMNS[:2]]
    places = [
        np.argmin(np.abs(columns[name][:, np.newaxis] - axis), axis=1)
        for name, axis in zip(COLUMNS[:2], axes, strict=True)
    ]
    grids = [np.full((len(axes[0]), len(axes[1])), np.nan) for _ in range(2)]
    for row, (j, k) in enumerate(zip(*places, strict=True)):
        if np.isfinite(grids[0][j, k]):
            where = path if lines is None else f"{path}:{lines[row]}"
            raise ConfigurationError(
                f"{where}: i_d = {axes[0][j]:g} A, i_q = {axes[1][k]:g} A a second time, accepted:"
                " once"
            )
        for grid, name in zip(grids, COLUMNS[2:], strict=True):
            grid[j, k] = columns[name][row]
    for j, k in np.argwhere(np.isnan(grids[0])):
        raise ConfigurationError(
            f"{path}: nothing at i_d = {axes[0][j]:g} A, i_q = {axes[1][k]:g} A, accepted: every"
            " point of a grid"
        )
    return FluxMap(axes[0], axes[1], grids[0], grids[1])


def _axis(values: Array) -> Array:
    rising = np.unique(values)
    return np.asarray(rising[np.concatenate([[True], np.diff(rising) > SAME_A])])


def _from_npz(path: Path) -> FluxMap:
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays: dict[str, Any] = {name: stored[name] for name in stored.files}
    except FileNotFoundError:
        raise ConfigurationError(f"{path}: file not found") from None
    except (OSError, ValueError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise ConfigurationError(f"{path}: accepted: {ARRAYS}") from error
    if {"i_s_dq", "psi_s_dq"} <= set(arrays):
        current, flux = arrays["i_s_dq"], arrays["psi_s_dq"]
        if current.ndim != 2 or current.shape != flux.shape:
            raise ConfigurationError(f"{path}: accepted: i_s_dq and psi_s_dq on one grid")
        arrays = dict(zip(COLUMNS, (current.real, current.imag, flux.real, flux.imag), strict=True))
    elif not set(COLUMNS) <= set(arrays):
        raise ConfigurationError(f"{path}: accepted: {ARRAYS}")
    try:
        wanted = {name: np.asarray(arrays[name], np.float64) for name in COLUMNS}
        if wanted["i_d_a"].ndim == 1:
            shape = np.meshgrid(wanted["i_d_a"], wanted["i_q_a"], indexing="ij")
            wanted |= dict(zip(COLUMNS[:2], shape, strict=True))
        flat = {
            name: np.broadcast_to(v, wanted["psi_d_wb"].shape).ravel() for name, v in wanted.items()
        }
    except (TypeError, ValueError) as error:
        raise ConfigurationError(f"{path}: accepted: {ARRAYS}, all of one shape") from error
    _refuse_infinite(path, flat)
    return _from_columns(path, flat, None)
