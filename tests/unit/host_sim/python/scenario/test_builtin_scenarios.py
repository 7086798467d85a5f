# SPDX-License-Identifier: Apache-2.0
"""Every built-in scenario meets its criteria, and violates them with a changed plant.

A criterion that cannot fail proves nothing.
"""

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from hubsim import scenario

Hubsim = Callable[..., subprocess.CompletedProcess[str]]

# Change of the plant or the events, and the criterion that must fail.
SABOTAGE = {
    "abs_flag": ("plant.driver.demand_age_s=1", "before"),
    "abs_share": ("plant.driver.abs_motor_share=0.6", "half"),
    "accelerator_faults": ("events.shorted.at_s=0.79", "gone"),
    "brake_onset": ("plant.driver.demand_age_s=1", "comes"),
    "brake_pedal_unplugged": ("plant.driver.own_brake_path=0", "taken_over"),
    "brake_over_drive": ("plant.driver.demand_age_s=1", "brakes"),
    "bus_sensor_frozen": ("plant.battery.series_resistance_ohm=0.012", "says_why"),
    "contactor": ("plant.bus.capacitance_f=1e-3", "peak"),
    "contactor_coasting": ("demand_nm=20", "no_drag"),
    "demand_timeout": ("events.silence.until_s=1.05", "gone"),
    "descent_full": ("plant.brake.torque_loss=1", "speed"),
    "direction": ("plant.driver.direction=2", "before"),
    "ece15": ("plant.driver.demand_age_s=1", "follows"),
    "full_midstop": ("plant.bms.peak_charge_a=0", "no_dip"),
    "hall_dropout": ("events.unplugged.at_s=30", "says_why"),
    "hill_hold": ("plant.brake.torque_loss=1", "stands"),
    "hill_start": ("plant.brake.torque_loss=1", "held"),
    "hot_derate": ("plant.brake.torque_loss=1", "torque"),
    "hydraulic_dead": ("events.dead.at_s=50", "dead"),
    "hydraulic_late": ("plant.brake_sensor.fitted=0", "peak"),
    "hydraulic_weak": ("plant.brake_sensor.fitted=0", "peak"),
    "ice_stop": ("plant.anti_lock.active=0", "distance"),
    "lift_off": ("plant.driver.direction=2", "never_back"),
    "lost_braking": ("plant.driver.own_brake_path=0", "taken_over"),
    "lost_pedals": ("demand_nm=0", "never_drives"),
    "low_bus_stop": ("plant.motor.flux_linkage_wb=0.0235", "never_more"),
    "mu_jump": ("plant.brake.hydraulic_time_constant_s=0.2", "surplus"),
    "mu_split": ("plant.wheel2.road_friction=1", "deceleration"),
    "nearly_full": ("plant.battery.series_resistance_ohm=0.03", "stored"),
    "no_other_brake": ("plant.brake.torque_loss=1", "stands"),
    "overspeed": ("slope_percent=0", "speed"),
    "pedal_free_travel": ("plant.pedal_sensors.brake_b_offset=0.07", "no_friction"),
    "pedal_ratio": ("plant.pedal_sensors.brake_a_offset=0.07", "motor"),
    "pedal_series": ("plant.pedal_sensors.brake_a_offset=0.07", "total"),
    "pedal_stab": ("plant.brake.hydraulic_time_constant_s=0.3", "goes"),
    "ramp150": ("plant.motor.phase_resistance_ohm=0.04", "best_power"),
    "reverse": ("plant.motor.flux_linkage_wb=0.015", "speeds_up"),
    "rotor_sensor_lost": ("rotor.observer_takeover=false", "goes_on"),
    "rolling_start": ("initial_speed_kmh=75", "current"),
    "rolling_start_fast": ("plant.motor.flux_linkage_wb=0.03", "current"),
    "stop": ("plant.motor.flux_linkage_wb=0.006", "torque"),
    "udds": ("plant.driver.demand_age_s=1", "follows"),
    "winding_sensor_open": ("plant.thermal.winding_heat_capacity_j_per_k=60", "estimate"),
}
SHORTENED = {
    "udds": ("max_duration_s=60",),
    "ece15": ("max_duration_s=30",),
    "descent_full": ("max_duration_s=10", "initial_soc=1"),
}
BEGINNING = {} if "HUBFOC_FOR_LONG" in os.environ else {"udds": ("max_duration_s=465",)}
"""Of 1 370 s, with the steepest of its accelerations at 455 s; in a long run the whole cycle."""


def evaluated(done: subprocess.CompletedProcess[str], path: Path) -> dict[str, bool]:
    found = json.loads(path.read_text(encoding="utf-8"))
    assert found["passed"] is (done.returncode == 0)
    return {outcome["name"]: outcome["passed"] for outcome in found["criteria"]}


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_criteria_are_met_and_energy_is_conserved(
    hubsim: Hubsim, tmp_path: Path, name: str
) -> None:
    shorter = [part for short in BEGINNING.get(name, ()) for part in ("--set", short)]
    done = hubsim("run", name, *shorter, "--json", "out.json")
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    criteria = evaluated(done, tmp_path / "out.json")
    assert all(criteria.values())
    assert set(criteria) == {*scenario.load(name, {})[1].criteria, "residual"}
    assert (
        json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))["residual_relative"] <= 1e-4
    )
    assert "never came" not in done.stderr


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_criteria_fail_in_a_simulation_that_violates_them(
    hubsim: Hubsim, tmp_path: Path, name: str
) -> None:
    setting, criterion = SABOTAGE[name]
    shorter = [part for short in SHORTENED.get(name, ()) for part in ("--set", short)]
    done = hubsim("run", name, "--set", setting, *shorter, "--json", "out.json")
    assert done.returncode == 1, done.stdout
    assert not evaluated(done, tmp_path / "out.json")[criterion]
    assert criterion in done.stderr.splitlines()[-1]
