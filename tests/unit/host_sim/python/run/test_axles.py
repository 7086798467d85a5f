# SPDX-License-Identifier: Apache-2.0
"""A vehicle whose axles differ: what both files agree on, and limits that both share."""

import re
from pathlib import Path

import numpy as np
import pytest
import unlike_axles
from hubsim import HubsimError, run, scenario
from hubsim.cli import main
from hubsim.run import axles
from hubsim.run.results import RunResult
from hubsim.scenario import overrides
from regen_table import schema
from regen_table.schema import Drive

SIGNALS = ("battery.current_a", "wheel*.motor_torque_nm")
CHARGE_A, DISCHARGE_A = 70.0, 80.0
ROUNDING = 0.005  # of the controllers' estimate of their own current


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return unlike_axles.files(
        tmp_path_factory.mktemp("axles"),
        {"max_charge_current_a": CHARGE_A, "max_discharge_current_a": DISCHARGE_A},
    )


def changed(files: tuple[Path, Path], *settings: str) -> tuple[Drive, Drive]:
    front, rear = (overrides.load_drive(path, overrides.parse(settings)) for path in files)
    return front, rear


def ridden(name: str, drives: tuple[Drive, Drive], **keys: object) -> RunResult:
    front, rear = drives
    title, chosen, beside = scenario.load(name, keys, front)
    return run.simulate(title, front, chosen, beside, SIGNALS, rear=rear)


def column(result: RunResult, name: str) -> np.ndarray:
    return result.rows[:, result.names.index(name)]


def test_a_hard_stop_uses_the_pack_s_charge_limit_fully_and_never_exceeds_it(
    files: tuple[Path, Path],
) -> None:
    """Equal shares leave a tenth of it: 20 N m at 44 rad/s are 0.9 kW, 14 A of the 17.5 A."""
    shared = ridden("stop", changed(files), demand_nm=30.0, initial_speed_kmh=40.0)
    equal = ridden(
        "stop", changed(files, "vehicle.pack_share=0.25"), demand_nm=30.0, initial_speed_kmh=40.0
    )
    most_a, equal_a = (-column(result, "battery.current_a").min() for result in (shared, equal))
    assert 0.97 * CHARGE_A < most_a < (1.0 + ROUNDING) * CHARGE_A
    assert equal_a < 0.93 * CHARGE_A
    assert not shared.faults
    assert shared.stopped
    assert shared.account_j["braking.chemical_j"] < 0.99 * equal.account_j["braking.chemical_j"]
    assert abs(shared.account_j["energy.residual_j"]) < 1e-4 * shared.kinetic_energy_j


def test_the_urban_cycle_uses_the_pack_s_discharge_limit_fully_and_never_exceeds_it(
    files: tuple[Path, Path],
) -> None:
    shared = ridden("ece15", changed(files))
    most_a = column(shared, "battery.current_a").max()
    assert 0.97 * DISCHARGE_A < most_a < (1.0 + ROUNDING) * DISCHARGE_A
    assert not shared.faults
    torques = [np.abs(column(shared, f"wheel{k}.motor_torque_nm")).max() for k in range(4)]
    assert torques[:2] == pytest.approx([2.0 * nm for nm in torques[2:]], rel=0.02)
    assert abs(shared.account_j["energy.residual_j"]) < 1e-4 * shared.account_j["energy.chemical_j"]


def test_each_motor_makes_the_same_part_of_its_torque(files: tuple[Path, Path]) -> None:
    """40 and 20 N m: a third of the mean is moved to the front, 4/3 and 2/3 of it."""
    front, rear = changed(files)
    assert axles.front_bias(front, rear) == pytest.approx(1.0 / 3.0)
    assert axles.driver_parameters(front, rear)["driver.most_drive_nm"] == pytest.approx(30.0)


@pytest.mark.parametrize(
    ("setting", "why"),
    [
        ("battery.capacity_ah=50", "battery.capacity_ah"),
        ("battery.open_circuit_voltage_v=52", "battery.open_circuit_voltage_v"),
        ("vehicle.wheel_radius_m=0.2", "vehicle.wheel_radius_m"),
        ("vehicle.can_base=512", "vehicle.can_base"),
        ("can.vesc_status=10", "can.vesc_status"),
        ("vehicle.pack_share=0.2", "vehicle.pack_share"),
    ],
)
def test_drives_of_two_vehicles_are_refused(
    files: tuple[Path, Path], setting: str, why: str
) -> None:
    rear = overrides.load_drive(files[1], overrides.parse([setting]))
    with pytest.raises(HubsimError, match=re.escape(why)):
        axles.check(schema.load(files[0]), rear)


def test_two_files_on_the_command_line_are_front_and_rear(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    both = [word for path in files for word in ("--config", str(path))]
    short = ["--set", "max_duration_s=0.2", "--set", "stop_at_standstill=false"]
    stop = tmp_path / "stop.json"
    main(["run", "stop", *both, *short, "--set", "demand_nm=5", "--json", str(stop)])
    assert "front, rear" in stop.read_text(encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["run", "stop", *both, "--config", str(files[0])])
    assert "accepted: twice" in capsys.readouterr().err
