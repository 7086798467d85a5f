# SPDX-License-Identifier: Apache-2.0
import pytest
from hubsim.cli import DEFAULT_CONFIG
from hubsim.errors import HubsimError
from hubsim.scenario import overrides
from regen_table.errors import ConfigurationError


def test_key_is_assigned_to_scenario_or_drive() -> None:
    found = overrides.parse(
        [
            "demand_nm=60",
            "battery.initial_soc=0.5",
            "plant.motor.phase_resistance_ohm=0.04",
            "drag=false",
            "cycle=mine.csv",
        ]
    )
    assert found.scenario == {"demand_nm": 60, "drag": False, "cycle": "mine.csv"}
    assert found.drive == {("battery", "initial_soc"): 0.5}
    assert found.plant == {"motor.phase_resistance_ohm": 0.04}


def test_the_last_override_of_a_key_applies() -> None:
    assert overrides.parse(["demand_nm=1", "demand_nm=2"]).scenario == {"demand_nm": 2}


def test_an_override_of_the_drive_changes_only_the_drive() -> None:
    plain = overrides.load_drive(DEFAULT_CONFIG, overrides.Overrides())
    changed = overrides.load_drive(
        DEFAULT_CONFIG, overrides.parse(["motor.phase_resistance_ohm=0.04"])
    )
    assert changed.motor.phase_resistance_ohm == 0.04
    assert changed.name == plain.name
    assert changed.battery == plain.battery


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("demand_nm", "--set 'demand_nm': accepted: key=value"),
        ("=3", "--set '=3': accepted: key=value"),
        (
            "plant.motor.pole_pear=3",
            "--set plant.motor.pole_pear: unknown key, did you mean plant.motor.pole_pairs?",
        ),
        (
            "plant.road.slope=7",
            "--set plant.road.slope: 7 is not accepted, accepted: a number from -1 to 1",
        ),
        (
            "plant.road.slope=steep",
            "--set plant.road.slope: 'steep' is not accepted, accepted: a number from -1 to 1",
        ),
    ],
)
def test_an_invalid_override_is_an_error_in_one_line(setting: str, message: str) -> None:
    with pytest.raises(HubsimError) as caught:
        overrides.parse([setting])
    assert str(caught.value) == message


def test_an_invalid_key_or_value_of_the_drive_is_refused_by_its_schema() -> None:
    with pytest.raises(
        ConfigurationError, match=r"motor\.pole_pear: unknown key, did you mean pole_pairs\?"
    ):
        overrides.load_drive(DEFAULT_CONFIG, overrides.parse(["motor.pole_pear=3"]))
    with pytest.raises(ConfigurationError, match=r"motor\.pole_pairs: 0 is not accepted"):
        overrides.load_drive(DEFAULT_CONFIG, overrides.parse(["motor.pole_pairs=0"]))
