# SPDX-License-Identifier: Apache-2.0
"""One run: a drive, a scenario and a strategy in, recorded signals and accounts out."""

import operator
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from fnmatch import fnmatchcase
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from regen_table import installation
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

from hubsim import configuration, iron
from hubsim.emulator import Command, attached
from hubsim.engine import Engine, Rows
from hubsim.engine import parameters as engine_parameters
from hubsim.errors import HubsimError
from hubsim.run import axles, evaluation, plant
from hubsim.run.results import Fault, RunResult
from hubsim.run.spool import Spool
from hubsim.scenario import Scenario, cycles
from hubsim.scenario.events import Timeline

CHUNK_S = 1.0
ROTOR_SPREAD_TURN = 0.23  # no two wheels start at the same electrical angle
PERCENT = 100.0

Progress = Callable[[float, float], None]  # simulated s, planned s


def prepare(
    drive: Drive,
    scenario: Scenario,
    beside: Path,
    plant_overrides: dict[str, float],
    rear: Drive | None = None,
    image_of: Callable[[Drive], bytes] | None = None,
) -> tuple[Engine, float]:
    """Build the vehicle of a run that has not begun.

    ``rear`` is what the wheels of the rear axle have in place of ``drive``; ``image_of`` makes what
    the controllers are configured with. Returns the vehicle and the planned duration in s.
    """
    made = image_of or configuration.image_of
    if rear is None:
        return _prepared(drive, scenario, beside, plant_overrides, made)
    axles.check(drive, rear)
    shared = axles.driver_parameters(drive, rear) | plant_overrides
    engine, duration = _prepared(drive, scenario, beside, shared, made)
    engine.set_rear(_prepared(rear, scenario, beside, shared, made)[0])
    return engine, duration


def _prepared(
    drive: Drive,
    scenario: Scenario,
    beside: Path,
    plant_overrides: dict[str, float],
    image_of: Callable[[Drive], bytes],
) -> tuple[Engine, float]:
    wired = drive.pedals.accelerator_channels + drive.pedals.brake_channels
    if scenario.uses_pedals and wired == 0:
        raise HubsimError(
            f"{scenario.source}: accelerator, brake_pedal: accepted with a drive whose [pedals] has"
            " accelerator_channels or brake_channels"
        )
    engine = Engine()
    trace = followed(scenario, beside)
    if trace is not None:
        speeds = [
            speed * scenario.speed_scale / cycles.KMH_PER_M_PER_S for speed in trace.speed_kmh
        ]
        engine.set_trace(trace.time_s, speeds)
    sources = (
        plant.parameters(drive),
        _scenario_parameters(drive, scenario),
        scenario.plant,
        plant_overrides,
    )
    found = reduce(operator.or_, sources)
    map_of_plant = scenario.plant_flux_map
    measured = iron.of_drive(drive) if map_of_plant is None else iron.load(beside / map_of_plant)
    if measured is not None:
        found |= measured.parameters()
        engine.set_energy_map(measured)
    for name, value in found.items():
        engine.set(name, value)
    engine.set_voltage_curve(*plant.voltage_curve(drive))
    engine.load_config(image_of(drive))
    duration = (
        scenario.max_duration_s if trace is None else min(trace.duration_s, scenario.max_duration_s)
    )
    return engine, duration


def followed(scenario: Scenario, beside: Path) -> cycles.Cycle | None:
    """Return the speeds over time that the driver follows, if he does."""
    if scenario.speed_trace_kmh is not None:
        time_s, speed_kmh = zip(*scenario.speed_trace_kmh, strict=True)
        return cycles.Cycle("speed_trace_kmh", time_s, speed_kmh).repeated(scenario.repeats)
    return (
        cycles.load(scenario.cycle, beside).repeated(scenario.repeats)
        if scenario.cycle is not None
        else None
    )


