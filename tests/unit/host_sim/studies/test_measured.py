# SPDX-License-Identifier: Apache-2.0
"""Public measurements beside the model: the stored table, and known motors in the same files."""

import math
from pathlib import Path

import numpy as np
import published_maps as published
import pytest
from studies import __main__ as command
from studies.measured import maps
from studies.measured import study as measured

RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return published.write_all(tmp_path_factory.mktemp("published") / "data")


@pytest.fixture(scope="module")
def found(data: Path) -> list[measured.Outcome]:
    return [measured.measure(*numbered) for numbered in enumerate(measured.listed(str(data)))]


def the(
    outcomes: list[measured.Outcome], quantity: str, fitted_to: str = "", rpm: float = 0.0
) -> measured.Outcome:
    (one,) = (
        o
        for o in outcomes
        if (o.quantity, o.speed_rpm) == (quantity, rpm) and o.fitted_to in (fitted_to, "nothing")
    )
    return one


# The goals of the study: source of the bounds that its own list must not loosen.
GOALS = {
    (measured.ALONE, measured.MEDIAN_ERROR, 0.0): 0.03,
    (measured.ALONE, measured.PERCENTILE_ERROR, 0.0): 0.08,
    (measured.ALONE, measured.BEST_TORQUE, 80.0): 0.14,
    (measured.ALONE, measured.BEST_TORQUE, 155.0): 0.14,
    (measured.FACTOR, measured.BEST_TORQUE, 80.0): 0.06,
    (measured.FACTOR, measured.BEST_TORQUE, 155.0): 0.02,
    (measured.FACTOR, measured.STOP, 0.0): 0.002,
}


@pytest.mark.parametrize("goal", GOALS, ids=str)
def test_the_stored_table_meets_its_goals(goal: tuple[str, str, float]) -> None:
    fitted_to, quantity, rpm = goal
    stored = [o for o in measured.STUDY.stored() if o.source == measured.WHEEL]
    outcome = the(stored, quantity, fitted_to, rpm)
    assert abs(outcome.error) <= GOALS[goal]
    assert outcome.accepted <= GOALS[goal]


def test_the_stored_table_is_of_every_comparison_and_its_errors_are_those_of_its_columns() -> None:
    stored = measured.STUDY.stored()
    listed = measured.listed("")
    assert [(o.source, o.fitted_to, o.quantity, o.speed_rpm) for o in stored] == [
        (c.source, c.fitted_to, c.quantity, c.speed_rpm) for c in listed
    ]
    for outcome in stored:
        if math.isfinite(outcome.measured):
            error = outcome.predicted / outcome.measured - 1.0
            assert outcome.error == pytest.approx(error, abs=2e-5)


def test_a_motor_of_the_model_s_own_form_is_predicted_but_for_its_warmer_winding(
    found: list[measured.Outcome],
) -> None:
    """Copper loss 1.12 times as large takes 1 - 1/1.12 of T_opt's part in the air gap.

    The fit to the motoring map has the torque of most power at (Omega - inverter)/(2 copper) + drag
    in the air gap less that drag; the copper factor brings it down to that of the braking map.
    """
    factor = the(found, measured.COPPER, measured.ALONE)
    assert factor.measured == pytest.approx(published.WARMER, abs=0.005)
    for rpm in (80.0, 155.0):
        margin = (RPM * rpm - published.INVERTER) / (2.0 * published.COPPER)
        alone = the(found, measured.BEST_TORQUE, measured.ALONE, rpm)
        right = the(found, measured.BEST_TORQUE, measured.FACTOR, rpm)
        assert alone.predicted == pytest.approx(margin + published.DRAG_NM, rel=5e-3)
        warm = margin / published.WARMER + published.DRAG_NM
        assert right.predicted == pytest.approx(warm, rel=5e-3)
        assert right.measured == pytest.approx(warm, rel=5e-3)
        assert 0.08 < alone.error < 0.13
    assert the(found, measured.MEDIAN_ERROR, measured.FACTOR).error < 1e-3
    assert the(found, measured.STOP, measured.FACTOR).error == pytest.approx(0.0, abs=1e-4)
    assert -0.02 < the(found, measured.STOP, measured.ALONE).error < -1e-4


def test_a_mean_error_of_the_power_is_the_missing_copper_loss(
    data: Path, found: list[measured.Outcome]
) -> None:
    """0.12 of the copper loss over the shaft power, the median over the points of the map."""
    torque = np.abs(maps.efficiency_map(maps.BRAKING.under(data), True, 680.0).torque_nm)
    speed = maps.efficiency_map(maps.BRAKING.under(data), True, 680.0).speed_rad_s
    missing = (published.WARMER - 1.0) * published.COPPER * (torque - published.DRAG_NM) ** 2
    median = the(found, measured.MEDIAN_ERROR, measured.ALONE)
    assert median.error == pytest.approx(float(np.median(missing / torque / speed)), rel=0.03)


def test_constant_inductances_make_the_torque_of_a_map_of_constants(
    found: list[measured.Outcome],
) -> None:
    for wanted in measured.FLUX_TORQUES_NM:
        quantity = measured.FLUX_TORQUE.format(wanted)
        torque = the(found, quantity, "magnet flux and two inductances")
        assert torque.error == pytest.approx(0.0, abs=1e-9)
    assert the(found, measured.RECIPROCITY).error == pytest.approx(0.0, abs=1e-12)


def test_the_curve_between_points_is_exact_for_a_parabola() -> None:
    x = np.array([0.0, 1.0, 2.5, 3.0, 5.0])
    where = np.linspace(0.0, 5.0, 41)
    assert measured.curve(x, 2.0 - x + 0.5 * x**2)(where) == pytest.approx(
        2.0 - where + 0.5 * where**2
    )


@pytest.mark.parametrize("source", maps.SOURCES, ids=lambda source: source.path)
def test_a_missing_file_is_named_with_its_source(
    source: maps.Source, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = published.write_all(tmp_path / "data")
    (folder / source.path).unlink()
    assert command.main(["measured", "--data", str(folder), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"study measured: {folder / source.path}: missing, accepted: ")
    assert source.origin in error
    assert error.count("\n") == 1


def test_without_a_folder_the_study_names_what_it_needs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command.main(["measured", "-o", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("study measured: --data: missing, accepted: a folder with ")
    assert all(source.origin in error for source in maps.SOURCES)
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("line", "answer"),
    [("80,3.5", "'80,3.5', accepted: rows of r/min"), ("80,x,70", "torque_nm '-x', accepted")],
)
def test_a_wrong_line_is_named(
    line: str, answer: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = published.write_all(tmp_path / "data")
    path = folder / maps.BRAKING.path
    path.write_text(f"80,5.1,50\n{line}\n", encoding="utf-8")
    arguments = ["--data", str(folder), "--workers", "1", "-o", str(tmp_path / "out")]
    assert command.main(["measured", *arguments]) == 2
    error = capsys.readouterr().err
    assert f"{path}:2: " in error
    assert answer in error
    assert error.count("\n") == 1
