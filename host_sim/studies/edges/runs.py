# SPDX-License-Identifier: Apache-2.0
"""Runs at the edges of braking: what is drawn for each kind of event, and its simulation.

One wheel with its share of mass and battery stands for the vehicle (stops), without drag; the bus
has its capacitor. What they must show: ``judges``.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from hubsim import run
from hubsim.engine import Engine, Rows
from hubsim.run import stops
from hubsim.run.plant import STANDARD_GRAVITY_M_PER_S2
from hubsim.scenario import Scenario, overrides
from hubsim.sweep import cases, faults_sweep
from regen_table import models
from regen_table.schema import Drive

ANTI_LOCK, OVER_DRIVE, ONSET = "anti_lock", "over_drive", "onset"
LOW_BUS, LOW_BUS_STOP = "low_bus", "low_bus_stop"
LOST_DRIVE, LOST_BRAKE, LOST_BOTH = "lost_drive", "lost_brake", "lost_both"
BOOT, LIFT_OFF, MOST_BRAKE, MOST_DRIVE = "boot", "lift_off", "most_brake", "most_drive"
KINDS = (
    ANTI_LOCK, OVER_DRIVE, ONSET, LOW_BUS, LOW_BUS_STOP, LOST_DRIVE, LOST_BRAKE, LOST_BOTH, BOOT,
    LIFT_OFF, MOST_BRAKE, MOST_DRIVE,
)  # fmt: skip
LOW = (LOW_BUS, LOW_BUS_STOP)
"""Where the pack's voltage is between empty and full; 0.4 to 0.9 otherwise."""
FILLED = {
    LOW_BUS: (0.0, 0.4),
    LOW_BUS_STOP: (0.0, 0.4),
    BOOT: (0.0, 0.9),
    MOST_BRAKE: (0.4, 0.7),  # no fold-back
    MOST_DRIVE: (0.4, 0.7),
}
SENSORS = ("hall", "encoder", "angle")
AT_A_CONSTANT_SPEED = (LOW_BUS, MOST_BRAKE, MOST_DRIVE)  # the mass is so large that it stays
HEAVY_KG = 1e6
LARGEST_SPEED_SHARE = 1.1
LOW_BUS_SPEED_SHARE = 0.85  # from here on
LIFT_OFF_SPEED_SHARE = (0.1, 0.6)
PULL_MARGIN = 2.0  # times the pull of the slope: lift-off braking that stops
SLOPE_PERCENT = (-6.0, 6.0)
LARGE_PACK = 3.0  # times the currents of the pack, where the motor is to be the limit
BEYOND = 1.3  # of the largest torque: a demand that is never met
FIRST_S, EVENT_S, END_S, LONG_END_S = 0.1, 0.9, 1.6, 2.2
STANDS_S, LONGEST_S = 1.0, 200.0
RECORD_S = 0.001
SIGNALS = (
    "time_s",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "wheel0.speed_rad_per_s",
    "wheel0.current_d_a",
    "wheel0.current_q_a",
    "bus.voltage_v",
    "wheel0.mode",
    "wheel0.bridge",
    "wheel0.reason",
    "wheel0.warning_reason",
    "wheel0.first_fault_reason",
    "battery.polarisation_v",
    "wheel0.winding_temperature_c",
    "bms.charge_a",
    "vehicle.distance_m",
)


@dataclass(frozen=True)
class Case:
    """One run. Torques are magnitudes at the wheel; ``motor_share`` is the anti-lock system's."""

    kind: str
    drive: str
    sensor: str
    speed_share: float
    slope_percent: float
    drive_nm: float
    brake_nm: float
    motor_share: float
    soc: float
    open_circuit_v: float
    winding_c: float


