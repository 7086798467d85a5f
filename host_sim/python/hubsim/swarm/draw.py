# SPDX-License-Identifier: Apache-2.0
"""From a seed to everything that a run needs: a drive and a scenario, which is plain data.

Half of the runs have no fault. A run with faults has one, two 0.05 s to 60 s apart, or three; each
comes at once, grows, or comes and goes. The driver is simulated ahead with the vehicle of the draw
and then presses his pedals as he did there, whatever happens: so a run is one scenario of times and
values, which ``hubsim run`` can repeat from a file.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from regen_table import STRATEGIES, derived
from regen_table.schema import Drive

from hubsim.engine import Rows, parameters
from hubsim.run.plant import STANDARD_AIR_KG_PER_M3, STANDARD_GRAVITY_M_PER_S2
from hubsim.scenario import faults
from hubsim.scenario.faults import Fault
from hubsim.swarm import drives, vehicles
from hubsim.swarm.driving import STANDS_M_PER_S, STEP_S, Driver
from hubsim.swarm.vehicles import BRAKE, PREPARED, ROLLING, Lot, Phase, top_m_per_s

HEALTHY_SHARE = 0.5
COUNTS = (0.45, 0.4, 0.15)  # of the runs with faults: with one, two, three
APART_S = (0.05, 60.0)
AT_START_SHARE, AT_START_S = 0.1, 0.5
GROWS_SHARE, GROWS_S = 0.2, (1.0, 20.0)
COMES_AND_GOES_SHARE, PIECE_S, PIECES_MAX = 0.2, (0.005, 3.0), 12
SCALE = (0.3, 1.5)  # of a fault's own amount
BOOTS_SHARE = 0.9  # of the speed at which the EMF reaches an empty battery's voltage
BITS, MOST_CONFIG_BYTES = ("fault.config_bit",), 4096  # amounts that are the number of a bit
LAST_S = 1.0  # before the end: no fault comes later
ACKNOWLEDGES_S = (0.0, 0.02, 1.0)
ONE_WHEEL_SHARE = 0.7  # of the vehicles with several wheels, in which one has the faults
FLATNESS = 0.003  # of a pedal's travel, by which its trace is straightened
# An anti-lock system and slipping wheels are not drawn.
LEFT_OUT = ("wheel_locked", "wheel_speed_lost")

Point = tuple[float, float]
Data = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """One run.

    Attributes
    ----------
    config : str
        The drive that comes along on whose file it stands.
    data : dict
        The keys of its scenario, those of the drive included. The events of a fault have its name,
        or its name, a dash and more.
    """

    seed: int
    config: str
    data: Data

    @property
    def drive(self) -> Drive:
        """What the controllers are configured with."""
        return drives.changed(self.config, self.data["drive"])

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of its faults."""
        known = faults.table()
        names = (name.partition("-")[0] for name in self.data["events"])
        return tuple(sorted({name for name in names if name in known}))

    def begins_s(self, fault: str) -> float:
        """Return when one of its faults comes."""
        events = self.data["events"].items()
        return min(float(e["at_s"]) for name, e in events if name.partition("-")[0] == fault)

    @property
    def kind(self) -> str:
        """The faults in one word; empty without one."""
        return "+".join(self.faults)


