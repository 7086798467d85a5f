# SPDX-License-Identifier: Apache-2.0
"""Whole runs through the package, against figures that do not come from the simulation."""

import dataclasses
import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from hubsim import run, scenario
from hubsim.engine import ROOT
from hubsim.run.results import RunResult, as_json, json_object
from hubsim.run.results import realtime_factor as run_together
from hubsim.scenario import cycles, overrides
from regen_table import models, optimum, schema
from regen_table.schema import Drive

SIGNALS = (
    "time_s",
    "driver.reference_m_per_s",
    "vehicle.speed_m_per_s",
    "battery.chemical_w",
    "wheel0.copper_w",
)
POWER_DENSITY_OF_AIR = 1.204
FOR_LONG = "HUBFOC_FOR_LONG" in os.environ


def with_strategy(drive: Drive, strategy: str) -> Drive:
    data = drive.model_dump()
    data["brake"]["strategy"] = strategy
    return schema.parse(data, drive.name, "test")


def simulate(drive: Drive, name: str, strategy: str, **keys: object) -> RunResult:
    found, loaded, beside = scenario.load(name, keys)
    return run.simulate(found, with_strategy(drive, strategy), loaded, beside, SIGNALS)


def ideal_share(
    drive: Drive, cycle: cycles.Cycle, scale: float, strategy: str, battery_ohm: float
) -> float:
    """Share of braking work stored on a cycle followed exactly, by the steady-state equations."""
    dt = 0.01
    t = np.arange(0.0, cycle.duration_s, dt) + dt / 2.0
    v = np.interp(t, cycle.time_s, cycle.speed_kmh) * scale / 3.6
    a = np.interp(t + dt / 2.0, cycle.time_s, cycle.speed_kmh) - np.interp(
        t - dt / 2.0, cycle.time_s, cycle.speed_kmh
    )
    a *= scale / 3.6 / dt
    vehicle = drive.vehicle
    drag = 0.5 * POWER_DENSITY_OF_AIR * vehicle.drag_coefficient * vehicle.frontal_area_m2 * v * v
    force = vehicle.mass_kg * (a + vehicle.rolling_resistance * 9.80665) + drag
    demand = -force * vehicle.wheel_radius_m / vehicle.driven_wheels
    braking = (demand > 0.0) & (v > 0.0)
    omega = v / vehicle.wheel_radius_m * drive.motor.pole_pairs
    motor, bridge = models.machine(drive, 25.0), models.bridge(drive)
    best = np.maximum(-optimum.closed_form(motor, bridge, omega).torque_optimal_nm, 0.0)
    electric = {
        "parallel_ratio": drive.brake.parallel_electric_share * demand,
        "parallel_free_travel": np.minimum(demand, drive.brake.electric_rated_torque_nm),
        "series_optimal": np.minimum(demand, best),
    }[strategy]
    # Near standstill the motor is blended out to the hydraulic brake; electric braking would draw
    # energy there.
    rpm = v / vehicle.wheel_radius_m * 30.0 / np.pi
    control = drive.control
    electric *= np.clip(
        (rpm - control.handover_end_rpm) / (control.handover_start_rpm - control.handover_end_rpm),
        0.0,
        1.0,
    )
    current = optimum.current_at_zero_d_current(
        motor, omega, -np.minimum(electric, drive.motor.max_torque_nm)
    )
    power = models.evaluate(motor, bridge, omega, 0.0, current).dc_power_w * vehicle.driven_wheels
    chemical = models.battery_steady(
        models.open_circuit_voltage_v(drive), battery_ohm, power
    ).chemical_power_w
    work = demand * v / vehicle.wheel_radius_m * vehicle.driven_wheels
    return float(-np.sum(chemical[braking]) / np.sum(work[braking]))


@pytest.mark.parametrize("strategy", run.STRATEGIES)
def test_energy_stored_over_the_urban_cycle_matches_the_steady_states(
    drive: Drive, strategy: str
) -> None:
    result = simulate(drive, "ece15", strategy)
    cycle = cycles.load("ece15")
    error_kmh = (
        result.signal("vehicle.speed_m_per_s") - result.signal("driver.reference_m_per_s")
    ) * 3.6
    assert np.max(np.abs(error_kmh)) < 2.0  # the regulation's tolerance
    assert result.duration_s == pytest.approx(195.0)
    assert result.distance_m == pytest.approx(0.75 * cycle.distance_m, rel=5e-3)
    assert result.residual_relative < 1e-4
    assert result.faults == []
    # The battery's RC branch (30 s) has no loss in a short braking and its steady-state loss in a
    # long one: the share lies between those two. Driver preview, rounded corners of the trace and
    # brake delays: 1 %.
    series_ohm = drive.battery.series_resistance_ohm
    steady_ohm = series_ohm + drive.battery.polarisation_resistance_ohm
    lowest = ideal_share(drive, cycle, 0.75, strategy, steady_ohm) - 0.01
    highest = ideal_share(drive, cycle, 0.75, strategy, series_ohm) + 0.002
    assert lowest < result.braking_share_stored < highest


