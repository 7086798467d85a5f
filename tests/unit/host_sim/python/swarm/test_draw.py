# SPDX-License-Identifier: Apache-2.0
"""Draws: the same from the same seed, of all kinds, within what they promise."""

import itertools
import json

import numpy as np
import pytest
from hubsim.engine import parameters
from hubsim.run import plant
from hubsim.scenario import Scenario, events, faults
from hubsim.swarm import draw, drives, vehicles
from hubsim.swarm.draw import Case, case, straightened
from hubsim.swarm.vehicles import Lot
from hubsim.sweep.drives import DRIVES, drive_named

COUNT = 4  # the drives that come along
MANY = 300


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    return [case(seed, COUNT) for seed in range(MANY)]


def test_a_run_depends_on_its_seed_alone(drawn: list[Case]) -> None:
    again = [case(seed, COUNT) for seed in (250, 3, 77)]
    assert again == [drawn[seed] for seed in (250, 3, 77)]
    assert len({json.dumps(each.data, sort_keys=True) for each in drawn}) == MANY


def test_half_of_the_runs_have_no_fault_and_any_run_can_be_made_healthy(drawn: list[Case]) -> None:
    without = sum(not each.faults for each in drawn)
    assert abs(without - MANY / 2) < 4.0 * (MANY / 4) ** 0.5  # four standard deviations
    for each in drawn[:20]:
        healthy = case(each.seed, COUNT, healthy=True)
        assert healthy.faults == ()
        assert healthy.data["drive_trace_nm"] == each.data["drive_trace_nm"]


def test_faults_of_every_group_come_in_every_way_and_number(drawn: list[Case]) -> None:
    ill = [each for each in drawn if each.faults]
    assert {len(each.faults) for each in ill} == {1, 2, 3}
    groups = {faults.table()[name].group for each in ill for name in each.faults}
    assert groups == {fault.group for fault in faults.table().values()}
    names = [name.partition("-")[2] for each in ill for name in each.data["events"]
             if name.partition("-")[0] in faults.table()]  # fmt: skip
    assert {"", "grows", "0", "1"} <= set(names)
    assert {each.data["plant"]["driver.fault_reset_every_s"] for each in ill} == {0.0, 0.02, 1.0}


def test_no_two_faults_of_a_run_set_the_same_parameter(drawn: list[Case]) -> None:
    for each in drawn:
        several = [
            {*faults.table()[name].sets, *faults.table()[name].needs} for name in each.faults
        ]
        for a, b in itertools.combinations(several, 2):
            assert not a & b


def test_faults_come_with_their_sensors_needs_and_before_the_end(drawn: list[Case]) -> None:
    for each in drawn:
        end_s = each.data["max_duration_s"]
        for name in each.faults:
            fault = faults.table()[name]
            assert each.drive.rotor.sensor in fault.sensors
            assert name not in draw.LEFT_OUT
            assert fault.needs.items() <= each.data["plant"].items()
            assert 0.0 <= each.begins_s(name) <= end_s - draw.LAST_S + 1e-3
            assert not fault.at_start or each.begins_s(name) == 0.0


def test_every_scenario_is_accepted_and_ends(drawn: list[Case]) -> None:
    for each in drawn[:60]:
        found = Scenario.model_validate(each.data)
        assert 15.0 < found.max_duration_s < 150.0
        for event in found.events.values():
            for name, value in event.values.items():
                events.check_parameter(name, value)
        assert each.data["plant"]["bus.capacitance_f"] > 0.0


def test_parts_of_the_plant_are_within_their_tolerances(drawn: list[Case]) -> None:
    for each in drawn[:60]:
        nominal = plant.parameters(each.drive)
        for name, (low, high) in vehicles.FACTORS.items():
            if name != "motor.friction_torque_nm":  # which adds some
                share = each.data["plant"][name] / nominal[name] if nominal[name] else 1.0
                assert low - 1e-5 <= share <= high + 1e-5, name