def case(seed: int, count: int = drives.COUNT, healthy: bool | None = None) -> Case:
    """Return the run of a seed, with one of the first ``count`` drives.

    ``healthy``: without faults whatever the seed says; None: as it says.
    """
    lot = Lot(drives.SEED, drives.COUNT * drives.ATTEMPTS_MAX + seed)
    number = lot.whole(count)
    chosen = drives.numbered(number)
    strategy = STRATEGIES[2 if lot.chance(0.6) else lot.whole(2)]
    drive = chosen.drive
    sensor = drive.rotor.sensor
    ambient_c = lot.within(*vehicles.AMBIENT_C)
    warm = lot.chance(0.5)
    world = vehicles.parts_of(lot, drive, ambient_c)
    capacitance_f = drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f
    world.setdefault("bus.capacitance_f", capacitance_f)  # without one no bus is ever cut off
    begins = vehicles.begins(lot, sensor)
    rolls = begins == ROLLING or (begins == PREPARED and lot.chance(0.5))
    initial = lot.within(0.05, 0.8) * top_m_per_s(drive) if rolls else 0.0
    if begins == ROLLING:
        initial = min(initial, _measurable_m_per_s(drive))
    phases = vehicles.phases_of(lot, drive, world, rolls)
    hottest_c = drive.motor.max_winding_temperature_c - 15.0
    driver = Driver(drive, _inertia(drive, world), lot.within(0.2, 1.0), lot.within(0.1, 0.6))
    traces = ahead(driver, drive, world, phases, initial)
    end_s = float(traces[-1, 0])
    data: Data = {
        "initial_speed_kmh": 3.6 * initial,
        "boots_rolling": begins != PREPARED,
        "max_duration_s": round(end_s, 2),
        "ambient_temperature_c": ambient_c,
        "winding_temperature_c": lot.within(ambient_c, hottest_c) if warm else ambient_c,
        "switch_temperature_c": lot.within(ambient_c, ambient_c + 40.0) if warm else ambient_c,
        "initial_soc": vehicles.cells(lot, drive).soc,
        "seed": lot.whole(1 << 31),
        "record_interval_s": 0.001,
        "drive": {**chosen.data, "brake": {**chosen.data.get("brake", {}), "strategy": strategy}},
        "plant": world,
        **_pedals(traces, drive),
        "events": _road(traces),
    }
    ill = not lot.chance(HEALTHY_SHARE)
    found = _faults(lot, sensor, end_s) if ill and not healthy else ()
    for fault, at_s in found:
        _inject(lot, data, fault, at_s)
    if found:
        world["driver.fault_reset_every_s"] = lot.one_of(*ACKNOWLEDGES_S)
        if drive.vehicle.driven_wheels > 1 and lot.chance(ONE_WHEEL_SHARE):
            world["fault.wheels"] = 1.0
    return Case(seed, chosen.base, data)


def _measurable_m_per_s(drive: Drive) -> float:
    """Return up to which speed a controller can boot without a warning.

    Where the EMF drives a current through the diodes of the open bridge, the current sensors' zeros
    cannot be measured: OFFSETS_STORED says so until they have been.
    """
    motor, lowest_v = drive.motor, derived.lowest_open_circuit_v(drive)
    emf_v = math.sqrt(3.0) * motor.flux_linkage_wb * motor.pole_pairs
    return BOOTS_SHARE * lowest_v / emf_v * drive.vehicle.wheel_radius_m


def _inertia(drive: Drive, world: Mapping[str, float]) -> float:
    """Return a driven wheel's share of the mass times the radius, kg m."""
    return world["vehicle.mass_kg"] * world["vehicle.wheel_radius_m"] / drive.vehicle.driven_wheels


