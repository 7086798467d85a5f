# SPDX-License-Identifier: Apache-2.0
import math

import pytest
from hubsim.report import markup


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [
        (1.005, 1, "1.0"),
        (-2.25, 1, "−2.2"),
        (-0.001, 2, "0.00"),
        (0.0, 0, "0"),
        (-0.6, 0, "−1"),
        (math.nan, 2, "–"),
        (math.inf, 2, "–"),
    ],
)
def test_fixed_numbers_use_a_minus_sign_no_negative_zero_and_a_dash_for_missing_values(
    value: float, decimals: int, text: str
) -> None:
    assert markup.fixed(value, decimals) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.012345, "0.0123"), (123456.0, "123000"), (-9.999, "−10.00"), (0.0, "0"), (41.96, "42.0")],
)
def test_significant_digits_are_counted_from_the_first_one(value: float, text: str) -> None:
    assert markup.significant(value) == text


@pytest.mark.parametrize(
    ("energy_j", "text"),
    [
        (154780.0, "155 kJ"),
        (15040.0, "15.0 kJ"),
        (2490.0, "2.49 kJ"),
        (-6100.0, "−6.10 kJ"),
        (4.2, "4 J"),
        (-0.2, "0 J"),
        (math.nan, "–"),
    ],
)
def test_energy_labels_have_three_digits_or_whole_joules(energy_j: float, text: str) -> None:
    assert markup.kilojoules(energy_j) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0, "0 %"),
        (2.5e-7, "2.5 · 10⁻⁵ %"),
        (-3e-12, "−3.0 · 10⁻¹⁰ %"),
        (0.0012, "0.12 %"),
        (1e-5, "0.0010 %"),
    ],
)
def test_very_small_shares_are_written_with_a_power_of_ten(share: float, text: str) -> None:
    assert markup.small_percent(share) == text
