# SPDX-License-Identifier: Apache-2.0
"""Loss parameters from measurements whose parameters are known, and what such data cannot tell.

The measurements are made here from the equations of the loss, written down a second time.
"""

import json
import math
import os
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from regen_table import cli, least_squares, loss_fit, loss_report, measured, models, optimum, schema
from regen_table.loss_model import BEND, CONSTANT, COPPER, GROWTH, INVERTER, NAMES, SLOPE
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar, nnls

Array = npt.NDArray[np.float64]
SPEEDS_RPM = (40.0, 90.0, 150.0, 220.0, 300.0, 400.0, 520.0, 650.0)
TORQUES_NM = (3.0, 6.0, 10.0, 15.0, 21.0, 28.0, 36.0)
BOTH_WAYS_NM = (*TORQUES_NM, *(-torque for torque in TORQUES_NM))
RPM = math.pi / 30.0
DRAWS = 40 if "HUBFOC_FOR_LONG" in os.environ else 20


@dataclass(frozen=True)
class Truth:
    copper: float = 0.09
    inverter: float = 0.4
    constant: float = 0.5
    slope: float = 0.02
    bend: float = 0.0
    growth: float = 0.0

    def drag(self, speed: float) -> float:
        return self.constant + self.slope * speed / (1.0 + self.bend * speed)

    def loss(self, speed: float, torque: float) -> float:
        air_gap = abs(torque + self.drag(speed))
        return (
            self.copper * air_gap**2
            + self.growth * air_gap**4
            + self.inverter * air_gap
            + self.drag(speed) * speed
        )

    def value(self, parameter: int) -> float:
        return {
            COPPER: self.copper,
            INVERTER: self.inverter,
            CONSTANT: self.constant,
            SLOPE: self.slope,
            BEND: self.bend,
            GROWTH: self.growth,
        }[parameter]


def losses(
    truth: Truth,
    speeds_rpm: Sequence[float] = SPEEDS_RPM,
    torques_nm: Sequence[float] = BOTH_WAYS_NM,
    noise: Array | None = None,
) -> measured.Losses:
    """Return a map; ``noise`` is relative, a number for each point."""
    places = [(RPM * rpm, torque) for rpm in speeds_rpm for torque in torques_nm]
    speed, torque = np.array(places).T
    loss = np.array([truth.loss(*place) for place in places])
    unknown = np.full(len(places), np.nan)
    return measured.Losses(
        speed_rad_s=speed,
        torque_nm=torque,
        loss_w=loss * (1.0 + (0.0 if noise is None else noise)),
        resolution_w=np.zeros(len(places)),
        switching=np.ones(len(places), dtype=np.bool_),
        current_a=unknown,
        winding_temperature_c=unknown,
    )


def named(found: loss_fit.Fit) -> set[frozenset[str]]:
    return {frozenset(point.parameters) for point in found.cannot_tell}


