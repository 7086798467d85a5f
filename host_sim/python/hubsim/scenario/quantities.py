# SPDX-License-Identifier: Apache-2.0
"""What formulas may name of a drive: the numbers of its file, and figures that follow from them.

The figures describe what a drive can do before any run, so that one scenario fits every drive: a
share of the top speed instead of 50 km/h, the torque with which the motor brakes alone instead of
38 N m.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from regen_table import braking, bus_capacitor, derived, ideal, loops, models
from regen_table.models import Array
from regen_table.schema import Drive

REFERENCE_C = 25.0  # of the windings
SLOWEST, FASTEST = 0.25, 5.0 / 6.0  # of the top speed, between which motor_brakes_nm is available
SPEEDS = 50
GRAVITY = 9.80665
CHARGE_SHARE = 0.9  # of the pack's charge current: its limit folds back before its voltage's end


@dataclass(frozen=True)
class Figure:
    """A figure of a drive: how it is computed, and its description."""

    of: Callable[[Drive], float]
    text: str


def _top_m_per_s(drive: Drive) -> float:
    return drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m


def _speeds(drive: Drive) -> Array:
    return np.linspace(SLOWEST, FASTEST, SPEEDS) * drive.motor.max_speed_rpm * math.pi / 30.0


@lru_cache(maxsize=32)
def _motor_brakes_nm(drive: Drive) -> float:
    speed = _speeds(drive)
    machine, bridge = models.machine(drive, REFERENCE_C), models.bridge(drive)
    optimal = ideal.optimal_nm(drive, machine, bridge, speed)
    charge_w = CHARGE_SHARE * drive.battery.max_charge_current_a * _pack_v(drive)
    by_pack = charge_w / drive.vehicle.driven_wheels / speed
    return float(np.nanmin([optimal, braking.torque_limit_nm(drive, speed), by_pack]))


def _motor_drives_nm(drive: Drive) -> float:
    pack_w = drive.battery.max_discharge_current_a * drive.battery.min_voltage_v
    by_pack = 0.5 * pack_w / drive.vehicle.driven_wheels / _speeds(drive)[-1]
    limit = float(np.min(braking.torque_limit_nm(drive, _speeds(drive))))
    return float(min(limit, by_pack))


def _drag_nm(drive: Drive) -> float:
    machine, bridge = models.machine(drive, REFERENCE_C), models.bridge(drive)
    return -float(models.evaluate(machine, bridge, derived.omega_max(drive), 0.0, 0.0).torque_nm)


def _pack_v(drive: Drive) -> float:
    return derived.initial_open_circuit_v(drive)


def _highest_bus_v(drive: Drive) -> float:
    capacitance_f = drive.inverter.bus_capacitance_f
    return bus_capacitor.worst_bus_v(drive, capacitance_f) if capacitance_f > 0.0 else math.inf


def _emf_limit_kmh(drive: Drive) -> float:
    """Return the speed in km/h at which the bridge's voltage circle is the back-EMF."""
    most_v = loops.phase_voltage_limit_v(drive, _pack_v(drive))
    return _top_m_per_s(drive) * 3.6 * most_v / (derived.line_emf_v(drive) / math.sqrt(3.0))


def _diodes_kmh(drive: Drive) -> float:
    """Return the speed in km/h from which the back-EMF charges the pack through the diodes."""
    reached_v = _pack_v(drive) + 2.0 * drive.inverter.diode_forward_voltage_v
    return _top_m_per_s(drive) * 3.6 * reached_v / derived.line_emf_v(drive)


FIGURES: Mapping[str, Figure] = {
    "drive.top_speed_kmh": Figure(
        lambda d: 3.6 * _top_m_per_s(d), "vehicle speed at motor.max_speed_rpm"
    ),
    "drive.pack_voltage_v": Figure(_pack_v, "open circuit, at the initial state of charge"),
    "drive.full_voltage_v": Figure(
        lambda d: models.open_circuit_voltage_v(d, 1.0), "open circuit, of the full pack"
    ),
    "drive.trip_voltage_v": Figure(derived.overvoltage_trip_v, "of the bus, over-voltage trip"),
    "drive.device_voltage_v": Figure(
        derived.device_voltage_v, "rating of switches and bus capacitors, or the trip"
    ),
    "drive.highest_bus_voltage_v": Figure(
        _highest_bus_v, "of the bus, when the battery leaves at the worst moment"
    ),
    "drive.emf_limit_kmh": Figure(
        _emf_limit_kmh, "vehicle speed at which the back-EMF takes all of the bridge's voltage"
    ),
    "drive.diodes_kmh": Figure(
        _diodes_kmh, "vehicle speed from which the back-EMF charges the pack through the diodes"
    ),
    "drive.motor_brakes_nm": Figure(
        _motor_brakes_nm,
        "torque with which each motor brakes alone from a quarter to 5/6 of the top speed, by its"
        " optimum, its limits and the pack's charge current",
    ),
    "drive.stopping_s": Figure(
        lambda d: (
            _top_m_per_s(d)
            * d.vehicle.mass_kg
            * d.vehicle.wheel_radius_m
            / (d.vehicle.driven_wheels * _motor_brakes_nm(d))
        ),
        "time in which motor_brakes_nm stops the vehicle from its top speed",
    ),
    "drive.observer_speed_kmh": Figure(
        lambda d: 3.6 * derived.observer_speed_rad_s(d) * d.vehicle.wheel_radius_m,
        "vehicle speed above which the EMF observer tells the angle",
    ),
    "drive.motor_drives_nm": Figure(
        _motor_drives_nm, "torque with which each motor drives up to 5/6 of the top speed"
    ),
    "drive.weight_nm": Figure(
        lambda d: d.vehicle.mass_kg * GRAVITY * d.vehicle.wheel_radius_m / d.vehicle.driven_wheels,
        "weight times wheel radius at each driven wheel: times the slope, the torque of its pull",
    ),
    "drive.derated_from_c": Figure(
        derived.derate_winding_temperature_c, "winding temperature where the torque begins to fall"
    ),
    "drive.drag_nm": Figure(_drag_nm, "iron's drag of the open bridge at the top speed"),
    "drive.hall_sensor": Figure(lambda d: float(d.rotor.sensor == "hall"), "1 with hall sensors"),
    "drive.angle_sensor": Figure(lambda d: float(d.rotor.sensor == "angle"), "1 with an angle"),
}


def of_file(drive: Drive) -> dict[str, float]:
    """Return every number and switch of a drive's file, ``drive.SECTION.KEY``."""
    return {
        f"drive.{section}.{key}": float(value)
        for section, keys in drive.model_dump().items()
        for key, value in keys.items()
        if isinstance(value, bool | int | float)
    }


class Quantities(Mapping[str, float]):
    """All that formulas may name of one drive; a figure is computed when it is asked for."""

    def __init__(self, drive: Drive) -> None:
        self._drive = drive
        self._known = of_file(drive)

    def __getitem__(self, name: str) -> float:
        if name not in self._known:
            self._known[name] = FIGURES[name].of(self._drive)
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._known or name in FIGURES

    def __iter__(self) -> Iterator[str]:
        return iter({**self._known, **FIGURES})

    def __len__(self) -> int:
        return len({**self._known, **FIGURES})
