# SPDX-License-Identifier: Apache-2.0
"""Every fault at instants of a stop, beside the same stop without it (``hubsim faults``).

One wheel with its share of mass and battery stands for the vehicle (stops), so that a fault of one
wheel shows in full. A run drives, coasts and brakes to standstill, or rolls back on a slope and
brakes; the fault comes in any of these, and from then on the driver acknowledges faults all the
time. Runs of one vehicle, sensor, demand and situation share their beginning, which is simulated
once.
"""

import math
import zlib
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from regen_table import loops
from regen_table.schema import Drive

from hubsim import reasons, run
from hubsim.engine import Engine, Rows, parameters
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario, faults, overrides
from hubsim.scenario.faults import Fault
from hubsim.sweep.drives import drive_named
from hubsim.sweep.faults_outcome import Outcome

STOP, ROLL_BACK = "stop", "roll back"
# Configuration, rotor sensor: every sensor with the paper's vehicle, each other with its own.
VEHICLES = (
    ("lu2013", "hall"),
    ("lu2013", "encoder"),
    ("lu2013", "angle"),
    ("ebike36v", "hall"),
    ("scooter48v", "hall"),
    ("ipm400v", "angle"),
)
SPEED_KMH, SPEED_SHARE = 40.0, 0.7  # the slower one; share of the largest
DEMAND_SHARES = (0.8, 2.5)  # of the rated torque
DRIVE_SHARE = 0.5
COAST_S, BRAKE_S = 1.2, 2.8  # the driver lets go, and brakes: by then the road is known
BEFORE_S = (1.0, 2.6)  # while driving, while coasting
STOP_SHARES = (
    0.01,
    0.1,
    0.3,
    0.55,
    0.75,
    0.9,
)  # of the time that mass and demand alone would take
BACK_KMH, BACK_SLOPE_PERCENT, BACK_SHARE, BACK_BRAKE_S = -6.3, 3.0, 1.2, 1.8
BACK_BRAKE_KMH = 7.5  # about: what the slope makes of it until the driver brakes
BACK_BEFORE_S, BACK_STOP_SHARE = 1.6, 0.3
LONGEST = 1.6  # times the stop without the fault
LONGEST_PLAIN = 6.0  # and that one, times what mass and demand alone would take: a slope pulls
RECORD_S = 0.001
MEAN_ROWS = 20
WRONG_NM = 2.0
MOVING_M_PER_S = 0.05
RESETS_S = 0.02  # how often the driver acknowledges from the fault on
HARMLESS_DISTANCE, HARMLESS_TORQUE = 0.02, 0.05
ENCODER = {"encoder_counts": 4096, "encoder_index_deg": 90.0}
SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "vehicle.distance_m",
    "driver.brake_nm",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "wheel0.fault_reason",
    "wheel0.warning_reason",
    "wheel0.available_reason",
    "wheel0.mode",
)
TIME, SPEED, DISTANCE, BRAKE, MOTOR, HYDRAULIC, FAULT, WARNING, LIMIT, MODE = range(len(SIGNALS))


@dataclass(frozen=True)
class Group:
    """Runs that differ in the fault and its instant only; demand in N m at the wheel.

    ``whole``: all driven wheels, the fault in each, instead of one with its share of the vehicle.
    """

    config: str
    rotor_sensor: str
    situation: str
    demand_nm: float
    needs: tuple[tuple[str, float], ...] = ()
    whole: bool = False


@dataclass(frozen=True)
class Case:
    """One run."""

    group: Group
    fault: str
    instant_s: float

    @property
    def key(self) -> tuple[str, str, str, str, float, float]:
        """What tells it from all others."""
        g = self.group
        return (
            self.fault,
            g.config,
            g.rotor_sensor,
            g.situation,
            g.demand_nm,
            self.instant_s,
        )


@lru_cache
def drive_of(config: str, sensor: str) -> Drive:
    """Return a drive that comes along, with this rotor sensor."""
    drive = drive_named(config)
    changes: dict[tuple[str, str], object] = {("rotor", "sensor"): sensor}
    if sensor == "encoder" and drive.rotor.encoder_counts is None:
        changes |= {("rotor", key): value for key, value in ENCODER.items()}
    return overrides.changed(drive, changes, f"{config} with {sensor}")


def initial_kmh(drive: Drive, situation: str) -> float:
    """Return the speed at which a run begins."""
    if situation == ROLL_BACK:
        return BACK_KMH
    top = 3.6 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    return round(min(SPEED_KMH, SPEED_SHARE * top), 3)


