# SPDX-License-Identifier: Apache-2.0
"""The paper's vehicle as one wheel with a quarter of everything.

Motion, energy shares and states are those of the whole vehicle.
"""

from typing import Any

from hubsim import run, scenario
from hubsim.engine import ROOT, Engine
from regen_table import schema
from regen_table.schema import Drive

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


def quarter(strategy: str = "series_optimal", sensor: str = "angle") -> Drive:
    """Return the drive with one wheel.

    ``sensor`` "angle" removes the angle error of the hall sensors.
    """
    drive = schema.load(LU2013)
    wheels = drive.vehicle.driven_wheels
    vehicle = {
        "driven_wheels": 1,
        "mass_kg": drive.vehicle.mass_kg / wheels,
        "frontal_area_m2": drive.vehicle.frontal_area_m2 / wheels,
    }
    battery = {
        "series_resistance_ohm": drive.battery.series_resistance_ohm * wheels,
        "polarisation_resistance_ohm": drive.battery.polarisation_resistance_ohm * wheels,
        "polarisation_capacitance_f": drive.battery.polarisation_capacitance_f / wheels,
        "capacity_ah": drive.battery.capacity_ah / wheels,
        "max_charge_current_a": drive.battery.max_charge_current_a / wheels,
        "max_discharge_current_a": drive.battery.max_discharge_current_a / wheels,
    }
    return drive.model_copy(
        update={
            "vehicle": drive.vehicle.model_copy(update=vehicle),
            "battery": drive.battery.model_copy(update=battery),
            "brake": drive.brake.model_copy(update={"strategy": strategy}),
            "rotor": drive.rotor.model_copy(update={"sensor": sensor}),
        }
    )


def started(
    drive: Drive, scenario_keys: dict[str, Any], plant: dict[str, float] | None = None
) -> Engine:
    """Return a running vehicle on a flat road without drag or noise."""
    name, loaded, beside = scenario.load("stop", {"drag": False, "noise": False, **scenario_keys})
    assert name == "stop"
    engine, _ = run.prepare(drive, loaded, beside, plant or {})
    engine.start()
    return engine


def accounts(engine: Engine) -> dict[str, float]:
    """Return all accounts of the run so far, J, by their short names."""
    return {
        s.removeprefix("energy."): engine.value(s)
        for s in engine.signals()
        if s.startswith("energy.")
    }


def stopped(engine: Engine) -> float:
    """Run to standstill and return the share of the kinetic energy stored in the cells."""
    speed = engine.value("vehicle.speed_m_per_s")
    kinetic_j = 0.5 * engine.get("vehicle.mass_kg") * speed**2
    while not engine.ended:
        engine.run(5.0)
    return -engine.value("braking.chemical_j") / kinetic_j
