# SPDX-License-Identifier: Apache-2.0
"""Drives with a flux map or saturation curves: constants of the controller, answers, refusals."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from regen_table import (
    cli,
    flux_constants,
    image,
    layout,
    mapped_tables,
    points,
    schema,
    stored_flux,
)
from regen_table.errors import ConfigurationError
from regen_table.flux_files import COLUMNS

Array = npt.NDArray[np.float64]
Tree = dict[str, Any]
CONSTANTS = ("flux_linkage_wb", "d_inductance_h", "q_inductance_h")
DRIVE = Path(__file__).resolve().parents[4] / "tools" / "motors" / "ipm400v.toml"
AXIS_D = np.linspace(-2.0, 0.6, 27)  # of the largest phase current
AXIS_Q = np.linspace(-1.0, 1.0, 41)
# 16 bits and 290 points of a flux whose tangent falls by a third over the circle: the straight
# lines of five points would be 1.4 % beside it at most, those of ten 0.3 %.
TORQUE_ERROR = 3e-3


@pytest.fixture
def tree() -> Tree:
    return tomllib.loads(DRIVE.read_text(encoding="utf-8"))


def bent(tree: Tree, i_d: Array | float, i_q: Array | float) -> tuple[Array, Array]:
    """Return fluxes of a motor whose L_q falls to two thirds at the largest current."""
    motor = tree["motor"]
    knee = 0.9 * motor["max_phase_current_a"]
    psi_d = motor["flux_linkage_wb"] + motor["d_inductance_h"] * np.asarray(i_d)
    return psi_d, knee * motor["q_inductance_h"] * np.tanh(np.asarray(i_q) / knee)


def straight(tree: Tree, i_d: Array, i_q: Array) -> tuple[Array, Array]:
    motor = tree["motor"]
    psi_d = motor["flux_linkage_wb"] + motor["d_inductance_h"] * i_d
    return psi_d, motor["q_inductance_h"] * i_q


def mapped(
    tree: Tree, folder: Path, flux: Callable[..., tuple[Array, Array]] = bent, end: float = 1.0
) -> Tree:
    """Return a drive with a map file in place of its constants."""
    most = tree["motor"]["max_phase_current_a"]
    i_d, i_q = np.meshgrid(end * AXIS_D * most, AXIS_Q * most, indexing="ij")
    rows = np.stack([part.ravel() for part in (i_d, i_q, *flux(tree, i_d, i_q))], axis=1)
    path = folder / "map.csv"
    np.savetxt(path, rows, "%.15g", ",", header=",".join(COLUMNS), comments="")
    motor = {key: value for key, value in tree["motor"].items() if key not in CONSTANTS}
    return {**tree, "motor": {**motor, "flux_map": path.name}}


def parsed(tree: Tree, folder: Path) -> schema.Drive:
    return schema.parse(tree, "mapped", "mapped.toml", beside=folder)


def test_a_map_of_constants_makes_the_image_of_the_constants(tree: Tree, tmp_path: Path) -> None:
    found = parsed(mapped(tree, tmp_path, straight), tmp_path)
    for key in CONSTANTS:
        assert getattr(found.motor, key) == pytest.approx(tree["motor"][key], rel=1e-6)
    plain = schema.parse(tree, "mapped", "mapped.toml")
    assert image.build(found) == image.build(plain)
    line = flux_constants.warning(found)
    assert line is not None
    assert "(0.0% of the largest)" in line
    assert flux_constants.warning(plain) is None


def test_constants_leave_the_least_squares_of_flux_and_the_stated_error_of_torque(
    tree: Tree, tmp_path: Path
) -> None:
    """Compared on the circle's half with points drawn evenly by area."""
    drive = parsed(mapped(tree, tmp_path), tmp_path)
    motor, found = drive.motor, flux_constants.of(drive)
    assert found is not None
    rng = np.random.default_rng(5)
    radius = motor.max_phase_current_a * np.sqrt(rng.uniform(size=40000))
    angle = rng.uniform(0.5 * np.pi, 1.5 * np.pi, size=40000)
    i_d, i_q = radius * np.cos(angle), radius * np.sin(angle)
    psi_d, psi_q = bent(tree, i_d, i_q)

    def missed(change: Array) -> float:
        psi, d_h, q_h = np.array([getattr(motor, key) for key in CONSTANTS]) * (1.0 + change)
        return float(np.mean((psi + d_h * i_d - psi_d) ** 2 + (q_h * i_q - psi_q) ** 2))

    for k in range(3):
        step = 0.03 * np.eye(3)[k]
        assert missed(np.zeros(3)) < min(missed(step), missed(-step))
    active = motor.flux_linkage_wb + (motor.d_inductance_h - motor.q_inductance_h) * i_d
    error = 1.5 * motor.pole_pairs * (active * i_q - psi_d * i_q + psi_q * i_d)
    fitted = flux_constants.fit(motor.model_dump(), found)
    largest = np.max(np.abs(1.5 * motor.pole_pairs * (psi_d * i_q - psi_q * i_d)))
    assert abs(fitted.error_nm) == pytest.approx(np.max(np.abs(error)), rel=0.05)
    assert fitted.largest_nm == pytest.approx(largest, rel=0.01)
    assert abs(fitted.error_nm) > 0.01 * fitted.largest_nm


