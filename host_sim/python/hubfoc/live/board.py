# SPDX-License-Identifier: Apache-2.0
"""Real wheels on a CAN bus, for the page: what they say of themselves, and no more.

There is no plant, no fault to put in and no scenario. A page may send demands only where the
command allowed it.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from hubsim import can_protocol
from hubsim.engine import Rows
from regen_table import schema

from hubfoc.bus import Frame
from hubfoc.client import SENT_BY_WHEELS, Wheel
from hubfoc.errors import HubfocError
from hubfoc.live.faults import Active
from hubfoc.live.vehicle import POSITIONS, STEP_S

# A signal's name in the simulation: message, its name on CAN, unit and meaning.
ON_CAN = {
    "mode": ("WheelState", "mode", "", "mode of the controller"),
    "fault_reason": ("WheelState", "fault_reason", "", "first of its faults"),
    "warning_reason": ("WheelHealth", "warning_reason", "", "first of its warnings"),
    "waits_for": ("WheelAvailable", "waits_for", "", "what it waits for before it drives"),
    "speed_rad_per_s": ("WheelState", "speed_rad_s", "rad/s", "of the wheel, forward"),
    "motor_torque_nm": ("WheelState", "motor_torque_estimate_nm", "N.m", "its estimate"),
    "motor_uncertainty_nm": (
        *("WheelPower", "motor_torque_uncertainty_nm", "N.m"),
        "one standard deviation of its estimate",
    ),
    "motor_command_nm": ("WheelDrive", "motor_torque_command_nm", "N.m", "torque wanted"),
    "hydraulic_torque_nm": ("WheelBrake", "hydraulic_torque_nm", "N.m", "commanded"),
    "available_nm": ("WheelBrake", "electric_brake_available_nm", "N.m", "limit of braking"),
    "drive_available_nm": ("WheelAvailable", "drive_available_nm", "N.m", "limit of driving"),
    "ahead_nm": ("WheelAhead", "electric_brake_ahead_nm", "N.m", "braking limit 300 ms later"),
    "reason": ("WheelDrive", "torque_reason", "", "why not more torque"),
    "current_q_a": ("WheelDrive", "current_q_a", "A", "peak phase"),
    "bus_voltage_v": ("WheelPower", "bus_voltage_v", "V", "at the inverter"),
    "bus_current_a": ("WheelPower", "bus_current_a", "A", "out of the battery"),
    "winding_temperature_c": ("WheelHealth", "winding_temperature_c", "degC", "in use"),
    "switch_temperature_c": ("WheelHealth", "switch_temperature_c", "degC", "in use"),
    "drawn_wh": ("WheelEnergy", "drawn_wh", "Wh", "drawn since its start"),
    "returned_wh": ("WheelEnergy", "returned_wh", "Wh", "returned since its start"),
    "friction_percent": ("WheelEnergy", "friction_percent", "%", "of braking, since its start"),
    "life_drawn_wh": ("WheelEnergy", "life_drawn_wh", "Wh", "drawn for life"),
    "life_returned_wh": ("WheelEnergy", "life_returned_wh", "Wh", "returned for life"),
    "life_friction_percent": ("WheelEnergy", "life_friction_percent", "%", "of braking, for life"),
}
OF_VEHICLE = {
    "vehicle.speed_m_per_s": ("m/s", "mean of the wheels"),
    "battery.voltage_v": ("V", "mean at the inverters"),
    "battery.current_a": ("A", "sum at the inverters, out of the battery"),
    "energy.shaft_j": ("J", "torque estimates by speeds since the start"),
    "energy.hydraulic_j": ("J", "commanded torques by speeds since the start"),
}
ONLY_SIMULATED = "real wheels: there is no world to change, accepted: on a virtual vehicle"


class BoardVehicle:
    """What the wheels on a bus say, in the shape of a simulated vehicle; nothing is sent.

    A value that no wheel has said, or that comes no more (five cycles), is NaN.
    """

    ended = False

    def __init__(self, drive: schema.Drive) -> None:
        self._base = drive.vehicle.can_base
        self.wheel_radius_m = drive.vehicle.wheel_radius_m
        self.wheels = drive.vehicle.driven_wheels
        self._of_wheels = [Wheel(POSITIONS[k], self._base) for k in range(self.wheels)]
        self._steps = 0
        self._work_j = dict.fromkeys(("energy.shaft_j", "energy.hydraulic_j"), 0.0)
        self._names: list[str] = []

    @property
    def time_s(self) -> float:
        """Since the start."""
        return self._steps * STEP_S

    def meanings(self) -> dict[str, tuple[str, str]]:
        """Return unit and meaning of every signal by name."""
        own = {
            f"wheel{k}.{name}": (unit, f"{POSITIONS[k].replace('_', ' ')}: {text}")
            for k in range(self.wheels)
            for name, (_, _, unit, text) in ON_CAN.items()
        }
        return own | OF_VEHICLE

    def choose(self, signals: Sequence[str]) -> None:
        """Choose what ``sample`` takes."""
        self._names = list(signals)

    def sample(self, row: Rows) -> None:
        """Write the chosen signals now into ``row``."""
        wheels = [self._values(wheel) for wheel in self._of_wheels]
        known = {f"wheel{k}.{n}": v for k, values in enumerate(wheels) for n, v in values.items()}
        speeds = [values["speed_rad_per_s"] for values in wheels]
        known["vehicle.speed_m_per_s"] = _mean(speeds) * self.wheel_radius_m
        known["battery.voltage_v"] = _mean([values["bus_voltage_v"] for values in wheels])
        known["battery.current_a"] = _sum([values["bus_current_a"] for values in wheels])
        for name, torque, sign in (
            ("energy.shaft_j", "motor_torque_nm", lambda speed: speed),
            ("energy.hydraulic_j", "hydraulic_torque_nm", abs),
        ):
            power_w = _sum([v[torque] * sign(v["speed_rad_per_s"]) for v in wheels])
            self._work_j[name] += power_w * STEP_S
        known |= self._work_j
        row[:] = [known[name] for name in self._names]

    def step(self, received: Sequence[Frame]) -> list[Frame]:
        """Go on by a millisecond with what came by the bus."""
        now_ms = self._steps
        for identifier, data in received:
            if can_protocol.message_of(identifier, self._base) in SENT_BY_WHEELS:
                place = identifier & can_protocol.WHEEL_MASK
                if place < self.wheels:
                    self._of_wheels[place].take(identifier, data, now_ms)
        for wheel in self._of_wheels:
            for receiver in wheel.receivers.values():
                receiver.timed_out(now_ms)
        self._steps += 1
        return []

    def serial_take(self, wheel: int) -> bytes:
        """Return nothing: the shells are on serial lines of their own."""
        del wheel
        return b""

    def serial_type(self, wheel: int, text: bytes) -> None:
        """Do nothing: the shells are on serial lines of their own."""

    def packet_send(self, wheel: int, packet: bytes) -> None:
        """Do nothing: real wheels have XCP by CAN alone."""

    def packets_take(self, wheel: int) -> list[bytes]:
        """Return nothing: real wheels have XCP by CAN alone."""
        del wheel
        return []

    @staticmethod
    def _values(wheel: Wheel) -> dict[str, float]:
        out = {}
        for name, (message, signal, _, _) in ON_CAN.items():
            lost = wheel.receivers[message].link == "TIMED_OUT"
            out[name] = math.nan if lost else wheel.values.get(message, {}).get(signal, math.nan)
        if not wheel.values.get("WheelBrake", {}).get("hydraulic_valid"):
            out["hydraulic_torque_nm"] = math.nan  # it hands over
        return out


def _known(values: Sequence[float]) -> list[float]:
    return [value for value in values if not math.isnan(value)]


def _sum(values: Sequence[float]) -> float:
    return math.fsum(_known(values))


def _mean(values: Sequence[float]) -> float:
    known = _known(values)
    return math.fsum(known) / len(known) if known else math.nan


class NoFaults:
    """Nothing is broken on purpose."""

    silences = False

    def __init__(self) -> None:
        self.active: dict[str, Active] = {}


class Board:
    """Real wheels in the place of a simulated world.

    Parameters
    ----------
    config : path
        The drive's file: names the wheels, the identifiers and the largest torques of the pedals.
    demands : bool
        A page may send demands, as long as its dead-man key is held.
    rear : path, optional
        The rear wheels', where they differ.
    """

    real = True
    paused = False
    ends = False
    number = 1
    ended: str | None = None
    scenario: str | None = None

    def __init__(self, config: Path, *, demands: bool, rear: Path | None = None) -> None:
        self.drive = schema.load(config)
        self.rear = None if rear is None else schema.load(rear)
        self.vehicle = BoardVehicle(self.drive)
        self.demands = demands
        self.faults = NoFaults()

    def __enter__(self) -> Self:
        """Return the wheels themselves."""
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing has to be freed."""

    @property
    def time_s(self) -> float:
        """Since the start."""
        return self.vehicle.time_s

    def state(self) -> dict[str, Any]:
        """Return what a page shows beside the signals."""
        return {
            "time_s": self.time_s,
            "faults": {},
            "scenario": None,
            "paused": False,
            "ended": None,
        }

    def fault_list(self) -> list[dict[str, Any]]:
        """Return no faults: real ones come by themselves."""
        return []

    def scenarios(self) -> dict[str, str]:
        """Return no scenarios."""
        return {}

    def change(self, wanted: Mapping[str, Any]) -> dict[str, Any]:
        """Refuse to change the world."""
        del wanted
        raise HubfocError(ONLY_SIMULATED)

    def stop(self, why: str) -> None:
        """Do nothing: real wheels are not stopped from here."""