def timeline(scenario: Scenario, beside: Path) -> Timeline:
    """Return what is changed during a run: the pedals' traces, a cycle's grade and the events."""
    traces = {
        "driver.brake_demand_nm": scenario.demand_trace_nm,
        "driver.drive_demand_nm": scenario.drive_trace_nm,
        "driver.accelerator": scenario.accelerator_trace,
        "driver.brake_pedal": scenario.brake_pedal_trace,
    }
    cycle = followed(scenario, beside)
    if cycle is not None and cycle.slope:
        own = scenario.slope_percent / PERCENT
        traces["road.slope"] = tuple(
            (t, own + s) for t, s in zip(cycle.time_s, cycle.slope, strict=True)
        )
    return Timeline(
        scenario.events, {name: points for name, points in traces.items() if points is not None}
    )


def _scenario_parameters(drive: Drive, scenario: Scenario) -> dict[str, float]:
    """Return the parameters of the simulated world that a scenario decides."""
    found = {
        "road.air_density_kg_per_m3": plant.STANDARD_AIR_KG_PER_M3,
        "road.gravity_m_per_s2": plant.STANDARD_GRAVITY_M_PER_S2,
        "road.slope": scenario.slope_percent / PERCENT,
        "thermal.winding_temperature_c": scenario.winding_temperature_c,
        "thermal.switch_temperature_c": scenario.switch_temperature_c,
        "thermal.ambient_temperature_c": scenario.ambient_temperature_c,
        "driver.follow_trace": float(scenario.follows),
        "driver.brake_demand_nm": scenario.demand_nm,
        "driver.drive_demand_nm": scenario.drive_nm,
        "driver.uses_pedals": float(scenario.uses_pedals),
        "driver.accelerator": scenario.accelerator or 0.0,
        "driver.brake_pedal": scenario.brake_pedal or 0.0,
        "driver.bandwidth_rad_per_s": scenario.driver_bandwidth_rad_per_s,
        "driver.preview_s": scenario.driver_preview_s,
        "driver.release_speed_m_per_s": scenario.driver_release_speed_m_per_s,
        "driver.most_drive_nm": axles.most_drive_nm(drive),
        "driver.most_brake_nm": axles.most_brake_nm(drive),
        "driver.enable": 1.0,
        "driver.direction": 1.0,
        "driver.own_brake_path": float(not drive.driver.no_other_brake),
        "run.seed": float(scenario.seed),
        "run.initial_speed_m_per_s": scenario.initial_speed_kmh / cycles.KMH_PER_M_PER_S,
        "run.boots_rolling": float(scenario.boots_rolling),
        "run.stop_at_standstill": float(scenario.stop_at_standstill),
        "run.record_interval_s": scenario.record_interval_s,
        "run.rotor_spread_turn": ROTOR_SPREAD_TURN,
    }
    if not scenario.drag:
        found |= {"road.air_density_kg_per_m3": 0.0, "vehicle.rolling_resistance": 0.0}
    if scenario.initial_soc is not None:
        found["battery.initial_soc"] = scenario.initial_soc
    if not scenario.noise:
        found |= {"sensors.current_noise_a": 0.0, "sensors.bus_voltage_noise_v": 0.0}
    return found


def matching(known: Sequence[str], patterns: Sequence[str]) -> list[str]:
    """Return the known signals that any pattern (``*`` for anything) names, in the order known."""
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            raise HubsimError(
                f"--signals {pattern}: no such signal, 'hubsim list --signals' shows all"
            )
    return [name for name in known if any(fnmatchcase(name, pattern) for pattern in patterns)]


