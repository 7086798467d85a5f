# SPDX-License-Identifier: Apache-2.0
"""Motors whose iron saturates, plant and controller from the same map: torque and no fault.

The plant has a spline of the map's energy, the controller the 290 points of its image. Angle and
magnets are as the controller assumes. Torque is the mean airgap torque less friction.
"""

import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hubsim import configuration
from hubsim.configuration import Configuration
from hubsim.run.bench import Bench, Recording
from saturating_drives import MOTORS, saturating

HEAVY = {"vehicle.mass_kg": 1e6}  # the speed stays
SETTLED_S, MEAN_ROWS = 0.5, 100
FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
OF_COMMAND, OF_LARGEST = 0.02, 0.005  # accepted errors of torque


@pytest.fixture(scope="module")
def leaf(tmp_path_factory: pytest.TempPathFactory) -> Configuration:
    return saturating(MOTORS / "public" / "leaf.toml", tmp_path_factory.mktemp("leaf"))


@pytest.fixture(scope="module")
def reluctance() -> Configuration:
    return configuration.load(Path(__file__).parent / "reluctance.toml")


@pytest.fixture(scope="module")
def hub(tmp_path_factory: pytest.TempPathFactory) -> Configuration:
    return saturating(MOTORS / "lu2013.toml", tmp_path_factory.mktemp("hub"))


def ridden(
    config: Configuration,
    speed_share: float,
    torques: list[float],
    winding_c: float | None = None,
    *,
    sensor_stops: bool = False,
) -> list[Recording]:
    """Return what happens with demands in N m one after the other, negative brakes.

    The rotor's sensor stops with the second one.
    """
    assert config.drive is not None
    motor, vehicle = config.drive.motor, config.drive.vehicle
    speed_m_per_s = speed_share * motor.max_speed_rpm * math.pi / 30.0 * vehicle.wheel_radius_m
    plant = HEAVY if winding_c is None else HEAVY | {"thermal.winding_temperature_c": winding_c}
    signals = ("motor_torque_nm", "command_nm", "first_fault_reason", "warning_reason")
    recorded = []
    with Bench(
        config,
        "stop",
        plant=plant,
        record=[f"wheel0.{name}" for name in signals],
        initial_speed_kmh=3.6 * speed_m_per_s,
        noise=False,
        record_interval_s=0.001,
        max_duration_s=60.0,
    ) as bench:
        for n, torque in enumerate(torques):
            bench.set("fault.rotor_frozen", float(sensor_stops and n > 0))
            bench.set("driver.brake_demand_nm", max(-torque, 0.0))
            bench.set("driver.drive_demand_nm", max(torque, 0.0))
            recorded.append(bench.run(SETTLED_S))
    return recorded


def friction_nm(config: Configuration, speed_share: float) -> float:
    assert config.drive is not None
    motor = config.drive.motor
    speed = speed_share * motor.max_speed_rpm * math.pi / 30.0
    return motor.friction_torque_nm + motor.viscous_friction_nm_s * speed


def assert_torque(
    config: Configuration, speed_share: float, torque_shares: list[float], winding_c: float = 25.0
) -> None:
    assert config.drive is not None
    most = config.drive.motor.max_torque_nm
    demands = [share * most for share in torque_shares]
    for recording in ridden(config, speed_share, demands, winding_c):
        airgap = float(np.mean(recording["wheel0.motor_torque_nm"][-MEAN_ROWS:]))
        made = airgap - friction_nm(config, speed_share)
        command = float(np.mean(recording["wheel0.command_nm"][-MEAN_ROWS:]))
        assert made == pytest.approx(command, abs=OF_COMMAND * abs(command) + OF_LARGEST * most)
        assert not np.any(recording["wheel0.first_fault_reason"])
        assert not np.any(recording["wheel0.warning_reason"])


@pytest.mark.parametrize("speed_share", [0.1, 0.5, 0.9] if FOR_LONG else [0.1, 0.9])
def test_interior_magnets_of_80_kw_make_the_torque_that_is_commanded(
    leaf: Configuration, speed_share: float
) -> None:
    assert_torque(leaf, speed_share, [-1.0, -0.5, -0.05, 0.05, 0.5, 1.0])


