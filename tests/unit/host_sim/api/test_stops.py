# SPDX-License-Identifier: Apache-2.0
"""Stops at constant demand.

One wheel is simulated in place of the vehicle; the ideal stop is the upper bound of its energy.
"""

import hubsim
import numpy as np
import pytest
from hubsim import configuration, run, scenario
from hubsim.engine import ROOT
from hubsim.run import stops
from regen_table import ideal, image, joint, models, schema
from regen_table.schema import Drive

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


@pytest.fixture(scope="module")
def drives() -> list[Drive]:
    found = [
        hubsim.load_configuration(LU2013, {"brake.strategy": strategy}).drive
        for strategy in run.STRATEGIES
    ]
    return [drive for drive in found if drive is not None]


def test_images_for_each_strategy_equal_those_of_the_generator(
    drives: list[Drive],
) -> None:
    assert len(drives) == 3
    assert [configuration.image_of(drive) for drive in drives] == [
        image.build(drive) for drive in drives
    ]
    assert len({configuration.image_of(drive) for drive in drives}) == 3


def test_one_wheel_with_its_share_of_the_vehicle_gives_the_same_stop(drives: list[Drive]) -> None:
    for drive, curve in zip(drives, stops.simulate(drives, (15.0, 60.0)), strict=True):
        for demand, stored in zip(curve.demand_nm, curve.stored, strict=True):
            settings = {"initial_speed_kmh": stops.SPEED_KMH, "demand_nm": demand, "drag": False}
            name, chosen, beside = scenario.load("stop", settings)
            whole = run.simulate(name, drive, chosen, beside, ())
            share = whole.account_j["energy.chemical_j"] / whole.account_j["energy.kinetic_j"]
            assert stored == pytest.approx(share, abs=2e-4), (curve.strategy, demand)


def test_simulated_stops_are_close_to_the_ideal_and_series_optimal_stores_the_most(
    drives: list[Drive],
) -> None:
    """The step's own error is below 1e-5 (physics/test_stops.py)."""
    curves = {curve.strategy: curve for curve in stops.simulate(drives)}
    for drive in drives:
        curve = curves[drive.brake.strategy]
        for demand, share, settled in zip(
            curve.demand_nm, curve.stored, curve.settled, strict=True
        ):
            bounds = [
                ideal.stop(
                    drive,
                    curve.strategy,
                    demand,
                    stops.SPEED_KMH,
                    stops.TEMPERATURE_C,
                    battery=battery,
                ).stored_share_of_kinetic
                for battery in ("dynamic", "settled")
            ]
            assert share == pytest.approx(bounds[0], abs=0.01)
            assert np.interp(demand, curve.ideal_demand_nm, curve.ideal) == pytest.approx(
                bounds[0], abs=1e-12
            )
            assert settled == bounds[1]
    for other in ("parallel_ratio", "parallel_free_travel"):
        for best, share in zip(curves["series_optimal"].stored, curves[other].stored, strict=True):
            assert best > share - 1e-5


def test_the_map_equals_the_optimum_of_the_table(drives: list[Drive]) -> None:
    """At 100 and 300 r/min.

    Figures of the steady-state model: optimum, zero at twice its torque, limits of the motor.
    """
    found = stops.optimum_map(drives[2])
    rpm = found.speed_rad_s * 30.0 / np.pi
    assert np.interp([100.0, 300.0], rpm, found.optimal_nm) == pytest.approx(
        [49.60, 148.7], rel=2e-3
    )
    assert np.interp(100.0, rpm, found.zero_nm) == pytest.approx(98.02, rel=2e-3)
    assert np.max(found.limit_nm) == 40.0
    assert found.wheel_radius_m == 0.25


def test_the_map_of_a_salient_motor_uses_the_minimum_loss_d_current() -> None:
    """The scooter near 60 r/min, by brute force over torque.

    Where the current limit is exceeded the line is outside the map.
    """
    drive = schema.load(ROOT / "tools" / "motors" / "scooter48v.toml")
    found = stops.optimum_map(drive)
    motor, inverter = models.machine(drive, found.temperature_c), models.bridge(drive)
    row = int(np.searchsorted(found.speed_rad_s, 60.0 * np.pi / 30.0))
    omega = found.speed_rad_s[row] * drive.motor.pole_pairs
    torques = np.linspace(0.9, 1.1, 41) * found.optimal_nm[row]
    limits = joint.Limits(3.0 * drive.motor.max_phase_current_a)
    power = [
        float(joint.least_power(motor, inverter, omega, -torque, limits).state.dc_power_w)
        for torque in torques
    ]
    assert abs(int(np.argmin(power)) - 20) <= 1
    assert np.all(np.isfinite(found.optimal_nm)) and found.optimal_nm[-1] > found.limit_nm.max()
