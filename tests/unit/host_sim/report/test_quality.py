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


def test_the_table_has_units_and_dashes_for_missing_values() -> None:
    run = drive("parallel_ratio")
    del run.signals["vehicle.acceleration_m_per_s2"]
    table = documents.read(tables.braking_quality([run], "how well"))
    rows = [[cell.words() for cell in row.all("td")] for row in table.all("tbody")[0].all("tr")]
    assert [row[0] for row in rows] == ["N·m", "N·m", "m/s³", "m/s³"]
    assert [row[1] for row in rows][2:] == ["–", "–"]
    run.signals = {}
    assert tables.braking_quality([run], "how well") == ""
    assert quality.torque_error_nm(run) is None
