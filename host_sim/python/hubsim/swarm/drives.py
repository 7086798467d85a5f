# SPDX-License-Identifier: Apache-2.0
"""The drives of drawn runs: those that come along, and hundreds that a number alone makes.

A drawn drive begins with a vehicle: a scooter, a bicycle, a motorcycle, a car with hub motors or
with a gear. Its speed, acceleration and battery decide the motor in shares that do not depend on
its size: back-EMF at the largest speed over the battery's voltage, L_d I / psi, L_q / L_d, losses
over power. What the generator of configurations or the firmware refuses is drawn again, so every
drive here has an image. Once found, a drive is kept on disk by the content of what made it
(regen_table/stored.py).
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from regen_table import bus_capacitor, stored
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

from hubsim import configuration
from hubsim.engine import Engine
from hubsim.errors import HubsimError
from hubsim.scenario import overrides
from hubsim.swarm import vehicles
from hubsim.swarm.vehicles import Lot
from hubsim.sweep import drives, faults_sweep

COUNT = 400
BASE = "lu2013"  # whose keys a drawn drive replaces: all but those of slipping wheels
SEED = 33  # of the drives; the runs have seeds of their own
ATTEMPTS_MAX = 60
WHOLE_SHARE = 0.1  # of the draws with several wheels whose wheels are all simulated
OWN_SENSORS = {"lu2013": "hall", "ebike36v": "hall", "scooter48v": "hall", "ipm400v": "angle"}
HALLS_SALIENCY = 2.0  # L_q over L_d beyond which a motor does not have halls alone
PWM_HZ = (8e3, 10e3, 12e3, 16e3, 20e3, 24e3)
PERIODS_PER_TURN = 18.0  # PWM periods in an electrical turn at the largest speed, at least
CELL_ENDS_V = {"nmc": (3.0, 4.2), "lfp": (2.5, 3.65)}
CELL_RESTS_V = {
    "nmc": ((0.0, 3.0), (0.1, 3.4), (0.5, 3.65), (0.9, 4.02), (1.0, 4.17)),
    "lfp": ((0.0, 2.6), (0.1, 3.18), (0.5, 3.28), (0.9, 3.34), (1.0, 3.5)),
}

Data = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Kind:
    """A kind of vehicle: least and largest of what it draws; radius before the gear."""

    name: str
    battery_v: tuple[float, float]
    mass_kg: tuple[float, float]
    wheels: tuple[int, ...]
    radius_m: tuple[float, float]
    gear: tuple[float, float]
    top_kmh: tuple[float, float]
    air_m2: tuple[float, float]  # frontal area
    acceleration: tuple[float, float]  # of all driven wheels, m/s2
    pole_pairs: tuple[int, int]
    emf: tuple[float, float]  # between lines at the largest speed, over the battery's voltage
    salient: float  # share of the drives whose L_q is larger than L_d
    saliency: tuple[float, float]


KINDS = (
    Kind("scooter", (24.0, 60.0), (70.0, 150.0), (1, 2), (0.08, 0.15), (1.0, 1.0), (15.0, 50.0),
         (0.5, 0.7), (1.0, 3.0), (8, 20), (0.6, 1.0), 0.4, (1.2, 2.0)),
    Kind("bicycle", (24.0, 60.0), (80.0, 140.0), (1,), (0.25, 0.36), (1.0, 5.0), (22.0, 50.0),
         (0.5, 0.7), (0.7, 2.0), (8, 23), (0.6, 1.0), 0.3, (1.2, 2.0)),
    Kind("motorcycle", (60.0, 110.0), (150.0, 300.0), (1,), (0.25, 0.32), (1.0, 1.0),
         (60.0, 120.0), (0.6, 0.8), (2.0, 4.0), (12, 24), (0.6, 1.1), 0.4, (1.2, 2.5)),
    Kind("hub car", (48.0, 400.0), (400.0, 1500.0), (2, 4), (0.25, 0.33), (1.0, 1.0),
         (45.0, 130.0), (1.3, 2.4), (1.0, 3.0), (14, 26), (0.6, 1.2), 0.4, (1.2, 2.5)),
    Kind("geared car", (100.0, 420.0), (700.0, 2000.0), (1, 2), (0.28, 0.34), (4.0, 9.0),
         (90.0, 150.0), (1.8, 2.5), (2.0, 4.0), (3, 5), (0.7, 1.7), 0.85, (1.3, 4.5)),
)  # fmt: skip


@dataclass(frozen=True)
class Chosen:
    """A drive of the population: whose file it stands on, and what differs from that."""

    number: int
    base: str
    data: Mapping[str, Mapping[str, Any]]

    @property
    def name(self) -> str:
        """Its number, or the name of the one that comes along."""
        own = self.number < len(drives.DRIVES)
        return self.base if own else f"drawn {self.number}"

    @property
    def drive(self) -> Drive:
        """Everything known about it."""
        return changed(self.base, self.data)


def changed(base: str, data: Mapping[str, Mapping[str, Any]]) -> Drive:
    """Return a drive that comes along with other values of some keys."""
    return _changed(base, json.dumps(data))


@lru_cache(maxsize=16)
def _changed(base: str, data: str) -> Drive:
    changes = {
        (section, key): value
        for section, keys in json.loads(data).items()
        for key, value in keys.items()
    }
    return overrides.changed(drives.drive_named(base), changes, f"swarm: {base}")


@lru_cache(maxsize=COUNT)
def numbered(number: int) -> Chosen:
    """Return a drive of the population, 0 <= number < COUNT; the first ones come along.

    The rotor sensor, the hold and how many wheels are simulated belong to it: one image each.
    """
    if number < len(drives.DRIVES):
        base = drives.DRIVES[number]
        rotor = {"rotor": {"sensor": OWN_SENSORS[base]}}
        return Chosen(number, base, rotor | one_wheel(drives.drive_named(base)))
    own = Path(__file__).read_bytes()
    content = (*configuration.program(), own, _base_file(), str(number).encode())
    found = stored.by_content("drive", content, lambda: json.dumps(_accepted(number)).encode())
    return Chosen(number, BASE, json.loads(found))


def _base_file() -> bytes:
    return repr(drives.drive_named(BASE).model_dump()).encode()


def _accepted(number: int) -> Data:
    """Return the first draw that generator and firmware accept."""
    for attempt in range(ATTEMPTS_MAX):
        data = drawn(Lot(SEED, number * ATTEMPTS_MAX + attempt))
        try:
            plain = Chosen(number, BASE, data).drive
            data["inverter"]["bus_capacitance_f"] = _capacitance_f(plain)
            drive = Chosen(number, BASE, data).drive
            if bus_capacitor.warning(drive) is None:
                with Engine() as engine:  # the firmware's own validator
                    engine.load_config(configuration.image_of(drive))
                return data
        except (ConfigurationError, HubsimError):
            continue
    raise AssertionError(f"drive {number}: {ATTEMPTS_MAX} draws were refused")


def _capacitance_f(drive: Drive) -> float:
    """Return a bus capacitor that keeps the devices' rating when the battery leaves."""
    least_f = bus_capacitor.least_capacitance_f(drive)
    if least_f is None:
        raise ConfigurationError("inverter.bus_capacitance_f: no value is enough")
    return float(_six(1.1 * least_f / bus_capacitor.LEFT_SHARE))


