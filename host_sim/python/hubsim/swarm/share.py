# SPDX-License-Identifier: Apache-2.0
"""The stop beside a healthy run: what it stores, against the configured ideal on the true vehicle.

The same vehicle with its parts wrong within their tolerances stops once at a constant demand under
``series_optimal``, without drag and warming. The ideal is that of the drive's file
(``regen_table.limited_stop``): its currents at each speed, in the motor, bridge and battery as they
are, store what the firmware is to store. Sensors and the hydraulic brake's gain are exact here: an
angle or a current that is shown wrong costs up to another hundredth. Saturation, cogging, the road
and limits that the battery management makes of its voltage are left out as well, which the ideal
does not have either.

The tolerance is a hundredth of the kinetic energy where the table of the optimum decides, twice
that for slow stops (as ``stored_share``). Where a limit of torque or phase current decides, it acts
on a motor whose parts are wrong by up to six hundredths, which come on top. Where the battery's
limit decides there is no comparison: what flows beside it is an invariant of its own
(``charge_current``). Nor where the controller derates by a temperature: at its start it takes the
switches to be as hot as the winding, and the ideal has no temperature's limit. Nor in a stop that
lasts less than ten times as long as its torque takes to rise and the hydraulic brake to follow: it
is handed over so much before the blend-out, and the ideal's falls at once.
"""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from regen_table import limited_stop, models, packs
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

from hubsim import can_protocol, reasons, run
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.scenario import Scenario, overrides
from hubsim.swarm import drives, judge
from hubsim.swarm.draw import Case
from hubsim.swarm.judge import Finding
from hubsim.swarm.vehicles import Lot, top_m_per_s

TOLERANCE, TOLERANCE_SLOW = 0.01, 0.02  # of the kinetic energy; of slow or limited stops
PARTS_SHARE = 0.06  # of what is stored, where a limit decides
CHARGE_SHARE = 0.8  # of the battery's limit: what losses that are wrong can leave of it
BY_THE_BATTERY = ("charge_current", "fold_back")
BY_A_TEMPERATURE = ("WINDING_TEMPERATURE", "SWITCH_TEMPERATURE")
BY_THE_TABLE = ("", "loss_optimum", "blend_out", "torque_rate")
STRATEGY = "series_optimal"
SLOW_SHARE, SLOW_HANDOVER = 0.3, 4.0  # of the largest speed; of where the blend-out begins
RATED_SHARE = (0.25, 1.1)
SOC = (0.2, 0.8)
SPEED_SHARE = (0.3, 0.95)
SHORTEST_RAMPS = 10.0
DEMAND_NM = can_protocol.MESSAGES["Demand"].signals["brake_torque_nm"].step
LONGEST_S = 600.0
SECTIONS = ("motor", "inverter", "battery", "vehicle")
EXACT = ("sensors.", "encoder.", "winding_sensor.", "switch_sensor.", "brake_sensor.", "bms.m")
LEFT_OUT = (
    "motor.q_saturation_current_a",
    "motor.cogging_torque_nm",
    "motor.cogging_per_turn",
    "brake.torque_loss",
    "road.wind_m_per_s",
    "vehicle.rolling_resistance",
    "thermal.active",
)


@dataclass(frozen=True)
class Stop:
    """One stop: demand at the wheel as CAN carries it, speed and temperature where it begins."""

    demand_nm: float
    speed_kmh: float
    winding_c: float
    soc: float


def drawn(case: Case) -> Stop:
    """Return the stop that belongs to a run."""
    lot, drive = Lot(drives.SEED + 1, case.seed), case.drive
    return Stop(
        demand_nm=DEMAND_NM
        * max(round(lot.within(*RATED_SHARE) * drive.motor.rated_torque_nm / DEMAND_NM), 1),
        speed_kmh=3.6 * lot.within(*SPEED_SHARE) * top_m_per_s(drive),
        winding_c=lot.within(0.0, drive.motor.max_winding_temperature_c - 40.0),
        soc=lot.within(*SOC),
    )


def true_drive(drive: Drive, world: Mapping[str, float]) -> Drive:
    """Return the drive's file as it would be, had every part been measured."""
    changes: dict[tuple[str, str], object] = {}
    for name, value in world.items():
        section, _, key = name.partition(".")
        if section in SECTIONS and key in type(getattr(drive, section)).model_fields:
            changes[section, key] = value
    changes.pop(("motor", "iron_loss_resistance_ohm"), None)
    if drive.motor.iron_loss_resistance_ohm is not None:
        changes["motor", "iron_loss_resistance_ohm"] = [
            world["motor.iron_loss_resistance_ohm"],
            world["motor.iron_loss_resistance_slope_ohm_s"],
        ]
    changes["motor", "type"] = "ipmsm"  # two inductances that were equal in the file
    coefficient = "flux_temperature_coefficient_per_k"
    changes["motor", coefficient] = min(world[f"motor.{coefficient}"], 0.0)
    return overrides.changed(drive, changes, "the vehicle as it is")


def braked(case: Case) -> Drive:
    """Return the drive of a run under the strategy that has the table."""
    data = case.data["drive"]
    return drives.changed(case.config, {**data, "brake": {**data["brake"], "strategy": STRATEGY}})


