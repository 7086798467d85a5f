# SPDX-License-Identifier: Apache-2.0
"""Stops in closed loop beside the ideal stop inside the same limits.

How much of the kinetic energy the firmware stores, over state of charge, demand, speed and winding
temperature of every drive, against ``regen_table.limited_stop``. One wheel with its share of mass
and battery stands for the vehicle (stops).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from regen_table import limited_stop, models
from regen_table.schema import Drive

from hubsim import reasons, run
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep import cases
from hubsim.sweep.drives import drive_named, with_open_circuit_voltage

DEMAND_SHARE = (0.1, 1.2)  # of the rated torque
SPEED_SHARE = (0.2, 1.0)  # of the largest speed
SLOW_SHARE = 0.3  # of the largest speed: below it the tolerance is TOLERANCE_LARGE
TOLERANCE = 0.01  # of the kinetic energy
TOLERANCE_LARGE = 0.025  # of slow stops, and where the charge current keeps an angle's reserve
RIPPLE_MAX = 0.01  # of the rated torque
RECORD_S = 0.001
WINDOW_ROWS = 100  # in which torque is compared with a straight line
STEADY_SHARE = 0.02  # of the rated torque: a line that rises more in a window is no steady state
SETTLED_S = 0.3  # after the beginning
LONGEST_S = 3000.0
NOT_STARTED = "NOT_STARTED"
SIGNALS = (
    "wheel0.motor_torque_nm",
    "wheel0.reason",
    "vehicle.speed_m_per_s",
    "wheel0.first_fault_reason",
    "wheel0.limit_braking_reason",
)


@dataclass(frozen=True)
class Case:
    """One stop: torque at the wheel, winding temperature, and the battery when it begins.

    ``open_circuit_v`` stands for ``soc`` where the drive's voltage does not depend on charge.
    """

    drive: str
    demand_nm: float
    initial_speed_kmh: float
    winding_temperature_c: float
    soc: float
    open_circuit_v: float


@dataclass(frozen=True)
class Outcome:
    """What a stop stored, in shares of the kinetic energy, and how.

    Attributes
    ----------
    ripple_share_of_rated : float
        Largest deviation of the motor's torque from a straight line over a tenth of a second, where
        one reason bounds it and that line is level.
    first_fault : str
        Of the run; NOT_STARTED where the controllers reach the initial speed only with a fault.
    reason, ideal_reason : str
        The limit under which most energy of the demand went past the motor.
    impossible_s : float
        For how long no currents inside the limits exist: the ideal means nothing then.
    """

    number: int
    drive: str
    demand_nm: float
    demand_share_of_rated: float
    initial_speed_kmh: float
    speed_share_of_top: float
    winding_temperature_c: float
    soc: float
    open_circuit_v: float
    stored: float
    ideal: float
    difference: float
    ripple_share_of_rated: float
    first_fault: str
    reason: str
    ideal_reason: str
    impossible_s: float

    @property
    def tolerance(self) -> float:
        """Largest |difference| accepted of this stop."""
        reserve = self.ideal_reason == "charge_current"
        slow = self.speed_share_of_top < SLOW_SHARE
        return TOLERANCE_LARGE if slow or reserve else TOLERANCE

    @property
    def comparable(self) -> bool:
        """Whether there is an ideal to compare with."""
        return self.impossible_s == 0.0

    @property
    def within(self) -> bool:
        """Whether the stop stores what it should, without a fault."""
        return abs(self.difference) <= self.tolerance and not self.first_fault


def draw(drives: Sequence[str], count: int, seed: int) -> list[Case]:
    """Return so many stops, the drives in turn, each drive's a Latin hypercube.

    State of charge 0 to 1 where the voltage depends on it, else open-circuit voltage from the
    pack's lowest to its largest; winding temperature over the range of the drive's table.
    """
    return cases.hypercube(drives, count, seed, 4, _case)


def _case(name: str, _number: int, share: Rows) -> Case:
    """Return the stop at shares 0 to 1 of the ranges."""
    drive = drive_named(name)

    def within(k: int, low: float, high: float) -> float:
        return float(low + (high - low) * share[k])

    radius, battery = drive.vehicle.wheel_radius_m, drive.battery
    top_kmh = drive.motor.max_speed_rpm * np.pi / 30.0 * radius * 3.6
    flat = isinstance(battery.open_circuit_voltage_v, float | int)
    soc = 0.5 if flat else within(3, 0.0, 1.0)
    return Case(
        name,
        round(within(0, *DEMAND_SHARE) * drive.motor.rated_torque_nm, 3),
        round(within(1, *SPEED_SHARE) * top_kmh, 3),
        round(within(2, *drive.table.temperature_range_c), 2),
        round(soc, 4),
        round(within(3, battery.min_voltage_v, battery.max_voltage_v), 3)
        if flat
        else round(models.open_circuit_voltage_v(drive, soc), 3),
    )


def measure(number: int, case: Case) -> Outcome:
    """Simulate one stop and compare it."""
    plain = drive_named(case.drive)
    drive = with_open_circuit_voltage(plain, case.open_circuit_v)
    ideal = limited_stop.stop(
        drive,
        drive.brake.strategy,
        case.demand_nm,
        case.initial_speed_kmh,
        case.winding_temperature_c,
        case.soc,
    )
    try:
        stored, rows = _simulated(plain, case)
        fault = reasons.shown(float(rows[-1, 3]))
    except HubsimError:  # the controllers do not get to the initial speed without a fault
        stored, rows, fault = 0.0, np.zeros((1, len(SIGNALS))), NOT_STARTED
    rated = drive.motor.rated_torque_nm
    top_kmh = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    by_reason = {k: v for k, v in ideal.hydraulic_by_reason_j.items() if k != "demand"}
    return Outcome(
        number=number,
        drive=case.drive,
        demand_nm=case.demand_nm,
        demand_share_of_rated=case.demand_nm / rated,
        initial_speed_kmh=case.initial_speed_kmh,
        speed_share_of_top=case.initial_speed_kmh / top_kmh,
        winding_temperature_c=case.winding_temperature_c,
        soc=case.soc,
        open_circuit_v=case.open_circuit_v,
        stored=stored,
        ideal=ideal.stored_share_of_kinetic,
        difference=stored - ideal.stored_share_of_kinetic,
        ripple_share_of_rated=ripple_nm(rows, rated) / rated,
        first_fault=fault,
        reason=reasons.shown(_most_missing(rows, case.demand_nm)),
        ideal_reason=max(by_reason, key=lambda name: by_reason[name], default=""),
        impossible_s=ideal.impossible_s,
    )


def _simulated(drive: Drive, case: Case) -> tuple[float, Rows]:
    """Return the stored share of the kinetic energy and the recorded SIGNALS."""
    scenario = Scenario(
        initial_speed_kmh=case.initial_speed_kmh,
        demand_nm=case.demand_nm,
        drag=False,
        stop_at_standstill=True,
        winding_temperature_c=case.winding_temperature_c,
        initial_soc=case.soc,
        record_interval_s=RECORD_S,
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        if isinstance(drive.battery.open_circuit_voltage_v, float | int):
            engine.set_voltage_curve([0.0], [case.open_circuit_v])
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(SIGNALS)
        parts = []
        while not engine.ended and engine.value("time_s") < LONGEST_S:
            parts.append(engine.run(10.0))
        chemical, kinetic = engine.value("energy.chemical_j"), engine.value("energy.kinetic_j")
    return chemical / kinetic, np.concatenate(parts)


def ripple_nm(rows: Rows, rated_nm: float) -> float:
    """Return the largest deviation of the torque from a straight line, N m.

    Over windows of WINDOW_ROWS in which one reason bounds the torque, neither rate nor blend-out
    moves it, and the line moves by STEADY_SHARE at most: at low speed the loss optimum falls with
    the speed, and the bend where it begins is no ripple.
    """
    first = round(SETTLED_S / RECORD_S)
    count = (len(rows) - first) // WINDOW_ROWS
    if count <= 0:
        return 0.0
    windows = rows[first : first + count * WINDOW_ROWS].reshape(count, WINDOW_ROWS, -1)
    torque, reason = windows[:, :, 0], windows[:, :, 1]
    code = reasons.codes()
    moving = [code["TORQUE_RATE"], code["BLEND_OUT"]]
    steady = np.all(reason == reason[:, :1], axis=1) & ~np.isin(reason[:, 0], moving)
    if not np.any(steady):
        return 0.0
    x = np.arange(WINDOW_ROWS) - 0.5 * (WINDOW_ROWS - 1)
    torque = torque[steady] - torque[steady].mean(axis=1, keepdims=True)
    slope = torque @ x / (x @ x)
    level = np.abs(slope) * WINDOW_ROWS <= STEADY_SHARE * rated_nm
    deviation = np.abs(torque - slope[:, np.newaxis] * x)
    return float(np.max(deviation[level], initial=0.0))


def _most_missing(rows: Rows, demand_nm: float) -> float:
    """Return the tightest limit under which most energy of the demand went past the motor."""
    missing = np.maximum(demand_nm + rows[:, 0], 0.0) * rows[:, 2]
    found = {code: float(np.sum(missing[rows[:, 4] == code])) for code in np.unique(rows[:, 4])}
    return max(found, key=lambda code: found[code], default=0.0)