@lru_cache
def drive_of(name: str, sensor: str, kind: str = "") -> Drive:
    """Return a drive that comes along with this rotor sensor.

    For the largest torque strategy and battery leave the motor all it can make.
    """
    drive = faults_sweep.drive_of(name, sensor)
    if kind not in (MOST_BRAKE, MOST_DRIVE):
        return drive
    pack = drive.battery
    free: dict[tuple[str, str], object] = {
        ("brake", "strategy"): "parallel_free_travel",
        ("brake", "electric_rated_torque_nm"): drive.motor.max_torque_nm,
        ("battery", "max_charge_current_a"): LARGE_PACK * pack.max_charge_current_a,
        ("battery", "max_discharge_current_a"): LARGE_PACK * pack.max_discharge_current_a,
    }
    return overrides.changed(drive, free, f"{name}, {sensor}, free travel")


def draw(drives: Sequence[str], count: int, seed: int, kinds: Sequence[str] = KINDS) -> list[Case]:
    """Return so many runs: kinds and drives in turn, each a Latin hypercube, sensors in turn."""
    found: list[list[Case]] = []
    for k, kind in enumerate(kinds):
        here = (count + len(kinds) - 1 - k) // len(kinds)

        def case(name: str, number: int, share: Rows, kind: str = kind) -> Case:
            return _case(kind, name, number, share)

        found.append(cases.hypercube(drives, here, seed + k, 6, case) if here else [])
    return [several[j] for j in range(max(map(len, found))) for several in found
            if j < len(several)]  # fmt: skip


def top_rad_s(drive: Drive) -> float:
    """Return the largest speed of the configuration."""
    return drive.motor.max_speed_rpm * math.pi / 30.0


def inertia(drive: Drive) -> float:
    """Torque at a wheel for a deceleration of 1 m/s2, N m."""
    return drive.vehicle.mass_kg / drive.vehicle.driven_wheels * drive.vehicle.wheel_radius_m


def pull_nm(drive: Drive, slope_percent: float) -> float:
    """Return the torque with which a slope holds a wheel back."""
    sine = math.sin(math.atan(slope_percent / 100.0))
    return inertia(drive) * STANDARD_GRAVITY_M_PER_S2 * sine


def _case(kind: str, name: str, number: int, share: Rows) -> Case:
    sensor = SENSORS[number % len(SENSORS)]
    drive = drive_of(name, sensor)
    most = drive.motor.max_torque_nm

    def within(k: int, low: float, high: float) -> float:
        return float(low + (high - low) * share[k])

    drives_nm = within(1, 0.1, 1.0) * most
    brakes_nm = within(2, 0.1, 1.2) * most
    slope = 0.0
    if kind == LIFT_OFF:
        drives_nm = within(1, 0.2, 1.0) * most
        slope = within(3, *SLOPE_PERCENT)
        steepest = drives_nm / PULL_MARGIN / pull_nm(drive, 1.0)
        slope = float(np.clip(slope, -steepest, steepest))
    elif kind in (MOST_BRAKE, MOST_DRIVE):
        drives_nm = brakes_nm = BEYOND * most
    elif kind in LOW:
        brakes_nm = within(2, 0.0, 1.2) * most
    flat = isinstance(drive.battery.open_circuit_voltage_v, float | int)
    low_v, high_v = drive.battery.min_voltage_v, drive.battery.max_voltage_v
    low, high = FILLED.get(kind, (0.4, 0.9))
    filled = within(4, low, high)
    return Case(
        kind, name, sensor,
        round(_speed_share(kind, drive, brakes_nm, float(share[0])), 4),
        round(slope, 3),
        round(drives_nm, 3) if kind in (OVER_DRIVE, LOST_DRIVE, LOST_BOTH, LIFT_OFF, MOST_DRIVE)
        else 0.0,
        round(brakes_nm, 3) if kind not in (LOST_DRIVE, LIFT_OFF, MOST_DRIVE) else 0.0,
        round(within(3, 0.1, 0.9), 3) if kind == ANTI_LOCK and number // 3 % 2 else 0.0,
        0.5 if flat else round(filled, 4),
        round(low_v + (high_v - low_v) * filled, 3)
        if flat
        else round(models.open_circuit_voltage_v(drive, filled), 3),
        round(within(5, 0.0, 100.0), 2),
    )  # fmt: skip


