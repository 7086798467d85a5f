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
from hubsim.scenario import Scenario
from hubsim.swarm.driving import STANDS_M_PER_S, STEP_S, Driver
from hubsim.swarm.vehicles import BRAKE, ROLLING, STANDING, top_m_per_s
from studies.healthy.drawn import Ride, drive_of

SIGNALS = (
    "time_s",
    "vehicle.speed_m_per_s",
    "wheel0.mode",
    "wheel0.warning_reason",
    "wheel0.fault_reason",
)
TIME, SPEED, MODE, WARNING, FAULT = range(len(SIGNALS))


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
    drive = drive_of(ride.drive, ride.sensor, ride.strategy, ride.hold)
    inertia = engine.get("vehicle.mass_kg") * engine.get("vehicle.wheel_radius_m")
    driver = Driver(drive, inertia, ride.drive_s, ride.brake_s)
    for phase in ride.phases:
        for _ in range(round(phase.seconds / STEP_S)):
            speed = engine.value("vehicle.speed_m_per_s")
            if phase.kind == BRAKE and abs(speed) < STANDS_M_PER_S:
                break
            for name, value in driver.step(phase, speed).parameters.items():
                if engine.get(name) != value:
                    engine.set(name, value)
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
