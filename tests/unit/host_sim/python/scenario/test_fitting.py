# SPDX-License-Identifier: Apache-2.0
"""A scenario is fitted to a drive: formulas are worked out, and what a drive lacks is stated."""

import json
import math
from pathlib import Path

import pytest
from hubsim import run, scenario
from hubsim.engine import ROOT
from hubsim.errors import DoesNotApplyError, HubsimError
from hubsim.run import evaluation
from hubsim.scenario import Scenario
from hubsim.scenario.quantities import FIGURES, Quantities
from hubsim_command import Hubsim
from regen_table import schema
from regen_table.schema import Drive

MOTORS = ROOT / "tools" / "motors"
M365 = MOTORS / "public" / "m365.toml"
TURN_RAD_S = math.pi / 30.0  # of one revolution per minute


def fitted(tmp_path: Path, text: str, drive: Drive, **keys: object) -> Scenario:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return scenario.load(str(path), keys, drive)[1]


def test_figures_of_the_paper_s_vehicle(drive: Drive) -> None:
    """Its Tables 1 and 2 by hand; the motor's power is less than torque, optimum and pack."""
    known = Quantities(drive)
    assert known["drive.top_speed_kmh"] == pytest.approx(3.6 * 0.25 * 640.0 * TURN_RAD_S)
    assert known["drive.weight_nm"] == pytest.approx(660.0 * 9.80665 * 0.25 / 4.0)
    fastest_rad_s = 5.0 / 6.0 * 640.0 * TURN_RAD_S
    assert known["drive.motor_brakes_nm"] == pytest.approx(2094.0 / fastest_rad_s)
    speed_m_per_s = 0.25 * 640.0 * TURN_RAD_S
    deceleration = 4.0 * 2094.0 / fastest_rad_s / 0.25 / 660.0
    assert known["drive.stopping_s"] == pytest.approx(speed_m_per_s / deceleration)
    assert known["drive.pack_voltage_v"] == known["drive.full_voltage_v"] == 53.0
    assert known["drive.device_voltage_v"] == 75.0
    assert known["drive.trip_voltage_v"] == pytest.approx(0.98 * 61.8)
    assert (known["drive.hall_sensor"], known["drive.angle_sensor"]) == (1.0, 0.0)
    # Iron resistance 1.5 ohm + 0.006 ohm s times omega, phase EMF omega psi: 3/2 e^2 / (R omega_m).
    omega = 23.0 * 640.0 * TURN_RAD_S
    iron_w = 1.5 * (omega * 0.0204) ** 2 / (1.5 + 0.006 * omega)
    assert known["drive.drag_nm"] == pytest.approx(iron_w / (640.0 * TURN_RAD_S), rel=0.01)
    assert known["drive.motor.pole_pairs"] == 23.0
    assert known["drive.driver.no_other_brake"] == 0.0


def test_the_pack_bounds_what_a_small_motor_brakes() -> None:
    """M365: nine tenths of 8 A at 38.5 V, by 5/6 of 780 r/min, is less than 16 N m and 600 W."""
    known = Quantities(schema.load(M365))
    assert known["drive.pack_voltage_v"] == pytest.approx(36.5 + 0.2 / 0.4 * 4.0)
    at_most = 0.9 * 8.0 * 38.5 / (5.0 / 6.0 * 780.0 * TURN_RAD_S)
    assert known["drive.motor_brakes_nm"] == pytest.approx(at_most)


@pytest.mark.parametrize("path", sorted(MOTORS.rglob("*.toml")), ids=lambda path: path.stem)
def test_every_drive_has_every_figure(path: Path) -> None:
    known = Quantities(schema.load(path))
    assert all(not math.isnan(known[name]) and known[name] >= 0.0 for name in FIGURES)
    assert known["drive.emf_limit_kmh"] > 0.0
    assert known["drive.motor_brakes_nm"] <= known["drive.motor.max_torque_nm"]