def test_constants_held_are_what_the_motor_does_not_exceed(tree: Tree, tmp_path: Path) -> None:
    """The open circuit's flux; L_d, which does not saturate here, as far as L_q lets it."""
    drive = parsed(mapped(tree, tmp_path), tmp_path)
    own, bounding = tree["motor"], stored_flux.bounding(drive).motor
    assert bounding.flux_linkage_wb == pytest.approx(own["flux_linkage_wb"])
    assert 0.7 * own["d_inductance_h"] < bounding.d_inductance_h < 1.001 * own["d_inductance_h"]
    assert bounding.q_inductance_h < own["q_inductance_h"]


def test_surface_magnets_may_hold_unequal_inductances(paper_tree: Tree, tmp_path: Path) -> None:
    bounding = stored_flux.bounding(parsed(mapped(paper_tree, tmp_path), tmp_path)).motor
    assert bounding.type == "ipmsm"
    assert bounding.q_inductance_h < paper_tree["motor"]["q_inductance_h"]


def test_curves_are_the_motor_whose_fluxes_they_are(tree: Tree, tmp_path: Path) -> None:
    """The chords of the same law: constants as with its map."""
    most = tree["motor"]["max_phase_current_a"]
    current = np.linspace(0.0, most, 30)[1:]
    chord = bent(tree, 0.0, current)[1] / current
    motor = {key: value for key, value in tree["motor"].items() if key != "q_inductance_h"}
    motor["q_inductance_curve_h"] = [
        [float(i), float(h)] for i, h in zip(current, chord, strict=True)
    ]
    found = parsed({**tree, "motor": motor}, tmp_path)
    wanted = parsed(mapped(tree, tmp_path), tmp_path)
    assert found.motor.d_inductance_h == pytest.approx(tree["motor"]["d_inductance_h"], rel=1e-9)
    assert found.motor.q_inductance_h == pytest.approx(wanted.motor.q_inductance_h, rel=2e-3)
    line = flux_constants.warning(found)
    assert line is not None
    assert line.startswith(
        "motor.q_inductance_curve_h: the controller's torque, tables, current loop and"
    )


def test_surface_magnets_with_a_map_have_one_inductance(paper_tree: Tree, tmp_path: Path) -> None:
    motor = parsed(mapped(paper_tree, tmp_path), tmp_path).motor
    assert motor.type == "spmsm"
    assert motor.d_inductance_h == motor.q_inductance_h
    lowest = float(bent(paper_tree, 0.0, motor.max_phase_current_a)[1]) / motor.max_phase_current_a
    assert lowest < motor.q_inductance_h < paper_tree["motor"]["q_inductance_h"]