def stop_s(group: Group) -> float:
    """Return how long mass and demand alone would take to stand."""
    drive = drive_of(group.config, group.rotor_sensor)
    wheel_kg = drive.vehicle.mass_kg / drive.vehicle.driven_wheels
    back = group.situation == ROLL_BACK
    speed = (BACK_BRAKE_KMH if back else initial_kmh(drive, group.situation)) / 3.6
    return wheel_kg * speed * drive.vehicle.wheel_radius_m / group.demand_nm


def instants(group: Group) -> list[float]:
    """Return when faults come, s after the run began."""
    whole = stop_s(group)
    if group.situation == ROLL_BACK:
        return [BACK_BEFORE_S, round(BACK_BRAKE_S + BACK_STOP_SHARE * whole, 3)]
    return [*BEFORE_S, *(round(BRAKE_S + share * whole, 3) for share in STOP_SHARES)]


def plan(
    chosen: Sequence[Fault],
    vehicles: Sequence[tuple[str, str]] = VEHICLES,
    demand_shares: Sequence[float] = DEMAND_SHARES,
    exact: Collection[str] = (),
    whole: bool = False,
) -> list[Case]:
    """Return all runs of these faults, in the order in which they are made.

    Each run of a fault with mirror images is that of one of them, drawn by what tells the run from
    others; not so the ``exact`` names.
    """
    found: list[Case] = []
    for config, sensor in vehicles:
        rated = drive_named(config).motor.rated_torque_nm
        groups = [
            *(Group(config, sensor, STOP, share * rated, (), whole) for share in demand_shares),
            Group(config, sensor, ROLL_BACK, BACK_SHARE * rated, (), whole),
        ]
        for group in groups:
            for fault in chosen:
                if sensor in fault.sensors and _exists(fault, drive_of(config, sensor)):
                    own = replace(group, needs=tuple(sorted(fault.needs.items())))
                    times = [0.0] if fault.at_start else instants(own)
                    several = (Case(own, fault.name, at_s) for at_s in times)
                    found.extend(c if fault.name in exact else drawn(c) for c in several)
    return found


def _number(case: Case) -> int:
    """Return a number of 32 bits that depends on what tells the run from others."""
    return zlib.crc32(repr(case.key).encode())


def drawn(case: Case) -> Case:
    """Return the run with one of the mirror images of its fault."""
    images = faults.images(case.fault)
    return replace(case, fault=images[_number(case) % len(images)])


def values(case: Case) -> dict[str, float]:
    """Return the parameters that the fault of a run sets."""
    fault = faults.table()[case.fault]
    if not fault.draws:
        return dict(fault.sets)
    highest = int(parameters()[fault.draws].highest)
    return {**fault.sets, fault.draws: float(1 + _number(case) % highest)}


def _exists(fault: Fault, drive: Drive) -> bool:
    """Return whether the drive's file describes what the fault needs."""
    return "road.friction" not in fault.needs or drive.chassis.wheel_inertia_kg_m2 > 0.0


