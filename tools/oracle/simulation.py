# SPDX-License-Identifier: Apache-2.0
"""The simulated vehicles whose controllers are hashed.

All that the oracle uses of hubsim is imported here and by no other file. The engine is the
simulator's, linked with the oracle (tests/oracle): ``use_engine`` comes before anything else.
"""

import csv
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import cffi
from hubsim import configuration, engine, errors, faults, overrides, run, scenario, stops
from hubsim.engine import Engine
from hubsim.scenario import Scenario
from regen_table.schema import Drive

from oracle.baseline import ROOT, Hashes
from oracle.programs import BUILT, Reached

HEADER = ROOT / "tests" / "oracle" / "hashing.h"
FAULT_RUNS = ROOT / "tests" / "oracle" / "faults.csv"
DRIVES = ROOT / "tools" / "motors"
STRATEGIES = run.STRATEGIES
RunError = errors.HubsimError


class Oracle:
    """The oracle's own functions in the engine of this process."""

    def __init__(self) -> None:
        self._ffi = cffi.FFI()
        text = HEADER.read_text(encoding="utf-8")
        self._ffi.cdef(re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE))
        self._lib: Any = self._ffi.dlopen(str(engine.library_path()))

    def begin(self) -> None:
        """Begin a run."""
        self._lib.oracle_begin(0)

    def end(self) -> Hashes:
        """Return the hashes of the run."""
        found = self._lib.oracle_end()
        return Hashes.of(
            *(found.fast, found.slow, found.events, 0), *(found.fast_steps, found.slow_steps)
        )

    def list_values(self, path: Path | None) -> None:
        """Write every change of a value into a file from now on; None: no longer."""
        given = self._ffi.NULL if path is None else str(path).encode()
        if not self._lib.oracle_list_values(given):
            raise OSError(f"{path}: cannot be written")

    def reached(self) -> Reached:
        """Return how many slow steps reached what, by list and number, of all runs so far."""
        lib = self._lib
        counts = {
            (self._text(lib.oracle_reached_name(k)), n): int(lib.oracle_reached(k, n))
            for k in range(lib.oracle_reached_lists())
            for n in range(lib.ORACLE_NUMBERS)
        }
        return {key: steps for key, steps in counts.items() if steps}

    def value_names(self) -> list[str]:
        """Return the names of the hashed values, in their order."""
        lib = self._lib
        return [self._text(lib.oracle_value_name(k)) for k in range(lib.oracle_value_count())]

    def _text(self, chars: Any) -> str:  # noqa: ANN401, cffi's types have no public names
        raw = self._ffi.string(chars)
        assert isinstance(raw, bytes)
        return raw.decode("ascii")


@cache
def oracle() -> Oracle:
    """Return the oracle's functions."""
    return Oracle()


def use_engine() -> None:
    """Let hubsim load the oracle's engine, in this process and those that it starts."""
    os.environ["HUBFOC_ORACLE_DIR"] = str(BUILT)
    os.environ["HUBFOC_BUILD_DIR"] = str(BUILT / "engine")


def drive_named(name: str, changes: Mapping[tuple[str, str], object]) -> Drive:
    """Return a drive of tools/motors, changed."""
    drive = configuration.load(DRIVES / f"{name}.toml").drive
    assert drive is not None
    changed: Drive = overrides.changed(drive, dict(changes), name)
    return changed


# ---- scenarios ----


def builtin_scenarios() -> Sequence[str]:
    """Return the names of the simulator's scenarios."""
    return scenario.builtin_names()


def initial_speed_kmh(name: str) -> float:
    """Return the speed at which a scenario begins."""
    return scenario.load(name, {})[1].initial_speed_kmh


def run_scenario(
    name: str, drive: str, settings: Mapping[str, object], strategy: str | None
) -> Hashes:
    """Run a scenario with its events to the end, the start of the controllers included."""
    _, chosen, beside = scenario.load(name, {"needs": {}, **settings}, drive_named(drive, {}))
    changes = dict(chosen.drive_changes)
    if strategy is not None:
        changes["brake", "strategy"] = strategy
    oracle().begin()
    vehicle, planned_s = run.prepare(drive_named(drive, changes), chosen, beside, {})
    happening = run.timeline(chosen, beside)
    with vehicle:
        vehicle.start()
        vehicle.choose([])
        now_s = 0.0
        while not vehicle.ended and now_s < planned_s - 1e-6:
            happening.apply(vehicle, now_s)
            vehicle.run(min(planned_s, happening.next_s(now_s)) - now_s)
            now_s = vehicle.value("time_s")
    return oracle().end()


# ---- faults ----

