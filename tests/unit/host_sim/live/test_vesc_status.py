# SPDX-License-Identifier: Apache-2.0
"""VESC status frames of four wheels on a virtual bus, against the plant.

The decoder is written from the frames' public description (bldc, ``documentation/comm_can.md``).
"""

import struct
from collections import defaultdict

import can
import numpy as np
import pytest
from hubfoc.bus import join
from hubfoc.live.vehicle import SimulatedVehicle
from hubsim import can_protocol, cli
from hubsim.scenario import overrides
from regen_table import loops, schema
from regen_table.schema import Drive

FIRST_ID = 10
STEP_S = 1e-3
READY_MS, BRAKES_MS, ENDS_MS = 500, 6_000, 8_000
DRIVE_NM, BRAKE_NM = 40.0, 50.0
# What a drive must have had of each to show anything.
LEAST = {"erpm": 1000.0, "current_a": 20.0, "duty": 0.2, "tachometer": 1000.0, "v_in": 40.0}
# By packet number: name, format (big endian), and what one of a signal is.
LAYOUT: dict[int, tuple[str, tuple[tuple[str, float], ...]]] = {
    9: (">ihh", (("erpm", 1.0), ("current_a", 0.1), ("duty", 0.001))),
    14: (">ii", (("drawn_ah", 1e-4), ("charged_ah", 1e-4))),
    15: (">ii", (("drawn_wh", 1e-4), ("charged_wh", 1e-4))),
    16: (
        ">hhhh",
        (("fet_c", 0.1), ("motor_c", 0.1), ("current_in_a", 0.1), ("position_deg", 0.02)),
    ),
    27: (">ihh", (("tachometer", 1.0), ("v_in", 0.1), ("reserved", 1.0))),
}


def decoded(message: can.Message) -> tuple[int, dict[str, float]]:
    """Return controller id and signals of a status frame."""
    assert message.is_extended_id and message.dlc == 8
    layout, signals = LAYOUT[message.arbitration_id >> 8]
    values = struct.unpack(layout, message.data)
    found = {name: value * one for (name, one), value in zip(signals, values, strict=True)}
    return message.arbitration_id & 0xFF, found


def demand(ms: int) -> dict[str, float]:
    return {
        "enable": 1.0,
        "direction": 1.0,
        "drive_torque_nm": DRIVE_NM if READY_MS <= ms < BRAKES_MS else 0.0,
        "brake_torque_nm": BRAKE_NM if ms >= BRAKES_MS else 0.0,
    }


class Plant:
    """What the simulation says of a wheel, in the frames' quantities."""

    def __init__(self, vehicle: SimulatedVehicle, drive: Drive) -> None:
        self._vehicle, self._drive = vehicle, drive
        self.drawn, self.charged, self.angle_rad = np.zeros(2), np.zeros(2), np.zeros(4)
        speeds = [f"wheel{k}.speed_rad_per_s" for k in range(4)]
        self._now = np.zeros(2 + len(speeds))
        vehicle.choose(["battery.current_a", "battery.voltage_v", *speeds])

    def value(self, name: str) -> float:
        return self._vehicle.value(name)

    def step(self) -> None:
        """Add a millisecond: A s and W s out of the battery and into it, and turned angles."""
        self._vehicle.sample(self._now)
        current = self._now[0]
        flow = np.array([current, current * self._now[1]]) * STEP_S
        self.drawn += np.maximum(flow, 0.0)
        self.charged += np.maximum(-flow, 0.0)
        self.angle_rad += self._now[2:] * STEP_S

    def status(self, k: int) -> dict[str, float]:
        """Return what a frame says; the duty cycle, a share of the voltage circle, by the
        machine's equations.
        """
        motor, inverter = self._drive.motor, self._drive.inverter
        speed = self.value(f"wheel{k}.speed_rad_per_s") * motor.pole_pairs
        i_d, i_q = (self.value(f"wheel{k}.current_{axis}_a") for axis in "dq")
        ohm = motor.phase_resistance_ohm + inverter.switch_resistance_ohm
        u_d = ohm * i_d - speed * motor.q_inductance_h * i_q
        u_q = ohm * i_q + speed * (motor.d_inductance_h * i_d + motor.flux_linkage_wb)
        circle = loops.phase_voltage_limit_v(self._drive, self.value("battery.voltage_v"))
        return {
            "erpm": speed * 30.0 / np.pi,
            "current_a": np.copysign(np.hypot(i_d, i_q), i_q * speed),
            "tachometer": self.angle_rad[k] * motor.pole_pairs * 6.0 / (2.0 * np.pi),
            "v_in": self.value("battery.voltage_v"),
            "duty": np.copysign(np.hypot(u_d, u_q), u_q) / circle,
        }


