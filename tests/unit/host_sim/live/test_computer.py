# SPDX-License-Identifier: Apache-2.0
"""The vehicle's computer, on what wheels say and on a simulated vehicle."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import unlike_axles
from hubfoc.client import WHEELS, Wheel, WheelStatus
from hubfoc.computer import Computer, Driver
from hubfoc.live.vehicle import SimulatedVehicle
from hubsim import can_protocol, cli
from regen_table import schema

HEALTHY = WheelStatus(
    mode="RUN", fault="NONE", speed_rad_s=0.0, motor_torque_nm=0.0,
    motor_torque_uncertainty_nm=0.0, torque_limit="NONE", hydraulic_torque_nm=0.0,
    brake_available_nm=30.0, drive_available_nm=40.0, brake_ahead_nm=30.0, drive_ahead_nm=40.0,
    bus_voltage_v=53.0, bus_current_a=0.0, winding_temperature_c=25.0,
    warning="NONE", waits_for="", drawn_wh=0.0, returned_wh=0.0, friction_percent=None,
    life_drawn_wh=0.0, life_returned_wh=0.0, life_friction_percent=None, lost=(),
)  # fmt: skip
MOVING = replace(HEALTHY, speed_rad_s=20.0)
ON = Driver(is_on=True)
QUICK_NM_PER_S = 1e6


def settled(
    driver: Driver,
    wheels: list[WheelStatus],
    front_share: float = 0.5,
    *,
    has_hydraulic: bool = True,
) -> list[dict[str, float]]:
    """Return the demands of a computer that has chosen its direction at standstill."""
    computer = Computer(
        front_share=front_share, rate_nm_per_s=QUICK_NM_PER_S, has_hydraulic=has_hydraulic
    )
    computer.step(replace(driver, drive_nm=0.0, brake_nm=0.0), [HEALTHY] * 4)
    return [dict(values) for values in computer.step(driver, wheels)]


def test_torque_is_shared_by_axle_and_equal_left_and_right() -> None:
    demands = settled(replace(ON, drive_nm=100.0), [MOVING] * 4, front_share=0.6)
    assert [d["drive_torque_nm"] for d in demands] == pytest.approx([30.0, 30.0, 20.0, 20.0])
    demands = settled(replace(ON, brake_nm=100.0), [MOVING] * 4, front_share=0.6)
    assert [d["brake_torque_nm"] for d in demands] == pytest.approx([30.0, 30.0, 20.0, 20.0])
    assert {d["drive_torque_nm"] for d in demands} == {0.0}


@pytest.mark.parametrize(
    ("weak", "front_nm"),
    [
        (replace(MOVING, drive_available_nm=12.0), 12.0),
        (replace(MOVING, drive_ahead_nm=7.0), 7.0),
        (replace(MOVING, mode="FAULT"), 0.0),
        (replace(MOVING, lost=("WheelState",)), 0.0),
        (replace(MOVING, drive_available_nm=None), 0.0),
    ],
)
def test_both_wheels_of_an_axle_drive_as_the_weaker_can(weak: WheelStatus, front_nm: float) -> None:
    demands = settled(replace(ON, drive_nm=100.0), [MOVING, weak, MOVING, MOVING])
    assert [d["drive_torque_nm"] for d in demands] == [front_nm, front_nm, 25.0, 25.0]


def test_braking_is_reduced_only_where_nothing_fills() -> None:
    weak = [MOVING, replace(MOVING, brake_available_nm=3.0), MOVING, MOVING]
    driver = replace(ON, brake_nm=40.0)
    assert [d["brake_torque_nm"] for d in settled(driver, weak)] == [10.0] * 4
    without = settled(driver, weak, has_hydraulic=False)
    assert [d["brake_torque_nm"] for d in without] == [3.0, 3.0, 10.0, 10.0]


def test_driving_torque_rises_at_its_rate_and_falls_at_once() -> None:
    computer = Computer(rate_nm_per_s=400.0)
    computer.step(ON, [HEALTHY] * 4)
    first, second = (
        computer.step(replace(ON, drive_nm=160.0), [MOVING] * 4)[0]["drive_torque_nm"]
        for _ in range(2)
    )
    assert (first, second) == pytest.approx((4.0, 8.0))
    assert computer.step(ON, [MOVING] * 4)[0]["drive_torque_nm"] == 0.0


def test_direction_and_acknowledgement_need_standstill() -> None:
    computer = Computer(rate_nm_per_s=QUICK_NM_PER_S)
    reverse = Driver(is_on=True, direction="reverse", drive_nm=40.0, acknowledges=True)
    computer.step(ON, [HEALTHY] * 4)
    rolling = computer.step(reverse, [MOVING] * 4)[0]
    assert (rolling["direction"], rolling["fault_reset"]) == (1.0, 0.0)
    silent = [HEALTHY, HEALTHY, HEALTHY, replace(HEALTHY, lost=("WheelState",))]
    assert computer.step(reverse, silent)[0]["direction"] == 1.0
    standing = computer.step(reverse, [HEALTHY] * 4)[0]
    assert (standing["direction"], standing["drive_torque_nm"]) == (2.0, -10.0)
    released = replace(reverse, drive_nm=0.0)
    assert computer.step(released, [HEALTHY] * 4)[0]["fault_reset"] == 1.0


def test_a_vehicle_that_is_off_is_in_neutral_and_still_brakes() -> None:
    off = settled(Driver(is_on=False, drive_nm=40.0, brake_nm=20.0), [MOVING] * 4)
    assert {(d["enable"], d["direction"], d["drive_torque_nm"]) for d in off} == {(0.0, 0.0, 0.0)}
    assert {d["brake_torque_nm"] for d in off} == {5.0}


# Of the winding: straight from max_torque_nm at 130 degC to none at 150.
WARM_K = (100.0, 117.0)  # above 25 degC, from 1 to 5 s; (150 - 142)/(150 - 130) = 40 %
DRIVE_NM, BRAKE_NM = 30.0, 50.0  # of each wheel
STARTED, BRAKES = 150, 600  # in cycles: a second after the start halls know the angle; the pedal
FOLLOWED = 35  # dead time and five lags of the hydraulic brake


ALIKE = 0.5
UNLIKE = 2.0 / 3.0  # 40 and 20 N m


@pytest.mark.parametrize("front_share", [ALIKE, UNLIKE], ids=["axles alike", "axles that differ"])
def test_a_vehicle_with_one_wheel_at_forty_per_cent_stays_straight(
    tmp_path: Path, front_share: float
) -> None:
    """Yaw moment at most 5 % of the demanded torque times half the track, also axle by axle.

    Half the track and the wheels' radius are on both sides: left and right differ by at most 5 % of
    the demand, as means of 10 ms. The winding of the front right wheel warms within a second, ten
    times as fast as at full current, while the vehicle drives; then it brakes to standstill.
    """
    files = unlike_axles.files(tmp_path, {}) if front_share == UNLIKE else (cli.DEFAULT_CONFIG,) * 2
    drive, rear = map(schema.load, files)
    wheels = [Wheel(position) for position in WHEELS]
    computer = Computer(front_share=front_share)
    impulses = []
    with SimulatedVehicle(drive, rear=rear if front_share == UNLIKE else None) as vehicle:
        for ms in range(11000):
            frames = []
            if ms % 10 == 0:
                driver = Driver(
                    is_on=True,
                    drive_nm=4.0 * DRIVE_NM if 500 <= ms < 6000 else 0.0,
                    brake_nm=4.0 * BRAKE_NM if ms >= 6000 else 0.0,
                )
                demands = computer.step(driver, [wheel.status(ms) for wheel in wheels])
                frames = [
                    can_protocol.encode("Demand", values, wheel=k, counter=ms // 10)
                    for k, values in enumerate(demands)
                ]
                impulses.append(
                    [
                        [vehicle.value(f"wheel{k}.{kind}_torque_nm") for k in range(4)]
                        for kind in ("motor", "hydraulic")
                    ]
                )
            vehicle.set("wheel1.winding_rise_k", np.interp(ms, (1000.0, 5000.0), WARM_K))
            for identifier, data in vehicle.step(frames):
                wheels[identifier & can_protocol.WHEEL_MASK].take(identifier, data, ms)
        speed_m_per_s = vehicle.value("vehicle.speed_m_per_s")
    assert computer.step(ON, [wheel.status(11000) for wheel in wheels])  # still all there
    motor_nm, hydraulic_nm = np.moveaxis(np.diff(np.array(impulses), axis=0) / 0.010, 1, 0)
    total_nm = motor_nm - hydraulic_nm
    left, right = total_nm[:, ::2], total_nm[:, 1::2]
    # Of a wheel of each axle.
    drive_nm, brake_nm = (
        2.0 * nm * np.array([front_share, 1.0 - front_share]) for nm in (DRIVE_NM, BRAKE_NM)
    )
    assert right[550:590, 0].mean() == pytest.approx(16.0, rel=0.05)
    assert left[550:590, 1].mean() == pytest.approx(drive_nm[1], rel=0.02)  # the rear drives on
    apart_nm = np.abs(left - right)
    assert (apart_nm[STARTED:BRAKES] < 0.05 * drive_nm).all()
    assert (apart_nm[BRAKES + FOLLOWED :] < 0.05 * brake_nm).all()
    # The motor that has its torque is quicker than the hydraulic brake that fills: 40 ms of dead
    # time and 60 ms of lag, for the 34 N m that the warm motor lacks.
    assert (apart_nm[BRAKES:] < 0.25 * brake_nm).all()
    whole_nm = np.abs((left - right).sum(axis=1))
    assert whole_nm[BRAKES:].max() < 0.05 * 4.0 * BRAKE_NM
    assert speed_m_per_s < 0.5


def test_brakes_may_be_shared_otherwise_than_motors() -> None:
    computer = Computer(front_share=0.75, brake_front_share=0.6, rate_nm_per_s=QUICK_NM_PER_S)
    computer.step(ON, [HEALTHY] * 4)
    drives = computer.step(replace(ON, drive_nm=80.0), [MOVING] * 4)
    assert [d["drive_torque_nm"] for d in drives] == pytest.approx([30.0, 30.0, 10.0, 10.0])
    brakes = computer.step(replace(ON, brake_nm=100.0), [MOVING] * 4)
    assert [d["brake_torque_nm"] for d in brakes] == pytest.approx([30.0, 30.0, 20.0, 20.0])
