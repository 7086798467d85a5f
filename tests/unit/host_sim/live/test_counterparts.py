# SPDX-License-Identifier: Apache-2.0
"""Battery management and brake system as counterparts of wheels, by frames of the protocol."""

import itertools
import time
from collections.abc import Callable

import pytest
from hubfoc import Bms, BrakeSystem, HubfocError
from hubfoc.bus import join
from hubsim import can_protocol

TIMEOUT_S = 60.0
NUMBERS = itertools.count()


def channel() -> str:
    return f"virtual:counterparts{next(NUMBERS)}"


def until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def used(name: str, message: str, count: int) -> list[dict[str, float]]:
    """Return the values of frames that a receiver of the protocol uses."""
    bus = join(name)
    receivers: dict[int, can_protocol.Receiver] = {}
    out: list[dict[str, float]] = []
    end_s = time.monotonic() + TIMEOUT_S
    while len(out) < count:
        assert time.monotonic() < end_s
        for identifier, data in bus.receive(0.05):
            if can_protocol.message_of(identifier) == message:
                receiver = receivers.setdefault(identifier, can_protocol.Receiver(message))
                if receiver.receive(identifier, data, int(1e3 * time.monotonic())) == "used":
                    values = can_protocol.decode(message, data)
                    assert values is not None
                    out.append(values)
    bus.close()
    return out


def test_a_battery_says_its_limits_and_what_else_is_known() -> None:
    name = channel()
    with Bms(name, charge_a=20.0, discharge_a=60.0) as bms:
        limits = used(name, "BatteryLimits", 2)[-1]
        assert limits["charge_current_a"] == pytest.approx(20.0)
        assert limits["discharge_current_a"] == pytest.approx(60.0)
        assert limits["contactor"] == 1.0
        bms.set(charge_a=0.0, discharge_a=60.0, contactor="open", voltage_v=51.3)
        peak = used(name, "BatteryPeak", 1)[-1]
        assert peak["pack_voltage_v"] == pytest.approx(51.3)
        assert peak["pack_current_a"] == pytest.approx(-1638.4)  # not given, as hubfoc.dbc says
        assert used(name, "BatteryLimits", 1)[-1]["contactor"] == 2.0


def test_a_brake_system_hears_commands_and_reports_torques() -> None:
    name = channel()
    bus = join(name)
    with BrakeSystem(name) as brakes:
        assert brakes.commands_nm() == [None] * 4
        for counter in range(4):
            for wheel, valid in ((0, 1.0), (3, 0.0)):
                bus.send(*can_protocol.encode(
                    "WheelBrake", {"hydraulic_valid": valid, "hydraulic_torque_nm": 12.5},
                    wheel=wheel, counter=counter,
                ))  # fmt: skip
        until(lambda: brakes.commands_nm() == [12.5, None, None, None])
        until(lambda: brakes.commands_nm() == [None] * 4)  # it has been silent for five cycles
        brakes.report([10.0, None, 0.0, 20.0])
        reports = used(name, "HydraulicFeedback", 8)
    bus.close()
    assert {(r["torque_valid"], round(r["measured_torque_nm"], 1)) for r in reports} == {
        (1.0, 10.0), (0.0, 0.0), (1.0, 0.0), (1.0, 20.0),
    }  # fmt: skip


def test_what_cannot_be_said_is_one_line() -> None:
    name = channel()
    with pytest.raises(HubfocError, match=r"charge_current_a: -1 is not in 0 \.\. 32000"):
        Bms(name, charge_a=-1.0, discharge_a=1.0)
    with (
        Bms(name, charge_a=1.0, discharge_a=1.0) as bms,
        pytest.raises(HubfocError, match="contactor 'shut', accepted: not_reported, closed, open"),
    ):
        bms.set(charge_a=1.0, discharge_a=1.0, contactor="shut")
    with BrakeSystem(name) as brakes:
        with pytest.raises(HubfocError, match="2 torques, accepted: 4"):
            brakes.report([1.0, 1.0])
        with pytest.raises(HubfocError, match=r"measured_torque_nm: 30000 is not in 0 \.\. 20000"):
            brakes.report([3e4, None, None, None])