@pytest.mark.parametrize("speed_share", [0.3, 0.9, 1.05])
def test_a_reluctance_motor_as_measured_makes_the_torque_that_is_commanded(
    reluctance: Configuration, speed_share: float
) -> None:
    """Six times as much L_q as L_d; deep in field weakening no current must seem missing."""
    assert_torque(reluctance, speed_share, [-1.0, -0.5, -0.05, 0.05, 0.5, 1.0])


def test_a_torque_that_needs_more_voltage_for_its_rate_than_is_left_still_arrives(
    reluctance: Configuration,
) -> None:
    """2 N m a step need 0.14 H / (1.5 p psi) * 2000 N m/s = 200 V of the 310 V besides the EMF."""
    assert reluctance.drive is not None
    most = reluctance.drive.motor.max_torque_nm
    _, driven = ridden(reluctance, 0.9, [-most, 0.5 * most])
    assert driven["wheel0.command_nm"][-1] == pytest.approx(0.5 * most)


def test_the_observer_of_a_measured_map_has_the_torque_when_the_sensor_stops(
    reluctance: Configuration,
) -> None:
    assert reluctance.drive is not None
    most = reluctance.drive.motor.max_torque_nm
    demands = [-0.05 * most, -0.3 * most, -0.7 * most]
    for recording in ridden(reluctance, 0.6, demands, sensor_stops=True)[1:]:
        made = float(np.mean(recording["wheel0.motor_torque_nm"][-MEAN_ROWS:]))
        command = float(np.mean(recording["wheel0.command_nm"][-MEAN_ROWS:]))
        assert np.all(recording["wheel0.warning_reason"][-MEAN_ROWS:] > 0.0)
        assert abs(command) > 0.25 * most
        made -= friction_nm(reluctance, 0.6)
        assert made == pytest.approx(command, abs=OF_COMMAND * abs(command) + OF_LARGEST * most)


@pytest.mark.parametrize("speed_share", [0.1, 0.5, 0.9] if FOR_LONG else [0.1, 0.9])
def test_a_hub_motor_with_half_of_its_inductance_left_makes_the_torque_that_is_commanded(
    hub: Configuration, speed_share: float
) -> None:
    assert_torque(hub, speed_share, [-1.0, -0.5, -0.05, 0.05, 0.5, 1.0])


def test_hot_magnets_weaken_the_map_as_they_do_the_motor(leaf: Configuration) -> None:
    assert_torque(leaf, 0.3, [-0.4, 0.4], winding_c=110.0)


def test_a_reversal_of_torque_overshoots_by_no_more_than_two_per_cent(leaf: Configuration) -> None:
    """At a speed where neither voltage nor battery limits; 2 N m a millisecond."""
    assert leaf.drive is not None
    torque = 0.5 * leaf.drive.motor.max_torque_nm
    driven, braked = ridden(leaf, 0.15, [torque, -torque])
    friction = friction_nm(leaf, 0.15)
    assert np.max(driven["wheel0.motor_torque_nm"]) - friction < 1.02 * torque
    assert np.min(braked["wheel0.motor_torque_nm"]) - friction > -1.02 * torque


def test_with_its_constants_alone_the_controller_misses_the_torque(
    leaf: Configuration, tmp_path: Path
) -> None:
    """So that the tests above do find a controller without a map."""
    assert leaf.drive is not None
    motor = leaf.drive.motor
    text = (MOTORS / "public" / "leaf.toml").read_text(encoding="utf-8")
    for key in ("flux_linkage_wb", "d_inductance_h", "q_inductance_h"):
        text = re.sub(rf"^{key}.*", f"{key} = {getattr(motor, key)!r}", text, flags=re.MULTILINE)
    constants = tmp_path / "constants.toml"
    constants.write_text(text, encoding="utf-8")
    with Bench(
        leaf,
        "stop",
        controller=constants,
        plant=HEAVY,
        record=["wheel0.motor_torque_nm"],
        initial_speed_kmh=10.0,
        demand_nm=0.5 * motor.max_torque_nm,
        noise=False,
        record_interval_s=0.001,
    ) as bench:
        made = -float(np.mean(bench.run(SETTLED_S)["wheel0.motor_torque_nm"][-MEAN_ROWS:]))
    wanted = 0.5 * motor.max_torque_nm
    assert abs(made - wanted) > OF_COMMAND * wanted + OF_LARGEST * motor.max_torque_nm