def ideal_share(drive: Drive, true: Drive, stop: Stop) -> tuple[float, str] | None:
    """Return what the ideal of a drive's file stores in another vehicle, and what bounds it.

    Share of the kinetic energy; None where the voltage makes the stop impossible, near the
    battery's limit, and where the stop is short. Wheel speeds are those of the true vehicle; each
    step of speed lasts as long as the true torques take.
    """
    limited = drive.model_copy(update={"battery": true.battery})  # by its messages
    radius, true_radius = drive.vehicle.wheel_radius_m, true.vehicle.wheel_radius_m
    begins = (stop.demand_nm, stop.speed_kmh * radius / true_radius, stop.winding_c, stop.soc)
    trace = limited_stop.trace_of(limited, STRATEGY, *begins)
    most_a = CHARGE_SHARE * limited.battery.max_charge_current_a
    if not np.all(trace.possible) or np.max(trace.charge_a) > most_a:
        return None
    machine = models.machine(true, stop.winding_c)
    currents = (trace.state.current_d_a, trace.state.current_q_a)
    state = models.evaluate(machine, models.bridge(true), trace.state.omega_rad_s, *currents)
    planned = trace.hydraulic_nm - trace.motor_nm + _friction_nm(drive, trace.speed_rad_s)
    made = trace.hydraulic_nm - state.torque_nm + _friction_nm(true, trace.speed_rad_s)
    inertia = true.vehicle.mass_kg * true_radius**2 / (drive.vehicle.mass_kg * radius**2)
    seconds = trace.seconds * inertia * planned / made
    if np.sum(seconds) < SHORTEST_RAMPS * _ramp_s(drive, stop):
        return None
    power_w = true.vehicle.driven_wheels * state.dc_power_w
    pack = packs.flow(true, packs.DYNAMIC, power_w, seconds, stop.soc)
    kinetic_j = 0.5 * true.vehicle.mass_kg * (stop.speed_kmh / 3.6) ** 2
    missing = trace.hydraulic_nm * trace.speed_rad_s * trace.seconds
    by_reason = Counter[str]()
    for reason, joule in zip(trace.reason, missing.tolist(), strict=True):
        by_reason[reason] += joule
    del by_reason["demand"]
    main = max(by_reason, key=lambda name: by_reason[name], default="")
    return -pack.chemical_j / kinetic_j, main if by_reason[main] > 0.0 else ""


def _ramp_s(drive: Drive, stop: Stop) -> float:
    rises_s = stop.demand_nm / drive.control.torque_rate_nm_per_s
    return rises_s + drive.brake.hydraulic_dead_time_s + drive.brake.hydraulic_time_constant_s


def _friction_nm(drive: Drive, speed_rad_s: Rows) -> Rows:
    motor = drive.motor
    out: Rows = motor.friction_torque_nm + motor.viscous_friction_nm_s * speed_rad_s
    return out


def slow_m_per_s(drive: Drive) -> float:
    """Return the speed below which a stop is slow: the blend-out has a part of its energy."""
    rad_s = drive.control.handover_start_rpm * math.pi / 30.0
    return max(
        SLOW_SHARE * top_m_per_s(drive), SLOW_HANDOVER * rad_s * drive.vehicle.wheel_radius_m
    )


def gap(case: Case) -> Finding | None:
    """Return how far what a stop stores is beside the ideal; None where they are not compared."""
    drive, stop = braked(case), drawn(case)
    try:
        ideal = ideal_share(drive, true_drive(drive, case.data["plant"]), stop)
    except ConfigurationError:
        return None
    if ideal is None:
        return None
    share, main = ideal
    if main in BY_THE_BATTERY:
        return None
    try:
        stored = _stored(case, stop)
    except HubsimError:
        return Finding(judge.STORED_SHARE, 0, 0.0, math.inf, TOLERANCE, "1", judge.NOT_STARTED)
    if stored is None:
        return None
    slow = stop.speed_kmh < 3.6 * slow_m_per_s(drive)
    limit = TOLERANCE_SLOW if slow or main not in BY_THE_TABLE else TOLERANCE
    if main not in BY_THE_TABLE:
        limit += PARTS_SHARE * abs(share)
    text = f"{stored:.4f} beside {share:.4f}, {main}"
    return Finding(judge.STORED_SHARE, 0, 0.0, abs(stored - share), limit, "1", text)


def _stored(case: Case, stop: Stop) -> float | None:
    """Return what a stop stores, share of the kinetic energy; None if a temperature limits it."""
    scenario = Scenario(
        initial_speed_kmh=stop.speed_kmh,
        demand_nm=stop.demand_nm,
        drag=False,
        stop_at_standstill=True,
        winding_temperature_c=stop.winding_c,
        initial_soc=stop.soc,
        seed=case.data["seed"],
        plant={
            name: value
            for name, value in case.data["plant"].items()
            if name not in LEFT_OUT and not name.startswith(EXACT)
        },
    )
    engine, _ = run.prepare(braked(case), scenario, Path(), {})
    hot = [reasons.codes()[name] for name in BY_A_TEMPERATURE]
    with engine:
        engine.start()
        engine.choose(("wheel0.reason",))
        while not engine.ended and engine.value("time_s") < LONGEST_S:
            if np.any(np.isin(engine.run(10.0), hot)):
                return None
        return engine.value("energy.chemical_j") / engine.value("energy.kinetic_j")