def ahead(
    driver: Driver,
    drive: Drive,
    world: Mapping[str, float],
    phases: Sequence[Phase],
    initial_m_per_s: float,
) -> Rows:
    """Return what the driver does: rows of time, both pedals, direction, slope.

    The vehicle that he feels has the mass, radius and drag of the draw and makes what he asks for.
    """
    inertia, wheels = _inertia(drive, world), drive.vehicle.driven_wheels
    radius = world["vehicle.wheel_radius_m"]
    weight = world["vehicle.mass_kg"] * STANDARD_GRAVITY_M_PER_S2 * radius / wheels
    air = 0.5 * STANDARD_AIR_KG_PER_M3 * world["vehicle.frontal_area_m2"] * radius / wheels
    air *= drive.vehicle.drag_coefficient
    rolling = world["vehicle.rolling_resistance"] * weight
    most, top, speed = drive.motor.max_torque_nm, top_m_per_s(drive), initial_m_per_s
    rows = [(0.0, 0.0, 0.0, 1.0, 0.0)]
    for phase in phases:
        for _ in range(round(phase.seconds / STEP_S)):
            if phase.kind == BRAKE and abs(speed) < STANDS_M_PER_S:
                break
            pedals = driver.step(phase, speed)
            now_s = rows[-1][0] + STEP_S
            rows.append((now_s, pedals.drive_nm, pedals.brake_nm, pedals.direction, pedals.slope))
            drives_nm = min(max(pedals.drive_nm, -most), most)
            if pedals.brake_nm > 0.0 or abs(speed) > top:
                drives_nm = 0.0
            if drives_nm < 0.0 < speed and pedals.direction == 1.0:  # lift-off braking
                against, drives_nm = pedals.brake_nm - drives_nm, 0.0
            else:
                against = pedals.brake_nm
                drives_nm = max(drives_nm, 0.0) if pedals.direction == 1.0 else drives_nm
            pulls = drives_nm - weight * pedals.slope - air * speed * abs(speed)
            speed = _moved(speed, pulls / inertia * STEP_S, (against + rolling) / inertia * STEP_S)
    return np.array(rows)


def _moved(speed: float, pulled: float, braked: float) -> float:
    """Return the speed a step later: what brakes only ever takes speed away."""
    free = speed + pulled
    return math.copysign(max(abs(free) - braked, 0.0), free)


def _pedals(rows: Rows, drive: Drive) -> Data:
    most_brake = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    return {
        "drive_trace_nm": straightened(
            rows[:, 0], rows[:, 1], FLATNESS * drive.motor.max_torque_nm
        ),
        "demand_trace_nm": straightened(rows[:, 0], rows[:, 2], FLATNESS * most_brake),
    }


def straightened(time_s: Rows, values: Rows, within: float) -> list[Point]:
    """Return few points whose straight lines are within a distance of a trace, zero where it is."""
    zero = values == 0.0
    edges = np.flatnonzero(zero[1:] != zero[:-1])
    # The last zero before a run and the first one after it stay, so that zero is zero.
    ends = sorted({0, len(values) - 1, *(int(k) + int(not zero[k]) for k in edges)})
    kept = {k for a, b in itertools.pairwise(ends) for k in _needed(time_s, values, a, b, within)}
    return [(round(float(time_s[k]), 3), float(f"{values[k]:.5g}")) for k in sorted(kept)]


def _needed(time_s: Rows, values: Rows, first: int, last: int, within: float) -> Iterator[int]:
    """Yield the points between two that a straight line from one to the other would miss."""
    yield first
    yield last
    if last - first < 2:
        return
    inner = slice(first + 1, last)
    ends = ([time_s[first], time_s[last]], [values[first], values[last]])
    beside = np.abs(values[inner] - np.interp(time_s[inner], *ends))
    worst = first + 1 + int(np.argmax(beside))
    if beside[worst - first - 1] > within:
        yield from _needed(time_s, values, first, worst, within)
        yield from _needed(time_s, values, worst, last, within)


def _road(rows: Rows) -> dict[str, Data]:
    """Return the events of slope and drive direction."""
    found: dict[str, Data] = {}
    slopes = straightened(rows[:, 0], rows[:, 4], 1e-5)
    for k, (a, b) in enumerate(itertools.pairwise(slopes)):
        if a[1] != b[1]:
            found[f"road{k}"] = {
                "at_s": a[0],
                "over_s": round(b[0] - a[0], 3),
                "set": {"road.slope": b[1]},
            }
    for k in np.flatnonzero(np.diff(rows[:, 3])).tolist():
        at_s = round(float(rows[k + 1, 0]), 3)
        found[f"gear{k}"] = {"at_s": at_s, "set": {"driver.direction": float(rows[k + 1, 3])}}
    return found