def test_the_vehicle_that_is_driven_ahead_goes_and_stops(drawn: list[Case]) -> None:
    """Pedals that are pressed: some of each, none beyond its end, brake at the end."""
    for each in drawn[:60]:
        drive = each.drive
        accelerates = max(value for _, value in each.data["drive_trace_nm"])
        brakes = max(value for _, value in each.data["demand_trace_nm"])
        assert 0.0 < accelerates <= drive.motor.max_torque_nm * 1.0001
        assert 0.0 < brakes <= drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
        assert each.data["demand_trace_nm"][-1][1] > 0.0


def test_a_straightened_trace_is_near_and_zero_where_it_was() -> None:
    random = np.random.default_rng(3)
    for _ in range(50):
        time_s = np.linspace(0.0, 7.98, 400)
        values = np.maximum(np.cumsum(random.normal(size=400)), 0.0)
        points = straightened(time_s, values, 0.5)
        line = np.interp(time_s, [t for t, _ in points], [value for _, value in points])
        assert np.max(np.abs(line - values)) <= 0.5 + 1e-3 * np.max(values)
        alone = (values == 0.0) & (np.roll(values, 1) == 0.0) & (np.roll(values, -1) == 0.0)
        assert np.all(line[alone][1:-1] == 0.0)
        assert len(points) < 400


def test_the_population_begins_with_the_drives_that_come_along() -> None:
    assert [drives.numbered(k).name for k in range(4)] == list(DRIVES)
    assert all(drives.numbered(k).drive.vehicle.driven_wheels == 1 for k in range(4))


def test_one_wheel_has_its_share_of_everything() -> None:
    whole = drive_named("lu2013")
    one = drives.numbered(0).drive
    assert one.vehicle.mass_kg == whole.vehicle.mass_kg / 4
    assert one.battery.series_resistance_ohm == whole.battery.series_resistance_ohm * 4
    power_w = one.battery.max_charge_current_a**2 * one.battery.series_resistance_ohm
    all_w = whole.battery.max_charge_current_a**2 * whole.battery.series_resistance_ohm
    assert power_w == pytest.approx(all_w / 4)


def test_draws_of_drives_are_of_every_kind_and_hold_together() -> None:
    several = [drives.drawn(Lot(drives.SEED, k)) for k in range(120)]
    assert drives.drawn(Lot(drives.SEED, 7)) == several[7]
    assert {each["motor"]["name"] for each in several} == {f"drawn {k.name}" for k in drives.KINDS}
    assert {each["rotor"]["sensor"] for each in several} == {"hall", "encoder", "angle"}
    saliency = [
        each["motor"]["q_inductance_h"] / each["motor"]["d_inductance_h"] for each in several
    ]
    assert min(saliency) == 1.0
    assert max(saliency) > 3.24  # that of ipm400v, the most salient one that comes along
    for each, ratio in zip(several, saliency, strict=True):
        motor, inverter = each["motor"], each["inverter"]
        omega = motor["pole_pairs"] * motor["max_speed_rpm"] * np.pi / 30.0
        share = np.sqrt(3.0) * omega * motor["flux_linkage_wb"] / each["battery"]["max_voltage_v"]
        assert 0.4 < share < 2.0
        assert inverter["current_full_scale_a"] > 1.3 * motor["max_phase_current_a"]
        assert ratio <= drives.HALLS_SALIENCY or each["rotor"]["sensor"] != "hall"


def test_a_drawn_drive_is_the_same_with_and_without_what_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept = drives.numbered(5)
    drives.numbered.cache_clear()
    monkeypatch.setenv("HUBFOC_CACHE_DIR", "")
    assert drives.numbered(5) == kept
    drives.numbered.cache_clear()


def test_every_parameter_that_the_judge_asks_for_exists() -> None:
    from hubsim.swarm.ride import LATER  # noqa: PLC0415, here alone

    assert set(LATER) <= set(parameters())
