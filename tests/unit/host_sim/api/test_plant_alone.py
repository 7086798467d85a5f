# SPDX-License-Identifier: Apache-2.0
"""The plant without the firmware: shapes, signs, commands and refused input."""

import hubsim
import numpy as np
import pytest
from hubsim.run import external

LEVEL = np.full((4, 3), 0.5)


@pytest.fixture
def plant(config: hubsim.Configuration) -> hubsim.Plant:
    return hubsim.Plant(config, initial_speed_kmh=20.0, demand_nm=40.0, stop_at_standstill=True)


def test_a_measurement_has_a_row_for_each_wheel(plant: hubsim.Plant) -> None:
    now = plant.measure()
    assert now.phase_current_a.shape == now.phase_current_measured_a.shape == (4, 3)
    for values in (now.rotor_turn, now.speed_rad_s, now.motor_torque_nm, now.hall_state):
        assert values.shape == (4,)
    assert now.time_s == 0.0
    assert now.speed_m_per_s == pytest.approx(20.0 / 3.6)
    assert now.speed_rad_s == pytest.approx(now.speed_m_per_s / plant.get("vehicle.wheel_radius_m"))
    assert now.phase_current_a.sum(axis=1) == pytest.approx(np.zeros(4), abs=1e-9)
    assert now.enable
    assert not now.anti_lock_at_work


def test_a_returned_measurement_is_not_changed_by_later_steps(plant: hubsim.Plant) -> None:
    before = plant.measure()
    turn = before.rotor_turn.copy()
    after = plant.step(LEVEL)
    assert np.array_equal(before.rotor_turn, turn)
    assert after.time_s == pytest.approx(plant.period_s)
    assert not np.array_equal(after.rotor_turn, turn)


def test_active_short_circuit_brakes_and_freewheel_does_not(config: hubsim.Configuration) -> None:
    """In freewheel only iron loss brakes: 3/2 (omega psi)^2 / R_i over the speed."""
    torque_nm = {}
    for bridge in (external.SHORT, external.OFF):
        with hubsim.Plant(config, initial_speed_kmh=20.0, max_duration_s=1.0) as plant:
            for _ in range(2000):
                now = plant.step(LEVEL, bridge=bridge)
            pairs, flux_wb = plant.get("motor.pole_pairs"), plant.get("motor.flux_linkage_wb")
            omega = pairs * now.speed_rad_s
            slope = plant.get("motor.iron_loss_resistance_slope_ohm_s")
            iron_ohm = plant.get("motor.iron_loss_resistance_ohm") + slope * omega
            torque_nm[bridge] = now.motor_torque_nm
    assert np.all(torque_nm[external.SHORT] < -20.0)
    assert torque_nm[external.OFF] == pytest.approx(
        -1.5 * pairs * omega * flux_wb**2 / iron_ohm, rel=0.02
    )


def test_stopping_distance_of_the_hydraulic_brakes_follows_from_mass_and_torque(
    plant: hubsim.Plant,
) -> None:
    with plant:
        while not plant.ended:
            now = plant.step(LEVEL, hydraulic_nm=100.0, bridge=external.OFF)
        assert now.speed_m_per_s <= 0.0
        kinetic_j = 0.5 * plant.get("vehicle.mass_kg") * (20.0 / 3.6) ** 2
        ideal_m = kinetic_j * plant.get("vehicle.wheel_radius_m") / 400.0
        delay_s = plant.get("brake.hydraulic_dead_time_s") + plant.get(
            "brake.hydraulic_time_constant_s"
        )
        assert plant["vehicle.distance_m"] < ideal_m + 2.0 * delay_s * 20.0 / 3.6
        assert plant["energy.hydraulic_j"] == pytest.approx(kinetic_j, rel=0.1)
        with pytest.raises(hubsim.HubsimError, match="has ended"):
            plant.step(LEVEL)


def test_scenario_events_act_on_the_external_bench(config: hubsim.Configuration) -> None:
    with hubsim.Plant(
        config, initial_speed_kmh=20.0, max_duration_s=0.2,
        demand_trace_nm=[[0.0, 0.0], [0.05, 0.0], [0.1, 30.0]],
    ) as plant:  # fmt: skip
        demands = []
        while not plant.ended:
            demands.append(plant.step(LEVEL, bridge=external.OFF).brake_demand_nm)
        assert demands[500] == 0.0
        assert demands[1500] == pytest.approx(15.0, abs=1.0)
        assert demands[-1] == 30.0
        assert len(demands) == 4000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"duty": np.full((4, 3), np.nan)}, "wheel 0"),
        ({"duty": LEVEL, "bridge": 7}, "bridge 0 to 2"),
        ({"duty": LEVEL, "hydraulic_nm": [0.0, -1.0, 0.0, 0.0]}, "wheel 1"),
        ({"duty": np.zeros((2, 3))}, "shape"),
        ({"duty": "full"}, "duty"),
    ],
)
def test_an_invalid_command_is_refused_and_time_does_not_advance(
    plant: hubsim.Plant, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(hubsim.HubsimError, match=message):
        plant.step(**arguments)  # type: ignore[arg-type]
    assert plant.measure().time_s == 0.0


def test_only_delays_of_zero_or_one_period_are_accepted(config: hubsim.Configuration) -> None:
    with pytest.raises(hubsim.HubsimError, match="delay_periods: 2, accepted: 0 or 1"):
        hubsim.Plant(config, delay_periods=2, max_duration_s=1.0)
