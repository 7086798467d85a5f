# SPDX-License-Identifier: Apache-2.0
"""Temperature sensors of every kind: curves against formulas written down a second time."""

import math
from pathlib import Path

import pytest
from regen_table import schema, thermometers
from regen_table.errors import ConfigurationError
from regen_table.thermometers import Sensor

LU2013 = Path(__file__).parents[4] / "tools" / "motors" / "lu2013.toml"


def sensor(kind: str, divider_ohm: float = 10e3, to_supply: bool = False) -> Sensor:
    points = ((-20.0, 97e3), (0.0, 32.65e3), (25.0, 10e3), (60.0, 2.488e3), (120.0, 389.0))
    return Sensor(kind, 10e3, 3380.0, points, divider_ohm, to_supply)


def celsius_of(kind: str, ohm: float) -> float:
    """Return the temperature of a resistance, solved by hand."""
    if kind == "ntc":
        return 1.0 / (1.0 / 298.15 + math.log(ohm / 10e3) / 3380.0) - 273.15
    if kind == "pt1000":  # the quadratic of IEC 60751; below 0 degC within 0.3 K down to -50
        root = math.sqrt(3.9083e-3**2 + 4.0 * 5.775e-7 * (1.0 - ohm / 1000.0))
        return (3.9083e-3 - root) / (2.0 * 5.775e-7)
    # KTY84: the polynomial that STM-Project/DL7 (GitHub), Application/Inc/RTD.h gives for it
    terms = (8.907741e-15, -7.330942e-11, 2.423869e-7, -4.246555e-4, 5.327946e-1, -186.0705)
    value = 0.0
    for term in terms:
        value = value * ohm + term
    return value


@pytest.mark.parametrize(("kind", "within_k"), [("ntc", 1.5), ("pt1000", 0.6), ("kty84", 2.1)])
@pytest.mark.parametrize("to_supply", [False, True])
@pytest.mark.parametrize("divider_ohm", [4.7e3, 10e3])
def test_what_the_firmware_shows_is_the_temperature_of_the_resistance(
    kind: str, within_k: float, to_supply: bool, divider_ohm: float
) -> None:
    """At every code of a whole sensor, up to 150 degC; the code itself is whole."""
    made = thermometers.curve(sensor(kind, divider_ohm, to_supply))
    assert made.error_k <= 2.5
    checked = 0
    for code in range(made.lowest_code, made.highest_code + 1):
        share = code / 4096.0
        share = 1.0 - share if to_supply else share
        truth = celsius_of(kind, divider_ohm * share / (1.0 - share))
        shown = made.celsius(code)
        assert shown is not None
        if -39.0 < truth < 130.0:
            assert abs(shown - truth) < within_k
            checked += 1
    assert checked > 150


@pytest.mark.parametrize("kind", ["ntc", "pt1000", "kty84", "table"])
@pytest.mark.parametrize("to_supply", [False, True])
def test_open_and_shorted_lines_are_broken_sensors(kind: str, to_supply: bool) -> None:
    made = thermometers.curve(sensor(kind, to_supply=to_supply))
    for code in (0, 1, 4094, 4095):
        assert made.celsius(code) is None


def test_a_table_passes_through_its_points() -> None:
    made = thermometers.curve(sensor("table"))
    for celsius, ohm in ((0.0, 32.65e3), (25.0, 10e3), (60.0, 2.488e3)):
        shown = made.celsius(4096.0 * ohm / (ohm + 10e3))
        assert shown is not None
        assert abs(shown - celsius) < 2.0


def test_a_thermistor_where_a_pt1000_is_expected_is_broken_and_so_is_a_kty84() -> None:
    expected = sensor("pt1000")
    shown = thermometers.instead(expected, thermometers.curve(expected))
    assert shown == {"ntc": None, "kty84": None}


def test_a_pt1000_where_a_kty84_is_expected_shows_what_the_table_command_says() -> None:
    """1097 Ohm are 115 degC of a KTY84: such a mistake shows at the first start of a cold motor."""
    expected = sensor("kty84")
    shown = thermometers.instead(expected, thermometers.curve(expected))["pt1000"]
    assert shown == pytest.approx(celsius_of("kty84", 1097.3), abs=1.5)


def test_without_a_sensor_every_code_is_broken() -> None:
    made = thermometers.curve(None)
    assert all(made.celsius(code) is None for code in range(4096))


@pytest.mark.parametrize(
    ("points", "accepted"),
    [
        ("[[0.0, 1e4], [50.0, 3e3]]", True),
        ("[[0.0, 1e4], [50.0, 3e3], [40.0, 1e3]]", False),
        ("[[0.0, 1e4], [50.0, 3e3], [90.0, 4e3]]", False),
    ],
)
def test_a_table_that_turns_back_is_refused(points: str, accepted: bool, tmp_path: Path) -> None:
    text = LU2013.read_text(encoding="utf-8")
    keys = f'winding_sensor = "table"\nwinding_sensor_points = {points}\n'
    head = "[monitor]\n"
    file = tmp_path / "own.toml"
    file.write_text(
        text.replace(head, head + keys) if head in text else f"{text}\n{head}{keys}",
        encoding="utf-8",
    )
    if accepted:
        schema.load(file)
    else:
        with pytest.raises(ConfigurationError, match="winding_sensor_points"):
            schema.load(file)
