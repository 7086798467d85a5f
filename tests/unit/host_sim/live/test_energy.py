# SPDX-License-Identifier: Apache-2.0
"""The energy that four wheels say by CAN, against the plant's."""

import numpy as np
import pytest
from hubfoc.client import WHEELS, Wheel
from hubfoc.live.vehicle import SimulatedVehicle
from hubsim import can_protocol, cli
from regen_table import schema

JOULE_A_WH = 3600.0
STEP_S = 1e-3
STEP_WH = 0.1
DRIVE_NM, BRAKE_NM = 40.0, 50.0
READY_MS, BRAKES_MS, ENDS_MS = 500, 12_000, 21_000


def demand(ms: int) -> dict[str, float]:
    return {
        "enable": 1.0,
        "direction": 1.0,
        "drive_torque_nm": DRIVE_NM if READY_MS <= ms < BRAKES_MS else 0.0,
        "brake_torque_nm": BRAKE_NM if ms >= BRAKES_MS else 0.0,
    }


def test_the_wheels_accounts_add_up_to_what_flowed_through_the_battery_s_terminals() -> None:
    """Away from rest for 11.5 s and back to it, more braking than the motors alone can do.

    The wheels know their currents by a model of the inverter: 5 %, and each rounds down by less
    than 0.1 Wh. Friction's share is that of the plant's torques, means of a step, by its speed.
    """
    wheels = [Wheel(position) for position in WHEELS]
    flows_j = {"drawn": 0.0, "returned": 0.0}
    work_j = np.zeros(2)  # of motor and hydraulic brake
    signals = [f"wheel{k}.{name}" for name in
               ("motor_torque_nm", "hydraulic_torque_nm", "speed_rad_per_s")
               for k in range(4)]  # fmt: skip
    row = np.zeros(2 + len(signals))
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        vehicle.choose(["battery.voltage_v", "battery.current_a", *signals])
        for ms in range(ENDS_MS):
            frames = []
            if ms % 10 == 0:
                frames = [
                    can_protocol.encode("Demand", demand(ms), wheel=k, counter=ms // 10)
                    for k in range(4)
                ]
            for identifier, data in vehicle.step(frames):
                wheels[identifier & can_protocol.WHEEL_MASK].take(identifier, data, ms)
            vehicle.sample(row)
            power_w = row[0] * row[1]
            flows_j["drawn" if power_w > 0.0 else "returned"] += abs(power_w) * STEP_S
            motor_nm, hydraulic_nm, speeds = row[2:].reshape(3, 4)
            braking_nm = np.maximum([-motor_nm, hydraulic_nm], 0.0)
            work_j += (braking_nm * speeds).sum(axis=1) * STEP_S
        assert vehicle.value("vehicle.speed_m_per_s") < 0.1
    statuses = [wheel.status(ENDS_MS) for wheel in wheels]
    for kind, flow_j in flows_j.items():
        sum_wh = sum(getattr(status, f"{kind}_wh") for status in statuses)
        assert sum_wh == pytest.approx(flow_j / JOULE_A_WH, rel=0.05, abs=len(WHEELS) * STEP_WH)
        assert sum_wh > 8 * len(WHEELS) * STEP_WH
    share_percent = 100.0 * work_j[1] / work_j.sum()
    assert 10.0 < share_percent < 90.0
    assert [s.friction_percent for s in statuses] == pytest.approx([share_percent] * 4, abs=2.0)
    # New wheels: for life is since the start, in steps of 5 Wh.
    assert {s.life_friction_percent for s in statuses} == {s.friction_percent for s in statuses}
    assert all(0.0 <= (s.drawn_wh or 0.0) - (s.life_drawn_wh or 0.0) < 5.0 for s in statuses)
