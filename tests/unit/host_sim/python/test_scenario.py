from pathlib import Path

import pytest
from hubsim import scenario
from hubsim.errors import HubsimError


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_every_built_in_scenario_is_valid_and_says_what_it_is(name: str) -> None:
    found, loaded, directory = scenario.load(name, {})
    assert found == name
    assert loaded.description
    assert directory.is_dir()


def test_the_cycles_are_scaled_as_the_paper_does() -> None:
    assert scenario.load("ece15", {})[1].speed_scale == 60 / 80
    assert scenario.load("udds", {})[1].speed_scale == pytest.approx(60 / 91.25, abs=1e-7)


def test_an_override_wins_over_the_file() -> None:
    assert scenario.load("stop", {"demand_nm": 60})[1].demand_nm == 60.0


def test_a_scenario_of_ones_own_is_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("initial_speed_kmh = 30.0\nmax_duration_s = 2.0\n", encoding="utf-8")
    name, loaded, directory = scenario.load(str(path), {})
    assert (name, loaded.initial_speed_kmh, directory) == ("mine", 30.0, tmp_path)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"demand_mn": 3}, "--set demand_mn: unknown key, did you mean demand_nm?"),
        ({"zzz": 3}, "--set zzz: unknown key, known are description, cycle, speed_scale"),
        ({"demand_nm": -1}, "--set demand_nm: -1 is not accepted, accepted: a number from 0 to 100000"),
        ({"demand_nm": "much"}, "--set demand_nm: 'much' is not accepted, accepted: a number from 0 to 100000"),
        ({"demand_nm": float("nan")}, "--set demand_nm: nan is not accepted"),
        ({"drag": 1}, "--set drag: 1 is not accepted, accepted: true or false"),
        ({"repeats": 1.5}, "--set repeats: 1.5 is not accepted, accepted: a whole number from 1 to 1000"),
        ({"initial_speed_kmh": True}, "--set initial_speed_kmh: True is not accepted"),
    ],
)
def test_a_wrong_override_gets_one_line_with_key_and_range(overrides: dict[str, object], message: str) -> None:
    with pytest.raises(HubsimError) as caught:
        scenario.load("stop", overrides)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("demand_nm = ", "not valid TOML"),
        ("demand_nn = 3.0", "demand_nn: unknown key, did you mean demand_nm?"),
        ("demand_nm = [1, 2]", "demand_nm: [1, 2] is not accepted"),
        ("demand_nm = 3.0", "cycle: missing, accepted: a cycle, or max_duration_s, or stop_at_standstill = true"),
    ],
)
def test_a_wrong_file_gets_one_line_with_its_name(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(HubsimError) as caught:
        scenario.load(str(path), {})
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_scenario_is_answered_with_what_there_is(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match=r"no scenario 'stpo', accepted: .*stop, .*udds.* or a \.toml file"):
        scenario.load("stpo", {})
    with pytest.raises(HubsimError, match="file not found"):
        scenario.load(str(tmp_path / "none.toml"), {})