COAST_S, BRAKE_S, BACK_BRAKE_S = 1.2, 2.8, 1.8  # the driver lets go; brakes; brakes rolling back
DRIVE_SHARE = 0.5  # of the rated torque
BACK_SLOPE_PERCENT = 3.0
LONGEST, LONGEST_S = 1.6, 40.0  # of the run without the fault; of that one
RESETS_S = 0.02  # how often the driver acknowledges from the fault on
ENCODER = {"encoder_counts": 4096, "encoder_index_deg": 90.0}


@dataclass(frozen=True)
class Beginning:
    """What several faults have in common: drive, rotor sensor, situation, demand in N m."""

    drive: str
    sensor: str
    situation: str
    speed_kmh: float
    demand_nm: float
    needs: tuple[tuple[str, float], ...]

    def name(self) -> str:
        """Return it in words."""
        needs = "".join(f" {name}={value:g}" for name, value in self.needs)
        return f"{self.drive} {self.sensor} {self.situation} {self.demand_nm:g} N m{needs}"


@dataclass(frozen=True)
class FaultRun:
    """A fault at an instant of its beginning."""

    beginning: Beginning
    fault: str
    instant_s: float

    def name(self) -> str:
        """Return it in words."""
        return f"{self.fault}, {self.beginning.name()}, {self.instant_s:g} s"


def fault_runs() -> list[FaultRun]:
    """Return the runs of faults.csv, in its order."""
    found = []
    with FAULT_RUNS.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            beginning = Beginning(
                *(row["config"], row["sensor"], row["situation"]),
                *(float(row["speed_kmh"]), float(row["demand_nm"])),
                tuple(sorted(faults.table()[row["fault"]].needs.items())),
            )
            found.append(FaultRun(beginning, row["fault"], float(row["instant_s"])))
    return found


class _Drive:
    """One wheel with its share of a vehicle, and its driver."""

    def __init__(self, beginning: Beginning) -> None:
        changes: dict[tuple[str, str], object] = {("rotor", "sensor"): beginning.sensor}
        drive = drive_named(beginning.drive, {})
        if beginning.sensor == "encoder" and drive.rotor.encoder_counts is None:
            changes |= {("rotor", key): value for key, value in ENCODER.items()}
        drive = drive_named(beginning.drive, changes)
        back = beginning.situation == "roll back"
        driving = [(0.0, DRIVE_SHARE * drive.motor.rated_torque_nm, 0.0), (COAST_S, 0.0, 0.0)]
        self.brake_s = BACK_BRAKE_S if back else BRAKE_S
        self.changes = [*([] if back else driving), (self.brake_s, 0.0, beginning.demand_nm)]
        chosen = Scenario(
            initial_speed_kmh=beginning.speed_kmh,
            stop_at_standstill=True,
            slope_percent=BACK_SLOPE_PERCENT if back else 0.0,
            plant={
                "bus.capacitance_f": drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f
            },
        )
        self.engine, _ = run.prepare(drive, chosen, Path(), {})
        stops.as_one_wheel(self.engine, drive)
        for name, value in beginning.needs:
            self.engine.set(name, value)
        self.engine.start()
        self.engine.choose([])

    def go_on(self, until_s: float) -> None:
        """Go on to a time, the driver's demands at their own times."""
        engine: Engine = self.engine
        now_s = engine.value("time_s")
        while not engine.ended and now_s < until_s - 1e-6:
            for at_s, drive_nm, brake_nm in self.changes:
                if abs(at_s - now_s) < 1e-6:
                    engine.set("driver.drive_demand_nm", drive_nm)
                    engine.set("driver.brake_demand_nm", brake_nm)
            later = [at_s for at_s, _, _ in self.changes if at_s > now_s + 1e-6]
            engine.run(min([until_s, *later]) - now_s)
            now_s = engine.value("time_s")


def run_faults(
    beginning: Beginning, several: Sequence[FaultRun], listed: Mapping[str, Path]
) -> Iterator[tuple[str, Hashes]]:
    """Run a beginning without a fault, and then each fault from its instant to the end.

    ``listed``: files for the values of some of them, by name.
    """
    oracle().begin()
    oracle().list_values(listed.get(beginning.name()))
    vehicle = _Drive(beginning)
    with vehicle.engine as engine:
        states = {}
        for at_s in sorted({one.instant_s for one in several}):
            vehicle.go_on(at_s)
            states[at_s] = engine.save()
        vehicle.go_on(LONGEST_S)
        yield beginning.name(), oracle().end()
        end_s = engine.value("time_s")
        longest_s = vehicle.brake_s + LONGEST * (end_s - vehicle.brake_s) + 1.0
        for one in several:
            engine.restore(states[one.instant_s])
            oracle().begin()
            oracle().list_values(listed.get(one.name()))
            for name, value in faults.table()[one.fault].sets.items():
                engine.set(name, value)
            engine.set("driver.fault_reset_every_s", RESETS_S)
            vehicle.go_on(longest_s)
            yield one.name(), oracle().end()
        oracle().list_values(None)
