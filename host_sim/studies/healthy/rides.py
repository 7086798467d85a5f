# SPDX-License-Identifier: Apache-2.0
"""One ride: the driver's feet, the simulation, and what the controller says meanwhile.

One wheel with its share of mass and battery stands for the vehicle (stops). Reasons and mode are
looked at in every millisecond, boot included unless the ride is ``prepared``.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from hubsim import reasons, run
from hubsim.engine import Engine, Rows, mode_text
from hubsim.run import stops
from hubsim.run.plant import STANDARD_GRAVITY_M_PER_S2
from hubsim.scenario import Scenario
from studies.healthy.vehicles import (
    BRAKE,
    COAST,
    CRAWL_M_PER_S,
    HOLD,
    REVERSE,
    ROLLING,
    STANDING,
    Phase,
    Ride,
    drive_of,
    top_m_per_s,
)  # fmt: skip

STEP_S = 0.02  # of the driver
SLOPE_S = 1.0  # in which the road becomes another one
BANDWIDTH = 1.0  # of the driver's speed regulator, 1/s
FASTEST_SHARE = 0.97  # of the largest speed: here a coasting driver brakes
FORWARD, BACKWARD = 1.0, 2.0  # directions
STANDS_M_PER_S = 0.02
SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "wheel0.mode",
    "wheel0.warning_reason",
    "wheel0.fault_reason",
)
TIME, SPEED, MODE, WARNING, FAULT = range(len(SIGNALS))


class Driver:
    """The feet of one driver. Torques at the wheel in N m, speeds in m/s."""

    def __init__(self, ride: Ride, engine: Engine) -> None:
        drive = drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
        self._ride = ride
        self._engine = engine
        self._top = top_m_per_s(drive)
        self._inertia = engine.get("vehicle.mass_kg") * engine.get("vehicle.wheel_radius_m")
        self._most_drive = drive.motor.max_torque_nm
        self._most_brake = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
        self._drive = self._brake = self._slope = 0.0

    def wants(self, phase: Phase, speed: float) -> tuple[float, float]:
        """Return accelerator, negative lift-off braking, and brake pedal."""
        if phase.kind in (HOLD, BRAKE):
            return 0.0, phase.torque_nm
        pull = self._inertia * STANDARD_GRAVITY_M_PER_S2 * self._slope
        if phase.kind == COAST:
            fast = speed > FASTEST_SHARE * self._top or speed < -CRAWL_M_PER_S
            return -phase.torque_nm, abs(pull) + 0.1 * self._most_drive if fast else 0.0
        sign = -1.0 if phase.kind == REVERSE else 1.0
        error = phase.speed_share * self._top - sign * speed
        wanted = self._inertia * BANDWIDTH * error + sign * pull
        return sign * float(np.clip(wanted, 0.0, phase.torque_nm)), max(-wanted, 0.0)

    def step(self, phase: Phase, speed: float) -> None:
        """Move pedals and road by one step."""
        drive, brake = self.wants(phase, speed)
        self._drive = _towards(self._drive, drive, self._most_drive * STEP_S / self._ride.drive_s)
        self._brake = _towards(
            self._brake,
            min(brake, self._most_brake),
            self._most_brake * STEP_S / self._ride.brake_s,
        )
        self._slope = _towards(self._slope, phase.slope, 0.24 * STEP_S / SLOPE_S)
        direction = BACKWARD if phase.kind == REVERSE else FORWARD
        for name, value in (
            ("driver.drive_demand_nm", self._drive),
            ("driver.brake_demand_nm", self._brake),
            ("driver.direction", direction),
            ("road.slope", self._slope),
        ):
            if self._engine.get(name) != value:
                self._engine.set(name, value)


def _towards(value: float, end: float, step: float) -> float:
    return value + min(max(end - value, -step), step)


def simulated(ride: Ride) -> tuple[Rows, int]:
    """Return the recorded SIGNALS and the code of a fault before they begin, 0 none."""
    drive = drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
    scenario = Scenario(
        initial_speed_kmh=3.6 * ride.initial_share * top_m_per_s(drive),
        boots_rolling=ride.begins in (STANDING, ROLLING),
        max_duration_s=1e4,
        ambient_temperature_c=ride.ambient_c,
        winding_temperature_c=ride.winding_c,
        switch_temperature_c=ride.switch_c,
        initial_soc=ride.soc,
        seed=ride.seed,
        record_interval_s=0.001,
        plant=ride.plant,
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        if isinstance(drive.battery.open_circuit_voltage_v, float | int):
            engine.set_voltage_curve([0.0], [ride.rest_v])
        stops.as_one_wheel(engine, drive)
        engine.start()
        before = int(engine.value("wheel0.first_fault_reason"))
        engine.choose(SIGNALS)
        return np.concatenate(list(_driven(ride, engine))), before


def _driven(ride: Ride, engine: Engine) -> Iterator[Rows]:
    driver = Driver(ride, engine)
    for phase in ride.phases:
        for _ in range(round(phase.seconds / STEP_S)):
            speed = engine.value("vehicle.speed_m_per_s")
            if phase.kind == BRAKE and abs(speed) < STANDS_M_PER_S:
                break
            driver.step(phase, speed)
            yield engine.run(STEP_S)


def shown(rows: Rows, before: int) -> list[tuple[str, float]]:
    """Return every warning and fault of a ride with the time at which it came first."""
    found: dict[str, float] = {reasons.identifier(before): 0.0} if before else {}
    for column in (WARNING, FAULT):
        codes, first = np.unique(rows[:, column], return_index=True)
        for code, row in zip(codes, first, strict=True):
            name = reasons.shown(code)
            if name:
                found[name] = min(found.get(name, np.inf), float(rows[row, TIME]))
    return sorted(found.items(), key=lambda item: item[1])


def limp_s(rows: Rows) -> float:
    """Return when LIMP began, NaN never."""
    modes = np.unique(rows[:, MODE])
    limping = [mode for mode in modes if mode_text(mode) == "LIMP"]
    rows = rows[np.isin(rows[:, MODE], limping)]
    return float(rows[0, TIME]) if len(rows) else float("nan")


def stops_of(rows: Rows) -> int:
    """Return how often the vehicle came to rest."""
    moves = np.abs(rows[:, SPEED]) > STANDS_M_PER_S
    return int(np.sum(moves[:-1] & ~moves[1:]))


def distance_m(rows: Rows) -> float:
    """Return the way there and back."""
    return float(np.sum(np.abs(rows[:, SPEED])) * 0.001)
