# SPDX-License-Identifier: Apache-2.0
"""Results of runs as JSON: written, and read back with the recording beside them."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np

from hubsim import files
from hubsim.engine import Rows, reason_text
from hubsim.errors import HubsimError
from hubsim.results import RunResult

RECORDINGS = (".parquet", ".csv")
MAX_FILE_BYTES = 1 << 28


def run_object(result: RunResult) -> dict[str, Any]:
    """Return a run as ``hubsim run --json`` writes it.

    The summary's object and what a single run knows besides.
    """
    out = {"provenance": result.origin} | result.run_object
    out |= {"kinetic_energy_j": result.kinetic_energy_j}
    if result.stopped is not None:
        out["stop_distance_m"] = result.distance_m if result.stopped else None
    out |= criteria_object(result)
    if result.ideal:
        out["ideal_stop"] = result.ideal
    return out | {
        "config": result.vehicle,
        "duration_s": result.duration_s,
        "distance_m": result.distance_m,
        "soc_initial": result.soc[0],
        "soc_final": result.soc[1],
        "realtime_factor": result.realtime_factor,
        "faults": [
            {"wheel": f.wheel, "time_s": f.time_s, "reason": f.reason} for f in result.faults
        ],
        "accounts_j": result.account_j,
    }


def criteria_object(result: RunResult) -> dict[str, Any]:
    """Return whether a run met its criteria, and each of them; nothing for a run without any."""
    if not result.criteria:
        return {}
    passed = all(criterion["passed"] for criterion in result.criteria)
    return {"passed": passed, "criteria": result.criteria}


def as_json(value: object) -> str:
    """Return readable JSON; numbers that JSON cannot hold are a defect, not output."""
    return json.dumps(value, indent=2, allow_nan=False) + "\n"


def load(path: Path) -> RunResult:
    """Read a result and the recording of the same name beside it, if there is one.

    Raises
    ------
    HubsimError
        For a file that is not what ``hubsim run --json`` writes, or a recording that cannot be
        read.
    """
    data = _read(path)
    recording = next(
        (path.with_suffix(suffix) for suffix in RECORDINGS if path.with_suffix(suffix).is_file()),
        None,
    )
    names, rows = _recorded(recording) if recording is not None else (["time_s"], np.empty((0, 1)))
    try:
        duration_s = float(data["duration_s"])
        factor = float(data["realtime_factor"])
        return RunResult(
            cycle=str(data["cycle"]),
            strategy=str(data["strategy"]),
            vehicle=str(data["config"]),
            wheels=sum(name.endswith(".motor_torque_nm") for name in names),
            names=names,
            rows=rows,
            account_j={str(name): float(value) for name, value in data["accounts_j"].items()},
            duration_s=duration_s,
            distance_m=float(data["distance_m"]),
            kinetic_energy_j=float(data["kinetic_energy_j"]),
            soc=(float(data["soc_initial"]), float(data["soc_final"])),
            stopped=data["stop_distance_m"] is not None if "stop_distance_m" in data else None,
            cpu_s=duration_s / factor if factor > 0.0 else 0.0,
            reason_texts=_reasons(names, rows),
            origin=dict(data.get("provenance") or {}),
            criteria=list(data.get("criteria") or []),
            ideal=dict(data.get("ideal_stop") or {}),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        what = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise HubsimError(
            f"{path}: not a result of a run: {what}, accepted: what 'hubsim run --json' writes"
        ) from error


def _read(path: Path) -> dict[str, Any]:
    text = files.read_text(path, MAX_FILE_BYTES)
    try:
        data = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        raise HubsimError(
            f"{path}: not JSON: {' '.join(str(error).split())}, accepted: what 'hubsim run "
            "--json' writes"
        ) from error
    if not isinstance(data, dict):
        raise HubsimError(
            f"{path}: not a result of a run, accepted: what 'hubsim run --json' writes"
        )
    return data


def _recorded(path: Path) -> tuple[list[str], Rows]:
    names, rows = _parquet(path) if path.suffix == ".parquet" else _csv(path)
    if "time_s" not in names:
        raise HubsimError(f"{path}: no column time_s, accepted: a recording of 'hubsim run'")
    return names, rows


def _parquet(path: Path) -> tuple[list[str], Rows]:
    import pyarrow as pa  # noqa: PLC0415, a big library that only this needs
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        table = pq.read_table(path)
        return list(table.column_names), np.column_stack(
            [np.asarray(column, dtype=np.float64) for column in table.columns]
        )
    except (pa.ArrowException, ValueError, OSError) as error:
        raise HubsimError(f"{path}: cannot be read: {' '.join(str(error).split())}") from error


def _csv(path: Path) -> tuple[list[str], Rows]:
    lines = files.read_text(path).splitlines()
    names = next(csv.reader(lines[:1]), [])
    try:
        rows = np.loadtxt(lines[1:], delimiter=",", ndmin=2)
    except ValueError as error:
        raise HubsimError(f"{path}: cannot be read: {' '.join(str(error).split())}") from error
    if rows.shape[1] != len(names):
        raise HubsimError(f"{path}: {rows.shape[1]} columns under {len(names)} headings")
    return names, rows


def _reasons(names: list[str], rows: Rows) -> dict[str, str]:
    """Return the words for all reason codes that were recorded."""
    columns = [k for k, name in enumerate(names) if name.endswith("reason")]
    codes = np.unique(rows[:, columns]) if columns else np.empty(0)
    return {str(int(code)): reason_text(code) for code in codes if np.isfinite(code)}
