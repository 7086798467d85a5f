# SPDX-License-Identifier: Apache-2.0
"""Rides with a healthy hydraulic brake that the deceleration names wrong.

Every ride drives, coasts, brakes, and brakes with another demand, on one wheel with its share of
mass and battery (stops). Gain 0.8 to 1.2, delay and lag 0.5 to 2 times, mass and air drag 0.85 to
1.15 times what the controller is told, slopes to 8 % that change by up to 0.001 a metre, all of it
at once: then a gain of 1.2 with a mass of 0.85 is a brake that makes 1.4 times its command, and not
every finding is avoided. ``python -m hubsim.healthy_brakes`` prints the rides that were named; its
status is 1 if they are more than MOST of all. ``--steps``: the slope also steps once by 2 to 6 %
and back again, while it coasts or brakes, as on a ramp. ``--reports``: the brake reports its
torque.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hubsim import faults_sweep, reasons, run, stops, total_torque
from hubsim.errors import HubsimError
from hubsim.scenario import Scenario

VEHICLES = tuple(vehicle for vehicle in faults_sweep.VEHICLES if vehicle != ("lu2013", "angle"))
SPEED_SHARE = (0.25, 0.85)  # of the largest
DEMAND_SHARES = (0.8, 1.5, 2.5, 4.0)  # of the rated torque
GAIN, LATENESS, FACTOR = (0.8, 1.2), (0.5, 2.0), (0.85, 1.15)
SLOPE, SLOPES_PER_M = 0.08, (0.0, 0.0005, 0.001)
TURNS_A_STEP = 0.01  # how often the slope begins to change the other way
STEP_S, LONGEST_S = 0.05, 40.0
MOST = 0.08
SLOPE_STEP, STEP_LASTS_S = (0.02, 0.06), (0.5, 3.0)
STEP_BEFORE_S, STEP_AFTER_S = 1.0, 4.0  # the braking demand
SIGNALS = ("time_s", "vehicle.speed_m_per_s", "wheel0.warning_reason")


@dataclass(frozen=True)
class Ride:
    """One ride; demands in shares of the rated torque, factors of what the controller is told."""

    drive: str
    rotor_sensor: str
    speed_share: float
    drive_share: float
    brake_s: float
    demand_share: float
    then_s: float
    then_share: float
    gain: float = 1.0
    lateness: float = 1.0
    mass: float = 1.0
    drag: float = 1.0
    slope: float = 0.0
    slope_per_m: float = 0.0
    seed: int = 0
    step: float = 0.0
    step_s: float = 0.0
    step_lasts_s: float = 0.0
    reports: bool = False


def stepped(ride: Ride, seed: int) -> Ride:
    """Return a ride with a step of the slope."""
    random = np.random.default_rng((seed, ride.seed))
    step = float(random.uniform(*SLOPE_STEP) * random.choice((-1.0, 1.0)))
    step_s = ride.brake_s + random.uniform(-STEP_BEFORE_S, STEP_AFTER_S)
    return replace(ride, step=step, step_s=step_s, step_lasts_s=random.uniform(*STEP_LASTS_S))


def drawn(count: int, seed: int) -> Iterator[Ride]:
    """Draw rides, the vehicles in turn."""
    random = np.random.default_rng(seed)
    for k in range(count):
        name, sensor = VEHICLES[k % len(VEHICLES)]
        demand = float(random.choice(DEMAND_SHARES))
        brake_s = round(random.uniform(1.5, 4.0), 3)
        yield Ride(
            name,
            sensor,
            random.uniform(*SPEED_SHARE),
            random.uniform(0.0, 0.8),
            brake_s,
            demand,
            round(brake_s + random.uniform(1.0, 4.0), 3),
            demand * random.uniform(0.2, 1.0),
            random.uniform(*GAIN),
            random.uniform(*LATENESS),
            random.uniform(*FACTOR),
            random.uniform(*FACTOR),
            random.uniform(-SLOPE, SLOPE),
            float(random.choice(SLOPES_PER_M)),
            k,
        )


def named(ride: Ride) -> str:
    """Return the first finding about the hydraulic brake, empty: none."""
    drive = faults_sweep.drive_of(ride.drive, ride.rotor_sensor)
    rated_nm, vehicle = drive.motor.rated_torque_nm, drive.vehicle
    top_m_per_s = drive.motor.max_speed_rpm * np.pi / 30.0 * vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=3.6 * ride.speed_share * top_m_per_s,
        slope_percent=100.0 * ride.slope,
        stop_at_standstill=True,
        record_interval_s=0.01,
    )
    plant = total_torque.weak_and_late(drive, ride.gain, ride.lateness)
    if ride.reports:
        plant |= total_torque.FEEDBACK
    engine, _ = run.prepare(drive, scenario, Path(), plant)
    demands = {
        0.0: (ride.drive_share, 0.0),
        0.5 * ride.brake_s: (0.0, 0.0),
        ride.brake_s: (0.0, ride.demand_share),
        ride.then_s: (0.0, ride.then_share),
    }
    random = np.random.default_rng(ride.seed)
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.set("vehicle.mass_kg", ride.mass * engine.get("vehicle.mass_kg"))
        engine.set("vehicle.frontal_area_m2", ride.drag * engine.get("vehicle.frontal_area_m2"))
        engine.start()
        engine.choose(SIGNALS)
        slope, way = ride.slope, 1.0
        for at_s in np.arange(0.0, LONGEST_S, STEP_S):
            for from_s, (drive_share, brake_share) in demands.items():
                if at_s - STEP_S < from_s <= at_s:
                    engine.set("driver.drive_demand_nm", drive_share * rated_nm)
                    engine.set("driver.brake_demand_nm", brake_share * rated_nm)
            rows = engine.run(STEP_S)
            found = [reasons.identifier(code) for code in np.unique(rows[:, 2])]
            wrong = [name for name in found if name.startswith("HYDRAULIC_")]
            if wrong and wrong != ["HYDRAULIC_LIMIT"]:
                return wrong[0]
            if engine.ended:
                break
            way = -way if random.random() < TURNS_A_STEP or abs(slope) > SLOPE else way
            slope += way * ride.slope_per_m * abs(float(rows[-1, 1])) * STEP_S
            on_step = ride.step_s <= at_s + STEP_S < ride.step_s + ride.step_lasts_s
            engine.set("road.slope", slope + (ride.step if on_step else 0.0))
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Do the command."""
    parser = argparse.ArgumentParser(prog="python -m hubsim.healthy_brakes", description=__doc__)
    parser.add_argument("--count", type=int, default=400, metavar="N", help="default: 400")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="default: 1")
    parser.add_argument("--steps", action="store_true", help="the slope steps as well")
    parser.add_argument("--reports", action="store_true", help="the brake reports its torque")
    options = parser.parse_args(arguments)
    wrong = 0
    try:
        for ride in drawn(options.count, options.seed):
            tried = replace(ride, reports=options.reports)
            tried = stepped(tried, options.seed) if options.steps else tried
            reason = named(tried)
            if reason:
                wrong += 1
                print(f"{reason}: {tried}")
    except HubsimError as error:
        print(f"hubsim.healthy_brakes: {error}", file=sys.stderr)
        return 1
    print(f"{wrong} of {options.count} rides with a healthy brake have a finding")
    return 1 if wrong > MOST * options.count else 0


if __name__ == "__main__":
    sys.exit(main())
