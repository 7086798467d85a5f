# SPDX-License-Identifier: Apache-2.0
"""Criteria evaluated on constructed recordings with known results."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hubsim import reasons
from hubsim.errors import HubsimError
from hubsim.run import evaluation
from hubsim.run.evaluation import CriterionResult
from hubsim.run.results import RunResult
from hubsim.scenario import Scenario
from regen_table.schema import Drive

NAMES = [
    "time_s",
    "vehicle.speed_m_per_s",
    "wheel0.motor_torque_nm",
    "wheel1.motor_torque_nm",
    "wheel0.reason",
    "wheel1.reason",
]
TIME = np.arange(0.0, 1.0001, 0.1)
RESULT = RunResult(
    cycle="made up", strategy="series_optimal", vehicle="none", wheels=2, names=NAMES,
    rows=np.stack([TIME, 10.0 - 10.0 * TIME, -20.0 * np.minimum(TIME / 0.5, 1.0),
        -30.0 * np.minimum(TIME / 0.5, 1.0),
                   np.where(TIME > 0.55, 11.0, 0.0), np.zeros(11)], axis=1),
    account_j={"energy.copper_j": 5.0, "energy.turned_over_j": 100.0, "energy.residual_j": 1e-3,
        "energy.chemical_j": -40.0,
               "braking.chemical_j": -40.0, "braking.hydraulic_j": 10.0, "braking.shaft_j": -70.0},
    duration_s=1.0, distance_m=5.0, kinetic_energy_j=100.0, soc=(0.5, 0.6), stopped=True, cpu_s=0.1,
    parameters={"vehicle.mass_kg": 2.0},
)  # fmt: skip


def evaluated(
    drive: Drive,
    result: RunResult = RESULT,
    keys: dict[str, Any] | None = None,
    **criterion: Any,  # noqa: ANN401
) -> CriterionResult:
    chosen = Scenario.model_validate(
        {"max_duration_s": 1.0, "criteria": {"it": criterion}} | (keys or {})
    )
    return evaluation.evaluate(chosen, drive, result)[0]


@pytest.mark.parametrize(
    ("criterion", "passed", "value"),
    [
        ({"value": "max(vehicle.speed_m_per_s)", "at_most": 10.0}, True, 10.0),
        ({"value": "max(vehicle.speed_m_per_s)", "at_most": 9.9}, False, 10.0),
        ({"value": "min(vehicle.speed_m_per_s)", "at_least": 4.99, "until_s": 0.5}, True, 5.0),
        (
            {
                "value": "mean(vehicle.speed_m_per_s)",
                "at_least": 2.0,
                "at_most": 3.0,
                "from_s": 0.5,
            },
            True,
            2.5,
        ),
        ({"value": "min(total(wheels.motor_torque_nm))", "at_most": -49.0}, True, -50.0),
        ({"value": "energy.copper_j / run.kinetic_energy_j", "at_most": 0.05}, True, 0.05),
        ({"value": "run.returned_j", "at_least": 39.0}, True, 40.0),
        ({"value": "plant.vehicle.mass_kg", "at_most": "scenario.max_duration_s * 2"}, True, 2.0),
        (
            {
                "value": "max(wheels.motor_torque_nm)",
                "where": "vehicle.speed_m_per_s < 5.05",
                "at_most": -20.0,
            },
            True,
            -20.0,
        ),
        (
            {
                "value": "max(wheels.motor_torque_nm)",
                "where": "wheels.motor_torque_nm < -25",
                "at_most": -25.0,
            },
            True,
            -30.0,
        ),
        ({"value": "drive.motor.max_torque_nm", "at_least": 40}, True, 40.0),
        ({"value": "run.distance_m / (run.stopped - 1)", "at_most": 1.0}, False, math.inf),
    ],
)
def test_value_is_compared_with_its_limits(
    drive: Drive, criterion: dict[str, Any], passed: bool, value: float
) -> None:
    outcome = evaluated(drive, **criterion)
    assert outcome.passed is passed
    assert outcome.value == pytest.approx(value)


def test_a_window_without_a_row_fails(drive: Drive) -> None:
    outcome = evaluated(drive, value="max(vehicle.speed_m_per_s)", at_most=1e9, from_s=2.0)
    assert not outcome.passed
    assert outcome.remark == "no row in the window"
    assert math.isnan(outcome.value)


@pytest.mark.parametrize(
    ("band", "within_s", "passed", "settled_s"),
    [
        (4.0, 0.45, True, 0.4),
        (4.0, 0.35, False, 0.4),
        (0.1, 0.5, True, 0.5),
        (60.0, 0.0, True, 0.0),
    ],
)
def test_settling_time_is_the_last_time_outside_the_band(
    drive: Drive, band: float, within_s: float, passed: bool, settled_s: float
) -> None:
    outcome = evaluated(
        drive, value="wheel0.motor_torque_nm", settles_to=-20.0, band=band, within_s=within_s
    )
    assert outcome.passed is passed
    assert outcome.value == pytest.approx(settled_s)


def test_a_signal_outside_the_band_at_the_end_has_no_settling_time(drive: Drive) -> None:
    outcome = evaluated(
        drive, value="vehicle.speed_m_per_s", settles_to=5.0, band=1.0, within_s=9.0
    )
    assert not outcome.passed
    assert "never settles" in outcome.remark


def test_all_wheels_must_settle(drive: Drive) -> None:
    assert not evaluated(
        drive, value="wheels.motor_torque_nm", settles_to=-20.0, band=1.0, within_s=1.0
    ).passed


@pytest.mark.parametrize(
    ("criterion", "passed"),
    [
        ({"must_appear": ["BLEND_OUT"]}, True),
        ({"must_appear": ["BLEND_OUT"], "from_s": 0.6, "share": 1.0}, True),
        ({"must_appear": ["BLEND_OUT"], "share": 0.9}, False),
        ({"must_appear": ["ABS"]}, False),
        ({"must_not_appear": ["ABS", "ANY_FAULT"]}, True),
        ({"must_not_appear": ["BLEND_OUT"]}, False),
        ({"must_not_appear": ["BLEND_OUT"], "until_s": 0.5}, True),
        (
            {"must_appear": ["BLEND_OUT"], "must_not_appear": ["NONE"], "from_s": 0.6},
            False,
        ),  # the other wheel shows NONE
    ],
)
def test_reasons_can_be_required_or_excluded(
    drive: Drive, criterion: dict[str, Any], passed: bool
) -> None:
    assert evaluated(drive, reasons="wheels.reason", **criterion).passed is passed


def test_the_energy_residual_is_a_criterion_of_every_evaluated_run(drive: Drive) -> None:
    chosen = Scenario.model_validate(
        {"max_duration_s": 1.0, "criteria": {"it": {"value": "run.distance_m", "at_most": 9}}}
    )
    assert [v.passed for v in evaluation.evaluate(chosen, drive, RESULT)] == [True, True]
    leaking = replace(RESULT, account_j=RESULT.account_j | {"energy.residual_j": 1.1e-2})
    assert [v.passed for v in evaluation.evaluate(chosen, drive, leaking)] == [True, False]


def test_without_criteria_the_evaluation_is_empty(drive: Drive) -> None:
    assert (
        evaluation.evaluate(Scenario.model_validate({"max_duration_s": 1.0}), drive, RESULT) == []
    )


def test_a_criterion_on_a_time_series_without_reduction_is_refused(drive: Drive) -> None:
    with pytest.raises(
        HubsimError,
        match=r"criteria\.it: 'vehicle\.speed_m_per_s' changes over time, accepted: one number",
    ):
        evaluated(drive, value="vehicle.speed_m_per_s", at_most=1.0)


def test_unknown_names_are_refused_before_the_run(drive: Drive) -> None:
    for value, message in (
        (
            "max(vehicle.sped_m_per_s)",
            (
                "criteria.it.value: no quantity 'vehicle.sped_m_per_s', did you mean "
                "vehicle.speed_m_per_s?"
            ),
        ),
        ("plant.vehicle.mas_kg", "did you mean plant.vehicle.mass_kg?"),
        ("colour", "no quantity 'colour', 'hubsim list --signals'"),
    ):
        chosen = Scenario.model_validate(
            {"max_duration_s": 1.0, "criteria": {"it": {"value": value, "at_most": 1}}}
        )
        with pytest.raises(HubsimError) as caught:
            evaluation.signals_of(chosen, drive, NAMES)
        assert message in str(caught.value)


def test_reasons_are_those_of_the_firmware(drive: Drive) -> None:
    from hubsim.engine import Engine  # noqa: PLC0415

    with Engine() as engine:
        assert {engine.reason_text(code) for code in reasons.codes().values()} >= {
            "anti-lock intervention",
            "motor torque limit",
        }
        assert all(
            engine.reason_text(code) != "unknown reason" for code in reasons.codes().values()
        )
    assert reasons.codes()["ABS"] == 16
    assert reasons.meant("ANY_FAULT") == {code for code in reasons.codes().values() if code >= 64}