def candidates(sensor: str) -> dict[str, list[Fault]]:
    """Return the faults that a drive with this rotor sensor can have, by their group."""
    found: dict[str, list[Fault]] = {}
    for fault in faults.table().values():
        if sensor in fault.sensors and fault.name not in LEFT_OUT:
            found.setdefault(fault.group, []).append(fault)
    return found


def _faults(lot: Lot, sensor: str, end_s: float) -> tuple[tuple[Fault, float], ...]:
    """Return the faults of a run and their times; no two that set the same parameter."""
    groups = candidates(sensor)
    names = list(groups)
    pick = lot.within(0.0, 1.0)
    count = 1 + int(pick > COUNTS[0]) + int(pick > COUNTS[0] + COUNTS[1])
    latest = max(end_s - LAST_S, 0.0)
    soon = lot.chance(AT_START_SHARE)
    at_s = lot.within(0.0, AT_START_S) if soon else lot.within(0.0, latest)
    found: list[tuple[Fault, float]] = []
    for _ in range(count):
        group = groups[names[lot.whole(len(names))]]
        fault = group[lot.whole(len(group))]
        if all(not _touch(fault, other) for other, _ in found):
            found.append((fault, 0.0 if fault.at_start else round(min(at_s, latest), 3)))
        apart = np.log(APART_S)
        at_s += math.exp(lot.within(float(apart[0]), float(apart[1])))
    return tuple(found)


def _touch(a: Fault, b: Fault) -> bool:
    return bool({*a.sets, *a.needs} & {*b.sets, *b.needs})


def _inject(lot: Lot, data: Data, fault: Fault, at_s: float) -> None:
    """Add a fault to a scenario."""
    values = dict(fault.sets)
    known = parameters()
    if fault.draws:
        values[fault.draws] = float(1 + lot.whole(int(known[fault.draws].highest)))
    elif fault.amount in BITS:
        values[fault.amount] = float(1 + lot.whole(8 * MOST_CONFIG_BYTES))
    elif fault.amount:
        values[fault.amount] = _scaled(lot, fault)
    data["plant"] |= fault.needs
    name, may_vary = fault.name, not (fault.at_start or fault.draws or fault.amount in BITS)
    events: dict[str, Data]
    if may_vary and fault.amount and lot.chance(GROWS_SHARE):
        amount = {fault.amount: values.pop(fault.amount)}
        events = {f"{name}-grows": {"at_s": at_s, "over_s": lot.within(*GROWS_S), "set": amount}}
        if values:
            events[name] = {"at_s": at_s, "set": values}
    elif may_vary and lot.chance(COMES_AND_GOES_SHARE):
        events = dict(_pieces(lot, name, at_s, values, data["max_duration_s"]))
    else:
        events = {name: {"at_s": at_s, "set": values}}
    data["events"] |= events


def _scaled(lot: Lot, fault: Fault) -> float:
    """Return how much of a fault there is, inside the range of its parameter."""
    known = parameters()[fault.amount]
    value = fault.sets[fault.amount] * lot.within(*SCALE)
    return float(f"{min(max(value, known.lowest), known.highest):.6g}")


def _pieces(
    lot: Lot, name: str, at_s: float, values: Mapping[str, float], end_s: float
) -> Iterator[tuple[str, Data]]:
    """Yield the events of a fault that comes and goes."""
    low, high = np.log(PIECE_S)
    for k in range(1 + lot.whole(PIECES_MAX)):
        lasts_s, pause_s = (math.exp(lot.within(float(low), float(high))) for _ in range(2))
        until_s = round(at_s + max(lasts_s, 0.001), 3)
        if until_s > end_s:
            break
        yield f"{name}-{k}", {"at_s": at_s, "until_s": until_s, "set": dict(values)}
        at_s = round(until_s + max(pause_s, 0.001), 3)
