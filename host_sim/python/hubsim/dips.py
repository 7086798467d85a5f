# SPDX-License-Identifier: Apache-2.0
"""Dips of both brakes together where the motor must give up its torque at once.

``python -m hubsim.dips`` prints them for every drive that comes along: the charge limit falls to
zero without a limit for a short time, and the contactor opens; beside each the dip that follows
from what the motor may keep and how fast the hydraulic brake can come (Derived). One wheel with its
share of mass and battery stands for the vehicle (stops).
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from regen_table import models, stop_limits
from regen_table.schema import Drive

from hubsim import let_go, run, stops
from hubsim.engine import Rows
from hubsim.scenario import Scenario
from hubsim.stored_share import DRIVES, drive_named

DEMAND_SHARES = (0.33, 1.0, 2.0)  # of the rated torque
SPEED_SHARE = 0.6  # of the largest speed
NO_CHARGING, CONTACTOR = "charge limit to zero", "contactor opens"
EVENTS = {
    NO_CHARGING: ("battery.max_charge_current_a", 0.0),
    CONTACTOR: ("bus.contactor_open", 1.0),
}
AT_S, AFTER_S = 0.8, 0.6
RECORD_S = 0.001
MEAN_ROWS = 5
OVER_SHARE = 0.1  # a dip is over where less of the demand is missing
WINDING_C = 25.0
POINTS = 240
SIGNALS = (
    "driver.brake_nm",
    "vehicle.speed_m_per_s",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "bus.voltage_v",
)


@dataclass(frozen=True)
class Dip:
    """Largest missing share of the demand, and for how long more than OVER_SHARE is missing."""

    share: float
    seconds: float


@dataclass(frozen=True)
class Outcome:
    """A measured dip beside the derived one."""

    drive: str
    event: str
    demand_nm: float
    measured: Dip
    derived: Dip
    kept_nm: float


def lossy_braking_nm(drive: Drive, speed_rad_s: float, bus_v: float) -> float:
    """Return the largest braking torque (airgap, N m) that returns nothing: loss braking.

    Over all currents inside the phase current and the voltage; the model of ``regen_table``.
    """
    machine = models.machine(drive, WINDING_C)
    omega = np.array(machine.pole_pairs * speed_rad_s)
    voltage = float(stop_limits.largest_voltage_v(drive, omega, np.array(bus_v)))
    amperes = drive.motor.max_phase_current_a * np.linspace(0.0, 1.0, POINTS // 4)[:, np.newaxis]
    angle = np.linspace(0.5 * math.pi, 1.5 * math.pi, POINTS)
    state = models.evaluate(
        machine, models.bridge(drive), omega, amperes * np.cos(angle), amperes * np.sin(angle)
    )
    possible = (state.dc_power_w >= 0.0) & (state.voltage_v <= voltage)
    return float(np.max(-state.torque_nm, where=possible, initial=0.0))


def derived(
    drive: Drive, demand_nm: float, motor_nm: float, kept_nm: float, rate_nm_per_s: float
) -> Dip:
    """Return the dip where the motor falls from ``motor_nm`` to what it may keep at this rate.

    The hydraulic brake, which made the rest, is commanded what will be missing at the same instant
    and follows after its dead time with its lag:

        M(t) = max(kept, motor - rate t),  H(t) = demand - motor + (motor - kept) (1 - e^-(t - d)/l)
    """
    kept = min(kept_nm, motor_nm)
    t = np.arange(0.0, AFTER_S, 1e-4)
    late = np.maximum(t - drive.brake.hydraulic_dead_time_s, 0.0)
    come = -np.expm1(-late / drive.brake.hydraulic_time_constant_s)
    total = np.maximum(kept, motor_nm - rate_nm_per_s * t) + (motor_nm - kept) * come
    missing = (motor_nm - total) / demand_nm
    return Dip(float(np.max(missing)), float(np.sum(missing > OVER_SHARE)) * 1e-4)


def measure(name: str, event: str, demand_share: float) -> Outcome:
    """Simulate one and derive the other from the state before the event."""
    drive = drive_named(name)
    demand_nm = demand_share * drive.motor.rated_torque_nm
    rows, at = simulated(drive, event, demand_nm)
    before = rows[at - MEAN_ROWS : at].mean(axis=0)
    speed = float(before[1]) / drive.vehicle.wheel_radius_m
    if event == NO_CHARGING:
        kept = lossy_braking_nm(drive, speed, float(before[4]))
        rate = drive.control.torque_rate_nm_per_s
    else:  # nothing holds the bus: the bridge opens, what is left is the iron's drag
        kept = float(let_go.iron_drag_nm(drive, np.array([speed]))[0])
        rate = math.inf
    found = derived(drive, demand_nm, -float(before[2]), kept, min(rate, 1e9))
    return Outcome(name, event, demand_nm, measured(rows[at:], drive), found, kept)


def simulated(drive: Drive, event: str, demand_nm: float) -> tuple[Rows, int]:
    """Return the recorded SIGNALS and the row of the event."""
    top_m_per_s = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=3.6 * SPEED_SHARE * top_m_per_s,
        demand_nm=demand_nm,
        max_duration_s=AT_S + AFTER_S,
        winding_temperature_c=WINDING_C,
        record_interval_s=RECORD_S,
        plant={"bus.capacitance_f": drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f},
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(SIGNALS)
        rows = engine.run(AT_S)
        engine.set(*EVENTS[event])
        return np.concatenate([rows, engine.run(AFTER_S)]), len(rows)


def measured(rows: Rows, drive: Drive) -> Dip:
    """Return the dip of the sum of both brakes, in means of MEAN_ROWS."""
    demand, speed, airgap, hydraulic, _ = rows.T
    turning = speed / drive.vehicle.wheel_radius_m
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * turning
    missing = 1.0 - (hydraulic - airgap + friction) / demand
    missing = np.convolve(missing, np.ones(MEAN_ROWS) / MEAN_ROWS, "valid")
    return Dip(float(np.max(missing)), float(np.sum(missing > OVER_SHARE)) * RECORD_S)


def line(found: Outcome) -> str:
    """Return an outcome as a line."""
    parts = (
        f"{100.0 * dip.share:3.0f} % for {1000.0 * dip.seconds:3.0f} ms"
        for dip in (found.measured, found.derived)
    )
    return (
        f"{found.drive:11} {found.event:21} {found.demand_nm:6.1f} N m: dip "
        + ", derived ".join(parts)
        + f" (the motor may keep {found.kept_nm:.1f} N m)"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Do the command."""
    parser = argparse.ArgumentParser(prog="python -m hubsim.dips", description=__doc__)
    parser.add_argument("drives", nargs="*", default=DRIVES, metavar="DRIVE", help="default: all")
    for name in parser.parse_args(arguments).drives:
        for event in EVENTS:
            for share in DEMAND_SHARES:
                print(line(measure(name, event, share)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