def test_answers_are_those_of_the_map_with_both_currents_free(tree: Tree, tmp_path: Path) -> None:
    """Torque of the answered currents by the written-down law; no iron loss, so they are i_t."""
    del tree["motor"]["iron_loss_resistance_ohm"]
    drive = parsed(mapped(tree, tmp_path), tmp_path)
    how = points.setting(drive)
    assert how.free_d_current
    torque = -0.4 * drive.motor.max_torque_nm
    record = points.evaluate(drive, 3000.0, torque, drive.motor.reference_temperature_c, how)
    i_d, i_q = record["current_d_a"], record["current_q_a"]
    psi_d, psi_q = bent(tree, i_d, i_q)
    made = 1.5 * drive.motor.pole_pairs * (psi_d * i_q - psi_q * i_d)
    assert made == pytest.approx(torque, rel=1e-3)  # between the map's points
    assert record["residual_w"] == pytest.approx(0.0, abs=1e-6 * abs(record["dc_power_w"]))
    best = points.solve(drive, 3000.0, drive.motor.reference_temperature_c, how)
    assert best["dc_power_w"] <= record["dc_power_w"]
    assert best["torque_zero_nm"] <= best["torque_optimal_nm"] < 0.0


REFUSED: dict[str, tuple[Callable[[Tree], None], str]] = {
    "a constant beside the map": (
        lambda motor: motor.update(q_inductance_h=1e-3),
        "motor.q_inductance_h: accepted: without flux_map, which holds it",
    ),
    "a curve beside the map": (
        lambda motor: motor.update(q_inductance_curve_h=[[0.0, 1e-3]]),
        "motor.q_inductance_curve_h: accepted: without flux_map, which holds it",
    ),
    "no file": (
        lambda motor: motor.update(flux_map="none.csv"),
        "none.csv: file not found",
    ),
    "too much current": (
        lambda motor: motor.update(max_phase_current_a=2.5 * motor["max_phase_current_a"]),
        "accepted: a map up to the largest phase current",
    ),
    "another key that is wrong": (
        lambda motor: motor.update(pole_pairs=0),
        "motor.pole_pairs: 0 is not accepted",
    ),
}


@pytest.mark.parametrize("mistake", REFUSED)
def test_a_drive_whose_map_does_not_fit_is_refused_in_one_line(
    mistake: str, tree: Tree, tmp_path: Path
) -> None:
    change, answer = REFUSED[mistake]
    found = mapped(tree, tmp_path)
    change(found["motor"])
    with pytest.raises(ConfigurationError) as refused:
        parsed(found, tmp_path)
    assert answer in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_map_holds_the_circle_of_the_hottest_magnets_too(tree: Tree, tmp_path: Path) -> None:
    """0.0011/K over 130 K of 66 mWb at 0.37 mH are 25.5 A beyond 200 A."""
    with pytest.raises(ConfigurationError, match=r"-i_d up to 220 A, accepted: .* 225\.5 A$"):
        parsed(mapped(tree, tmp_path, end=0.55), tmp_path)
    assert parsed(mapped(tree, tmp_path, end=0.565), tmp_path).motor.flux_map is not None


CURVES: dict[str, tuple[list[list[float]], str]] = {
    "falling flux": ([[0.0, 1e-3], [400.0, 1e-4], [700.0, 1e-4]], "a flux that rises with i_q"),
    "too short": ([[0.0, 1e-3], [10.0, 9e-4]], "up to 10 A, accepted: a curve up to"),
    "turning back": ([[0.0, 1e-3], [900.0, 9e-4], [800.0, 8e-4]], "currents that rise"),
}


@pytest.mark.parametrize("mistake", CURVES)
def test_a_curve_that_is_no_motor_s_is_refused_in_one_line(
    mistake: str, tree: Tree, tmp_path: Path
) -> None:
    curve, answer = CURVES[mistake]
    motor = {key: value for key, value in tree["motor"].items() if key != "q_inductance_h"}
    with pytest.raises(ConfigurationError) as refused:
        parsed({**tree, "motor": {**motor, "q_inductance_curve_h": curve}}, tmp_path)
    assert str(refused.value).startswith("mapped.toml: motor.q_inductance_curve_h: ")
    assert answer in str(refused.value)


