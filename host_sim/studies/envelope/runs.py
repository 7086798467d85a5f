# SPDX-License-Identifier: Apache-2.0
"""Every drive at the edges of its envelope, firmware and plant in closed loop.

A Latin hypercube over speed 0 to 110 %, driving and braking demand, battery, charge limit and
temperatures, in turn from each start: standing, rolling, full battery, cold, a hall line dead from
the beginning, the hall plug off while torque is made. One wheel with its share of mass and battery
stands for the vehicle (stops); its mass is so large that the speed stays.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from hubsim import reasons, run
from hubsim.engine import Engine, Rows
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep import cases
from hubsim.sweep.drives import drive_named, with_open_circuit_voltage
from regen_table import models

STARTS = ("standing", "rolling", "full", "cold", "dead_line", "plug_off")
SENSOR_STARTS = ("dead_line", "plug_off")
SPEED_SHARE = (0.0, 1.1)  # of the largest speed
DEMAND_SHARE = (-1.2, 1.2)  # of the largest torque, negative brakes
COLD_C = -20.0
NO_CHARGE_SHARE = 0.2  # of the runs have a charge limit of zero
DEMAND_S, FAULT_S, STEADY_S, END_S = 0.3, 1.0, 1.5, 2.5
BRAKES_AFTER_S = 0.05  # driving torque is counted from here on after the demand
HEAVY_KG = 1e6
RECORD_S = 0.001
MEAN_ROWS = 10
DRIVES_SHARE = 0.02  # of the rated torque: less counts as none
NOT_STARTED = "NOT_STARTED"
SIGNALS = (
    "time_s",
    "wheel0.motor_torque_nm",
    "wheel0.command_nm",
    "wheel0.hydraulic_torque_nm",
    "wheel0.current_d_a",
    "wheel0.current_q_a",
    "bus.voltage_v",
    "wheel0.mode",
    "wheel0.reason",
    "wheel0.first_fault_reason",
    "wheel0.warning_reason",
)


@dataclass(frozen=True)
class Case:
    """One run. The demand is signed, negative brakes; speed is forward."""

    drive: str
    start: str
    speed_share: float
    demand_nm: float
    soc: float
    open_circuit_v: float
    winding_c: float
    switch_c: float
    charge_share: float


@dataclass(frozen=True)
class Outcome:
    """What a run did. Shares are of the rated torque, the current and voltage limits.

    Attributes
    ----------
    torque_nm, command_nm : float
        Means over the steady part, at the wheel: airgap torque less the friction of the bearings.
    deviation : float
        |torque - command| / rated there.
    ripple : float
        Largest distance of the torque from its mean there, means over 10 ms.
    sum_deviation : float
        Braking: |motor + hydraulic brake - demand| / rated there; driving: 0.
    current_share : float
        Largest phase current of the run over ``max_phase_current_a``.
    bus_share : float
        Largest bus voltage over the battery's ``max_voltage_v``.
    drove_nm, drove_s : float
        Largest driving torque under a braking demand, and for how long there was any beyond 2 % of
        the rated torque.
    reason : str
        That of the torque at the end.
    """

    number: int
    drive: str
    start: str
    speed_share: float
    demand_nm: float
    soc: float
    open_circuit_v: float
    winding_c: float
    switch_c: float
    charge_share: float
    torque_nm: float
    command_nm: float
    deviation: float
    ripple: float
    sum_deviation: float
    current_share: float
    bus_share: float
    drove_nm: float
    drove_s: float
    mode: int
    first_fault: str
    warning: str
    reason: str


def draw(drives: Sequence[str], count: int, seed: int) -> list[Case]:
    """Return so many runs, drives and starts in turn, each drive's a Latin hypercube."""
    return cases.hypercube(drives, count, seed, 6, _case)


def _case(name: str, number: int, share: Rows) -> Case:
    drive, start = drive_named(name), STARTS[number % len(STARTS)]
    battery, motor = drive.battery, drive.motor

    def within(k: int, low: float, high: float, digits: int) -> float:
        return round(float(low + (high - low) * share[k]), digits)

    flat = isinstance(battery.open_circuit_voltage_v, float | int)
    filled = 1.0 if start == "full" else within(2, 0.1, 1.0, 4)
    low_v, high_v = battery.min_voltage_v, battery.max_voltage_v
    cold = start == "cold"
    return Case(
        name,
        start,
        within(0, *SPEED_SHARE, 4),
        round(within(1, *DEMAND_SHARE, 6) * motor.max_torque_nm, 3),
        0.5 if flat else filled,
        round(low_v + (high_v - low_v) * filled, 3)
        if flat
        else round(models.open_circuit_voltage_v(drive, filled), 3),
        COLD_C if cold else within(3, COLD_C, motor.max_winding_temperature_c, 2),
        COLD_C if cold else within(4, COLD_C, 100.0, 2),
        0.0 if share[5] < NO_CHARGE_SHARE else within(5, 0.0, 1.0, 3),
    )


