# SPDX-License-Identifier: Apache-2.0
"""Faults by name on a running vehicle, on and off, of all wheels or of one."""

from collections.abc import Mapping
from dataclasses import dataclass

from hubsim.errors import HubsimError
from hubsim.scenario import faults
from regen_table.suggest import suggestion

from hubfoc.errors import HubfocError
from hubfoc.live.vehicle import POSITIONS, SimulatedVehicle

CHOICE = "fault.wheels"  # of the section fault: a bit a wheel, 0: all of them
SILENCE = "driver.silent"
# Parameters of all wheels that one wheel has as well.
OF_ONE_WHEEL = {
    "sensors.hall_stuck_low": "hall_stuck_low",
    "sensors.hall_stuck_high": "hall_stuck_high",
    "brake.torque_loss": "brake_torque_loss",
    "winding_sensor.open": "winding_sensor_open",
    "winding_sensor.shorted": "winding_sensor_shorted",
    "wheel_speed.dead": "speed_sensor_dead",
}


@dataclass(frozen=True)
class Active:
    """One fault that is there."""

    wheel: int | None  # None: of all wheels, or of the vehicle
    values: Mapping[str, float]
    since_s: float


def can_be_of_one_wheel(name: str) -> bool:
    """Return whether a fault can be there in one wheel alone."""
    sets = faults.table()[name].sets
    return all(p.startswith("fault.") or p in OF_ONE_WHEEL for p in sets)


def values_of(name: str, wheel: int | None) -> dict[str, float]:
    """Return the parameters that make a fault."""
    fault = faults.table()[name]
    values = dict(fault.needs)
    for parameter, value in fault.sets.items():
        if wheel is not None and parameter in OF_ONE_WHEEL:
            values[f"wheel{wheel}.{OF_ONE_WHEEL[parameter]}"] = value
        else:
            values[parameter] = value
    if any(parameter.startswith("fault.") for parameter in values):
        values.setdefault(CHOICE, 0.0 if wheel is None else float(1 << wheel))
    return values


class Faults:
    """The faults of one vehicle.

    Two faults that set one parameter to different values exclude each other: the later one
    replaces the earlier. Where a fault ends, its parameters are what they were before any fault.

    Attributes
    ----------
    active : mapping
        The faults that are there, by name.
    refused : mapping
        Those that this vehicle cannot have, with the reason.
    """

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._healthy: dict[str, float] = {}
        self.active: dict[str, Active] = {}
        self.refused = self._tried()

    def _tried(self) -> dict[str, str]:
        """Return the faults that this vehicle, still healthy, cannot have, with the reason."""
        out: dict[str, str] = {}
        for name, fault in faults.table().items():
            if not self._vehicle.rotor_sensors <= set(fault.sensors):
                out[name] = f"only with: {', '.join(fault.sensors)}"
                continue
            for parameter, value in values_of(name, None).items():
                before = self._vehicle.get(parameter)
                try:
                    self._vehicle.set(parameter, value)
                except HubsimError as error:
                    out[name] = str(error)
                self._vehicle.set(parameter, before)
        return out

    def put(self, name: str, position: str | None, time_s: float) -> None:
        """Let a fault be there, in the wheel of that position or in all."""
        known = faults.table()
        if name not in known:
            hint = suggestion(name, known, "'hubsim faults --list' shows all")
            raise HubfocError(f"no fault {name!r}, {hint}")
        if name in self.refused:
            raise HubfocError(f"{name}: {self.refused[name]}")
        wheel = self._wheel(name, position)
        values = values_of(name, wheel)
        others = {
            other: active
            for other, active in self.active.items()
            if other != name and not _contradict(active.values, values)
        }
        self.active = others | {name: Active(wheel, values, time_s)}
        self._apply()

    def take_away(self, name: str) -> None:
        """Let a fault be there no more."""
        if name not in self.active:
            raise HubfocError(f"{name}: no such fault is there")
        del self.active[name]
        self._apply()

    @property
    def silences(self) -> bool:
        """Whether the vehicle's computer is to send no demand."""
        return any(active.values.get(SILENCE) == 1.0 for active in self.active.values())

    def _wheel(self, name: str, position: str | None) -> int | None:
        if position is None:
            return None
        wheels = POSITIONS[: self._vehicle.wheels]
        if position not in wheels:
            raise HubfocError(f"wheel {position!r}, accepted: {', '.join(wheels)}")
        if not can_be_of_one_wheel(name):
            raise HubfocError(f"{name}: accepted without a wheel, it is of the whole vehicle")
        return wheels.index(position)

    def _apply(self) -> None:
        wanted = {k: v for active in self.active.values() for k, v in active.values.items()}
        for parameter in wanted:
            self._healthy.setdefault(parameter, self._vehicle.get(parameter))
        for parameter, healthy in self._healthy.items():
            value = wanted.get(parameter, healthy)
            if self._vehicle.get(parameter) != value:
                self._vehicle.set(parameter, value)


def _contradict(some: Mapping[str, float], others: Mapping[str, float]) -> bool:
    return any(others[name] != value for name, value in some.items() if name in others)