def test_ideal_stops_say_that_they_are_the_constants(
    tree: Tree, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mapped(tree, tmp_path)
    text = DRIVE.read_text(encoding="utf-8")
    lines = [x for x in text.splitlines() if x.partition(" ")[0] not in CONSTANTS]
    lines.insert(lines.index("[motor]") + 1, 'flux_map = "map.csv"')
    path = tmp_path / "drive.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    command = ["stop", str(path), "--initial-speed-kmh", "40", "--demand-nm", "50"]
    assert cli.main(command) == 0
    printed = capsys.readouterr().err
    assert printed.startswith(
        f"{path}: warning: motor.flux_map: the controller's torque, tables, current loop and"
    )
    assert printed.endswith("; these answers are the constants'\n")


def test_torque_of_the_stored_map_is_the_map_s_inside_the_circle(
    tree: Tree, tmp_path: Path
) -> None:
    drive = parsed(mapped(tree, tmp_path), tmp_path)
    stored = stored_flux.of(drive)
    assert stored is not None
    most, pairs = drive.motor.max_phase_current_a, drive.motor.pole_pairs
    rng = np.random.default_rng(3)
    radius, angle = most * np.sqrt(rng.uniform(size=4000)), rng.uniform(0.5, 1.5, 4000) * np.pi
    i_d, i_q = np.minimum(radius * np.cos(angle), 0.0), radius * np.sin(angle)
    psi_d, psi_q = bent(tree, i_d, i_q)
    torque = 1.5 * pairs * (psi_d * i_q - psi_q * i_d)
    error = np.abs(stored.flux.torque_nm(pairs, i_d, i_q) - torque)
    assert np.max(error) < TORQUE_ERROR * np.max(torque)


def test_image_holds_the_points_that_the_map_has_there(
    tree: Tree, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the tables of torque and current are, which take most of an image's time."""
    for table in ("currents", "braking"):
        monkeypatch.setattr(mapped_tables, table, lambda _, of_constants: of_constants)
    drive = parsed(mapped(tree, tmp_path), tmp_path)
    header = layout.load()
    packed: Any = header.ffi.from_buffer("config_t *", image.build(drive))
    bounding = stored_flux.bounding(drive).motor
    assert packed.motor.flux_linkage_nWb == round(bounding.flux_linkage_wb * 1e9)
    assert packed.motor.d_inductance_nH == round(bounding.d_inductance_h * 1e9)
    assert packed.motor.q_inductance_nH == round(bounding.q_inductance_h * 1e9)
    stored = packed.flux_map
    rows, columns = stored.d_points, stored.q_points
    assert rows * columns <= header.constants["CONFIG_FLUX_MAP_POINTS_MAX"]
    i_d = (np.arange(rows) - stored.d_negative_points) * stored.d_step_mA * 1e-3
    i_q = np.arange(columns) * stored.q_step_mA * 1e-3
    lsb_wb = 2.0**stored.lsb_log2 * 1e-9
    inside = i_q <= drive.motor.max_phase_current_a
    wanted = bent(tree, *np.meshgrid(i_d, i_q, indexing="ij"))
    for entries, psi in zip((stored.psi_d_lsb, stored.psi_q_lsb), wanted, strict=True):
        stored = np.array(list(entries)[: rows * columns]).reshape(rows, columns) * lsb_wb
        # The file's own grid is bilinear: 3e-4 of the flux between its 41 points.
        assert stored[:, inside] == pytest.approx(psi[:, inside], abs=3e-4 * float(np.max(psi)))


def test_points_reach_the_current_circle_of_the_hottest_magnets(tree: Tree, tmp_path: Path) -> None:
    found = mapped(tree, tmp_path)
    found["motor"]["flux_temperature_coefficient_per_k"] = -0.0011
    drive = parsed(found, tmp_path)
    stored = stored_flux.of(drive)
    assert stored is not None
    motor = drive.motor
    rise_k = motor.max_winding_temperature_c - motor.reference_temperature_c
    # psi_d is straight: psi + L_d i_d falls by 0.11 % of psi a kelvin.
    magnets, d_inductance = (tree["motor"][key] for key in ("flux_linkage_wb", "d_inductance_h"))
    shift_a = -0.0011 * rise_k * magnets / d_inductance
    assert stored.flux.i_d_a[0] <= -motor.max_phase_current_a + shift_a + 1e-3
    assert stored.flux.i_d_a[stored.d_negative_points] == 0.0
    assert stored.flux.i_d_a[-1] > 0.0


def test_constants_store_no_map(tree: Tree, tmp_path: Path) -> None:
    assert stored_flux.of(schema.load(DRIVE)) is None
    assert stored_flux.of(parsed(mapped(tree, tmp_path, straight), tmp_path)) is None
    assert flux_constants.of(parsed(mapped(tree, tmp_path, straight), tmp_path)) is not None
