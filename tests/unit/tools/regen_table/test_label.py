# SPDX-License-Identifier: Apache-2.0
"""A motor's label becomes a drive: the conversions, the commands, and labels of real motors."""

import csv
import io
import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from regen_table import (
    STOP_LIMITS,
    boards,
    cli,
    derived,
    filling,
    generate,
    image,
    label,
    limited_stop,
    points,
    questions,
    schema,
)

MOTORS = Path(__file__).resolve().parents[4] / "tools" / "motors"
ROWS = list(csv.DictReader((MOTORS / "labels.csv").read_text(encoding="utf-8").splitlines()))
LABELS = {row["name"]: row for row in ROWS}
PUBLIC = sorted(path.stem for path in (MOTORS / "public").glob("*.toml"))
OTHERS = [name for name in LABELS if name not in PUBLIC]
ABOUT = ("name", "source")
HOVERBOARD = ["--kv", "16", "--magnets", "30", "--wheel-diameter", "0.165", "--mass", "100"]
HOVERBOARD += ["--cells", "10", "--rated-torque", "6"]
MANY = 3600  # samples of a turn


def new(name: str, path: Path, *options: str) -> int:
    return cli.main(["new", name, *options, "-o", str(path)])


def made(name: str, folder: Path) -> schema.Drive:
    """Return the drive that one command makes of a label."""
    row = LABELS[name]
    options = [
        word
        for option, value in row.items()
        if value and option not in ABOUT
        for word in (f"--{option}", value)
    ]
    path = folder / f"{name}.toml"
    assert new(name, path, *options) == 0
    assert len(path.read_text(encoding="utf-8").splitlines()) <= label.LINES_MAX
    return schema.load(path)


def line_emf_v(flux_wb: float, pole_pairs: int, speed_rpm: float) -> np.ndarray:
    """Return the difference of two phases' EMF over a turn, sines of 120 deg."""
    angle = np.arange(MANY) * 2.0 * math.pi / MANY
    amplitude = flux_wb * pole_pairs * speed_rpm * math.pi / 30.0
    return amplitude * (np.sin(angle) - np.sin(angle - 2.0 * math.pi / 3.0))


def test_at_its_no_load_speed_the_line_emf_peaks_at_the_bus_voltage() -> None:
    flux = label.flux_linkage_wb(16.0, 15, "dc", "sine")
    assert line_emf_v(flux, 15, 16.0 * 36.0).max() == pytest.approx(36.0, rel=1e-5)
    assert flux == pytest.approx(0.02297, rel=1e-3)  # which ODrive's guide measured


@pytest.mark.parametrize("name", ["hoverboard", "leaf"])
def test_at_the_towing_speed_the_line_emf_of_cold_magnets_peaks_at_the_empty_packs_voltage(
    name: str,
) -> None:
    drive = schema.load(name)
    motor = drive.motor
    speed_rpm = derived.towing_speed_m_per_s(drive) / drive.vehicle.wheel_radius_m * 30.0 / math.pi
    cold_k = 25.0 - drive.table.temperature_range_c[0]
    flux = motor.flux_linkage_wb * (
        1.0 - (motor.flux_temperature_coefficient_per_k or 0.0) * cold_k
    )
    emf = line_emf_v(flux, motor.pole_pairs, speed_rpm)
    assert emf.max() == pytest.approx(drive.battery.min_voltage_v, rel=1e-5)
    kmh = speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    printed = generate.report_text(generate.make_report(drive))
    assert f"{name}: towing: up to {kmh:.1f} km/h nothing flows" in printed


def test_volts_rms_between_lines_are_rms_volts() -> None:
    flux = label.flux_linkage_wb(10.0, 23, "line-rms", "sine")
    emf = line_emf_v(flux, 23, 10.0 * 30.0)
    assert math.sqrt(np.mean(emf**2)) == pytest.approx(30.0, rel=1e-9)


