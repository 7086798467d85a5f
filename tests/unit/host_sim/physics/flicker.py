# SPDX-License-Identifier: Apache-2.0
"""Stops in which a device comes and goes: distance, changes of mode and of reasons.

One wheel with its share of mass and battery drives, coasts and brakes to standstill. While it
brakes a device fails and is healthy in turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from hubsim import reasons, run
from hubsim.engine import Engine, Rows
from hubsim.run import stops
from hubsim.scenario import Scenario, overrides
from hubsim.sweep.drives import drive_named
from hubsim.sweep.faults_sweep import initial_kmh
from regen_table.schema import Drive

PEDAL_SHARE = 4.0  # of rated torque, at the end of the brake pedal's travel
DEAD_TRAVEL = 0.05  # of a pedal, at its beginning
COASTS_S, BRAKES_S, FLICKERS_S = 0.4, 0.8, 1.4
DRIVE_SHARE = 0.5  # of the rated torque
LONGEST = 2.5  # times what mass and demand alone would take
SIGNALS = (
    "time_s",
    "vehicle.distance_m",
    "wheel0.mode",
    "wheel0.fault_reason",
    "wheel0.warning_reason",
    "wheel0.available_reason",
    "wheel0.hydraulic_reason",
)
TIME, DISTANCE, MODE, FAULT, WARNING, LIMIT, BRAKE = range(len(SIGNALS))
SHOWN = {"mode": MODE, "fault": FAULT, "warning": WARNING, "limit": LIMIT, "brake": BRAKE}


@dataclass(frozen=True)
class Device:
    """What flickers.

    Attributes
    ----------
    failed : mapping
        Parameters of the simulated world that make it fail.
    reasons : set of str
        Its names: one of them is shown.
    needs : mapping
        Parameters of the whole run.
    pedals : bool
        The demands come from wired pedals.
    """

    name: str
    failed: Mapping[str, float]
    reasons: frozenset[str]
    needs: Mapping[str, float] = field(default_factory=dict)
    pedals: bool = False


@dataclass(frozen=True)
class Outcome:
    """What a run shows; changes are the most in any second."""

    distance_m: float
    stands: bool
    changes: Mapping[str, int]
    reasons: frozenset[str]


class Wheel:
    """One wheel that stops, again and again from the same state."""

    def __init__(self, config: str, device: Device, demand_share: float) -> None:
        drive = drive_named(config)
        changes: dict[tuple[str, str], object] = {}
        if device.pedals:
            changes |= {
                ("pedals", "accelerator_channels"): 2,
                ("pedals", "brake_channels"): 2,
                ("pedals", "brake_torque_nm"): PEDAL_SHARE * drive.motor.rated_torque_nm,
            }
        self.drive = overrides.changed(drive, changes, config)
        self.device = device
        self.demand_nm = demand_share * self.drive.motor.rated_torque_nm
        self.engine = self._started(self.drive)
        self.healthy = {name: self.engine.get(name) for name in device.failed}
        self._until(COASTS_S, DRIVE_SHARE * self.drive.motor.rated_torque_nm, 0.0)
        self._until(BRAKES_S, 0.0, 0.0)
        self.rows = [self._until(FLICKERS_S, 0.0, self.demand_nm)]
        self.state = self.engine.save()

    def _started(self, drive: Drive) -> Engine:
        kmh = initial_kmh(drive, "stop")
        self.stop_s = (
            drive.vehicle.mass_kg
            / drive.vehicle.driven_wheels
            * (kmh / 3.6)
            * drive.vehicle.wheel_radius_m
            / self.demand_nm
        )
        released = 0.0 if self.device.pedals else None
        scenario = Scenario(
            initial_speed_kmh=kmh,
            stop_at_standstill=True,
            max_duration_s=300.0,
            record_interval_s=0.001,
            plant={
                "bus.capacitance_f": drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f
            },
            accelerator=released,
            brake_pedal=released,
        )
        engine, _ = run.prepare(drive, scenario, Path(), {})
        stops.as_one_wheel(engine, drive)
        for name, value in self.device.needs.items():
            engine.set(name, value)
        engine.start()
        engine.choose(SIGNALS)
        return engine

    def _until(self, time_s: float, drive_nm: float, brake_nm: float) -> Rows:
        engine = self.engine
        if self.device.pedals:
            engine.set("driver.accelerator", drive_nm / self.drive.motor.max_torque_nm)
            share = brake_nm / (PEDAL_SHARE * self.drive.motor.rated_torque_nm)
            engine.set("driver.brake_pedal", DEAD_TRAVEL + (1.0 - DEAD_TRAVEL) * share)
        else:
            engine.set("driver.drive_demand_nm", drive_nm)
            engine.set("driver.brake_demand_nm", brake_nm)
        return engine.run(time_s - engine.value("time_s"))

    def stop(self, rate_hz: float, failed_share: float = 0.5) -> Outcome:
        """Brake to standstill; rate_hz 0: failed_share of 1 is failed for good, of 0 healthy."""
        engine = self.engine
        engine.restore(self.state)
        end_s = BRAKES_S + LONGEST * self.stop_s + 1.0
        parts = list(self.rows)
        for at_s, is_failed in _turns(rate_hz, failed_share, end_s):
            for name, value in (self.device.failed if is_failed else self.healthy).items():
                engine.set(name, value)
            if engine.ended:
                break
            parts.append(engine.run(max(at_s - engine.value("time_s"), 0.0)))
        return _outcome(np.concatenate(parts), engine.ended)


def _turns(rate_hz: float, failed_share: float, end_s: float) -> list[tuple[float, bool]]:
    """Return until when each of the parts lasts, and whether the device is failed in it."""
    if rate_hz == 0.0:
        return [(end_s, failed_share == 1.0)]
    turns: list[tuple[float, bool]] = []
    for at_s in np.arange(FLICKERS_S, end_s, 1.0 / rate_hz):
        turns += [(at_s + failed_share / rate_hz, True), (at_s + 1.0 / rate_hz, False)]
    return turns


def _most_changes(rows: Rows, column: int) -> int:
    """Return the largest number of changes within a second."""
    times = rows[1:, TIME][np.diff(rows[:, column]) != 0.0]
    return int(max((np.sum((times >= t) & (times < t + 1.0)) for t in times), default=0))


def _outcome(rows: Rows, stands: bool) -> Outcome:
    braking = rows[rows[:, TIME] >= BRAKES_S - 1e-9]
    flickering = rows[rows[:, TIME] > FLICKERS_S - 1e-9]
    return Outcome(
        distance_m=float(braking[-1, DISTANCE] - braking[0, DISTANCE]),
        stands=stands,
        changes={name: _most_changes(flickering, column) for name, column in SHOWN.items()},
        reasons=frozenset(
            reasons.identifier(int(code))
            for column in (FAULT, WARNING, LIMIT, BRAKE)
            for code in np.unique(flickering[:, column])
        ),
    )
