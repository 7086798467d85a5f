# SPDX-License-Identifier: Apache-2.0
"""The result of a run: accounts, recorded signals, and the JSON made of them and read back."""

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hubsim import files
from hubsim.engine import Rows, reason_text
from hubsim.errors import HubsimError

INVERTER = ("conduction", "diode", "switching")
SIGNAL_POINTS_MAX = 4000
LEAST_CPU_S = 1e-9  # the step of a thread's clock
RECORDINGS = (".parquet", ".csv")
MAX_FILE_BYTES = 1 << 28


@dataclass(frozen=True)
class Fault:
    """A controller that went into fault during a run."""

    wheel: int
    time_s: float
    reason: str


@dataclass(frozen=True)
class RunResult:
    """A finished run of one vehicle.

    Attributes
    ----------
    cycle, strategy, vehicle : str
        Names of the scenario, of the braking strategy and of the configuration.
    names, rows
        Recorded signals; ``rows`` has the shape (times, signals) and the units of the signals'
        names.
    account_j : dict
        "energy.<account>_j" of the whole run and "braking.<account>_j" of the times in which the
        driver braked, J.
    kinetic_energy_j : float
        Of the vehicle when the run began.
    stopped : bool or None
        Whether the vehicle came to rest, where that was to end the run.
    cpu_s : float
        Processor time of the simulation alone, for the whole vehicle.
    reason_texts : dict
        Words for the reason codes that were recorded, by code.
    parameters : dict
        Of the simulated world when the run began, by the engine's names.
    missed : dict
        Events later than the end of the run: time in s by name.
    meanings : dict
        Unit and words for every recorded signal, by name.
    origin : dict
        Version, commit, configuration with its CRC, scenario, seed and date: what every file made
        of the run holds.
    criteria : list
        Result of each criterion of the scenario, as JSON holds it; empty without criteria.
    observed : dict
        Limits, modes and findings of the controllers, and physics left out (course.observed), as
        JSON holds it.
    ideal : dict
        The ideal stop of the same demand, speed and temperature (``regen_table stop``), as JSON
        holds it; empty where the run is no stop at constant demand.
    """

    cycle: str
    strategy: str
    vehicle: str
    wheels: int
    names: list[str]
    rows: Rows
    account_j: dict[str, float]
    duration_s: float
    distance_m: float
    kinetic_energy_j: float
    soc: tuple[float, float]
    stopped: bool | None
    cpu_s: float
    faults: list[Fault] = field(default_factory=list)
    reason_texts: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    missed: dict[str, float] = field(default_factory=dict)
    meanings: dict[str, tuple[str, str]] = field(default_factory=dict)
    origin: dict[str, Any] = field(default_factory=dict)
    criteria: list[dict[str, Any]] = field(default_factory=list)
    observed: dict[str, Any] = field(default_factory=dict)
    ideal: dict[str, Any] = field(default_factory=dict)

    def signal(self, name: str) -> Rows:
        """Return one recorded signal, shape (times,)."""
        return np.ascontiguousarray(self.rows[:, self.names.index(name)])

    def blocks(self, names: Sequence[str], block_bytes: int) -> Iterator[Rows]:
        """Give the rows of these signals, shape (times, names), in parts of about so many bytes."""
        columns = [self.names.index(name) for name in names]
        step = max(block_bytes // (np.float64().nbytes * max(len(columns), 1)), 1)
        for k in range(0, max(len(self.rows), 1), step):
            yield self.rows[k : k + step][:, columns]

    @property
    def time_s(self) -> Rows:
        """Times of ``signals``, at most SIGNAL_POINTS_MAX of them."""
        return self.signals["time_s"]

    @property
    def signals(self) -> dict[str, Rows]:
        """All recorded signals by name, shape (points,); a long recording is thinned out evenly."""
        step = -(-len(self.rows) // SIGNAL_POINTS_MAX) or 1
        thin = self.rows[::step]
        return {name: np.ascontiguousarray(thin[:, k]) for k, name in enumerate(self.names)}

    def braking_j(self, *accounts: str) -> float:
        """Return the sum of accounts over the times in which the driver braked, J."""
        return sum(self.account_j[f"braking.{name}_j"] for name in accounts)

    def energy_j(self, *accounts: str) -> float:
        """Return the sum of accounts over the whole run, J."""
        return sum(self.account_j[f"energy.{name}_j"] for name in accounts)

    def driving_j(self, *accounts: str) -> float:
        """Return the sum of accounts over the times in which the driver did not brake, J."""
        return self.energy_j(*accounts) - self.braking_j(*accounts)

    @property
    def returned_j(self) -> float:
        """Net chemical energy into the battery while the driver brakes."""
        return 0.0 - self.braking_j("chemical")

    @property
    def braking_work_j(self) -> float:
        """Work of motors and hydraulic brakes against the motion while the driver brakes."""
        return self.braking_j("hydraulic") - self.braking_j("shaft")

    @property
    def residual_relative(self) -> float:
        """The simulation's own energy error over the energy turned over, magnitude."""
        turned_over = self.energy_j("turned_over")
        return abs(self.energy_j("residual")) / turned_over if turned_over > 0.0 else 0.0

    @property
    def braking_share_stored(self) -> float:
        """Share of the braking work at the wheels that came to rest in the battery.

        0 without braking.
        """
        return self.returned_j / self.braking_work_j if self.braking_work_j > 0.0 else 0.0

    @property
    def realtime_factor(self) -> float:
        """Simulated time over processor time, whole vehicle on one core."""
        return _times_real_time(self.duration_s, self.cpu_s)

    @property
    def run_object(self) -> dict[str, Any]:
        """The run as summary.json holds it: names, energies in J, shares."""
        return {
            "cycle": self.cycle,
            "strategy": self.strategy,
            "energy_j": {
                "traction": self.driving_j("chemical"),
                "braking_at_wheels": self.braking_work_j,
                "battery_returned": self.returned_j,
                "hydraulic": self.energy_j("hydraulic"),
                "copper": self.energy_j("copper"),
                "iron": self.energy_j("iron"),
                "inverter": self.energy_j(*INVERTER),
                "battery": self.energy_j("battery"),
            },
            "residual_relative": self.residual_relative,
            "braking_share_stored": self.braking_share_stored,
        }

    @property
    def summary(self) -> dict[str, Any]:
        """The run object and the additional fields of a report.

        Other sinks and storage, losses by what the driver does.
        """
        out = {"provenance": self.origin} | self.run_object
        out["energy_j"] |= {
            "bearing": self.energy_j("bearing"),
            "drag": self.energy_j("drag"),
            "rolling": self.energy_j("rolling"),
            "climbed": self.energy_j("climbed"),
            "stored_kinetic": self.energy_j("kinetic"),
            "stored_battery": self.energy_j("polarisation"),
        }
        # What a field or the polarisation took in is on its way to heat: with it, the losses of a
        # phase balance.
        parts = {
            "battery": ("battery", "polarisation"),
            "inverter": INVERTER,
            "copper": ("copper", "magnetic"),
        }
        parts |= {name: (name,) for name in ("iron", "bearing", "hydraulic")}
        out["while_driving_j"] = {
            name: self.driving_j(*accounts) for name, accounts in parts.items()
        }
        out["while_braking_j"] = {
            name: self.braking_j(*accounts) for name, accounts in parts.items()
        }
        out["reason_texts"] = self.reason_texts
        out["criteria"] = self.criteria
        out["ideal_stop"] = self.ideal
        return out


def realtime_factor(results: Sequence[RunResult]) -> float:
    """Return simulated time over processor time of all runs together.

    Whole vehicles on one core.
    """
    cpu_s = sum(result.cpu_s for result in results)
    return _times_real_time(sum(result.duration_s for result in results), cpu_s)


def _times_real_time(simulated_s: float, cpu_s: float) -> float:
    """Return a finite factor; 0 where the thread's clock has not moved, which its steps allow."""
    return simulated_s / cpu_s if cpu_s > LEAST_CPU_S else 0.0


def json_object(result: RunResult) -> dict[str, Any]:
    """Return a run as ``hubsim run --json`` writes it.

    The summary object and the additional fields of a single run.
    """
    out = {"provenance": result.origin} | result.run_object
    out |= {"kinetic_energy_j": result.kinetic_energy_j}
    if result.stopped is not None:
        out["stop_distance_m"] = result.distance_m if result.stopped else None
    out |= criteria_object(result)
    if result.ideal:
        out["ideal_stop"] = result.ideal
    if result.observed:
        out["observed"] = result.observed
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


def load_result(path: Path) -> RunResult:
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
