# SPDX-License-Identifier: Apache-2.0
"""The examples run as started by a user and give the stated results."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hubsim.engine import ROOT

EXAMPLES = ROOT / "host_sim" / "python" / "examples"


def example(name: str) -> Any:  # noqa: ANN401, a module
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested_and_listed_in_the_readme() -> None:
    found = {path.stem for path in EXAMPLES.glob("*.py")}
    assert found == {"strategies", "own_plant", "own_controller", "motulator_motor"}
    readme = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    assert all(f"{name}.py" in readme for name in found)


def test_an_example_runs_as_a_program_from_any_directory(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLES / "own_plant.py")]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert "mode RUN" in result.stdout


def test_energies_of_the_strategies_are_close_to_the_ideal_stop() -> None:
    """Stored share of the kinetic energy at 40 N m.

    Steady-state figures of regen_table down to standstill. A stop gives up to 1.8 % more: the
    hydraulic brake takes over below the blend-out speed, where 40 N m of the motor cost energy.
    """
    ideal = {"parallel_ratio": 0.149, "parallel_free_travel": 0.743, "series_optimal": 0.756}
    stored = example("strategies").main()
    assert stored.keys() == ideal.keys()
    for strategy, share in ideal.items():
        assert share - 0.002 < stored[strategy] < share + 0.018


@pytest.mark.parametrize(("speed_rad_s", "brake_nm"), [(20.0, 20.0), (35.0, 5.0)])
def test_torque_of_the_example_motor_equals_that_of_the_controllers_model(
    speed_rad_s: float, brake_nm: float
) -> None:
    motor_nm, estimate_nm = example("own_plant").main(speed_rad_s, brake_nm)
    assert motor_nm == pytest.approx(-brake_nm, rel=0.01)
    assert estimate_nm == pytest.approx(motor_nm, rel=0.01)


def test_torque_on_motulators_motor_agrees_within_1_percent() -> None:
    module = example("motulator_motor")
    for (_, brake_nm), torques in zip(module.POINTS, module.main(), strict=True):
        for name in ("command", "estimate", "motulator", "bench"):
            assert torques[name] == pytest.approx(-brake_nm, rel=0.01), name


def test_a_textbook_controller_stops_the_vehicle_within_tolerance_of_the_firmware() -> None:
    """Both brake with 60 N m from 30 km/h; the firmware limits the rate of its demand.

    A quarter of the vehicle, 165 kg on a wheel of 0.25 m, stops in 165 v^2 r / 2 / 60 N m.
    """
    found = example("own_controller").main()
    kinetic_j = 0.5 * 165.0 * (30.0 / 3.6) ** 2
    meant_m = kinetic_j * 0.25 / 60.0
    iron_nm = 2.5  # bound of the additional braking torque (friction, drag)
    for stop in found.values():
        assert meant_m * 60.0 / (60.0 + iron_nm) < stop.distance_m < meant_m * 1.05
        assert 0.2 * kinetic_j < stop.hydraulic_j < 0.5 * kinetic_j
        assert abs(stop.residual_j) < 1e-4 * kinetic_j
    assert found["own"].stored == pytest.approx(found["firmware"].stored, abs=0.02)