def _speed_share(kind: str, drive: Drive, brakes_nm: float, share: float) -> float:
    """Return the initial speed, such that braking does not end in the blend-out."""
    top = top_rad_s(drive)
    if kind == LIFT_OFF:
        low, high = LIFT_OFF_SPEED_SHARE
    elif kind in LOW:
        low, high = LOW_BUS_SPEED_SHARE, LARGEST_SPEED_SHARE
    elif kind == BOOT:
        low, high = 0.0, LARGEST_SPEED_SHARE
    elif kind == MOST_DRIVE:
        low, high = 0.1, 0.95  # below the line MAX_SPEED
    else:
        slows = brakes_nm / inertia(drive) / drive.vehicle.wheel_radius_m * LONG_END_S
        begins = drive.control.handover_start_rpm * math.pi / 30.0
        low, high = (slows + 1.3 * begins) / top, 1.0
    low = min(low, high)
    return low + (high - low) * share


def simulated(case: Case) -> Rows:
    """Return the recorded SIGNALS."""
    drive = drive_of(case.drive, case.sensor, case.kind)
    radius = drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=3.6 * case.speed_share * top_rad_s(drive) * radius,
        boots_rolling=case.kind == BOOT,
        slope_percent=case.slope_percent,
        max_duration_s=LONGEST_S,
        drag=False,
        winding_temperature_c=case.winding_c,
        initial_soc=case.soc,
        record_interval_s=RECORD_S,
        plant={"bus.capacitance_f": drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f},
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        if isinstance(drive.battery.open_circuit_voltage_v, float | int):
            engine.set_voltage_curve([0.0], [case.open_circuit_v])
        stops.as_one_wheel(engine, drive)
        if case.kind in AT_A_CONSTANT_SPEED:
            engine.set("vehicle.mass_kg", HEAVY_KG)
        engine.start()
        engine.choose(SIGNALS)
        return np.concatenate(list(_phases(engine, case)))


def _phases(engine: Engine, case: Case) -> Iterable[Rows]:
    """First what is before the event, then the event."""
    if case.kind == LIFT_OFF:
        yield from _until_it_stands(engine, case)
        return
    yield engine.run(FIRST_S)
    late = case.kind in (OVER_DRIVE, ONSET, BOOT)
    engine.set("driver.drive_demand_nm", case.drive_nm)
    engine.set("driver.brake_demand_nm", 0.0 if late else case.brake_nm)
    yield engine.run(EVENT_S - FIRST_S)
    if case.kind == ANTI_LOCK:
        engine.set("driver.abs_motor_share", case.motor_share)
        engine.set("driver.abs_active", 1.0)
    elif case.kind in (LOST_DRIVE, LOST_BRAKE, LOST_BOTH):
        engine.set("driver.silent", 1.0)
    engine.set("driver.brake_demand_nm", case.brake_nm)
    long = case.kind in (LOW_BUS_STOP, LOST_DRIVE, LOST_BRAKE, LOST_BOTH)
    yield engine.run((LONG_END_S if long else END_S) - EVENT_S)


def _until_it_stands(engine: Engine, case: Case) -> Iterable[Rows]:
    """Lift-off braking, sent as a negative driving torque, and STANDS_S more."""
    yield engine.run(FIRST_S)
    engine.set("driver.drive_demand_nm", -case.drive_nm)
    stood_s = np.inf
    while True:
        rows = engine.run(0.1)
        yield rows
        stands = rows[:, 3] <= 0.0
        if np.any(stands):
            stood_s = min(stood_s, float(rows[np.argmax(stands), 0]))
        if rows[-1, 0] >= min(stood_s + STANDS_S, LONGEST_S - 0.2):
            return