def test_formulas_name_the_drive_and_keys_given_before(tmp_path: Path, drive: Drive) -> None:
    text = """
        initial_speed_kmh = "round(0.5 * drive.top_speed_kmh)"
        demand_nm = "drive.motor.max_torque_nm / 2"
        demand_trace_nm = [[0.0, 0.0], [1.0, "3 * scenario.demand_nm"]]
        max_duration_s = "scenario.initial_speed_kmh / 10"
        [plant.battery]
        series_resistance_ohm = "2 * drive.battery.series_resistance_ohm"
        [events.late]
        at_s = "scenario.max_duration_s / 2"
        set.road.slope = "-drive.motor.max_torque_nm / drive.weight_nm"
        [criteria.fast]
        value = "max(vehicle.speed_m_per_s)"
        at_least = "drive.top_speed_kmh / 10"
    """
    found = fitted(tmp_path, text, drive)
    assert (found.initial_speed_kmh, found.demand_nm, found.max_duration_s) == (30.0, 20.0, 3.0)
    assert found.demand_trace_nm == ((0.0, 0.0), (1.0, 60.0))
    assert found.plant["battery.series_resistance_ohm"] == pytest.approx(0.024)
    assert found.events["late"].at_s == 1.5
    slope = found.events["late"].set["road.slope"]
    assert slope == pytest.approx(-40.0 * 4.0 / 0.25 / 660.0 / 9.80665)
    assert found.criteria["fast"].at_least == "drive.top_speed_kmh / 10"
    # A setting of the command line counts, and is no unread key although a trace is given.
    assert fitted(tmp_path, text, drive, demand_nm=10.0).demand_trace_nm == (
        (0.0, 0.0),
        (1.0, 30.0),
    )


def test_formulas_name_the_drive_with_the_scenario_s_changes(tmp_path: Path, drive: Drive) -> None:
    text = """
        demand_nm = "drive.motor.max_torque_nm"
        stop_at_standstill = true
        [drive.motor]
        max_torque_nm = "0.875 * drive.motor.max_torque_nm"
        rated_torque_nm = "0.875 * drive.motor.rated_torque_nm"
    """
    assert fitted(tmp_path, text, drive).demand_nm == 35.0
    path = tmp_path / "mine.toml"
    settings = {("motor", "max_torque_nm"): 32.0}
    assert scenario.load(str(path), {}, drive, settings)[1].demand_nm == 32.0


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ('demand_nm = "drive.motor.max_torqe_nm"', "did you mean drive.motor.max_torque_nm?"),
        ('demand_nm = "2 * scenario.initial_speed_kmh"', "demand_nm: no quantity"),
        ('demand_nm = "-drive.motor.max_torque_nm"', "demand_nm: -40.0 is not accepted"),
        ('needs."x" = "drive.none > 0"', "needs: no quantity 'drive.none'"),
    ],
)
def test_a_wrong_formula_is_one_line(tmp_path: Path, drive: Drive, key: str, message: str) -> None:
    with pytest.raises(HubsimError) as caught:
        fitted(tmp_path, f"{key}\nmax_duration_s = 1.0\n", drive)
    assert str(caught.value).startswith(f"{tmp_path / 'mine.toml'}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_a_scenario_needs_is_asked_of_the_drive(tmp_path: Path, drive: Drive) -> None:
    text = """
        max_duration_s = 1.0
        needs."a hydraulic brake" = "drive.brake.max_hydraulic_torque_nm > 0"
        needs."four wheels" = "drive.vehicle.driven_wheels == 4"
    """
    assert fitted(tmp_path, text, drive).max_duration_s == 1.0
    with pytest.raises(DoesNotApplyError) as caught:
        fitted(tmp_path, text, schema.load(M365))
    assert caught.value.needs == ["a hydraulic brake", "four wheels"]
    assert "mine does not apply to m365, needs: a hydraulic brake, four wheels" in str(caught.value)
    assert fitted(tmp_path, text, schema.load(M365), needs={}).max_duration_s == 1.0


def test_a_criterion_that_does_not_apply_is_stated_and_not_judged(
    tmp_path: Path, drive: Drive
) -> None:
    text = """
        max_duration_s = 0.01
        [criteria.braked]
        value = "max(wheel1.hydraulic_torque_nm)"
        at_least = 1.0
        needs."a hydraulic brake" = "drive.brake.max_hydraulic_torque_nm > 0"
    """
    with_brake = fitted(tmp_path, text, drive)
    result = run.simulate("mine", drive, with_brake, tmp_path, ())
    judged = evaluation.evaluate(with_brake, drive, result)[0]
    assert (judged.applies, judged.passed) == (True, False)
    scooter = schema.load(M365)  # of one wheel: it has no signal of wheel 1 either
    without = fitted(tmp_path, text, scooter)
    result = run.simulate("mine", scooter, without, tmp_path, ())
    stated = evaluation.evaluate(without, scooter, result)[0]
    assert (stated.applies, stated.passed) == (False, True)
    assert stated.remark == "does not apply: needs a hydraulic brake"


def test_the_command_says_why_and_does_not_fail(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim("run", "hill_hold", "--config", "m365", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("hill_hold does not apply to m365, needs: a hydraulic brake")
    found = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert (found["applies"], found["needs"]) == (False, ["a hydraulic brake"])
    done = hubsim("run", "abs_flag", "--config", "m365", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    done = hubsim("compare", "hill_hold", "hill_hold", "--config", "m365")
    assert done.returncode == 2
    assert "hill_hold does not apply to m365" in done.stderr
