# SPDX-License-Identifier: Apache-2.0
"""Vehicle and client on one bus of this process: driven, braked, let go; and what is refused."""

import os
import time
from collections.abc import Iterator

import pytest
from hubfoc import HubfocError, Vehicle
from hubfoc.bus import Bus, join, reserve
from hubfoc.live import clock
from hubfoc.live.terminals import Terminals
from hubfoc.live.vehicle import SimulatedVehicle
from hubsim import can_protocol, cli
from regen_table import schema

from tests.unit.host_sim.live.support import NUMBERS, running, until


@pytest.fixture(scope="module")
def drive() -> schema.Drive:
    return schema.load(cli.DEFAULT_CONFIG)


@pytest.fixture
def channel() -> Iterator[str]:
    """Return the bus of a vehicle that runs in real time."""
    with running() as vehicle:
        yield vehicle.channel


def test_a_vehicle_is_driven_braked_and_let_go(channel: str) -> None:
    with Vehicle(channel) as car:
        wheel = car.rear_right
        until(lambda: wheel.status().mode == "READY")
        car.demand()
        until(lambda: wheel.status().mode == "RUN")
        car.demand(drive_nm=25.0)
        until(lambda: (wheel.status().speed_rad_s or 0.0) > 4.0)
        assert wheel.status().motor_torque_nm == pytest.approx(25.0, abs=0.5)
        assert wheel.status().lost == ()
        assert {w.status().fault for w in car.wheels} == {"NONE"}
        car.demand(brake_nm=60.0)
        until(lambda: (wheel.status().hydraulic_torque_nm or 0.0) > 15.0)
        until(lambda: wheel.status().speed_rad_s == 0.0)
    with Vehicle(channel) as car:  # which only listens
        until(lambda: car.front_left.status().torque_limit == "DEMAND_TIMEOUT")


def test_wheels_can_be_asked_for_different_torques(channel: str) -> None:
    with Vehicle(channel) as car:
        until(lambda: car.front_left.status().mode == "READY")
        car.demand()
        until(lambda: all(wheel.status().mode == "RUN" for wheel in car.wheels))
        car.demand(wheels={"front_right": {"drive_nm": 10.0}})
        until(lambda: (car.front_right.status().motor_torque_nm or 0.0) > 9.0)
        assert abs(car.front_left.status().motor_torque_nm or 0.0) < 1.0


def test_a_second_sender_is_refused(channel: str) -> None:
    with Vehicle(channel) as first, Vehicle(channel) as second:
        first.demand(brake_nm=1.0)
        with pytest.raises(HubfocError, match="another sender's demand is on this bus"):
            second.demand(brake_nm=1.0)


def test_what_no_demand_can_be_is_one_line(channel: str) -> None:
    with Vehicle(channel) as car:
        with pytest.raises(HubfocError, match="direction 'up', accepted: neutral, forward"):
            car.demand(direction="up")
        with pytest.raises(HubfocError, match="wheel 'spare', accepted: front_left"):
            car.demand(wheels={"spare": {}})
        with pytest.raises(HubfocError, match=r"brake_torque_nm: 5000 is not in 0 \.\. 3276"):
            car.demand(brake_nm=5000.0)


def test_messages_that_come_no_more_are_lost() -> None:
    """Of a bus on which only WheelState was ever sent, and then nothing."""
    name = f"virtual:{next(NUMBERS)}"
    bus = join(name)
    with Vehicle(name) as car:
        assert car.front_left.status().lost == ()
        for counter in range(4):
            bus.send(*can_protocol.encode("WheelState", {"speed_rad_s": 3.0}, counter=counter))
        until(lambda: car.front_left.status().speed_rad_s == 3.0)
        until(lambda: car.front_left.status().lost == ("WheelState",))
    bus.close()


class Echoing:
    """A port that gives back what is sent, as a multicast group does."""

    def __init__(self) -> None:
        self.queue: list[object] = []

    def send(self, message: object) -> None:
        self.queue.append(message)

    def recv(self, wait_s: float) -> object:
        del wait_s
        return self.queue.pop(0) if self.queue else None


def test_ones_own_frames_are_not_received_but_equal_ones_of_others_are() -> None:
    port = Echoing()
    bus = Bus(port, "udp_multicast:239.74.163.2")  # type: ignore[arg-type]
    bus.send(0x100, b"12345678")
    assert bus.receive(0.0) == []
    bus.send(0x100, b"12345678")
    port.queue *= 2
    assert bus.receive(0.0) == [(0x100, b"12345678")]


def test_a_shell_answers_on_its_terminal(drive: schema.Drive) -> None:
    with SimulatedVehicle(drive) as vehicle, Terminals(vehicle.wheels) as terminals:
        line = os.open(terminals.names[1], os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        os.write(line, b"limits\r")
        answer = b""
        for _ in range(500):
            vehicle.step([])
            terminals.exchange(vehicle)
            try:
                answer += os.read(line, 4096)
            except BlockingIOError:
                continue
        os.close(line)
    assert b"LOSS_OPTIMUM" in answer


def test_two_vehicles_have_different_groups() -> None:
    first, second = reserve("udp_multicast"), reserve("udp_multicast")
    try:
        assert first.name != second.name
        with pytest.raises(HubfocError, match="another vehicle has this bus"):
            reserve(first.name)
    finally:
        first.close()
        second.close()


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("udp_multicast:10.0.0.1", r"accepted: 224\.0\.0\.0 to 239"),
        ("udp_multicast:house", "accepted: an IPv4 multicast group"),
        ("can99", "can99: no such bus, accepted: udp_multicast"),
    ],
)
def test_a_bus_that_is_none_is_one_line(name: str, why: str) -> None:
    with pytest.raises(HubfocError, match=why):
        reserve(name)


def test_a_late_step_is_made_up_for_and_a_lost_second_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The clock on the wall stands at 100 s; steps are 1 ms."""
    now_s = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now_s[0])
    pace = clock.Clock(paced=True)
    pace.begin()
    assert pace.stepped(0.001, 0.001) is None
    assert pace.wait_s() == pytest.approx(0.001)
    now_s[0] = 100.021  # 20 ms late: the next twenty steps are due at once
    assert pace.wait_s() == 0.0
    assert pace.health()["late_ms_max"] == pytest.approx(20.0)
    for k in range(20):
        assert pace.wait_s() == 0.0
        pace.stepped(0.002 + 0.001 * k, 0.001)
    assert pace.wait_s() == pytest.approx(0.0, abs=1e-9)
    now_s[0] = 101.0
    assert "this machine is too slow" in str(pace.stepped(0.022, 0.001))
    assert pace.wait_s() == 0.0
    pace.stepped(0.023, 0.001)
    assert pace.wait_s() > 0.0


def test_a_vehicle_that_is_not_paced_never_waits() -> None:
    assert clock.Clock(paced=False).wait_s() == 0.0