def written(path: Path, heading: str, rows: Sequence[Sequence[float]]) -> Path:
    lines = [heading, *(",".join(f"{value:.6g}" for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "truth",
    [
        Truth(),
        Truth(bend=0.08, slope=0.2, constant=0.2),
        Truth(growth=2e-5),
        Truth(bend=0.05, slope=0.1, growth=3e-5),
    ],
)
def test_an_exact_map_gives_back_every_parameter_and_no_other(truth: Truth) -> None:
    found = loss_fit.fit(losses(truth))
    for parameter in range(len(NAMES)):
        if truth.value(parameter) > 0.0:
            assert found.value(parameter) == pytest.approx(truth.value(parameter), rel=2e-3)
        elif parameter in found.fitted:
            scale = {BEND: 1e-3, GROWTH: 1e-9}[parameter]
            assert found.value(parameter) < scale


@pytest.mark.parametrize("truth", [Truth(), Truth(bend=0.05, slope=0.1, growth=3e-5)])
def test_true_values_lie_inside_the_standard_deviations_as_often_as_those_of_a_normal_error(
    truth: Truth,
) -> None:
    """Of a normal distribution 68 % lie inside one and 99.7 % inside three deviations.

    The deviations are estimates from 112 residuals; 40 or 20 draws of four or more parameters.
    """
    source = np.random.default_rng(34)
    distances = []
    for _ in range(DRAWS):
        clean = losses(truth)
        found = loss_fit.fit(losses(truth, noise=source.normal(0.0, 0.02, len(clean))))
        distances += [
            (found.value(k) - truth.value(k)) / found.deviations[k]
            for k in found.fitted
            if truth.value(k) > 0.0
        ]
    far = np.abs(distances)
    assert len(far) >= 4 * DRAWS
    assert np.mean(far < 3.0) >= 0.97
    assert 0.58 < np.mean(far < 1.0) < 0.8


def test_errors_of_equal_efficiency_rather_than_of_equal_loss_get_fitting_deviations() -> None:
    """0.2 points of efficiency are 0.2 % of the loss at 50 % and 4 % of it at 95 %."""
    source = np.random.default_rng(35)
    truth, clean = Truth(), losses(Truth())
    errors_w = 0.002 * np.abs(clean.shaft_power_w)
    distances = []
    for _ in range(DRAWS):
        drawn = clean.loss_w + errors_w * source.normal(0.0, 1.0, len(clean))
        found = loss_fit.fit(replace(clean, loss_w=drawn))
        distances += [
            (found.value(k) - truth.value(k)) / found.deviations[k]
            for k in (COPPER, INVERTER, CONSTANT, SLOPE)
        ]
    assert np.mean(np.abs(distances) < 3.0) >= 0.97
    assert 0.55 < np.mean(np.abs(distances) < 1.0) < 0.82


def test_single_wrong_points_move_no_parameter_by_more_than_its_deviation_allows() -> None:
    """Three of 112 points with three times their loss; least squares would follow them."""
    truth = Truth()
    noise = np.random.default_rng(6).normal(0.0, 0.02, len(losses(truth)))
    noise[[5, 50, 90]] = 2.0
    found = loss_fit.fit(losses(truth, noise=noise))
    assert found.scatter < 0.04
    for k in (COPPER, INVERTER, CONSTANT, SLOPE):
        assert abs(found.value(k) - truth.value(k)) < 3.0 * found.deviations[k]
    assert found.value(COPPER) == pytest.approx(truth.copper, rel=0.03)


def test_non_negative_least_squares_are_those_of_lawson_and_hanson() -> None:
    source = np.random.default_rng(5)
    for _ in range(100):
        design = source.normal(0.0, 1.0, (12, 5)) * 10.0 ** source.uniform(-3.0, 3.0, 5)
        wanted = source.normal(0.0, 1.0, 12)
        expected = nnls(design, wanted)[0]
        assert least_squares.non_negative(design, wanted) == pytest.approx(
            expected, rel=1e-6, abs=1e-9 * float(np.max(expected))
        )


def test_one_speed_cannot_tell_a_constant_drag_from_one_that_grows() -> None:
    found = loss_fit.fit(losses(Truth(), speeds_rpm=(200.0,)))
    assert frozenset({"drag_constant_nm", "drag_slope_nm_s"}) in named(found)
    truth = Truth()
    assert found.value(CONSTANT) == pytest.approx(truth.drag(200.0 * RPM), rel=1e-3)
    assert found.value(COPPER) == pytest.approx(truth.copper, rel=1e-2)


def test_one_torque_cannot_tell_the_winding_from_the_inverter() -> None:
    """The drag alone lets the torque in the air gap vary: too little."""
    found = loss_fit.fit(losses(Truth(slope=0.0), torques_nm=(20.0,)))
    pairs = [pair for pair in named(found) if {"copper_w_per_nm2", "inverter_w_per_nm"} <= pair]
    assert pairs


def test_nearly_confounded_parameters_are_named_with_their_correlation() -> None:
    """Between 20 and 24 N m a square and a straight line differ by 2 parts in a thousand."""
    noise = np.random.default_rng(2).normal(0.0, 0.01, 8 * 5)
    found = loss_fit.fit(losses(Truth(), torques_nm=(20.0, 21.0, 22.0, 23.0, 24.0), noise=noise))
    assert frozenset({"copper_w_per_nm2", "inverter_w_per_nm"}) in named(found)
    assert any("correlation -" in point.text for point in found.cannot_tell)


def test_a_no_load_curve_holds_the_drag_and_says_that_it_holds_no_copper(tmp_path: Path) -> None:
    truth = Truth(copper=0.0, inverter=0.0, slope=0.03)
    rows = [(rpm, truth.loss(RPM * rpm, 0.0)) for rpm in SPEEDS_RPM]
    path = written(tmp_path / "no_load.csv", "speed_rpm,no_load_power_w", rows)
    found = loss_fit.fit(measured.load(path))
    assert found.fitted == (CONSTANT, SLOPE)
    assert found.value(CONSTANT) == pytest.approx(truth.constant, rel=1e-3)
    assert found.value(SLOPE) == pytest.approx(truth.slope, rel=1e-3)
    assert frozenset({"copper_w_per_nm2", "inverter_w_per_nm"}) in named(found)
    assert "no row has a torque" in loss_report.text(found)


def test_a_coast_down_holds_the_drag(tmp_path: Path) -> None:
    """The speed by integration of J dOmega/dt = -d, with noise of a tenth of a r/min."""
    truth, inertia = Truth(slope=0.03), 0.5
    time = np.linspace(0.0, 20.0, 2001)
    fallen = solve_ivp(
        lambda _, speed: [-truth.drag(speed[0]) / inertia],
        (0.0, 20.0),
        [60.0],
        t_eval=time,
        rtol=1e-9,
    ).y[0]
    rpm = fallen / RPM + np.random.default_rng(8).normal(0.0, 0.1, len(time))
    path = written(tmp_path / "coast.csv", "time_s,speed_rpm", list(zip(time, rpm, strict=True)))
    found = loss_fit.fit(measured.load(path, inertia))
    for parameter in (CONSTANT, SLOPE):
        error = found.value(parameter) - truth.value(parameter)
        assert abs(error) < 3.0 * found.deviations[parameter] + 2e-3 * truth.value(parameter)
    assert found.deviations[SLOPE] < 0.1 * truth.slope


def test_a_map_and_a_coast_down_together_hold_the_drag_better_than_the_map(tmp_path: Path) -> None:
    truth, inertia = Truth(), 0.5
    decay = truth.slope / inertia
    rest = truth.constant / truth.slope
    time = np.linspace(0.0, 25.0, 1001)
    rpm = ((60.0 + rest) * np.exp(-decay * time) - rest) / RPM  # of a drag linear in the speed
    path = written(tmp_path / "coast.csv", "time_s,speed_rpm", list(zip(time, rpm, strict=True)))
    clean = losses(truth)
    noisy = losses(truth, noise=np.random.default_rng(4).normal(0.0, 0.03, len(clean)))
    alone = loss_fit.fit(noisy)
    both = loss_fit.fit(measured.joined([noisy, measured.load(path, inertia)]))
    assert both.deviations[SLOPE] < 0.7 * alone.deviations[SLOPE]
    assert abs(both.value(SLOPE) - truth.slope) < 3.0 * both.deviations[SLOPE]


def with_currents(factor: float, fall: float, resistance: float) -> measured.Losses:
    """Return a map over currents: T = factor i (1 - fall i^2) - drag, copper loss 1.5 R i^2."""
    truth = Truth(copper=0.0, inverter=0.0)
    rows = []
    for rpm in SPEEDS_RPM:
        for current in (*range(4, 64, 6), *range(-60, 0, 6)):
            drag = truth.drag(RPM * rpm)
            torque = factor * current * (1.0 - fall * current**2) - drag
            loss = 1.5 * resistance * current**2 + drag * RPM * rpm
            rows.append((RPM * rpm, torque, loss, abs(current)))
    speed, torque, loss, current = np.array(rows).T
    return measured.Losses(
        speed, torque, loss, 0.0 * loss, loss > 0.0, current, np.full(len(loss), np.nan)
    )


def test_measured_currents_give_torque_per_ampere_its_fall_and_the_resistance(
    paper: schema.Drive,
) -> None:
    """Torque constant 0.7 N m/A with 23 pole pairs is a flux of 0.7/(1.5 23) Wb.

    Without the currents the same map holds only resistance over the square of the flux.
    """
    points = with_currents(0.7, 3e-5, 0.04)
    found = loss_fit.fit(points)
    assert found.torque_per_ampere is not None
    assert found.torque_per_ampere.factor_nm_per_a == pytest.approx(0.7, rel=1e-6)
    assert found.torque_per_ampere.fall_per_a2 == pytest.approx(3e-5, rel=1e-4)
    assert GROWTH not in found.fitted
    confounded = frozenset({"phase_resistance_ohm", "flux_linkage_wb"})
    assert confounded not in named(found)
    keys = tomllib.loads(loss_report.toml(found, paper))["motor"]
    assert keys["flux_linkage_wb"] == pytest.approx(0.7 / 1.5 / 23.0, rel=1e-4)
    switches = models.bridge(paper).square_w_per_a2 / 1.5
    assert keys["phase_resistance_ohm"] == pytest.approx(0.04 - switches, rel=1e-3)
    blind = loss_fit.fit(replace(points, current_a=np.full(len(points), np.nan)))
    assert confounded in named(blind)
    assert GROWTH in blind.fitted


def test_a_known_winding_temperature_refers_the_copper_loss_to_the_reference() -> None:
    """A winding at 85 degC has 1 + 0.00393 60 times the resistance of 25 degC."""
    hot = losses(Truth(copper=0.09 * (1.0 + 0.00393 * 60.0)))
    by_column = loss_fit.fit(replace(hot, winding_temperature_c=np.full(len(hot), 85.0)))
    by_option = loss_fit.fit(hot, winding_temperature_c=85.0)
    unknown = frozenset({"phase_resistance_ohm", "winding_temperature_c"})
    for found in (by_column, by_option):
        assert found.value(COPPER) == pytest.approx(0.09, rel=1e-3)
        assert unknown not in named(found)
    assert unknown in named(loss_fit.fit(hot))


def test_only_data_that_brake_say_something_of_braking() -> None:
    assert "no row brakes" in loss_report.text(loss_fit.fit(losses(Truth(), torques_nm=TORQUES_NM)))
    assert "no row brakes" not in loss_report.text(loss_fit.fit(losses(Truth())))


@pytest.mark.parametrize("rpm", [60.0, 155.0, 420.0])
def test_best_braking_is_the_closed_form_of_a_quadratic_loss(rpm: float) -> None:
    """x Omega - copper x^2 - inverter x is largest at x = (Omega - inverter)/(2 copper)."""
    truth = Truth()
    best = loss_fit.best_braking(loss_fit.fit(losses(truth)), rpm)
    margin = RPM * rpm - truth.inverter
    assert best.torque_nm == pytest.approx(
        margin / (2.0 * truth.copper) + truth.drag(RPM * rpm), rel=1e-4
    )
    assert best.power_w == pytest.approx(margin**2 / (4.0 * truth.copper), rel=1e-4)


def test_best_braking_of_a_growing_loss_is_its_minimum() -> None:
    truth, rpm = Truth(growth=3e-5, bend=0.05, slope=0.1), 155.0
    best = loss_fit.best_braking(loss_fit.fit(losses(truth)), rpm)
    speed = RPM * rpm
    least = minimize_scalar(
        lambda t: truth.loss(speed, -t) - t * speed, bounds=(1.0, 200.0), method="bounded"
    )
    assert best.torque_nm == pytest.approx(least.x, rel=1e-3)
    assert best.power_w == pytest.approx(-least.fun, rel=1e-4)


def test_no_braking_is_best_where_none_returns_energy() -> None:
    """Below the speed whose EMF is the inverter's drop: Omega < inverter."""
    best = loss_fit.best_braking(loss_fit.fit(losses(Truth())), 0.9 * Truth().inverter / RPM)
    assert (best.torque_nm, best.power_w) == (0.0, 0.0)


def test_the_copper_factor_is_that_of_a_warmer_winding() -> None:
    driving = loss_fit.fit(losses(Truth(growth=2e-5), torques_nm=TORQUES_NM))
    warm = Truth(copper=0.09 * 1.15, growth=2e-5 * 1.15)
    braking = losses(warm, torques_nm=[-t for t in TORQUES_NM])
    factor, deviation = loss_fit.copper_factor(driving, braking)
    assert factor == pytest.approx(1.15, abs=2e-3)
    assert deviation < 2e-3
    assert loss_fit.loss_w(
        driving.with_copper(factor), braking.speed_rad_s, braking.torque_nm
    ) == pytest.approx(braking.loss_w, rel=2e-3)


def circuit_map(drive: schema.Drive) -> list[tuple[float, float, float]]:
    """Return speed, torque and loss of a drive's own circuit with i_d = 0."""
    motor, bridge = models.machine(drive, 25.0), models.bridge(drive)
    rows = []
    for rpm in np.linspace(25.0, 600.0, 9):
        for torque in (*np.linspace(2.0, 40.0, 8), *np.linspace(-40.0, -2.0, 8)):
            omega = RPM * rpm * motor.pole_pairs
            i_q = optimum.current_at_zero_d_current(motor, omega, torque)
            state = models.evaluate(motor, bridge, omega, 0.0, i_q)
            rows.append((rpm, torque, float(state.dc_power_w) - torque * RPM * rpm))
    return rows


def test_the_keys_of_a_map_of_the_paper_s_motor_make_that_motor(
    paper: schema.Drive, paper_tree: dict[str, Any], tmp_path: Path
) -> None:
    """Written into a drive without these numbers they give the losses back.

    Within 1 % at every point: the fit lets the iron loss depend on speed alone, the circuit on
    the flux of the current as well (2.2 V of 21 V at 424 r/min and 20 N m: 1 % of the iron loss).
    """
    rows = circuit_map(paper)
    path = written(tmp_path / "map.csv", "speed_rpm,torque_nm,loss_w", rows)
    out = tmp_path / "keys.toml"
    options = ["--drive", "lu2013", "--winding-temperature-c", "25", "-o", str(out)]
    assert cli.main(["fit", str(path), *options]) == 0
    keys = tomllib.loads(out.read_text(encoding="utf-8"))
    assert keys["motor"]["phase_resistance_ohm"] == pytest.approx(0.031, rel=0.03)
    a0, a1 = keys["motor"]["iron_loss_resistance_ohm"]
    assert (a0, a1) == (pytest.approx(1.5, rel=0.06), pytest.approx(0.006, rel=0.06))
    for section in ("motor", "inverter"):
        paper_tree[section] |= keys[section]
    again = schema.parse(paper_tree, "again", "again.toml")
    motor, bridge = models.machine(again, 25.0), models.bridge(again)
    for rpm, torque, loss in rows:
        speed = RPM * rpm
        air_gap = torque + again.motor.friction_torque_nm
        i_q = optimum.current_at_zero_d_current(motor, speed * motor.pole_pairs, air_gap)
        state = models.evaluate(motor, bridge, speed * motor.pole_pairs, 0.0, i_q)
        assert float(state.dc_power_w) - torque * speed == pytest.approx(loss, rel=0.015)


def test_the_command_leaves_text_keys_json_and_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = losses(Truth(growth=2e-5))
    rows = np.stack([points.speed_rad_s / RPM, points.torque_nm, points.loss_w], axis=1).tolist()
    path = written(tmp_path / "map.csv", "speed_rpm,torque_nm,loss_w", rows)
    made = {name: tmp_path / f"out.{name}" for name in ("toml", "json", "svg", "png")}
    options = ["--drive", "scooter48v", "-o", str(made["toml"]), "--json", str(made["json"])]
    assert cli.main(["fit", str(path), *options, "--picture", str(made["svg"])]) == 0
    assert cli.main(["fit", str(path), "--picture", str(made["png"])]) == 0
    printed = capsys.readouterr().out
    for name in (NAMES[k] for k in (COPPER, INVERTER, CONSTANT, SLOPE, GROWTH)):
        assert f"\n{name} " in printed
    assert "cannot tell: hysteresis and Coulomb friction" in printed
    found = json.loads(made["json"].read_text(encoding="utf-8"))
    assert found["points"] == len(points)
    assert found["driving"] + found["braking"] == len(points)
    assert found["parameters"]["copper_w_per_nm2"]["value"] == pytest.approx(0.09, rel=0.02)
    assert len(found["rows"]) == len(points)
    assert found["residual_of_loss"]["median"] < 1e-3
    assert {"parameters", "text"} == set(found["cannot_tell"][0])
    keys = made["toml"].read_text(encoding="utf-8")
    assert all("  # +- " in line for line in keys.splitlines() if "_loss_j_per_a = " in line)
    assert set(tomllib.loads(keys)) == {"motor", "inverter"}
    ET.fromstring(made["svg"].read_text(encoding="utf-8"))
    assert made["png"].read_bytes().startswith(b"\x89PNG")


def test_the_picture_of_a_curve_without_load_shows_drag(tmp_path: Path) -> None:
    truth = Truth(copper=0.0, inverter=0.0)
    rows = [(rpm, truth.loss(RPM * rpm, 0.0)) for rpm in SPEEDS_RPM]
    path = written(tmp_path / "no_load.csv", "speed_rpm,no_load_power_w", rows)
    picture = tmp_path / "out.svg"
    assert cli.main(["fit", str(path), "--picture", str(picture)]) == 0
    assert "drag of iron and friction" in picture.read_text(encoding="utf-8")


def test_faster_points_are_left_out_on_request(tmp_path: Path) -> None:
    """Above 400 r/min the field is weakened here: the copper loss is five times as large."""
    weak = losses(Truth(copper=0.45), speeds_rpm=(520.0, 650.0))
    whole = measured.joined([losses(Truth(), speeds_rpm=SPEEDS_RPM[:6]), weak])
    rows = np.stack([whole.speed_rad_s / RPM, whole.torque_nm, whole.loss_w], axis=1).tolist()
    path = written(tmp_path / "map.csv", "speed_rpm,torque_nm,loss_w", rows)
    out = tmp_path / "out.json"
    assert cli.main(["fit", str(path), "--max-speed-rpm", "400", "--json", str(out)]) == 0
    copper = json.loads(out.read_text(encoding="utf-8"))["parameters"]["copper_w_per_nm2"]
    assert copper["value"] == pytest.approx(0.09, rel=1e-2)


MAP = "speed_rpm,torque_nm,efficiency_percent\n"
WRONG = {
    "no heading": ("80,3.5,69.8\n", "", "columns speed_rpm, torque_nm and one of"),
    "two powers": ("speed_rpm,torque_nm,loss_w,efficiency_percent\n1,2,3,4\n", "", "and one of"),
    "a column twice": ("speed_rpm,torque_nm,loss_w,loss_w\n1,2,3,4\n", "", "and one of"),
    "a word": (MAP + "80,3.5,69.8\n80,x,70\n", ":3", "torque_nm 'x', accepted: a number from"),
    "a comment before": (MAP + "# bench\n80,3.5,101\n", ":3", "above 0 and below 100 %"),
    "no number": (MAP + "80,nan,50\n", ":2", "torque_nm 'nan', accepted"),
    "standstill": (MAP + "0,3,50\n", ":2", "speed_rpm '0', accepted: a number from"),
    "no torque": (MAP + "80,0,50\n", ":2", "torque_nm '0', accepted: a torque other than zero"),
    "too short": (MAP + "80,3\n", ":2", "2 cells and the heading has 3"),
    "too few": (MAP + "80,3,60\n80,4,60\n", "", "2 points, accepted: at least 3"),
    "a gain": (
        "speed_rpm,torque_nm,electrical_power_w\n100,10,104.7\n",
        ":2",
        "electrical_power_w '104.7', accepted: a power that leaves a loss above 0 W",
    ),
    "no loss": ("speed_rpm,no_load_power_w\n100,0\n", ":2", "accepted: a number above 0 W"),
    "no inertia": ("time_s,speed_rpm\n0,100\n", "", "accepted: together with --inertia-kg-m2"),
    "current": ("speed_rpm,torque_nm,loss_w,current_a\n9,9,9,-1\n", ":2", "from 0 to 1e4 A"),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_wrong_file_is_refused_in_one_line_with_file_line_and_what_is_accepted(
    mistake: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content, line, accepted = WRONG[mistake]
    path = tmp_path / "wrong.csv"
    path.write_text(content, encoding="utf-8")
    out = tmp_path / "out.json"
    assert cli.main(["fit", str(path), "--json", str(out)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{path}{line}: ")
    assert accepted in error
    assert "accepted: " in error
    assert error.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("rows", "line", "accepted"),
    [
        ([(0.01 * k, 500.0) for k in range(200)], 2, "does not fall"),
        ([(0.01 * k, 500.0 - abs(100 - k)) for k in range(200)], 2, "does not fall"),
        ([(0.01 * (k // 2), 500.0 - k) for k in range(200)], 3, "a later time"),
        ([(0.01 * k, 500.0 - k) for k in range(20)], None, "at least 80"),
    ],
)
def test_what_is_no_coast_down_is_refused(
    rows: list[tuple[float, float]],
    line: int | None,
    accepted: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = written(tmp_path / "coast.csv", "time_s,speed_rpm", rows)
    assert cli.main(["fit", str(path), "--inertia-kg-m2", "0.5"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{path}: " if line is None else f"{path}:{line}: ")
    assert accepted in error
    assert error.count("\n") == 1


def test_keys_need_a_drive_and_switches_that_fit_into_the_measured_loss(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = losses(Truth(copper=1e-4))
    rows = np.stack([points.speed_rad_s / RPM, points.torque_nm, points.loss_w], axis=1).tolist()
    path = written(tmp_path / "map.csv", "speed_rpm,torque_nm,loss_w", rows)
    out = tmp_path / "keys.toml"
    assert cli.main(["fit", str(path), "-o", str(out)]) == 2
    assert capsys.readouterr().err == (
        "-o: accepted: together with --drive, of pole pairs and inverter\n"
    )
    assert cli.main(["fit", str(path), "--drive", "lu2013", "-o", str(out)]) == 2
    assert "inverter.switch_resistance_ohm: 0.0033 ohm is more than all" in capsys.readouterr().err
    assert not out.exists()


def test_efficiencies_losses_and_powers_of_one_point_are_the_same_loss(tmp_path: Path) -> None:
    """100 r/min and 9.55 N m are 100 W: 80 % while driving is 125 W in, while braking 80 W out."""
    torque = 30.0 / math.pi
    for sign, electrical, loss in ((1.0, 125.0, 25.0), (-1.0, -80.0, 20.0)):
        for column, value in (
            ("efficiency_percent", 80.0),
            ("electrical_power_w", electrical),
            ("loss_w", loss),
        ):
            for way in (1.0, -1.0):
                path = tmp_path / "point.csv"
                path.write_text(
                    f"speed_rpm,torque_nm,{column}\n{way * 100},{way * sign * torque},{value}\n",
                    encoding="utf-8",
                )
                points = measured.load(path)
                assert points.loss_w == pytest.approx([loss], rel=1e-9)
                assert points.torque_nm == pytest.approx([sign * torque])
                assert points.electrical_power_w == pytest.approx([electrical])


def test_resolution_is_that_of_the_file_s_last_digits(tmp_path: Path) -> None:
    """Driving 10.5 rad/s at 50 %: loss equals shaft power; 0.1 N m of rounding alone is 1.05 W
    uniform, 0.1 % is T Omega/eta^2 0.001; both by sqrt(12)."""
    path = tmp_path / "point.csv"
    path.write_text(f"{MAP}100,8.0,50.0\n100,4,50\n", encoding="utf-8")
    speed = 100.0 * RPM
    expected = math.hypot(speed * 0.1, 8.0 * speed / 0.25 * 0.001) / math.sqrt(12.0)
    assert measured.load(path).resolution_w[0] == pytest.approx(expected)
