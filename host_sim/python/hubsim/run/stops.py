# SPDX-License-Identifier: Apache-2.0
"""Stops at constant demand (the paper's Fig. 14).

What simulated controllers store, beside the ideal ones.

A stop of a vehicle whose wheels all do the same is that of one wheel with its share of mass and
battery: currents, voltages and shares of energy are equal, at a fraction of the work.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from regen_table import braking, ideal, models, packs
from regen_table.ideal import lines
from regen_table.schema import Drive

from hubsim import configuration
from hubsim.engine import Engine, Rows
from hubsim.errors import HubsimError
from hubsim.run import simulation
from hubsim.scenario import Scenario

SPEED_KMH = 40.0
TEMPERATURE_C = 25.0
DEMANDS_NM = (5.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0, 120.0)
IDEAL_POINTS = 16
MAP_POINTS = 120
BEYOND = 10.0
LONGEST_S = 1000.0

# Of the whole vehicle, in proportion to the wheels, and against it.
_SHARED = (
    "vehicle.mass_kg",
    "battery.polarisation_capacitance_f",
    "battery.capacity_ah",
    "battery.max_charge_current_a",
    "battery.max_discharge_current_a",
    "vehicle.frontal_area_m2",
    "bus.capacitance_f",
)
_AGAINST = (
    "battery.series_resistance_ohm",
    "battery.polarisation_resistance_ohm",
    "bus.cable_resistance_ohm",
)


@dataclass(frozen=True)
class Curve:
    """Stored share of the kinetic energy (1) over the demand at a wheel (N m), of one strategy.

    ``ideal`` is with the battery's RC branch at rest before the stop, as in the simulation;
    ``settled``, at the simulated demands, with that branch in steady state throughout.
    """

    strategy: str
    demand_nm: tuple[float, ...]
    stored: tuple[float, ...]
    settled: tuple[float, ...]
    ideal_demand_nm: tuple[float, ...]
    ideal: tuple[float, ...]


@dataclass(frozen=True)
class Map:
    """The loss-optimal braking torque of a drive over wheel speed.

    Arrays of shape (points,), magnitudes in N m.

    ``zero_nm``: beyond it braking takes energy out of the battery. ``limit_nm``: torque and power
    limits. With the i_d of least loss where the magnets are buried; there, ``BEYOND`` times the
    largest limit stands for what more than three times the drive's current would take.
    """

    temperature_c: float
    wheel_radius_m: float
    speed_rad_s: Rows
    optimal_nm: Rows
    zero_nm: Rows
    limit_nm: Rows


def optimum_map(drive: Drive, temperature_c: float = TEMPERATURE_C) -> Map:
    """Compute the map up to the motor's largest speed."""
    speed = np.linspace(0.0, drive.motor.max_speed_rpm * np.pi / 30.0, MAP_POINTS)
    best, limit = (
        lines(drive, models.machine(drive, temperature_c), models.bridge(drive), speed),
        braking.torque_limit_nm(drive, speed),
    )
    optimal, zero = (
        np.nan_to_num(torque, nan=BEYOND * np.max(limit))
        for torque in (best.optimal_nm, best.zero_nm)
    )
    return Map(temperature_c, drive.vehicle.wheel_radius_m, speed, optimal, zero, limit)


def simulate(
    drives: Sequence[Drive],
    demands_nm: Sequence[float] = DEMANDS_NM,
    progress: Callable[[], None] | None = None,
) -> list[Curve]:
    """Simulate stops from 40 km/h without drag, a strategy in each drive, all at the same time.

    Parameters
    ----------
    progress : callable, optional
        Called after every stop.
    """
    with ThreadPoolExecutor() as pool:
        stored = list(pool.map(lambda drive: _stored(drive, demands_nm, progress), drives))
    curves = []
    for drive, found in zip(drives, stored, strict=True):
        strategy = drive.brake.strategy
        grid = np.union1d(
            np.geomspace(min(demands_nm), max(demands_nm), IDEAL_POINTS), np.array(demands_nm)
        )
        over, settled = (
            _ideal(drive, grid.tolist(), packs.DYNAMIC),
            _ideal(drive, demands_nm, packs.SETTLED),
        )
        curves.append(
            Curve(strategy, tuple(demands_nm), tuple(found), settled, tuple(grid.tolist()), over)
        )
    return curves


def as_one_wheel(engine: Engine, drive: Drive) -> None:
    """Leave one wheel with its share of mass and battery of a vehicle that has not begun."""
    wheels = drive.vehicle.driven_wheels
    for names, factor in ((_SHARED, 1.0 / wheels), (_AGAINST, float(wheels))):
        for name in names:
            engine.set(name, factor * engine.get(name))
    engine.set("vehicle.driven_wheels", 1.0)
    engine.load_config(
        configuration.changed_image(
            configuration.image_of(drive), {("battery", "driven_wheels"): 1}
        )
    )


def _ideal(drive: Drive, demands_nm: Sequence[float], battery: str) -> tuple[float, ...]:
    found = (
        ideal.stop(drive, drive.brake.strategy, demand, SPEED_KMH, TEMPERATURE_C, battery=battery)
        for demand in demands_nm
    )
    return tuple(stop.stored_share_of_kinetic for stop in found)


def _stored(
    drive: Drive, demands_nm: Sequence[float], progress: Callable[[], None] | None
) -> list[float]:
    """Return the stored share of the kinetic energy for every demand."""
    standing = Scenario(
        initial_speed_kmh=SPEED_KMH,
        drag=False,
        stop_at_standstill=True,
        winding_temperature_c=TEMPERATURE_C,
    )
    engine, _ = simulation.prepare(drive, standing, Path(), {})
    with engine:
        as_one_wheel(engine, drive)
        engine.start()
        begun, found = engine.save(), []
        for demand in demands_nm:
            engine.restore(begun)
            engine.set("driver.brake_demand_nm", demand)
            engine.run(LONGEST_S)
            if not engine.ended:
                raise HubsimError(
                    f"{drive.name}: a stop at {demand:g} N m takes more than {LONGEST_S:g} s"
                )
            found.append(-engine.value("energy.chemical_j") / -engine.value("energy.kinetic_j"))
            if progress is not None:
                progress()
    return found
