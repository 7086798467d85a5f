# SPDX-License-Identifier: Apache-2.0
"""Tolerances of a drive: their way into the image, and that nothing else depends on them."""

import math
from collections.abc import Callable

import pytest
from regen_table import image
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

OTHERS = {
    "tolerance.magnet_flux": 0.1,
    "tolerance.inductance": 0.5,
    "tolerance.drag": 1.0,
    "tolerance.current_gain": 0.0,
    "tolerance.rotor_angle_deg": 9.0,
}


def test_each_limit_is_its_share_of_one_or_of_a_radian(change: Callable[..., Drive]) -> None:
    assert image.fields(change(OTHERS))["tolerance"] == {
        "magnet_flux_q15": round(0.1 * 2**15),
        "inductance_q15": 2**14,
        "drag_q15": 2**15 - 1,  # the largest number of the format
        "current_gain_q15": 0,
        "rotor_angle_rad_q15": round(9.0 * math.pi / 180.0 * 2**15),
    }


def test_a_file_that_gives_none_has_the_limits_of_usual_data_sheets(
    change: Callable[..., Drive],
) -> None:
    found = image.fields(change({}))["tolerance"]
    expected = {
        "magnet_flux_q15": 0.05,
        "inductance_q15": 0.2,
        "drag_q15": 0.2,
        "current_gain_q15": 0.02,
        "rotor_angle_rad_q15": 3.0 * math.pi / 180.0,
    }
    assert found == {name: round(share * 2**15) for name, share in expected.items()}


def test_no_other_field_of_the_image_depends_on_a_limit(change: Callable[..., Drive]) -> None:
    usual, other = (image.fields(change(changes)) for changes in ({}, OTHERS))
    assert [name for name, values in usual.items() if values != other[name]] == ["tolerance"]


@pytest.mark.parametrize(
    ("key", "value", "range_"),
    [
        ("magnet_flux", 0.6, "0 to 0.5"),
        ("magnet_flux", -0.01, "0 to 0.5"),
        ("inductance", 1.1, "0 to 1"),
        ("drag", -1.0, "0 to 1"),
        ("current_gain", 2.0, "0 to 0.5"),
        ("rotor_angle_deg", 26.0, "0 to 25 deg"),
    ],
)
def test_a_limit_beyond_its_range_is_refused_with_key_and_range(
    key: str, value: float, range_: str, change: Callable[..., Drive]
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        change({f"tolerance.{key}": value})
    line = str(caught.value)
    assert line.startswith(f"changed.toml: tolerance.{key}: ")
    assert range_ in line