def test_of_a_trapezoid_the_fundamental_counts() -> None:
    """Phases with a flat top of 120 deg; the flat top between lines is the bus voltage."""
    angle = np.arange(MANY) * 2.0 * math.pi / MANY
    phase = np.clip(np.arcsin(np.sin(angle)) / (math.pi / 6.0), -1.0, 1.0)
    line = phase - np.roll(phase, MANY // 3)
    fundamental = 2.0 * abs(np.fft.rfft(line)[1]) / MANY / line.max()
    ratio = label.flux_linkage_wb(9.0, 4, "dc", "trapezoid") / label.flux_linkage_wb(
        9.0, 4, "dc", "sine"
    )
    assert ratio == pytest.approx(fundamental, rel=1e-4)


@pytest.mark.parametrize("magnets", ["spmsm", "ipmsm"])
def test_two_wires_show_the_mean_of_both_inductances_twice(magnets: str) -> None:
    """Current in at a and out at b, the rotor at all angles: flux of a minus that of b."""
    d, q = label.phase_inductances_h(500e-6, magnets)
    readings = []
    for theta in np.arange(MANY) * 2.0 * math.pi / MANY:
        shifts = theta - np.array([0.0, 2.0, 4.0]) * math.pi / 3.0
        park = 2.0 / 3.0 * np.array([np.cos(shifts), -np.sin(shifts)])
        back = np.array([np.cos(shifts), -np.sin(shifts)]).T
        flux = back @ np.diag([d, q]) @ park @ np.array([1.0, -1.0, 0.0])
        readings.append(flux[0] - flux[1])
    assert np.mean(readings) == pytest.approx(500e-6)
    assert (q / d == pytest.approx(2.0)) if magnets == "ipmsm" else d == q


def test_star_and_triangle_of_one_line_resistance_are_the_same_motor() -> None:
    """0.12 ohm between wires: a triangle of 0.18 ohm a side, or a star of 0.06 ohm."""
    side = 0.18
    assert side * 2.0 * side / (3.0 * side) == pytest.approx(0.12)
    assert label.phase_resistance_ohm(0.12) == pytest.approx(side / 3.0)


def test_a_phase_current_is_rms_and_its_power_is_that_of_the_torque() -> None:
    """3 E I = T Omega with rms EMF and current."""
    torque = label.rated_torque_nm(20.0, 15, 0.023)
    speed = 30.0
    emf_rms = 0.023 * 15 * speed / math.sqrt(2.0)
    assert 3.0 * emf_rms * 20.0 == pytest.approx(torque * speed)


def test_iron_and_friction_take_the_whole_no_load_loss_at_its_speed() -> None:
    resistance, friction = label.no_load(12.0, 576.0, 15, 0.023)
    omega = 576.0 * math.pi / 30.0
    phase_rms = 0.023 * 15 * omega / math.sqrt(2.0)
    assert 3.0 * phase_rms**2 / resistance + friction * omega == pytest.approx(12.0)


def test_estimates_of_three_public_motors_are_within_a_third() -> None:
    """What the rules were made from, as whole files: resistance by mass, loss by power."""
    for name, motor_kg in (("hoverboard", 2.3), ("mxus3k", 8.5)):
        motor = schema.load(name).motor
        found = label.estimated_resistance_ohm(motor_kg, motor.pole_pairs, motor.flux_linkage_wb)
        assert found == pytest.approx(motor.phase_resistance_ohm, rel=1.0 / 3.0)


# ---- the command ----


def test_everything_missing_is_named_at_once_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("mine", tmp_path / "mine.toml") == 2
    lines = capsys.readouterr().err.splitlines()
    named = [re.match(r"mine: (--[\w-]+): missing, accepted: ", line) for line in lines]
    assert [found[1] for found in named if found] == [
        *("--pole-pairs", "--kv", "--cells", "--rated-torque", "--wheel-diameter", "--mass")
    ]
    assert lines[1].startswith(
        "mine: --kv: missing, accepted: no-load speed per volt, r/min per V;"
    )
    assert lines[4].endswith("outer diameter of the tyre, m")
    assert list(tmp_path.iterdir()) == []


def test_a_label_whose_drive_is_refused_is_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    heavy = [*HOVERBOARD[:-1], "200", "--board", "vesc6_mk3"]
    assert new("mine", tmp_path / "mine.toml", *heavy) == 2
    assert "motor.rated_torque_nm: 200 N m, accepted" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_is_not_written_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("kept")
    assert new("mine", path, *HOVERBOARD) == 2
    assert "exists" in capsys.readouterr().err
    assert path.read_text() == "kept"


def test_what_is_checked_before_it_is_written_is_the_drive_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[schema.Drive] = []
    monkeypatch.setattr(image, "build", built.append)
    assert new("mine", tmp_path / "mine.toml", *HOVERBOARD) == 0
    assert built == [schema.load(tmp_path / "mine.toml")]


def test_what_was_estimated_and_assumed_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    assert new("mine", path, *HOVERBOARD) == 0
    lines = capsys.readouterr().out.splitlines()
    estimated = [line for line in lines if line.startswith("estimated: ")]
    for key in ("phase_resistance_ohm", "d_inductance_h", "iron_loss_resistance_ohm", "board"):
        assert any(key in line for line in estimated)
    drive = schema.load(path)
    printed = [line for line in lines if line.startswith("assumed: ")]
    assert printed == [f"assumed: {found}" for found in filling.assumptions(drive)]
    assert all("; if wrong: " in line for line in printed)


def test_answers_on_a_terminal_make_the_file_that_options_make() -> None:
    given = dict(zip([word[2:] for word in HOVERBOARD[::2]], HOVERBOARD[1::2], strict=True))
    asked: list[str] = []

    def answer(question: str) -> str:
        name = question.partition(" ")[0]
        again = bool(asked) and asked[-1] == name
        asked.append(name)
        return given.get(name, "") if again or name != "mass" else "heavy"

    found = questions.ask({}, answer)
    options = {name.replace("-", "_"): float(value) for name, value in given.items()}
    assert label.short_file("mine", found).text == label.short_file("mine", options).text
    assert asked.count("mass") == 2, "a line that is no number is asked again"
    assert "no-load-rpm" not in asked, "in place of Kv, which is known"


class Terminal(io.StringIO):
    """A stream that a person types into or reads."""

    def isatty(self) -> bool:
        return True


def test_on_a_terminal_only_what_the_options_leave_open_is_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = Terminal()
    monkeypatch.setattr("sys.stdin", Terminal("0.36\n" + 30 * "\n"))
    monkeypatch.setattr("sys.stdout", screen)
    path = tmp_path / "mine.toml"
    assert new("mine", path, *HOVERBOARD, "--at-volt", "36") == 0
    assert screen.getvalue().startswith("Empty: not known.\nline-resistance (between two wires")
    assert schema.load(path).motor.phase_resistance_ohm == 0.18


def test_the_proposed_board_stands_the_pack_and_carries_the_current() -> None:
    for cells in range(1, 120):
        for current in (5.0, 39.0, 100.0, 159.0, 400.0):
            name = label.proposed_board(current, cells)
            fits = [
                board.name
                for board in boards.known().values()
                if board.name != boards.DESCRIPTION
                and 4.2 * cells <= board.voltage_most_v
                and 1.05 * current <= board.current_most_a
            ]
            assert name in fits or (name == label.OWN_BOARD and not fits)


SMALL = {"kv": 9.0, "magnets": 46.0, "cells": 20.0, "wheel_diameter": 0.66, "mass": 100.0}


@pytest.mark.parametrize("rated_nm", [2.0, 4.0, 8.0, 15.0, 40.0, 100.0])
def test_no_board_is_proposed_that_refuses_the_motor(
    rated_nm: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """20 cells take a board of 450 A, which sees a motor of 7 A by 20 codes."""
    options = [
        word
        for option, value in (SMALL | {"rated_torque": rated_nm}).items()
        for word in (f"--{option.replace('_', '-')}", f"{value:g}")
    ]
    assert new("mine", tmp_path / "mine.toml", *options) == 0
    lines = capsys.readouterr().out.splitlines()
    proposed = next(line for line in lines if "inverter.board:" in line)
    board = schema.load(tmp_path / "mine.toml").inverter.board
    assert (board == "mks84_200_hp") == (rated_nm > 10.0)
    assert board is not None or ("own: " in proposed and "not mks84_200_hp" in proposed)
    if board is None:
        path = tmp_path / "other.toml"
        assert new("mine", path, *options, "--board", "mks84_200_hp") == 2
        last = capsys.readouterr().err.splitlines()[-1]
        assert last == f"{path}: --board: mks84_200_hp, accepted for this motor: own"


# ---- labels of real motors ----


def test_every_public_drive_has_a_label_and_every_label_a_source() -> None:
    assert set(PUBLIC) <= set(LABELS)
    assert all(len(row["source"]) > 10 for row in ROWS)


def compared(name: str, folder: Path) -> tuple[list[float], list[float]]:
    """Return T_opt and a stop's stored share, of the whole file and of the label."""
    whole, short = schema.load(name), made(name, folder)
    speed = STOPS_KMH[name] / 3.6 / whole.vehicle.wheel_radius_m * 30.0 / math.pi
    found = []
    for drive in (whole, short):
        how = points.setting(drive, drive.motor.type == "ipmsm", None)
        best = points.solve(drive, speed, 25.0, how)["torque_optimal_nm"]
        at = (drive, "series_optimal", whole.motor.rated_torque_nm, STOPS_KMH[name], 25.0, None)
        stop = limited_stop.stop(*at, tuple(STOP_LIMITS))
        found.append([best, 100.0 * stop.stored_share_of_kinetic])
    return found[0], found[1]


STOPS_KMH = {
    "hoverboard": 15.0,
    "m365": 25.0,
    "mxus3k": 40.0,
    "qs273": 60.0,
    "elaphe700": 60.0,
    "leaf": 60.0,
}


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_drives_label_stores_what_the_readme_says_beside_the_whole_file(
    name: str, tmp_path: Path, validated: Callable[[bytes], str]
) -> None:
    text = (MOTORS / "README.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith(f"| `{name}` |"))
    numbers = [float(cell) for cell in row.split("|")[3:7]]
    whole, short = compared(name, tmp_path)
    assert validated(image.build(schema.load(tmp_path / f"{name}.toml"))) == ""
    assert numbers == pytest.approx([whole[0], short[0], whole[1], short[1]], rel=6e-3, abs=0.06)


@pytest.mark.parametrize("name", OTHERS)
def test_a_real_motors_label_makes_a_table_an_image_and_a_stop(
    name: str, tmp_path: Path, validated: Callable[[bytes], str]
) -> None:
    drive = made(name, tmp_path)
    assert validated(image.build(drive)) == ""
    proposed = drive.inverter.board
    if proposed is not None:
        board = boards.known()[proposed]
        assert drive.battery.max_voltage_v <= board.voltage_most_v
        assert drive.motor.max_phase_current_a <= board.current_most_a
    top_kmh = drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    demand = 0.5 * drive.motor.rated_torque_nm
    at = (drive, "series_optimal", demand, min(0.7 * top_kmh, 40.0), 25.0, None)
    stop = limited_stop.stop(*at, tuple(STOP_LIMITS))
    assert 0.0 < stop.stored_share_of_kinetic < 1.0
    assert tomllib.loads((tmp_path / f"{name}.toml").read_text(encoding="utf-8"))["motor"]
