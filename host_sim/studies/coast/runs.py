# SPDX-License-Identifier: Apache-2.0
"""Motor torque without a demand beside the least that physics allows (letting go).

Speeds up to 110 % of the largest, the battery's whole range, slopes of 8 %, the battery connected
or disconnecting at any of twenty instants: while the vehicle coasts, brakes with all the motors
have, or drives so. One wheel with its share of mass and battery stands for the vehicle (stops).
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from hubsim import reasons, run
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep import cases, drives
from regen_table import models
from regen_table.schema import Drive
from studies import least_torque

SPEED_SHARE = (0.0, 1.1)  # of the largest speed
SLOPE_PERCENT = (-8.0, 8.0)
INSTANTS = 20
FIRST_CUT_S, LAST_CUT_S = 0.4, 1.0
COAST, BRAKE, DRIVE = "coast", "brake", "drive"
TOLERANCE_NM, TOLERANCE_SHARE = (
    2.0,
    0.05,
)  # the larger of both; share of the rated torque
RECORD_S = 0.001
MEAN_ROWS = 5
DURATION_S = 2.0
SETTLED_S = 0.05  # after the beginning, at which the controllers have just started
AROUND_S = 0.005  # before and after the controller learns that the battery has left
MESSAGE_S = 0.1  # between two messages of the battery: the contactor is known so late
NOT_STARTED = "NOT_STARTED"
OPEN, SWITCHING = 0, 1  # of the bridge
WARNINGS = ("", "OVERSPEED", "BATTERY_DISCONNECTED")
SIGNALS = (
    "time_s",
    "wheel0.motor_torque_nm",
    "wheel0.speed_rad_per_s",
    "bus.voltage_v",
    "battery.polarisation_v",
    "wheel0.winding_temperature_c",
    "bms.charge_a",
    "wheel0.bridge",
    "wheel0.warning_reason",
    "wheel0.first_fault_reason",
)
TIME, TORQUE, SPEED, BUS, POLARISATION, WINDING, CHARGE, BRIDGE, WARNING, FAULT = range(10)


@dataclass(frozen=True)
class Case:
    """One vehicle left to itself; ``cut_s`` infinite: the battery stays connected.

    ``demand`` is what the driver wants until the contactor opens and after it.
    """

    drive: str
    initial_speed_kmh: float
    slope_percent: float
    soc: float
    open_circuit_v: float
    demand: str
    cut_s: float


@dataclass(frozen=True)
class Outcome:
    """What a case did, at the instant of its largest excess.

    Attributes
    ----------
    excess_nm : float
        |torque| of the motor in a mean of MEAN_ROWS beyond iron drag and the feasible minimum.
    highest_bus_share : float
        Of the devices' rating.
    """

    number: int
    drive: str
    initial_speed_kmh: float
    speed_share_of_top: float
    slope_percent: float
    soc: float
    open_circuit_v: float
    demand: str
    cut_s: float
    excess_nm: float
    torque_nm: float
    least_nm: float
    way: str
    at_s: float
    speed_kmh: float
    bus_v: float
    bridge: int
    highest_bus_share: float
    first_fault: str
    warning: str

    @property
    def tolerance_nm(self) -> float:
        """Largest excess accepted."""
        rated = drives.drive_named(self.drive).motor.rated_torque_nm
        return max(TOLERANCE_NM, TOLERANCE_SHARE * rated)

    @property
    def within(self) -> bool:
        """Whether the vehicle was let go as it should be."""
        return (
            self.excess_nm <= self.tolerance_nm
            and self.highest_bus_share < 1.0
            and not self.first_fault
            and self.warning in WARNINGS
        )


def draw(drives: Sequence[str], count: int, seed: int) -> list[Case]:
    """Return so many cases, the drives in turn, each drive's a Latin hypercube.

    Half of them with a battery that stays; the others with one that leaves at INSTANTS instants,
    coasting, braking and driving in turn.
    """
    return cases.hypercube(drives, count, seed, 3, _case)


def _case(name: str, number: int, share: Rows) -> Case:
    drive = drives.drive_named(name)

    def within(k: int, low: float, high: float) -> float:
        return float(low + (high - low) * share[k])

    battery = drive.battery
    flat = isinstance(battery.open_circuit_voltage_v, float | int)
    soc = 0.5 if flat else round(within(1, 0.0, 1.0), 4)
    instant = number // 2 % INSTANTS
    cut_s = round(FIRST_CUT_S + (LAST_CUT_S - FIRST_CUT_S) * instant / (INSTANTS - 1), 4)
    leaves = number % 2 == 1
    return Case(
        name,
        round(within(0, *SPEED_SHARE) * _top_kmh(drive), 3),
        round(within(2, *SLOPE_PERCENT), 3),
        soc,
        round(within(1, battery.min_voltage_v, battery.max_voltage_v), 3)
        if flat
        else round(models.open_circuit_voltage_v(drive, soc), 3),
        (COAST, BRAKE, DRIVE)[number // 2 % 3] if leaves else COAST,
        cut_s if leaves else float("inf"),
    )


def _top_kmh(drive: Drive) -> float:
    return drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6


def measure(number: int, case: Case, edges: bool = False) -> Outcome:
    """Simulate one case, with the bridge's edges or their mean, beside the feasible minimum."""
    drive = drives.drive_named(case.drive)
    try:
        rows = simulated(drive, case, edges)
    except HubsimError:
        rows = np.zeros((1, len(SIGNALS)))
        return _outcome(number, case, drive, rows, (0.0, 0.0, least_torque.PWM, 0), NOT_STARTED)
    return _outcome(
        number, case, drive, rows, worst(drive, case, rows), reasons.shown(rows[-1, FAULT])
    )


