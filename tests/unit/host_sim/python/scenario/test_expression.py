# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hubsim.scenario import expression
from hubsim.scenario.expression import EmptyWindow, ExpressionError, Value

NAN = np.nan
TIME = np.array([0.0, 0.1, 0.2, 0.4])
ROWS = {
    "time_s": TIME,
    "x": np.array([1.0, -3.0, 2.0, 4.0]),
    "part.y_nm": np.array([10.0, 20.0, 30.0, 40.0]),
    "wheels.t": np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]),
    "hole": np.array([NAN, 2.0, NAN, 8.0]),
    "nothing": np.full(4, NAN),
    "two": np.asarray(2.0),
    "": np.diff(TIME, prepend=TIME[:1]),
}


def value(text: str) -> Value:
    return expression.read(text).value(ROWS.__getitem__)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2 * 3 ** 2", 19.0),
        ("-two / 4", -0.5),
        ("max(x)", 4.0),
        ("max(abs(x - 5))", 8.0),
        ("min(part.y_nm) + mean(x)", 11.0),
        ("span(x)", 7.0),
        ("rms(x)", np.sqrt(30.0 / 4.0)),
        ("initial(x)", 1.0),
        ("final(x)", 4.0),
        ("final(wheels.t)", 6.0),
        ("max(total(wheels.t))", 12.0),
        ("max(wheels.t)", 8.0),
        ("at_min(part.y_nm, x)", 20.0),
        ("at_max(part.y_nm, x)", 40.0),
        ("max(change(part.y_nm))", 10.0),
        ("integral(x)", -0.3 + 0.2 + 0.8),  # each value is valid from the previous row to its own
        ("max(min(x, 3))", 3.0),
        ("min(max(x, two, 0))", 2.0),
        ("max(hole)", 8.0),
        ("initial(hole)", 2.0),
        ("integral(hole)", 0.2 + 1.6),
        ("sqrt(16) + exp(0)", 5.0),
        ("max(x)\n  + 1", 5.0),
    ],
)
def test_value_of_a_formula_equals_that_computed_by_hand(text: str, expected: float) -> None:
    found = value(text)
    assert found.shape == ()
    assert float(found) == pytest.approx(expected)


def test_conditions_are_evaluated_per_row() -> None:
    assert value("x > 0 and part.y_nm < 35").tolist() == [True, False, True, False]
    assert value("not x > 0 or part.y_nm == 40").tolist() == [False, True, False, True]


def test_names_in_a_formula_are_extracted_before_evaluation() -> None:
    assert expression.read("max(wheels.t) - part.y_nm / two + part.y_nm").names == (
        "wheels.t",
        "part.y_nm",
        "two",
    )


@pytest.mark.parametrize(
    "text",
    ["max(nothing)", "mean(nothing)", "final(nothing)", "at_min(x, nothing)", "integral(nothing)"],
)
def test_an_empty_window_is_reported(text: str) -> None:
    with pytest.raises(EmptyWindow):
        value(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("max(", "'max(' cannot be read, accepted: a formula like"),
        ("", "is no part of a formula"),
        ("median(x)", "no function 'median', accepted: abs, sqrt"),
        ("at_min(x)", "at_min with 1 arguments, accepted: 2"),
        ("mean(x, x)", "mean with 2 arguments, accepted: 1"),
        ("'text'", "\"'text'\" is no part of a formula, accepted: numbers, names"),
        ("x[0]", "'x[0]' is no part of a formula"),
        ("x if x else x", "is no part of a formula"),
        ("lambda: x", "is no part of a formula"),
        ("(1).real", "is no part of a formula"),
        ("__import__('os')", "no function '__import__'"),
        ("x.__class__()", "is no part of a formula"),
        ("1 < x < 2", "is no part of a formula"),
        ("True", "is no part of a formula"),
        ("1" + "+1" * 600, "longer than 1000 characters"),
    ],
)
def test_an_invalid_formula_is_an_error_in_one_line(text: str, message: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        expression.read(text)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