def reduced() -> list[Case]:
    """Return a few runs of every fault: the paper's vehicle, the sensors in turn, a hard stop."""
    found: list[Case] = []
    for fault in faults.named(()):
        k = zlib.crc32(fault.name.encode())  # the same runs whatever faults come after
        sensors = [sensor for sensor in ("hall", "angle") if sensor in fault.sensors]
        sensor = sensors[k // 8 % len(sensors)] if sensors else fault.sensors[0]
        several = plan([fault], [("lu2013", sensor)], [DEMAND_SHARES[1]], [fault.name])
        wanted = (2 + k % 3, 4 + k % 3) if len(several) > 7 else range(len(several))
        found.extend(several[j] for j in wanted)
        found.extend(case for case in several[-2 + k % 2 :][:1] if k % 4 == 0)
    return list(dict.fromkeys(found))


class _Vehicle:
    """The vehicle of one group, and its run without a fault."""

    def __init__(self, group: Group, times: Sequence[float]) -> None:
        self.group = group
        self.drive = drive_of(group.config, group.rotor_sensor)
        back = group.situation == ROLL_BACK
        rated = self.drive.motor.rated_torque_nm
        self.changes = (
            [(BACK_BRAKE_S, 0.0, group.demand_nm)]
            if back
            else [
                (0.0, DRIVE_SHARE * rated, 0.0),
                (COAST_S, 0.0, 0.0),
                (BRAKE_S, 0.0, group.demand_nm),
            ]
        )
        self.brake_s = self.changes[-1][0]
        self.engine = self._started(back)
        self.states: dict[float, bytes] = {}
        parts = []
        for at_s in sorted(times):
            parts.append(self._until(at_s, math.inf))
            self.states[at_s] = self.engine.save()
        longest_s = self.brake_s + LONGEST_PLAIN * stop_s(group) + 2.0
        parts.append(self._until(longest_s, math.inf))
        self.rows = np.concatenate(parts)
        self.ended = self.engine.ended
        self.end_s = float(self.rows[-1, TIME])
        self.distance_m = self._stopping_m(self.rows)

    def _started(self, back: bool) -> Engine:
        scenario = Scenario(
            initial_speed_kmh=initial_kmh(self.drive, self.group.situation),
            stop_at_standstill=True,
            slope_percent=BACK_SLOPE_PERCENT if back else 0.0,
            record_interval_s=RECORD_S,
            plant={
                "bus.capacitance_f": self.drive.vehicle.driven_wheels
                * self.drive.inverter.bus_capacitance_f
            },
        )
        engine, _ = run.prepare(self.drive, scenario, Path(), {})
        if not self.group.whole:
            stops.as_one_wheel(engine, self.drive)
        for name, value in self.group.needs:
            engine.set(name, value)
        engine.start()
        engine.choose(SIGNALS)
        return engine

    def _until(self, end_s: float, limit_s: float) -> Rows:
        """Go on to a time, the driver's demands at their own times."""
        parts = []
        now_s = self.engine.value("time_s")
        until_s = min(end_s, limit_s)
        while not self.engine.ended and now_s < until_s - 1e-6:
            for at_s, drive_nm, brake_nm in self.changes:
                if abs(at_s - now_s) < 1e-6:
                    self.engine.set("driver.drive_demand_nm", drive_nm)
                    self.engine.set("driver.brake_demand_nm", brake_nm)
            later = [at_s for at_s, _, _ in self.changes if at_s > now_s + 1e-6]
            parts.append(self.engine.run(min([until_s, *later]) - now_s))
            now_s = self.engine.value("time_s")
        return np.concatenate(parts) if parts else np.empty((0, len(SIGNALS)))

    def _stopping_m(self, rows: Rows) -> float:
        braking = rows[rows[:, TIME] >= self.brake_s - 1e-9]
        return abs(float(braking[-1, DISTANCE] - braking[0, DISTANCE]))

    def measure(self, case: Case) -> Outcome:
        """Run with the fault from its instant on."""
        self.engine.restore(self.states[case.instant_s])
        for name, value in values(case).items():
            self.engine.set(name, value)
        self.engine.set("driver.fault_reset_every_s", RESETS_S)
        before = self.rows[self.rows[:, TIME] < case.instant_s - 1e-9]
        longest_s = self.brake_s + LONGEST * (self.end_s - self.brake_s) + 1.0
        try:
            after = self._until(longest_s, math.inf)
        except HubsimError as error:
            run = f"{case.fault}, {case.group.config}, {case.group.rotor_sensor}"
            where = f"{case.group.situation} at {case.group.demand_nm:g} N m"
            raise HubsimError(f"{run}, {where}, from {case.instant_s:g} s on: {error}") from error
        return self._outcome(case, np.concatenate([before, after]), len(before))

    def _outcome(self, case: Case, rows: Rows, begins: int) -> Outcome:
        engine, group, drive = self.engine, case.group, self.drive
        rated = drive.motor.rated_torque_nm
        brakes = (rows[:, BRAKE] > 0.0) & (np.abs(rows[:, SPEED]) > MOVING_M_PER_S)
        driving = np.where(brakes, rows[:, MOTOR] * np.sign(rows[:, SPEED]), 0.0)[begins:]
        total = _total(rows)
        excess = _means(np.where(brakes, total - rows[:, BRAKE], 0.0)[begins:], 5 * MEAN_ROWS)
        right = faults.expected()[case.fault]
        reason, at_s = _first_reason(rows, begins, self._new_limits(right, begins))
        distance = self._stopping_m(rows) / self.distance_m if engine.ended else math.nan
        error = self._error(rows, begins) / rated
        tripped = bool(np.any(rows[begins:, FAULT] > 0.0))
        harmless = (
            abs(distance - 1.0) <= HARMLESS_DISTANCE and error < HARMLESS_TORQUE and not tripped
        )
        latched = rows[:, FAULT] > 0.0
        boots = [mode for mode in np.unique(rows[:, MODE]) if engine.mode_text(mode) == "BOOT"]
        runs_on = ~np.isin(rows[1:, MODE], boots)
        gone = latched[:-1] & ~latched[1:] & runs_on
        healed = np.any(gone & (rows[1:, BRAKE] > 0.0))
        turns = np.abs(rows[1:, SPEED]) > MOVING_M_PER_S
        trip_a = loops.overcurrent_pu(drive) * drive.inverter.current_full_scale_a
        return Outcome(
            fault=case.fault,
            config=group.config,
            rotor_sensor=group.rotor_sensor,
            situation=group.situation,
            demand_nm=group.demand_nm,
            instant_s=case.instant_s,
            distance_ratio=distance,
            wrong_sign_ms=1e3 * RECORD_S * _longest((driving > WRONG_NM).tolist()),
            wrong_nm=float(np.max(driving, initial=0.0)),
            excess_nm=float(np.max(excess, initial=0.0)),
            error_share=error,
            current_ratio=engine.value("wheel0.peak_current_a") / trip_a,
            bus_peak_v=engine.value("bus.peak_v"),
            bus_limit_v=drive.inverter.device_voltage_v or math.inf,
            first_reason=reason,
            reason_expected=int(reason in (right or ("",))),
            time_to_reason_ms=1e3 * (at_s - case.instant_s),
            harmless=int(harmless),
            final_mode=engine.mode_text(rows[-1, MODE]),
            healed_under_braking=int(healed),
            acknowledged_turning=int(np.any(gone & turns)),
        )

    def _new_limits(self, right: Sequence[str], begins: int) -> list[int]:
        """Return the limits among the right reasons that the run without the fault never shows."""
        shown = self.rows[begins:, LIMIT]
        codes = [reasons.codes()[name] for name in right if name in reasons.limits()]
        return [code for code in codes if code not in shown]

    def _error(self, rows: Rows, begins: int) -> float:
        """Return the largest difference of the torque, signed as motion has it, N m."""
        plain, torque = _means(_total(self.rows)), _means(_total(rows))
        speeds = np.abs(self.rows[: len(plain), SPEED])
        falling = np.flatnonzero(self.rows[: len(plain), BRAKE] > 0.0)[::-1]
        moving = np.abs(rows[: len(torque), SPEED])
        at_speed = np.interp(moving, np.maximum.accumulate(speeds[falling]), plain[falling])
        at_time = plain[np.minimum(np.arange(len(torque)), len(plain) - 1)]
        apart = np.minimum(np.abs(torque - at_time), np.abs(torque - at_speed))
        counted = apart[begins:][moving[begins:] > 5.0 * MOVING_M_PER_S]
        return float(np.max(counted, initial=0.0))


def _total(rows: Rows) -> Rows:
    """Return the torque of motor and brake against the motion, N m.

    Both signals are signed by the forward direction: a brake that slows a wheel which rolls back
    is negative in HYDRAULIC, a motor that does is positive in MOTOR.
    """
    total: Rows = np.sign(rows[:, SPEED]) * (rows[:, HYDRAULIC] - rows[:, MOTOR])
    return total


def _means(values: Rows, count: int = MEAN_ROWS) -> Rows:
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return (sums[count:] - sums[:-count]) / count if len(values) >= count else values[:0]


def _longest(flags: Iterable[bool]) -> int:
    edges = np.flatnonzero(np.diff([0, *map(int, flags), 0]))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def _first_reason(rows: Rows, begins: int, limits: Sequence[int] = ()) -> tuple[str, float]:
    """Return the first fault or warning that was not there when the fault came, and when.

    So counts one of these limits, as the wheel reports it of its electric braking torque.
    """
    codes = rows[:, [FAULT, WARNING, LIMIT]]
    codes[~np.isin(codes[:, 2], limits), 2] = 0.0
    known = [0.0, *codes[max(begins - 1, 0)]]
    new = ~np.isin(codes[begins:], known)
    if not np.any(new):
        return "", math.nan
    first = int(np.argmax(np.any(new, axis=1)))
    code = codes[begins + first][np.argmax(new[first])]
    return reasons.identifier(code), float(rows[begins + first, TIME])


def measure(group: Group, several: Sequence[Case]) -> list[Outcome]:
    """Simulate the runs of one group."""
    vehicle = _Vehicle(group, sorted({case.instant_s for case in several}))
    with vehicle.engine:
        return [vehicle.measure(case) for case in several]


def tasks(several: Sequence[Case], size: int = 40) -> Iterator[tuple[Group, list[Case]]]:
    """Divide runs into lots that share their vehicle."""
    groups: dict[Group, list[Case]] = {}
    for case in several:
        groups.setdefault(case.group, []).append(case)
    for group, members in groups.items():
        for k in range(0, len(members), size):
            yield group, members[k : k + size]
