# SPDX-License-Identifier: Apache-2.0
"""The current of minimum loss for a torque.

The paper's closed form for surface magnets, the least loss for salient motors.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from regen_table import braking, current_audit, ideal, ideal_cycles, joint, models, schema

ROOT = Path(__file__).resolve().parents[4]
MOTORS = sorted((ROOT / "tools" / "motors").glob("*.toml"))
SALIENT = [path for path in MOTORS if schema.load(path).motor.type == "ipmsm"]


def test_optimum_of_surface_magnets_is_the_closed_form_of_the_paper(paper: schema.Drive) -> None:
    assert ideal.production(paper) is braking.ZERO_D_CURRENT
    line = ideal.lines(
        paper,
        models.machine(paper, 25.0),
        models.bridge(paper),
        np.array([100.0, 300.0]) * math.pi / 30.0,
    )
    assert line.optimal_nm == pytest.approx([49.60, 148.7], rel=5e-4)
    assert line.zero_nm == pytest.approx([98.02, 295.7], rel=5e-4)
    # T_opt = 40 N m, the limit, between 50 and 100 r/min.
    meeting = (
        ideal.meeting_rad_s(paper, models.machine(paper, 25.0), models.bridge(paper))
        * 30.0
        / math.pi
    )
    assert pytest.approx(meeting, rel=5e-3) == 50.0 + 50.0 * (40.0 - 24.19) / (49.60 - 24.19)


@pytest.mark.parametrize("path", SALIENT, ids=lambda path: path.stem)
def test_lines_of_a_salient_motor_are_optimum_and_zero_of_the_least_power(path: Path) -> None:
    drive = schema.load(path)
    motor, inverter = models.machine(drive, 60.0), models.bridge(drive)
    meeting = ideal.meeting_rad_s(drive, motor, inverter)
    speed = meeting * np.array([0.5, 0.8])
    line = ideal.lines(drive, motor, inverter, speed)

    def power(torque: models.Array) -> models.Array:
        return ideal.state(drive, motor, inverter, speed, -torque).dc_power_w

    best = power(line.optimal_nm)
    assert np.all(best < 0.0)
    for factor in (0.9, 1.1):
        assert np.all(power(factor * line.optimal_nm) > best)
    assert np.all(line.zero_nm > line.optimal_nm)
    assert np.all(np.abs(power(line.zero_nm)) < 1e-3 * np.abs(best))
    still = ideal.lines(drive, motor, inverter, np.array([1e-4]))
    assert still.optimal_nm == still.zero_nm == np.zeros(1)


@pytest.mark.parametrize("path", SALIENT, ids=lambda path: path.stem)
def test_stop_and_cycle_of_a_salient_motor_return_the_energy_of_the_minimum_loss_current(
    path: Path,
) -> None:
    drive = schema.load(path)
    made, motor, inverter = (
        ideal.production(drive),
        models.machine(drive, 60.0),
        models.bridge(drive),
    )
    speed = np.linspace(0.05, 1.0, 20) * drive.motor.max_speed_rpm * math.pi / 30.0
    limit = braking.torque_limit_nm(drive, speed)
    best = joint.best_braking(
        motor, inverter, speed * motor.pole_pairs, current_audit.relaxed(drive), limit
    ).state.dc_power_w
    torque = made.capability_nm(drive, motor, inverter, speed)
    assert np.all(
        made.state(motor, inverter, speed, -torque).dc_power_w <= best + 1e-3 * np.abs(best)
    )
    demand = 0.7 * drive.motor.max_torque_nm
    stopped = ideal.stop(drive, "series_optimal", demand, 20.0, 60.0)
    assert abs(stopped.residual_relative) < 1e-9
    trace = ideal_cycles.load(ideal_cycles.DIRECTORY / "ece15.csv", 30.0)
    free, zero = (
        ideal_cycles.run(drive, trace, "series_optimal", 60.0, made=way).energy_j.battery_returned
        for way in (made, braking.ZERO_D_CURRENT)
    )
    assert free > zero