def test_the_error_of_the_speed_in_udds_is_small_most_of_the_time(drive: Drive) -> None:
    """Its largest, and that there is no fault, are criteria of the scenario.

    The first minute; in a long run five.
    """
    duration_s = 330.0 if FOR_LONG else 60.0
    result = simulate(drive, "udds", "series_optimal", max_duration_s=duration_s)
    error_kmh = (
        result.signal("vehicle.speed_m_per_s") - result.signal("driver.reference_m_per_s")
    ) * 3.6
    assert np.sqrt(np.mean(error_kmh**2)) < 1.0
    assert result.faults == []
    assert result.residual_relative < 1e-4


# Share of the speed, slope in percent: the first hall edges of a drive-off, and a wheel that
# hangs at an edge, are no lost rotor and no open phase.
@pytest.mark.parametrize(("scale", "slope", "seconds"), [(0.45, 0.0, 30.0), (0.3, 8.0, 195.0)])
def test_a_healthy_scooter_drives_off_without_a_fault(
    scale: float, slope: float, seconds: float
) -> None:
    drive = schema.load(ROOT / "tools" / "motors" / "scooter48v.toml")
    keys = {"speed_scale": scale, "slope_percent": slope, "max_duration_s": seconds}
    result = simulate(drive, "ece15", "series_optimal", **keys)
    assert result.faults == []


def test_a_stop_has_the_kinetic_energy_and_distance_of_the_closed_form(drive: Drive) -> None:
    result = simulate(drive, "stop", "series_optimal", drag=False, demand_nm=60.0)
    assert result.kinetic_energy_j == pytest.approx(0.5 * 660.0 * (40.0 / 3.6) ** 2, rel=1e-12)
    assert result.stopped is True
    deceleration = 4 * 60.0 / 0.25 / 660.0
    assert result.distance_m == pytest.approx(
        (40.0 / 3.6) ** 2 / (2.0 * deceleration), abs=0.15 * 40.0 / 3.6
    )
    assert result.braking_work_j == pytest.approx(result.kinetic_energy_j, rel=1e-4)


def test_energies_of_the_run_object_equal_the_accounts(drive: Drive) -> None:
    result = simulate(drive, "stop", "parallel_ratio", demand_nm=50.0)
    energy = result.run_object["energy_j"]
    a = result.account_j
    assert energy["inverter"] == pytest.approx(
        a["energy.conduction_j"] + a["energy.diode_j"] + a["energy.switching_j"]
    )
    assert energy["traction"] - energy["battery_returned"] == pytest.approx(a["energy.chemical_j"])
    summary = result.summary
    under_way = {"battery": a["energy.polarisation_j"], "copper": a["energy.magnetic_j"]}
    for name in ("copper", "iron", "inverter", "battery", "hydraulic"):
        parts = summary["while_driving_j"][name] + summary["while_braking_j"][name]
        assert parts == pytest.approx(energy[name] + under_way.get(name, 0.0), abs=1e-9)
    heat = sum(
        a[f"energy.{name}_j"]
        for name in (
            "copper",
            "iron",
            "conduction",
            "diode",
            "switching",
            "bearing",
            "hydraulic",
            "battery",
        )
    )
    road = a["energy.drag_j"] + a["energy.rolling_j"]
    gained = a["energy.kinetic_j"] + a["energy.magnetic_j"] + a["energy.polarisation_j"]
    assert a["energy.chemical_j"] == pytest.approx(heat + road + gained, abs=0.1)


def test_the_integral_of_a_recorded_power_is_its_account(drive: Drive) -> None:
    result = simulate(drive, "stop", "series_optimal", demand_nm=40.0, record_interval_s=0.01)
    to_the_last_row = float(np.sum(result.signal("battery.chemical_w")) * 0.01)
    assert to_the_last_row == pytest.approx(
        result.account_j["energy.chemical_j"], abs=20.0
    )  # the last row to the end


def test_controller_fault_is_reported_with_reason_and_time(drive: Drive) -> None:
    name, loaded, beside = scenario.load(
        "stop", {"demand_nm": 40.0, "max_duration_s": 1.0, "stop_at_standstill": False}
    )
    result = run.simulate(name, drive, loaded, beside, (), {"fault.phase_open": 1.0})
    assert {fault.wheel for fault in result.faults} == {0, 1, 2, 3}
    assert {fault.reason for fault in result.faults} == {
        "phase wire or switch open: no current where one is wanted"
    }


def test_a_detuned_plant_does_not_change_the_controllers_configuration(drive: Drive) -> None:
    name, loaded, beside = scenario.load("stop", {"demand_nm": 40.0})
    plain = run.simulate(name, drive, loaded, beside, ())
    detuned = run.simulate(name, drive, loaded, beside, (), {"motor.phase_resistance_ohm": 0.062})
    ratio = detuned.account_j["energy.copper_j"] / plain.account_j["energy.copper_j"]
    assert ratio == pytest.approx(2.0, rel=0.03)  # the same currents through twice the resistance


