# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hubsim.report import quality, tables

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_vehicle import drive, three


def test_torque_error_is_zero_when_the_demand_is_met() -> None:
    for run in three():
        error = quality.torque_error_nm(run)
        assert error is not None
        assert quality.largest(quality.while_braking(run, error)) < 1e-9


def test_a_braking_shortfall_is_a_positive_torque_error() -> None:
    run = drive("parallel_ratio")
    run.signals["wheel0.hydraulic_torque_nm"] = run.signals["wheel0.hydraulic_torque_nm"] - 3.0
    error = quality.while_braking(run, quality.torque_error_nm(run))
    assert error is not None
    assert np.allclose(error, 3.0)
    assert quality.root_mean_square(error) == pytest.approx(3.0)


def test_torque_error_is_the_same_backwards() -> None:
    """A wheel that turns the other way has speed, motor, brake and drive of the other sign."""
    run = drive("parallel_ratio")
    run.signals["wheel0.hydraulic_torque_nm"] = run.signals["wheel0.hydraulic_torque_nm"] - 3.0
    forwards = quality.torque_error_nm(run)
    for name in ("vehicle.speed_m_per_s", "driver.drive_nm"):
        run.signals[name] = -run.signals[name]
    for name in ("motor_torque_nm", "hydraulic_torque_nm"):
        run.signals[f"wheel0.{name}"] = -run.signals[f"wheel0.{name}"]
    backwards = quality.torque_error_nm(run)
    assert forwards is not None
    assert backwards is not None
    assert np.nanmax(forwards) == pytest.approx(3.0)
    assert np.allclose(backwards, forwards, equal_nan=True)


def test_torque_error_is_zero_at_standstill() -> None:
    run = drive()
    error = quality.torque_error_nm(run)
    assert error is not None
    standing = np.abs(run.signals["vehicle.speed_m_per_s"]) < quality.STANDING_M_PER_S
    assert np.all(np.isnan(error[standing]))
    assert np.any(standing)


def test_jerk_is_the_derivative_of_the_acceleration() -> None:
    run = drive()
    run.signals["vehicle.acceleration_m_per_s2"] = np.where(
        run.time_s < 50.0, 0.0, -0.5 * (run.time_s - 50.0)
    )
    jerk = quality.jerk_m_per_s3(run)
    assert jerk is not None
    assert np.all(np.isnan(jerk[:2]))
    assert np.allclose(jerk[2:][run.time_s[2:] < 49.9], 0.0)
    assert np.allclose(jerk[run.time_s > 50.1], -0.5)


def test_the_jolt_at_the_stop_is_the_deceleration_that_ends_with_the_motion() -> None:
    """A stop with 0.5 m/s^2 to the end, sampled every 0.1 s: 0.5 / 0.1 = 5 m/s^3, then a start."""
    run = drive()
    run.time_s = np.linspace(0.0, 5.9, 60)
    speed = np.maximum(1.5 - 0.05 * np.arange(60), 0.0)
    speed[50:] = 0.2 * np.arange(1, 11)
    acceleration = np.where(speed > 1e-9, -0.5, 0.0)
    acceleration[50:] = 2.0
    run.signals = {
        "vehicle.speed_m_per_s": np.where(speed > 1e-9, speed, 0.0),
        "vehicle.acceleration_m_per_s2": acceleration,
        "driver.brake_nm": np.where(np.arange(60) < 50, 10.0, 0.0),
    }
    jerk = quality.jerk_m_per_s3(run)
    assert quality.largest(quality.at_the_stop(run, jerk)) == pytest.approx(5.0)
    assert quality.largest(quality.while_braking(run, jerk)) < 1e-9  # it ends at 0.3 m/s
    left = quality.left_at_the_stop_m_per_s2(run)
    assert left is not None
    assert left == pytest.approx([0.5])
    run.signals["vehicle.speed_m_per_s"] = np.ones(60)
    assert quality.at_the_stop(run, jerk) is None
    assert quality.left_at_the_stop_m_per_s2(run) is None


def test_the_table_has_units_and_dashes_for_missing_values() -> None:
    run = drive("parallel_ratio")
    del run.signals["vehicle.acceleration_m_per_s2"]
    table = documents.read(tables.braking_quality([run], "how well"))
    rows = [[cell.words() for cell in row.all("td")] for row in table.all("tbody")[0].all("tr")]
    assert [row[0] for row in rows] == ["N·m", "N·m", "m/s³", "m/s³", "m/s³", "m/s²"]
    assert [row[1] for row in rows][2:] == ["–"] * 4
    run.signals = {}
    assert tables.braking_quality([run], "how well") == ""
    assert quality.torque_error_nm(run) is None