def simulate(
    name: str,
    drive: Drive,
    scenario: Scenario,
    beside: Path,
    patterns: Sequence[str],
    plant_overrides: dict[str, float] | None = None,
    progress: Progress | None = None,
    formulas: Sequence[str] = (),
    date: str | None = None,
    processor: Command | None = None,
    application: Path | None = None,
    rear: Drive | None = None,
) -> RunResult:
    """Run to the end.

    Parameters
    ----------
    name : str
        Of the scenario, for the result.
    beside : Path
        Directory in which the scenario's own files are looked for.
    patterns : sequence of str
        Signals to record besides those of the scenario's criteria; empty: none.
    progress : callable, optional
        Called with the simulated time and the planned end, both in s.
    formulas : sequence of str
        What will be worked out of the run besides the criteria: the signals in them are recorded
        too.
    date : str, optional
        Of the run, for its origin (ISO 8601); absent: SOURCE_DATE_EPOCH, or else the clock.
    processor : Command, optional
        Starts another one that executes the controllers (``emulator.command``); absent: this one.
    application : Path, optional
        Library of the whole application, which then is the controller of every wheel.
    rear : Drive, optional
        Of the wheels of the rear axle; absent: as in front.
    """
    origin = origin_of(name, drive, scenario, date)
    if rear is not None:
        origin["rear"] = origin_of(name, rear, scenario, date)
    try:
        engine, planned_s = prepare(drive, scenario, beside, plant_overrides or {}, rear)
    except ConfigurationError as error:
        raise HubsimError(f"{drive.name}: {error}") from error
    with engine, attached(engine, processor) if processor is not None else nullcontext():
        if application is not None:
            engine.attach_application(application)
        engine.start()
        known = engine.signals()
        parameters = {parameter: engine.get(parameter) for parameter in engine_parameters()}
        evaluated = evaluation.signals_of(scenario, drive, known, formulas)
        wanted = {*evaluated, *matching(known, patterns)}
        names = [name for name in known if name in wanted]
        engine.choose(names)
        happening = timeline(scenario, beside)
        begun = time.thread_time()
        kinetic_j = 0.5 * engine.get("vehicle.mass_kg") * engine.value("vehicle.speed_m_per_s") ** 2
        soc = engine.value("battery.soc")
        recorded = Spool(len(names))
        now_s = shown_s = 0.0
        while not engine.ended and now_s < planned_s - 1e-6:
            happening.apply(engine, now_s)
            until_s = min(shown_s + CHUNK_S, planned_s, happening.next_s(now_s))
            recorded.add(engine.run(until_s - now_s))
            now_s = engine.value("time_s")
            if now_s >= shown_s + CHUNK_S - 1e-6:
                shown_s = now_s
                if progress is not None:
                    progress(now_s, planned_s)
        wheels = int(engine.get("vehicle.driven_wheels"))
        rows = recorded.rows()
        return RunResult(
            cycle=name,
            strategy=drive.brake.strategy,
            vehicle=drive.name if rear is None else f"{drive.name}, {rear.name}",
            wheels=wheels,
            names=names,
            rows=rows,
            account_j={s: engine.value(s) for s in known if s.startswith(("energy.", "braking."))},
            duration_s=engine.value("time_s"),
            distance_m=engine.value("vehicle.distance_m"),
            kinetic_energy_j=kinetic_j,
            soc=(soc, engine.value("battery.soc")),
            stopped=engine.ended if scenario.stop_at_standstill else None,
            cpu_s=time.thread_time() - begun,
            faults=_faults(engine, wheels),
            reason_texts=_reason_texts(engine, names, rows),
            parameters=parameters,
            missed=happening.missed(now_s),
            meanings={
                name: meaning for name, meaning in engine.meanings().items() if name in names
            },
            origin=origin,
        )


def origin_of(
    name: str, drive: Drive, scenario: Scenario, date: str | None = None
) -> dict[str, Any]:
    """Return the provenance of a run."""
    try:
        raw = configuration.image_of(drive)
    except ConfigurationError as error:
        raise HubsimError(f"{drive.name}: {error}") from error
    return installation.provenance(drive.name, raw, scenario=name, seed=scenario.seed, date=date)


def _faults(engine: Engine, wheels: int) -> list[Fault]:
    found = []
    for k in range(wheels):
        reason = engine.value(f"wheel{k}.first_fault_reason")
        if reason:
            found.append(
                Fault(k, engine.value(f"wheel{k}.first_fault_s"), engine.reason_text(reason))
            )
    return found


def _reason_texts(engine: Engine, names: Sequence[str], rows: Rows) -> dict[str, str]:
    """Return the words for all reason codes among the recorded signals."""
    columns = [k for k, name in enumerate(names) if name.endswith("reason")]
    codes = {int(code) for k in columns for code in np.unique(rows[:, k])}
    return {str(code): engine.reason_text(code) for code in sorted(codes)}