def one_wheel(drive: Drive) -> Data:
    """Return the keys of one wheel with its share of a vehicle whose wheels all do the same."""
    share, battery = 1.0 / drive.vehicle.driven_wheels, drive.battery
    if share == 1.0:
        return {}
    return {
        "vehicle": {
            "driven_wheels": 1,
            "mass_kg": share * drive.vehicle.mass_kg,
            "frontal_area_m2": share * drive.vehicle.frontal_area_m2,
        },
        "battery": {
            "series_resistance_ohm": battery.series_resistance_ohm / share,
            "polarisation_resistance_ohm": battery.polarisation_resistance_ohm / share,
            "polarisation_capacitance_f": battery.polarisation_capacitance_f * share,
            "capacity_ah": battery.capacity_ah * share,
            "max_charge_current_a": battery.max_charge_current_a * share,
            "max_discharge_current_a": battery.max_discharge_current_a * share,
        },
    }


def drawn(lot: Lot) -> Data:
    """Return one draw, every section but those of slipping wheels.

    Vehicles of several driven wheels are mostly one wheel with its share of them.
    """
    kind = KINDS[lot.whole(len(KINDS))]
    wheels = kind.wheels[lot.whole(len(kind.wheels))]
    mass, rest_v = lot.within(*kind.mass_kg), math.exp(lot.within(*np.log(kind.battery_v)))
    share = 1.0 if lot.chance(WHOLE_SHARE) else 1.0 / wheels
    mass, wheels = mass * share, round(wheels * share)
    radius = lot.within(*kind.radius_m) / lot.within(*kind.gear)
    inertia = mass / wheels * radius
    top = lot.within(*kind.top_kmh) / 3.6 / radius
    most_nm = lot.within(*kind.acceleration) * inertia
    pairs = kind.pole_pairs[0] + lot.whole(kind.pole_pairs[1] - kind.pole_pairs[0] + 1)
    pwm_hz = _pwm_hz(lot, pairs * top)
    motor = _motor(lot, kind, (most_nm, top, pairs, rest_v))
    largest_a, power_w = motor["max_phase_current_a"], motor["max_power_w"]
    battery = _battery(lot, rest_v, wheels * power_w)
    hydraulic_nm = max(lot.within(7.0, 10.0) * inertia - most_nm, 2.0 * most_nm)
    start_rpm = lot.within(2.0, 5.0) / 3.6 / radius * 30.0 / math.pi
    found: Data = {
        "motor": motor,
        "inverter": _inverter(lot, battery["max_voltage_v"], largest_a, motor, pwm_hz),
        "battery": battery,
        "vehicle": {
            "mass_kg": mass,
            "wheel_radius_m": radius,
            "frontal_area_m2": lot.within(*kind.air_m2) * share,
            "drag_coefficient": 0.9 if kind.air_m2[1] < 1.0 else 0.35,
            "rolling_resistance": lot.within(0.006, 0.018),
            "driven_wheels": wheels,
        },
        "brake": {
            "parallel_electric_share": lot.within(0.1, 0.5),
            "electric_rated_torque_nm": motor["rated_torque_nm"],
            "hydraulic_dead_time_s": lot.within(0.015, 0.06),
            "hydraulic_time_constant_s": lot.within(0.03, 0.1),
            "hydraulic_rate_nm_per_s": hydraulic_nm / lot.within(0.1, 0.3),
            "max_hydraulic_torque_nm": hydraulic_nm,
        },
        "control": {
            "current_bandwidth_hz": pwm_hz / lot.within(18.0, 32.0),
            "torque_rate_nm_per_s": most_nm / lot.within(0.06, 0.25),
            "handover_start_rpm": start_rpm,
            "handover_end_rpm": lot.within(0.3, 0.45) * start_rpm,
            "field_weakening_current_a": _weakening_a(lot, motor),
        },
        "table": {
            "speed_points": "auto",
            "temperature_points": "auto",
            "temperature_range_c": [-20.0, motor["max_winding_temperature_c"] - 10.0],
        },
        "thermal": _thermal(lot, motor),
        "rotor": _rotor(lot, motor),
    }
    vehicle = found["vehicle"]
    air_m2 = vehicle["frontal_area_m2"] * vehicle["drag_coefficient"] / wheels
    holds_nm = vehicles.hold_torque_nm(motor["rated_torque_nm"], radius, air_m2)
    found["driver"] = {"hold_torque_nm": holds_nm if lot.chance(0.25) else 0.0}
    return {section: {key: _six(value) for key, value in keys.items()}
            for section, keys in found.items()}  # fmt: skip


