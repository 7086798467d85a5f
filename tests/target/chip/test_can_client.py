# SPDX-License-Identifier: Apache-2.0
"""A CAN client stops the vehicle: python-can and cantools against the flashable image.

The image runs on the model of its chip with the plant at its pins (``bus.c``). Its bus is a virtual
one of python-can; everything that is not the wheel, vehicle and battery, is a client of that bus,
which knows the protocol by ``hubfoc.dbc`` alone, its end-to-end protection besides.
"""

from __future__ import annotations

import math
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import can
import cantools
from cantools.database.can import Database
from hubsim import can_protocol
from wheel_on_bus import Wheel

ROOT = Path(__file__).resolve().parents[3]
CYCLE_S = 0.010
"""Of the messages: CAN makes the demand older by one, and the brake's command."""
SPEED_M_PER_S = 2.5
BRAKE_NM = 90.0
MODE_RUN = "RUN"
STOPPED_S = 0.4
"""That the program goes on after the stop."""
POLE_PAIRS = tomllib.loads((ROOT / "tools" / "motors" / "lu2013.toml").read_text())["motor"][
    "pole_pairs"
]


def _database() -> Database:
    found = cantools.database.load_file(ROOT / "firmware" / "comms" / "hubfoc.dbc")
    assert isinstance(found, Database)
    return found


class Client:
    """Vehicle and battery on the bus."""

    def __init__(self, channel: str) -> None:
        self.bus = can.Bus(channel, interface="virtual")
        self.dbc = _database()
        self.counters: Counter[str] = Counter()
        self.receivers = {
            name: can_protocol.Receiver(name)
            for name in can_protocol.MESSAGES
            if name.startswith("Wheel")
        }
        self.latest: dict[str, dict[str, Any]] = {}
        self.least_torque_nm = 0.0
        self.modes: list[str] = []

    def _send(self, name: str, **values: float | str) -> None:
        message = self.dbc.get_message_by_name(name)
        zero: dict[str, Any] = {signal.name: 0 for signal in message.signals}
        data = message.encode(zero | values)
        profile = can_protocol.MESSAGES[name].profile
        data = can_protocol.protect(profile, data, message.frame_id, self.counters[name])
        self.counters[name] += 1
        self.bus.send(can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False))

    def _is_due(self, name: str, now_ms: int) -> bool:
        cycle_ms = self.dbc.get_message_by_name(name).cycle_time
        assert cycle_ms is not None, name
        return now_ms % cycle_ms == 0

    def receive(self, now_ms: int) -> None:
        """Take what is on the bus."""
        while (frame := self.bus.recv(timeout=0)) is not None:
            message = self.dbc.get_message_by_frame_id(frame.arbitration_id)
            data = bytes(frame.data)
            self.receivers[message.name].receive(frame.arbitration_id, data, now_ms)
            values: Any = message.decode(data)
            assert isinstance(values, dict)
            self.latest[message.name] = values
            if message.name == "WheelState":
                torque_nm = float(values["motor_torque_estimate_nm"])
                self.least_torque_nm = min(self.least_torque_nm, torque_nm)
                if not self.modes or self.modes[-1] != str(values["mode"]):
                    self.modes.append(str(values["mode"]))

    def speed_rad_s(self) -> float:
        """Return what the wheel says."""
        return float(self.latest.get("WheelState", {"speed_rad_s": 0.0})["speed_rad_s"])

    def send(self, now_ms: int, battery: list[int], sensor_mnm: int | None) -> None:
        """Send what is due: brake as soon as the wheel turns."""
        braking = self.speed_rad_s() > 1.0 or self.least_torque_nm < -1.0
        if self._is_due("Demand", now_ms):
            brake_nm = BRAKE_NM if braking else 0.0
            self._send("Demand", enable=1, direction="FORWARD", brake_torque_nm=brake_nm)
        if self._is_due("BatteryLimits", now_ms):
            self._send(
                "BatteryLimits",
                contactor=1,
                charge_current_a=battery[0] // 100 / 10,
                discharge_current_a=battery[1] // 100 / 10,
            )
        if (battery[2] or battery[3]) and self._is_due("BatteryPeak", now_ms):
            self._send(
                "BatteryPeak",
                charge_peak_current_a=battery[2] // 100 / 10,
                pack_voltage_v=battery[3] // 100 / 10,
            )
        if sensor_mnm is not None:
            self._send(
                "HydraulicFeedback", torque_valid=1, measured_torque_nm=sensor_mnm // 100 / 10
            )


def test_a_client_of_the_bus_stops_the_vehicle() -> None:
    wheel, client = Wheel("wheel"), Client("wheel")
    _, *plan = wheel.from_chip.readline().split()
    planned_m, planned_j = map(float, plan)
    now_ms, speed_m_per_s, distance_m, stored_j = 0, 0.0, 0.0, 0.0
    try:
        while (received := wheel.listen()) is not None:
            battery, sensor, step = received
            speed_m_per_s, distance_m, stored_j = map(float, step[1:])
            client.receive(now_ms)
            client.send(now_ms, battery, sensor)
            wheel.answer()
            now_ms += 1
    finally:
        client.bus.shutdown()
        status = wheel.close()
    print(f"{now_ms} ms, stop {distance_m:.3f} m, {stored_j:.1f} J stored; modes {client.modes}")
    print({name: dict(receiver.counts) for name, receiver in client.receivers.items()})
    assert status == 0
    assert speed_m_per_s <= 0.01
    # The client begins to brake when the wheel's message says that it turns: a cycle more.
    late_s = 3.0 * CYCLE_S
    assert abs(distance_m - planned_m) < late_s * SPEED_M_PER_S + 0.002 * planned_m
    assert abs(stored_j - planned_j) < BRAKE_NM * 9.0 * late_s
    assert client.modes[-1] == MODE_RUN
    assert client.least_torque_nm < -20.0, "the motor brakes"
    # Halls: less than a sixth of an electrical turn in the time since the stop, less two cycles.
    slowest_rad_s = math.pi / 3.0 / POLE_PAIRS / (STOPPED_S - 2.0 * CYCLE_S)
    assert client.speed_rad_s() < slowest_rad_s
    assert client.latest["WheelHealth"]["demand_errors"] == 0
    assert client.latest["WheelHealth"]["battery_errors"] == 0
    for name, receiver in client.receivers.items():
        good = receiver.counts.get("used", 0)
        assert set(receiver.counts) <= {"used", "lost"}, name
        assert receiver.counts.get("lost", 0) == 0, name
        assert good > 0.9 * now_ms / can_protocol.MESSAGES[name].cycle_ms - 20, name
