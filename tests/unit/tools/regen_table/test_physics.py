# SPDX-License-Identifier: Apache-2.0
"""Properties of any correct loss model, for the paper's vehicle and two hundred random drives."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from regen_table import (
    STRATEGIES,
    braking,
    ideal,
    ideal_cycles,
    joint,
    models,
    optimum,
    points,
    schema,
)

Change = Callable[[dict[str, Any]], schema.Drive]
SPEEDS_RPM = (25.0, 50.0, 100.0, 150.0, 300.0, 424.4)
# Derived in the project's notes from circuit laws, with peak flux, and confirmed by a three-phase
# simulation.
T_OPT_NM = (-11.32, -24.19, -49.60, -74.71, -148.7, -208.9)
T_ZERO_NM = (-22.17, -47.59, -98.02, -148.0, -295.7, -415.9)
DEMANDS_NM = (5.0, 20.0, 40.0, 60.0, 120.0)
STORED_PERCENT = {
    "parallel_ratio": (-14.0, 11.2, 14.9, 15.9, 16.0),
    "parallel_free_travel": (63.7, 80.6, 74.3, 49.5, 24.8),
    "series_optimal": (63.7, 81.0, 75.6, 50.4, 25.2),
}


def test_torques_of_the_papers_vehicle_equal_the_hand_derivation(paper: schema.Drive) -> None:
    for speed, optimal, zero in zip(SPEEDS_RPM, T_OPT_NM, T_ZERO_NM, strict=True):
        record = points.solve(paper, speed, 25.0, points.setting(paper))
        assert record["torque_optimal_nm"] == pytest.approx(optimal, rel=5e-4)
        assert record["torque_zero_nm"] == pytest.approx(zero, rel=5e-4)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_energy_of_a_stop_from_40_km_h_equals_the_hand_derivation(
    paper: schema.Drive, strategy: str
) -> None:
    for demand, percent in zip(DEMANDS_NM, STORED_PERCENT[strategy], strict=True):
        result = ideal.stop(paper, strategy, demand, 40.0, 25.0)
        assert 100.0 * result.stored_share_of_kinetic == pytest.approx(percent, abs=0.06)
        assert result.kinetic_energy_j == pytest.approx(0.5 * 660.0 * (40.0 / 3.6) ** 2)
        # s = m v^2 / 2 F, F = 4 T / r
        assert result.stop_distance_m == pytest.approx(
            result.kinetic_energy_j / (4.0 * demand / 0.25)
        )
        assert abs(result.residual_relative) < 1e-9


def test_a_hot_winding_reduces_the_optimal_torque_by_a_quarter(paper: schema.Drive) -> None:
    cold, hot = (
        points.solve(paper, 150.0, warm, points.setting(paper))["torque_optimal_nm"]
        for warm in (25.0, 120.0)
    )
    assert 1.0 - hot / cold == pytest.approx(0.24, abs=0.01)


def random_states(drive: schema.Drive, rng: np.random.Generator) -> models.State:
    motor = models.machine(drive, rng.uniform(-20.0, 150.0, 50))
    omega = (
        drive.motor.max_speed_rpm * math.pi / 30.0 * motor.pole_pairs * rng.uniform(-1.0, 1.0, 50)
    )
    current = drive.motor.max_phase_current_a * rng.uniform(-1.0, 1.0, (2, 50))
    return models.evaluate(motor, models.bridge(drive), omega, current[0], current[1])


def test_the_power_balance_closes_in_every_state(random_drives: list[schema.Drive]) -> None:
    rng = np.random.default_rng(3)
    for drive in random_drives:
        state = random_states(drive, rng)
        sinks = (
            state.loss_copper_w
            + state.loss_iron_w
            + state.loss_inverter_w
            + state.loss_friction_w
            + state.shaft_power_w
        )
        size = (
            np.abs(state.loss_copper_w)
            + np.abs(state.loss_iron_w)
            + np.abs(state.shaft_power_w)
            + np.abs(state.dc_power_w)
        )
        assert np.all(np.abs(state.dc_power_w - sinks) <= 1e-9 * size)
        terminal = 1.5 * (
            state.voltage_d_v * state.current_d_a + state.voltage_q_v * state.current_q_a
        )
        assert np.all(np.abs(terminal - state.motor_power_w) <= 1e-9 * size)


def test_every_loss_is_non_negative(random_drives: list[schema.Drive]) -> None:
    rng = np.random.default_rng(4)
    for drive in random_drives:
        state = random_states(drive, rng)
        for loss in (
            state.loss_copper_w,
            state.loss_iron_w,
            state.loss_inverter_w,
            state.loss_friction_w,
        ):
            assert np.all(loss >= -1e-9 * drive.motor.max_power_w)


def test_battery_balance_closes_and_its_loss_grows_with_power() -> None:
    power = np.linspace(-5000.0, 12000.0, 1001)
    pack = models.battery_steady(53.0, 0.022, power)
    assert np.allclose(pack.terminal_voltage_v * pack.current_a, power, rtol=1e-12, atol=1e-9)
    assert np.allclose(pack.chemical_power_w, power + pack.loss_w, rtol=1e-12, atol=1e-9)
    assert np.all(np.diff(pack.chemical_power_w) > 0.0)
    # Beyond u_oc^2 / (4 R) no current delivers the power.
    edge = 53.0**2 / (4.0 * 0.022)
    assert np.isfinite(models.battery_steady(53.0, 0.022, edge * (1.0 - 1e-9)).current_a)
    assert np.isnan(models.battery_steady(53.0, 0.022, edge * 1.001).current_a)
    assert models.battery_steady(53.0, 0.0, 530.0).current_a == pytest.approx(10.0)


def test_the_battery_does_not_change_the_optimum(change: Change) -> None:
    base = change({})
    others: list[dict[str, Any]] = [
        {"battery.series_resistance_ohm": 0.0, "battery.polarisation_resistance_ohm": 0.0},
        {"battery.series_resistance_ohm": 0.5},
        {"battery.open_circuit_voltage_v": 44.0},
        {"battery.open_circuit_voltage_v": [[0.0, 44.0], [1.0, 57.0]], "battery.initial_soc": 0.3},
    ]
    for changes in others:
        other = change(changes)
        for speed in SPEEDS_RPM:
            a, b = (points.solve(d, speed, 60.0, points.setting(d)) for d in (base, other))
            for key in (
                "torque_optimal_nm",
                "torque_zero_nm",
                "torque_idle_nm",
                "torque_optimal_limited_nm",
                "current_q_a",
                "dc_power_w",
            ):
                assert a[key] == pytest.approx(b[key], rel=1e-9, abs=1e-12)
            assert a["battery_power_w"] != b["battery_power_w"]


def test_the_boundaries_are_ordered_at_every_speed(random_drives: list[schema.Drive]) -> None:
    for drive in random_drives:
        motor = models.machine(drive, np.array([[-20.0], [60.0], [150.0]]))
        omega = (
            drive.motor.max_speed_rpm
            * math.pi
            / 30.0
            * motor.pole_pairs
            * np.linspace(0.0, 1.0, 200)
        )
        best = optimum.closed_form(motor, models.bridge(drive), omega)
        assert np.all(best.torque_zero_nm <= best.torque_optimal_nm)
        assert np.all(best.torque_optimal_nm <= best.torque_idle_nm)
        assert np.all(best.torque_idle_nm <= 0.0)
        strictly = best.possible
        assert np.all(best.torque_zero_nm[strictly] < best.torque_optimal_nm[strictly])
        # The optimum never rises with winding temperature.
        assert np.all(np.diff(np.abs(best.torque_optimal_nm), axis=0) <= 1e-12)


def test_reverse_rotation_is_symmetric_to_forward_rotation(
    random_drives: list[schema.Drive],
) -> None:
    for drive in random_drives[::10]:
        for free in (False, True):
            how = points.setting(drive, free_d_current=free)
            forward, backward = (
                points.solve(drive, sign * 0.4 * drive.motor.max_speed_rpm, 60.0, how)
                for sign in (1.0, -1.0)
            )
            for key in (
                "dc_power_w",
                "loss_copper_w",
                "loss_iron_w",
                "battery_power_w_limited",
                "current_d_a",
            ):
                assert forward[key] == pytest.approx(backward[key], rel=1e-9, abs=1e-9)
            for key in (
                "torque_optimal_nm",
                "torque_zero_nm",
                "torque_idle_nm",
                "torque_optimal_limited_nm",
                "current_q_a",
            ):
                assert forward[key] == pytest.approx(-backward[key], rel=1e-9, abs=1e-9)


def test_without_iron_and_bridge_losses_the_optimum_is_half_of_the_short_circuit_current(
    change: Change,
) -> None:
    drive = change({
        "motor.iron_loss_resistance_ohm": None,
        "inverter.switch_resistance_ohm": 0.0,
        "inverter.diode_resistance_ohm": 0.0,
        "inverter.diode_forward_voltage_v": 0.0,
        "inverter.turn_on_loss_j_per_a": 0.0,
        "inverter.turn_off_loss_j_per_a": 0.0,
    })  # fmt: skip
    for speed in SPEEDS_RPM:
        emf = 0.0204 * speed * math.pi / 30.0 * 23.0
        record = points.solve(drive, speed, 25.0, points.setting(drive))
        assert record["current_q_a"] == pytest.approx(-emf / 0.031 / 2.0, rel=1e-12)
        assert record["dc_power_w"] == pytest.approx(-1.5 * emf**2 / (4.0 * 0.031), rel=1e-12)
        assert record["torque_optimal_nm"] == pytest.approx(
            -1.5 * 23.0 * 0.0204 * emf / 0.062, rel=1e-12
        )
        motor = models.machine(drive, 25.0)
        assert braking.paper_optimum_nm(motor, speed * math.pi / 30.0) == pytest.approx(
            -record["torque_optimal_nm"], rel=1e-12
        )


def test_the_current_of_a_torque_gives_that_torque(random_drives: list[schema.Drive]) -> None:
    for drive in random_drives:
        motor = models.machine(drive, 80.0)
        omega = (
            drive.motor.max_speed_rpm
            * math.pi
            / 30.0
            * motor.pole_pairs
            * np.linspace(-1.0, 1.0, 41)[:, np.newaxis]
        )
        torque = drive.motor.rated_torque_nm * np.linspace(-1.0, 1.0, 21)
        current = optimum.current_at_zero_d_current(motor, omega, torque)
        made = optimum.torque_at_zero_d_current(motor, omega, current)
        assert np.all(np.abs(made - torque) <= 1e-9 * drive.motor.rated_torque_nm)


def test_an_optimised_d_current_never_increases_loss_and_reduces_it_with_saliency(
    random_drives: list[schema.Drive],
) -> None:
    gains = []
    for drive in random_drives[::4]:
        motor, inverter = models.machine(drive, 60.0), models.bridge(drive)
        omega = 0.3 * drive.motor.max_speed_rpm * math.pi / 30.0 * motor.pole_pairs
        torque = drive.motor.rated_torque_nm * np.array([-1.0, -0.5, 0.5, 1.0])
        zero = models.evaluate(
            motor, inverter, omega, 0.0, optimum.current_at_zero_d_current(motor, omega, torque)
        )
        free = joint.least_power(
            motor, inverter, omega, torque, joint.Limits(10.0 * drive.motor.max_phase_current_a)
        )
        assert np.all(free.feasible)
        assert np.all(np.abs(free.torque_nm - torque) <= 1e-6 * drive.motor.rated_torque_nm)
        saved = (zero.dc_power_w - free.state.dc_power_w) / (zero.loss_copper_w + zero.loss_iron_w)
        assert np.all(saved >= -1e-9)
        if drive.motor.type == "ipmsm":
            gains.append(float(saved[-1]))
    assert np.mean(gains) > 0.05


def test_the_gain_of_the_papers_motor_from_a_d_current_is_a_fraction_of_a_per_cent(
    paper: schema.Drive,
) -> None:
    zero, free = (
        points.evaluate(paper, 424.4, -20.0, 25.0, points.setting(paper, free))
        for free in (False, True)
    )
    assert -zero["dc_power_w"] == pytest.approx(762.0, abs=0.5)
    assert zero["dc_power_w"] - free["dc_power_w"] == pytest.approx(1.6, abs=0.05)


def test_limits_apply_to_the_joint_optimum(random_drives: list[schema.Drive]) -> None:
    for drive in random_drives[::5]:
        motor, inverter = models.machine(drive, 60.0), models.bridge(drive)
        omega = (
            drive.motor.max_speed_rpm
            * math.pi
            / 30.0
            * motor.pole_pairs
            * np.linspace(0.05, 1.0, 20)
        )
        bounds = joint.Limits(
            drive.motor.max_phase_current_a, points.setting(drive).phase_voltage_v
        )
        best = joint.best_braking(motor, inverter, omega, bounds, drive.motor.max_torque_nm)
        assert np.all(best.feasible)
        assert np.all(best.state.current_a <= drive.motor.max_phase_current_a * (1.0 + 1e-8))
        assert np.all(best.state.voltage_v <= points.setting(drive).phase_voltage_v * (1.0 + 1e-8))
        assert np.all(np.abs(best.torque_nm) <= drive.motor.max_torque_nm * (1.0 + 1e-8))
        impossible = joint.least_power(
            motor, inverter, omega, 100.0 * drive.motor.max_torque_nm, bounds
        )
        assert not np.any(impossible.feasible)


def test_the_four_regions_are_those_of_figure_5(paper: schema.Drive) -> None:
    motor, inverter = models.machine(paper, 25.0), models.bridge(paper)

    def name(speed_rpm: float, demand: float) -> str:
        return str(braking.region(paper, motor, inverter, speed_rpm * math.pi / 30.0, demand))

    # At 50 r/min T_opt = 24.19 and T_zero = 47.59 N m; at 300 r/min the motor's 40 N m come first.
    assert [name(50.0, demand) for demand in (10.0, 24.1, 24.3, 47.5, 47.7)] == [
        "III",
        "III",
        "II",
        "II",
        "I",
    ]
    assert [name(300.0, demand) for demand in (39.9, 40.1, 200.0)] == ["III", "IV", "IV"]
    # Beyond T_zero, 88.0 N m at 90 r/min, the limits do not matter; down to standstill it is zero.
    assert [name(90.0, demand) for demand in (39.9, 40.1, 87.9, 88.1)] == ["III", "IV", "IV", "I"]
    assert [name(0.0, demand) for demand in (0.0, 0.1, 200.0)] == ["III", "I", "I"]
    # 2094 W at 600 r/min are 33.3 N m.
    assert [name(600.0, demand) for demand in (33.2, 33.4)] == ["III", "IV"]


def test_no_strategy_returns_more_than_series_optimal(random_drives: list[schema.Drive]) -> None:
    for drive in random_drives[::10]:
        top = 0.9 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
        for demand in drive.motor.rated_torque_nm * np.array([0.2, 0.7, 1.5, 4.0]):
            stored = {
                s: ideal.stop(drive, s, float(demand), top, 80.0).stored_share_of_kinetic
                for s in STRATEGIES
            }
            assert stored["series_optimal"] >= max(stored.values()) - 1e-9


def test_scaling_the_optimal_torque_never_returns_more(paper: schema.Drive) -> None:
    motor, inverter = models.machine(paper, 25.0), models.bridge(paper)
    speed = np.linspace(2.0, 60.0, 200)
    best = braking.capability_nm(paper, motor, inverter, speed)
    free = best < braking.torque_limit_nm(paper, speed)
    assert np.any(free)
    power = {
        f: braking.state_of_torque(motor, inverter, speed, -f * best).dc_power_w
        for f in (0.8, 0.9, 1.0, 1.1, 1.2)
    }
    for factor in (0.8, 0.9, 1.1, 1.2):
        assert np.all(power[factor][free] > power[1.0][free])


def test_a_cycle_has_a_closed_balance_and_more_electric_braking_returns_more(
    paper: schema.Drive,
) -> None:
    time = np.array([0.0, 10.0, 20.0, 28.0, 40.0])
    trace = ideal_cycles.Cycle(
        "trapezium", time, np.array([0.0, 10.0, 10.0, 0.0, 0.0]), np.zeros(5)
    )
    results = {s: ideal_cycles.run(paper, trace, s, 25.0) for s in STRATEGIES}
    for result in results.values():
        assert abs(result.residual_relative) < 1e-9
    returned = [results[s].energy_j.battery_returned for s in STRATEGIES]
    assert returned[0] < returned[1] <= returned[2] * (1.0 + 1e-9)
    # The wheels must remove the kinetic energy less the work of drag: 0.5 * 660 kg * 100 m2/s2 =
    # 33 kJ.
    assert 28e3 < results["series_optimal"].energy_j.braking_at_wheels < 33e3


def test_emf_falls_with_temperature_only_with_a_flux_coefficient(change: Change) -> None:
    cold, hot = models.machine(change({}), 20.0), models.machine(change({}), 120.0)
    assert hot.flux_wb == cold.flux_wb
    drive = change({"motor.flux_temperature_coefficient_per_k": -0.0011})
    assert models.machine(drive, 125.0).flux_wb == pytest.approx(0.0204 * 0.89)
    assert models.machine(drive, 25.0).flux_wb == pytest.approx(0.0204)
