# SPDX-License-Identifier: Apache-2.0
"""Controllers that start on a rolling wheel with a healthy rotor sensor, and with a wrong one."""

import math
from pathlib import Path

import numpy as np
import pytest
from hubsim import reasons, run
from hubsim.engine import ROOT
from hubsim.run import stops
from hubsim.scenario import Scenario, overrides
from hubsim.sweep.faults_sweep import ENCODER
from regen_table import schema
from regen_table.schema import Drive

MOTORS = ROOT / "tools" / "motors"
CONFIGS = ("lu2013", "ebike36v", "scooter48v", "ipm400v", "bench/wheel24v")
SENSORS = ("hall", "encoder", "angle")
SHARES = (0.1, 0.35, 0.6, 0.85, 1.0, 1.1)
SECONDS = 0.3
SIGNALS = ("wheel0.fault_reason", "wheel0.warning_reason")


def drive_with(config: str, sensor: str) -> Drive:
    """Return a drive of the repository with a rotor sensor."""
    drive = schema.load(MOTORS / f"{config}.toml")
    changes: dict[tuple[str, str], object] = {("rotor", "sensor"): sensor}
    if sensor == "encoder" and drive.rotor.encoder_counts is None:
        changes |= {("rotor", key): value for key, value in ENCODER.items()}
    return overrides.changed(drive, changes, f"{config} {sensor}")


def names(
    drive: Drive, share: float, turn: float, demand: float, faults: dict[str, float]
) -> set[str]:
    """Return what is named after a start at a share of the largest speed."""
    top_kmh = 3.6 * drive.motor.max_speed_rpm * math.pi / 30 * drive.vehicle.wheel_radius_m
    scenario = Scenario(
        initial_speed_kmh=share * top_kmh,
        boots_rolling=True,
        record_interval_s=0.001,
        max_duration_s=10.0,
        plant={"run.rotor_turn": turn, **faults},
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    stops.as_one_wheel(engine, drive)
    engine.start()
    engine.choose(SIGNALS)
    with engine:
        engine.set("driver.brake_demand_nm", demand * drive.motor.max_torque_nm)
        codes = np.unique(engine.run(SECONDS))
    return {reasons.shown(code) for code in codes if code}


@pytest.mark.parametrize("sensor", SENSORS)
@pytest.mark.parametrize("config", CONFIGS)
def test_a_healthy_sensor_has_no_name(config: str, sensor: str) -> None:
    drive = drive_with(config, sensor)
    for number, share in enumerate(SHARES):
        # Above the speed that the bus admits no offsets can be measured: those stored are used.
        named = names(drive, share, 0.618 * number % 1.0, 0.0, {}) - {"OFFSETS_STORED"}
        assert not named, share


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_wrong_sensor_has_its_name_while_braking(sensor: str) -> None:
    drive = drive_with("lu2013", sensor)
    wrong = [{"fault.rotor_slip_deg_per_s": 2000.0}]
    if sensor != "encoder":  # without an index it is never used
        wrong.append({"fault.rotor_frozen": 1.0})
    for fault in wrong:
        named = names(drive, 0.6, 0.3, 0.3, fault)
        assert any(name.startswith("ROTOR_") for name in named), fault