def measure(number: int, case: Case) -> Outcome:
    """Simulate one run."""
    try:
        rows = _simulated(case)
    except HubsimError:  # the controllers do not get to the speed without a fault
        return _outcome(number, case, np.zeros((2, len(SIGNALS))), NOT_STARTED)
    return _outcome(number, case, rows, reasons.shown(rows[-1, 9]))


def _simulated(case: Case) -> Rows:
    plain = drive_named(case.drive)
    drive = with_open_circuit_voltage(plain, case.open_circuit_v)
    top = plain.motor.max_speed_rpm * np.pi / 30.0 * plain.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=case.speed_share * top * 3.6,
        boots_rolling=case.start in {"rolling", "dead_line"},
        max_duration_s=END_S,
        drag=False,
        winding_temperature_c=case.winding_c,
        switch_temperature_c=case.switch_c,
        initial_soc=case.soc,
        record_interval_s=RECORD_S,
    )
    engine, _ = run.prepare(plain, scenario, Path(), {})
    with engine:
        if isinstance(plain.battery.open_circuit_voltage_v, float | int):
            engine.set_voltage_curve([0.0], [case.open_circuit_v])
        stops.as_one_wheel(engine, drive)
        engine.set("vehicle.mass_kg", HEAVY_KG)
        limit_a = engine.get("battery.max_charge_current_a")
        engine.set("battery.max_charge_current_a", case.charge_share * limit_a)
        if case.start == "dead_line":
            engine.set("sensors.hall_stuck_low", 1.0)
        engine.start()
        engine.choose(SIGNALS)
        return np.concatenate(list(_phases(engine, case)))


def _phases(engine: Engine, case: Case) -> Iterable[Rows]:
    yield engine.run(DEMAND_S)
    engine.set("driver.brake_demand_nm", max(-case.demand_nm, 0.0))
    engine.set("driver.drive_demand_nm", max(case.demand_nm, 0.0))
    yield engine.run(FAULT_S - DEMAND_S)
    if case.start == "plug_off":
        engine.set("sensors.hall_stuck_high", 7.0)
    yield engine.run(END_S - FAULT_S)


def _outcome(number: int, case: Case, rows: Rows, fault: str) -> Outcome:
    drive = drive_named(case.drive)
    rated = drive.motor.rated_torque_nm
    time_s, airgap, command, hydraulic, i_d, i_q, bus_v, mode, reason, _, warning = rows.T
    speed = case.speed_share * drive.motor.max_speed_rpm * np.pi / 30.0
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * speed
    steady = time_s > STEADY_S
    if not np.any(steady):
        steady[:] = True
    torque = airgap - (friction if speed > 0.0 else 0.0)
    brakes = case.demand_nm < 0.0
    missing = hydraulic - torque + case.demand_nm if brakes else np.zeros_like(torque)
    over = np.where(brakes & (time_s > DEMAND_S + BRAKES_AFTER_S), airgap - friction, 0.0)
    whole = torque[steady]
    if len(whole) >= MEAN_ROWS:
        whole = whole[: len(whole) // MEAN_ROWS * MEAN_ROWS].reshape(-1, MEAN_ROWS).mean(axis=1)
    return Outcome(
        number=number,
        **asdict(case),
        torque_nm=float(torque[steady].mean()),
        command_nm=float(command[steady].mean()),
        deviation=abs(float((torque - command)[steady].mean())) / rated,
        ripple=float(np.max(np.abs(whole - whole.mean()), initial=0.0)) / rated,
        sum_deviation=abs(float(missing[steady].mean())) / rated,
        current_share=float(np.hypot(i_d, i_q).max()) / drive.motor.max_phase_current_a,
        bus_share=float(bus_v.max()) / drive.battery.max_voltage_v,
        drove_nm=float(over.max(initial=0.0)),
        drove_s=float(np.sum(over > DRIVES_SHARE * rated)) * RECORD_S,
        mode=int(mode[-1]),
        first_fault=fault,
        warning=reasons.shown(warning[-1]),
        reason=reasons.shown(reason[-1]),
    )