def test_a_long_recording_is_decimated_for_the_report(drive: Drive) -> None:
    result = simulate(drive, "stop", "series_optimal", record_interval_s=1e-3)
    assert len(result.rows) > 4000
    assert len(result.time_s) <= 4000
    assert all(len(values) == len(result.time_s) for values in result.signals.values())


def test_a_cycle_file_in_the_directory_of_the_scenario_is_used(
    drive: Drive, tmp_path: Path
) -> None:
    (tmp_path / "hop.csv").write_text(
        "time_s,speed_km_h\n0,0\n1,0\n5,12\n8,12\n12,0\n14,0\n", encoding="utf-8"
    )
    (tmp_path / "hop.toml").write_text('cycle = "hop.csv"\n', encoding="utf-8")
    name, loaded, beside = scenario.load(str(tmp_path / "hop.toml"), {})
    result = run.simulate(name, drive, loaded, beside, SIGNALS)
    assert result.cycle == "hop"
    assert result.distance_m == pytest.approx((4 * 6 + 3 * 12 + 4 * 6) / 3.6, rel=0.01)


@pytest.mark.parametrize("cpu_s", [0.0, 5e-324, 1e-300, -1e-6])
def test_a_zero_run_time_gives_no_infinity_in_the_json(drive: Drive, cpu_s: float) -> None:
    """On a loaded machine the processor time of a short thread can be zero."""
    reference = simulate(drive, "stop", "series_optimal", max_duration_s=0.1)
    result = dataclasses.replace(reference, cpu_s=cpu_s)
    found = json.loads(as_json(json_object(result)))
    assert found["realtime_factor"] == 0.0
    assert math.isfinite(run_together([reference, result])) and run_together([result]) == 0.0


EFFECTS = {
    "motor.d_saturation_current_a": 150.0,
    "motor.q_saturation_current_a": 120.0,
    "motor.cross_saturation": 0.6,
    "motor.magnet_bias_current_a": 25.0,
    "motor.cogging_torque_nm": 0.5,
    "motor.cogging_per_turn": 276.0,
    "sensors.sampling_delay_s": 0.5e-6,
    "sensors.shunt_settling_s": 0.3e-6,
    "winding_sensor.lag_s": 3.0,
    "winding_sensor.offset_k": 2.0,
    "wheel_speed.teeth": 96.0,
    "wheel_speed.clock_s": 1e-5,
    "wheel_speed.lowest_rad_per_s": 2.0,
    "anti_lock.active": 1.0,
}
SHORTER = {
    "udds": {"max_duration_s": 60.0},
    "ece15": {"max_duration_s": 30.0},
    "descent_full": {"max_duration_s": 20.0},
}


DIFFERENT = (
    *("abs_flag", "bus_sensor_frozen", "contactor", "full_midstop", "hall_dropout", "hill_start"),
    *("hydraulic_weak", "mu_jump", "mu_split", "reverse", "rolling_start_fast", "stop"),
)
"""Braking and driving, slopes, slip, no battery and a full one, faults of sensors and brake."""


@pytest.mark.parametrize("name", scenario.builtin_names() if FOR_LONG else DIFFERENT)
def test_energy_is_conserved_in_scenarios_with_every_effect_on(drive: Drive, name: str) -> None:
    _, loaded, beside = scenario.load(name, SHORTER.get(name, {}))
    changed = overrides.changed(drive, loaded.drive_changes, name)
    with_effects = run.simulate(name, changed, loaded, beside, (), EFFECTS)
    assert with_effects.residual_relative <= 1e-4
    assert with_effects.parameters["motor.cogging_torque_nm"] == EFFECTS["motor.cogging_torque_nm"]


@pytest.mark.parametrize(
    "effect",
    [name for name in EFFECTS if name.startswith(("motor.q_sat", "motor.cogging_t", "sensors."))],
)
def test_effects_are_selected_by_name(drive: Drive, effect: str) -> None:
    """Each effect alone changes the run; switched off, its other parameters do not."""
    name, loaded, beside = scenario.load("stop", {"max_duration_s": 1.0, "noise": False})
    other = {"motor.cogging_per_turn": 276.0} if "cogging" in effect else {}
    off, on = (
        run.simulate(
            name,
            drive,
            loaded,
            beside,
            ("wheel0.current_q_a", "vehicle.speed_m_per_s"),
            {**other, **more},
        )
        for more in ({}, {effect: EFFECTS[effect]})
    )
    assert not np.array_equal(off.rows, on.rows)
    plain = run.simulate(
        name, drive, loaded, beside, ("wheel0.current_q_a", "vehicle.speed_m_per_s")
    )
    assert np.array_equal(off.rows, plain.rows)
