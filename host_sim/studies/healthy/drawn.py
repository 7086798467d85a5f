# SPDX-License-Identifier: Apache-2.0
"""Rides of healthy vehicles, drawn (``hubsim.swarm.vehicles``).

A ride depends on the seed and its number alone: any range of rides has the same ones. Drives that
come along and rotor sensors take turns; all else is drawn.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from hubsim.scenario import overrides
from hubsim.swarm import vehicles
from hubsim.swarm.vehicles import PREPARED, ROLLING, Lot, Phase
from hubsim.sweep import faults_sweep
from hubsim.sweep.drives import DRIVES
from regen_table import STRATEGIES
from regen_table.schema import Drive

SENSORS: Mapping[str, tuple[str, ...]] = {
    "lu2013": ("hall", "angle", "encoder"),
    "ebike36v": ("hall", "angle", "encoder"),
    "scooter48v": ("hall", "angle", "encoder"),
    "ipm400v": ("angle", "encoder"),  # 11 000 r/min and salient: no motor like it has halls alone
}


@dataclass(frozen=True)
class Ride:
    """One vehicle and its driver; ``plant`` has the parameters of the world that are drawn.

    ``drive_s`` and ``brake_s``: for the whole travel of a pedal.
    """

    number: int
    drive: str
    sensor: str
    strategy: str
    hold: bool
    begins: str
    initial_share: float
    soc: float
    rest_v: float
    ambient_c: float
    winding_c: float
    switch_c: float
    seed: int
    drive_s: float
    brake_s: float
    plant: dict[str, float] = field(default_factory=dict)
    phases: tuple[Phase, ...] = ()

    @property
    def reports(self) -> int:
        """1: the hydraulic torque is measured and reported."""
        return int(self.plant["brake_sensor.fitted"])


@lru_cache
def drive_of(name: str, sensor: str, strategy: str, hold: bool) -> Drive:
    """Return what the controller is configured with."""
    drive = faults_sweep.drive_of(name, sensor)
    changes: dict[tuple[str, str], object] = {("brake", "strategy"): strategy}
    if hold:
        vehicle = drive.vehicle
        changes["driver", "hold_torque_nm"] = vehicles.hold_torque_nm(
            drive.motor.rated_torque_nm,
            vehicle.wheel_radius_m,
            vehicle.frontal_area_m2 * vehicle.drag_coefficient / vehicle.driven_wheels,
        )
    return overrides.changed(drive, changes, f"{name}, {sensor}, {strategy}")


def draw(seed: int, number: int) -> Ride:
    """Return one ride."""
    lot = Lot(seed, number)
    name = DRIVES[number % len(DRIVES)]
    sensor = SENSORS[name][number // len(DRIVES) % len(SENSORS[name])]
    strategy = STRATEGIES[lot.whole(len(STRATEGIES))]
    hold = lot.chance(0.25)
    drive = drive_of(name, sensor, strategy, hold)
    ambient_c = lot.within(*vehicles.AMBIENT_C)
    warm = lot.chance(0.5)
    hottest_c = drive.motor.max_winding_temperature_c - 15.0
    world = vehicles.parts_of(lot, drive, ambient_c)
    begins = vehicles.begins(lot, sensor)
    rolls = begins == ROLLING or (begins == PREPARED and lot.chance(0.5))
    cells = vehicles.cells(lot, drive)
    return Ride(
        number=number,
        drive=name,
        sensor=sensor,
        strategy=strategy,
        hold=hold,
        begins=begins,
        initial_share=lot.within(0.05, 0.8) if rolls else 0.0,
        soc=cells.soc,
        rest_v=cells.rest_v,
        ambient_c=ambient_c,
        winding_c=lot.within(ambient_c, hottest_c) if warm else ambient_c,
        switch_c=lot.within(ambient_c, ambient_c + 40.0) if warm else ambient_c,
        seed=lot.whole(1 << 31),
        drive_s=lot.within(0.2, 1.0),
        brake_s=lot.within(0.1, 0.6),
        plant=world,
        phases=vehicles.phases_of(lot, drive, world, rolls),
    )