def test_what_displays_are_told_is_what_the_plant_does() -> None:
    """Away from rest and halfway back.

    A sample of a current differs by its ripple from the mean; the wheels know the bus current by a
    model of the inverter.
    """
    settings = overrides.parse([f"can.vesc_status={FIRST_ID}"])
    drive = overrides.load_drive(cli.DEFAULT_CONFIG, settings)
    seen: dict[tuple[int, str], list[tuple[float, float]]] = defaultdict(list)
    last: list[dict[str, float]] = [{}, {}, {}, {}]
    bus, client = join("virtual:vesc"), join("virtual:vesc")
    display = can.Bus(interface="virtual", channel="vesc")
    frames = 0
    with SimulatedVehicle(drive) as vehicle:
        plant = Plant(vehicle, drive)
        for ms in range(ENDS_MS):
            demands = [
                can_protocol.encode("Demand", demand(ms), wheel=k, counter=ms // 10)
                for k in range(4)
            ] if ms % 10 == 0 else []  # fmt: skip
            for identifier, data in vehicle.step(demands):
                bus.send(identifier, data)
            plant.step()
            while (message := display.recv(0.0)) is not None:
                if not message.is_extended_id:
                    continue
                frames += 1
                controller, values = decoded(message)
                last[controller - FIRST_ID] |= values
                truth = plant.status(controller - FIRST_ID)
                for name in truth.keys() & values.keys():
                    seen[ms // BRAKES_MS, name].append((values[name], truth[name]))
        to_client = [identifier for identifier, _ in client.receive(0.0)]
        assert to_client and max(to_client) < 0x800
        display.shutdown()
        client.close()
        bus.close()
        assert frames == pytest.approx(ENDS_MS / 20 * 4, rel=0.02)
        for (phase, name), pairs in seen.items():
            sent, true = np.array(pairs).T
            largest = np.abs(true).max()
            assert np.abs(sent - true).mean() < 0.01 * largest, (phase, name)
            assert largest > LEAST[name]
        assert min(sent for sent, _ in seen[1, "current_a"]) < -20.0  # brakes
        for k, values in enumerate(last):
            assert values["motor_c"] == pytest.approx(
                vehicle.value(f"wheel{k}.winding_temperature_c"), abs=2.0
            )
            assert values["fet_c"] == pytest.approx(
                vehicle.value(f"wheel{k}.switch_temperature_c"), abs=2.0
            )
            assert values["position_deg"] == values["reserved"] == 0.0
        sums = {name: sum(values[name] for values in last) for name in last[0]}
        for kind, flowed in (("drawn", plant.drawn), ("charged", plant.charged)):
            assert sums[f"{kind}_ah"] == pytest.approx(flowed[0] / 3600.0, rel=0.06), kind
            assert sums[f"{kind}_wh"] == pytest.approx(flowed[1] / 3600.0, rel=0.06), kind


def test_no_such_frame_is_sent_as_shipped() -> None:
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        sent = [identifier for _ in range(300) for identifier, _ in vehicle.step([])]
    assert sent and max(sent) < 0x800