def simulated(drive: Drive, case: Case, edges: bool = False) -> Rows:
    """Return the recorded SIGNALS."""
    motor, wheels = drive.motor, drive.vehicle.driven_wheels
    scenario = Scenario(
        initial_speed_kmh=case.initial_speed_kmh,
        demand_nm=1.2 * motor.max_torque_nm if case.demand == BRAKE else 0.0,
        drive_nm=motor.max_torque_nm if case.demand == DRIVE else 0.0,
        slope_percent=case.slope_percent,
        max_duration_s=DURATION_S,
        initial_soc=case.soc,
        record_interval_s=RECORD_S,
        plant={
            "bus.capacitance_f": wheels * drive.inverter.bus_capacitance_f,
            "bms.period_s": MESSAGE_S,
            "inverter.switching": float(edges),
        },
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    with engine:
        if isinstance(drive.battery.open_circuit_voltage_v, float | int):
            engine.set_voltage_curve([0.0], [case.open_circuit_v])
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(SIGNALS)
        if not np.isfinite(case.cut_s):
            return engine.run(DURATION_S)
        before = engine.run(case.cut_s)
        engine.set("bus.contactor_open", 1.0)
        return np.concatenate([before, engine.run(DURATION_S - case.cut_s)])


def worst(drive: Drive, case: Case, rows: Rows) -> tuple[float, float, str, int]:
    """Return excess and feasible minimum (N m), its name and the row of the largest excess."""
    first = min(int(np.searchsorted(rows[:, TIME], SETTLED_S)), len(rows) - MEAN_ROWS)
    kernel = np.ones(MEAN_ROWS) / MEAN_ROWS
    unwanted = _unwanted(case, rows) + charging_nm(drive, case, rows)
    torque = np.abs(np.convolve(unwanted[first:], kernel, "valid"))
    at = first + MEAN_ROWS // 2 + np.arange(len(torque))
    beyond = torque - least_torque.iron_drag_nm(drive, rows[at, SPEED])
    around = np.abs(rows[at, TIME] - _known_s(case, rows)) < AROUND_S
    beyond[around] = -np.inf
    best = (-np.inf, 0.0, least_torque.PWM, int(at[0]))
    # What the feasible minimum takes away is at least zero: only rows that can be the worst.
    for k in np.argsort(-beyond):
        if beyond[k] <= best[0]:
            break
        row = rows[at[k]]
        connected = rows[at[k] - MEAN_ROWS // 2, TIME] <= case.cut_s + RECORD_S
        found = least_torque.least(
            drive,
            least_torque.State(
                speed_rad_s=abs(row[SPEED]),
                source_v=case.open_circuit_v - row[POLARISATION],
                bus_v=row[BUS],
                winding_c=row[WINDING],
                charge_a=row[CHARGE],
                connected=bool(connected),
            ),
        )
        excess = beyond[k] - found.torque_nm
        if excess > best[0]:
            best = (float(excess), found.torque_nm, found.way, int(at[k]))
    return best


def _unwanted(case: Case, rows: Rows) -> Rows:
    """Return the torque that is not what the driver wants.

    That a battery has left is known when its message has come, or the bus has told; until then a
    demand is still a demand.
    """
    torque, time = rows[:, TORQUE], rows[:, TIME]
    known_s = _known_s(case, rows)
    if case.demand == COAST:
        wanted = np.zeros(len(rows), dtype=bool)
    else:
        wanted = torque < 0.0 if case.demand == BRAKE else torque > 0.0
    return np.where((time < known_s) & wanted, 0.0, torque)


def _known_s(case: Case, rows: Rows) -> float:
    """Return when the controller says that the battery has left, or opens the bridge after it."""
    disconnected = reasons.codes()["BATTERY_DISCONNECTED"]
    switching = rows[:, BRIDGE] == SWITCHING
    opened = switching & ~np.append(switching[1:], True) & (rows[:, TIME] >= case.cut_s)
    known = np.flatnonzero((rows[:, WARNING] == disconnected) | opened)
    return float(rows[known[0], TIME]) if len(known) else float("inf")


def charging_nm(drive: Drive, case: Case, rows: Rows) -> Rows:
    """Return the torque with which an open bridge without a battery charges the capacitor, N m.

    Diodes let the EMF charge a bus below it; no controller can prevent that. A magnitude: energy of
    the capacitor since the row before over the angle that the wheel has turned.
    """
    volts, alone = rows[:, BUS], rows[:, TIME] > case.cut_s
    taken_j = 0.5 * drive.inverter.bus_capacitance_f * np.diff(volts**2, prepend=volts[0] ** 2)
    turned = np.abs(rows[:, SPEED]) * np.diff(rows[:, TIME], prepend=-np.inf)
    charged = alone & (rows[:, BRIDGE] == OPEN) & (taken_j > 0.0) & (turned > 0.0)
    return np.where(charged, taken_j / np.where(charged, turned, 1.0), 0.0)


def _outcome(
    number: int,
    case: Case,
    drive: Drive,
    rows: Rows,
    found: tuple[float, float, str, int],
    fault: str,
) -> Outcome:
    excess, least, way, k = found
    row = rows[k]
    warned = {reasons.shown(code) for code in np.unique(rows[:, WARNING])} - set(WARNINGS)
    shown = warned or ({reasons.shown(code) for code in np.unique(rows[:, WARNING])} - {""})
    return Outcome(
        number=number,
        **asdict(case),
        speed_share_of_top=case.initial_speed_kmh / _top_kmh(drive),
        excess_nm=excess,
        torque_nm=float(row[TORQUE]),
        least_nm=least,
        way=way,
        at_s=float(row[TIME]),
        speed_kmh=float(row[SPEED]) * drive.vehicle.wheel_radius_m * 3.6,
        bus_v=float(row[BUS]),
        bridge=int(row[BRIDGE]),
        highest_bus_share=float(np.max(rows[:, BUS])) / _rating_v(drive),
        first_fault=fault,
        warning=min(shown, default=""),
    )


def _rating_v(drive: Drive) -> float:
    rating_v = drive.inverter.device_voltage_v
    return float("inf") if rating_v is None else rating_v