def _six(value: Any) -> Any:  # noqa: ANN401, whatever a key takes
    """Return a number with six digits, as files have them."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    return [_six(each) for each in value] if isinstance(value, list) else value


def _pwm_hz(lot: Lot, largest_rad_s: float) -> float:
    """Return a PWM frequency with enough periods in an electrical turn."""
    least = PERIODS_PER_TURN * largest_rad_s / (2.0 * math.pi)
    enough = [f for f in PWM_HZ if f >= least] or [PWM_HZ[-1]]
    return enough[lot.whole(len(enough))]


def _torque_share(stretch: float, saliency: float) -> float:
    """Return the largest torque of a current over that of the same current in q.

    ``stretch``: L_d I / psi; ``saliency``: L_q / L_d.
    """
    angle = np.linspace(0.0, math.pi / 2.0, 181)
    reluctance = (saliency - 1.0) * stretch * np.sin(angle)
    return float(np.max(np.cos(angle) * (1.0 + reluctance)))


def _motor(lot: Lot, kind: Kind, sizes: tuple[float, float, int, float]) -> dict[str, Any]:
    """Return the motor's section.

    ``sizes``: largest torque, largest speed in rad/s, pole pairs, the battery's voltage.
    """
    most_nm, top, pairs, rest_v = sizes
    salient = lot.chance(kind.salient)
    saliency = lot.within(*kind.saliency) if salient else 1.0
    psi = lot.within(*kind.emf) * rest_v / (math.sqrt(3.0) * pairs * top)
    stretch = lot.within(0.25, 0.9) if salient else lot.within(0.1, 0.5)
    made_a = most_nm / (1.5 * pairs * psi * _torque_share(stretch, saliency))
    power_w = most_nm * top * lot.within(0.4, 0.9)
    copper = lot.within(0.05, 0.25) * 0.5 * most_nm * top
    iron_ohm = 1.5 * (pairs * top * psi) ** 2 / (lot.within(0.01, 0.05) * power_w)
    at_rest = lot.within(0.3, 0.8)
    d_h = stretch * psi / made_a
    return {
        "name": f"drawn {kind.name}",
        "type": "ipmsm" if salient else "spmsm",
        "pole_pairs": pairs,
        "phase_resistance_ohm": copper / (1.5 * made_a**2),
        "reference_temperature_c": 25.0,
        "resistance_temperature_coefficient_per_k": 0.00393,
        "d_inductance_h": d_h,
        "q_inductance_h": saliency * d_h,
        "flux_linkage_wb": psi,
        "flux_temperature_coefficient_per_k": -0.0011 if lot.chance(0.7) else 0.0,
        "iron_loss_resistance_ohm": [
            at_rest * iron_ohm,
            (1.0 - at_rest) * iron_ohm / (pairs * top),
        ],
        "friction_torque_nm": lot.within(0.001, 0.01) * most_nm,
        "viscous_friction_nm_s": lot.within(0.0, 0.005) * most_nm / top,
        "rated_torque_nm": lot.within(0.45, 0.8) * most_nm,
        "max_torque_nm": most_nm,
        "max_power_w": power_w,
        "max_phase_current_a": lot.within(1.04, 1.35) * made_a,
        "max_speed_rpm": top * 30.0 / math.pi,
        "max_winding_temperature_c": lot.within(110.0, 160.0),
    }


def _rotor(lot: Lot, motor: Mapping[str, Any]) -> dict[str, Any]:
    """Return a rotor sensor: no halls where saliency needs the angle at rest."""
    salient = motor["q_inductance_h"] > HALLS_SALIENCY * motor["d_inductance_h"]
    kinds = ("angle", "encoder") if salient else ("hall", "hall", "angle", "encoder")
    sensor = kinds[lot.whole(len(kinds))]
    return {"sensor": sensor} | (faults_sweep.ENCODER if sensor == "encoder" else {})


def _weakening_a(lot: Lot, motor: Mapping[str, Any]) -> float:
    """Return the largest demagnetising current, below what takes all of the flux."""
    whole = motor["flux_linkage_wb"] / motor["d_inductance_h"]
    return float(min(lot.within(0.6, 0.93) * motor["max_phase_current_a"], 0.95 * whole))


def _inverter(
    lot: Lot, full_v: float, largest_a: float, motor: Mapping[str, Any], pwm_hz: float
) -> dict[str, Any]:
    dead_s = lot.within(0.003, 0.012) / pwm_hz
    switching = full_v * lot.within(3e-8, 8e-8)
    return {
        "switch_resistance_ohm": lot.within(0.05, 0.3) * motor["phase_resistance_ohm"],
        "diode_forward_voltage_v": lot.within(0.7, 1.2),
        "diode_resistance_ohm": lot.within(0.05, 0.3) * motor["phase_resistance_ohm"],
        "dead_time_s": dead_s,
        "min_pulse_s": max(1e-6, 2.0 * dead_s),
        "pwm_frequency_hz": pwm_hz,
        "turn_on_loss_j_per_a": switching,
        "turn_off_loss_j_per_a": switching,
        "current_full_scale_a": lot.within(1.4, 2.2) * largest_a,
        "voltage_full_scale_v": lot.within(1.1, 1.35) * full_v,
        "device_voltage_v": lot.within(1.3, 1.7) * full_v,
        "max_switch_temperature_c": lot.within(120.0, 150.0),
    }


def _battery(lot: Lot, rest_v: float, power_w: float) -> dict[str, Any]:
    chemistry = "nmc" if lot.chance(0.7) else "lfp"
    low_v, high_v = CELL_ENDS_V[chemistry]
    rests = CELL_RESTS_V[chemistry]
    cells = max(round(rest_v / rests[2][1]), 6)
    current_a = lot.within(1.1, 1.7) * power_w / rest_v
    series_ohm = lot.within(0.03, 0.08) * rest_v / current_a
    slow_ohm = lot.within(0.3, 0.8) * series_ohm
    return {
        "open_circuit_voltage_v": [[soc, cells * v] for soc, v in rests],
        "initial_soc": 0.7,
        "series_resistance_ohm": series_ohm,
        "polarisation_resistance_ohm": slow_ohm,
        "polarisation_capacitance_f": lot.within(10.0, 60.0) / slow_ohm,
        "capacity_ah": current_a / lot.within(1.5, 5.0),
        "max_charge_current_a": lot.within(0.2, 1.0) * current_a,
        "max_discharge_current_a": current_a,
        "max_voltage_v": cells * high_v,
        "min_voltage_v": cells * low_v,
    }


def _thermal(lot: Lot, motor: Mapping[str, Any]) -> dict[str, Any]:
    """Return heat capacities and resistances by how fast and how far currents warm them."""
    resistance = motor["phase_resistance_ohm"]
    most_w = 1.5 * resistance * motor["max_phase_current_a"] ** 2
    rated_w = most_w * (motor["rated_torque_nm"] / motor["max_torque_nm"]) ** 2
    winding = most_w / lot.within(0.3, 2.0)
    switches_w = lot.within(0.01, 0.03) * motor["max_power_w"]
    switches = switches_w / lot.within(1.0, 10.0)
    return {
        "winding_heat_capacity_j_per_k": winding,
        "winding_thermal_resistance_k_per_w": lot.within(20.0, 50.0) / rated_w,
        "housing_heat_capacity_j_per_k": lot.within(5.0, 10.0) * winding,
        "housing_thermal_resistance_k_per_w": lot.within(20.0, 40.0) / rated_w,
        "switch_heat_capacity_j_per_k": switches,
        "switch_thermal_resistance_k_per_w": lot.within(10.0, 30.0) / switches_w,
        "heatsink_heat_capacity_j_per_k": lot.within(20.0, 100.0) * switches,
        "heatsink_thermal_resistance_k_per_w": lot.within(10.0, 30.0) / switches_w,
    }
