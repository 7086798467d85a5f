# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest
from hubsim import scenario
from hubsim.errors import HubsimError


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_every_built_in_scenario_is_valid_and_has_a_description(name: str) -> None:
    found, loaded, directory = scenario.load(name, {})
    assert found == name
    assert loaded.description
    assert directory.is_dir()


def test_cycles_are_scaled_as_in_the_paper() -> None:
    assert scenario.load("ece15", {})[1].speed_scale == 60 / 80
    assert scenario.load("udds", {})[1].speed_scale == pytest.approx(60 / 91.25, abs=1e-7)


def test_an_override_has_priority_over_the_file() -> None:
    assert scenario.load("stop", {"demand_nm": 60})[1].demand_nm == 60.0


def test_a_scenario_can_be_given_as_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("initial_speed_kmh = 30.0\nmax_duration_s = 2.0\n", encoding="utf-8")
    name, loaded, directory = scenario.load(str(path), {})
    assert (name, loaded.initial_speed_kmh, directory) == ("mine", 30.0, tmp_path)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"demand_mn": 3}, "--set demand_mn: unknown key, did you mean demand_nm?"),
        ({"zzz": 3}, "--set zzz: unknown key, accepted: description, cycle, speed_scale"),
        (
            {"demand_nm": -1},
            "--set demand_nm: -1 is not accepted, accepted: a number from 0 to 100000",
        ),
        (
            {"demand_nm": "much"},
            "--set demand_nm: 'much' is not accepted, accepted: a number from 0 to 100000",
        ),
        ({"demand_nm": float("nan")}, "--set demand_nm: nan is not accepted"),
        ({"drag": 1}, "--set drag: 1 is not accepted, accepted: true or false"),
        (
            {"repeats": 1.5},
            "--set repeats: 1.5 is not accepted, accepted: a whole number from 1 to 1000",
        ),
        ({"initial_speed_kmh": True}, "--set initial_speed_kmh: True is not accepted"),
    ],
)
def test_an_invalid_override_is_an_error_in_one_line_with_key_and_range(
    overrides: dict[str, object], message: str
) -> None:
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
        (
            "demand_nm = 3.0",
            "cycle: missing, accepted: a cycle, or max_duration_s, or stop_at_standstill = true",
        ),
    ],
)
def test_an_invalid_file_is_an_error_in_one_line_with_its_name(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(HubsimError) as caught:
        scenario.load(str(path), {})
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_error_for_an_unknown_scenario_names_the_one_meant_or_lists_all(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match=r"no scenario 'stopp', did you mean stop\?"):
        scenario.load("stopp", {})
    with pytest.raises(
        HubsimError, match=r"no scenario 'xyzzy', accepted: .*stop, .*udds.* or a \.toml file"
    ):
        scenario.load("xyzzy", {})
    with pytest.raises(HubsimError, match="file not found"):
        scenario.load(str(tmp_path / "none.toml"), {})


WHOLE = """
initial_speed_kmh = 30.0
max_duration_s = 2.0
demand_trace_nm = [[0, 0], [1.0, 40.0]]
[plant.battery]
initial_soc = 0.5
[drive.brake]
strategy = "parallel_ratio"
[events.lost]
at_s = 1.0
inject = "abs"
[events.hill]
at_s = 0.5
over_s = 0.5
set.road.slope = 0.05
[criteria.short]
value = "run.distance_m"
at_most = 20.0
"""


def loaded(
    tmp_path: Path, text: str, overrides: dict[str, object] | None = None
) -> scenario.Scenario:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return scenario.load(str(path), overrides or {})[1]


def test_sections_of_a_file_are_read_by_name(tmp_path: Path) -> None:
    found = loaded(tmp_path, WHOLE)
    assert found.plant == {"battery.initial_soc": 0.5, "thermal.active": 1.0}
    assert found.drive_changes == {("brake", "strategy"): "parallel_ratio"}
    assert found.events["hill"].values == {"road.slope": 0.05}
    assert found.events["lost"].values == {"driver.abs_active": 1.0}
    assert found.constants["events.hill.set.road.slope"] == 0.05
    assert found.demand_trace_nm == ((0.0, 0.0), (1.0, 40.0))


def test_keys_inside_sections_can_be_overridden(tmp_path: Path) -> None:
    keys = {
        "events.lost.at_s": 1.5,
        "events.hill.set.road.slope": 0.1,
        "criteria.short.at_most": "2 * 7",
    }
    found = loaded(tmp_path, WHOLE, keys)
    assert found.events["lost"].at_s == 1.5
    assert found.events["hill"].values == {"road.slope": 0.1}
    assert found.criteria["short"].at_most == "2 * 7"


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("events.lots.at_s", 1, "--set events.lots.at_s: did you mean events.lost?"),
        ("events.lost", 1, "--set events.lost: did you mean events.lost?"),
        ("events.lost.att_s", 1, "--set events.lost.att_s: unknown key, did you mean at_s?"),
        (
            "events.lost.at_s",
            -1,
            "--set events.lost.at_s: -1 is not accepted, accepted: a number from 0 to 1e+06",
        ),
        (
            "events.hill.set.road.slope",
            7,
            "--set events.hill.set.road.slope: road.slope: 7 is not accepted, accepted: a number",
        ),
        (
            "criteria.short.at_most",
            "max(",
            "--set criteria.short.at_most: at_most: 'max(' cannot be read",
        ),
    ],
)
def test_an_unknown_key_in_a_section_is_an_error_in_one_line(
    tmp_path: Path, key: str, value: object, message: str
) -> None:
    with pytest.raises(HubsimError) as caught:
        loaded(tmp_path, WHOLE, {key: value})
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[events.x]\nat_s = 1.0\n", "events.x: accepted: either set or inject"),
        (
            '[events.x]\ninject = "abs"\n',
            "events.x.at_s: missing, accepted: a number from 0 to 1e+06",
        ),
        (
            '[events.x]\nat_s = 1.0\ninject = "abd"\n',
            "events.x: inject: 'abd' is not accepted, did you mean abs?",
        ),
        (
            '[events.x]\nat_s = 1.0\nuntil_s = 0.5\ninject = "abs"\n',
            "events.x: until_s: 0.5 is not accepted, accepted: not before 1",
        ),
        (
            "[events.x]\nat_s = 1.0\nset.road.slop = 0.1\n",
            "events.x: road.slop: unknown key, did you mean road.slope?",
        ),
        (
            '[events.x]\nat_s = 1.0\nset.road.slope = "up"\n',
            "events.x.set: 'up' is not accepted, accepted: a section of parameters",
        ),
        ("[events]\nat_s = 1.0\n", "events.at_s: 1.0 is not accepted, accepted: a section"),
        ("events = 3\n", "events: 3 is not accepted, accepted: sections of events"),
        (
            "[plant.road]\nslope = 3.0\n",
            "plant.road.slope: 3 is not accepted, accepted: a number from -1 to 1",
        ),
        ("[criteria.x]\nat_most = 1\n", "criteria.x: accepted: either value or reasons"),
        (
            '[criteria.x]\nvalue = "1"\n',
            "criteria.x: accepted with value: at_least and/or at_most, or settles_to with band "
            "and within_s",
        ),
        (
            '[criteria.x]\nvalue = "1"\nsettles_to = 1\n',
            "criteria.x: accepted with value: at_least and/or at_most, or settles_to with",
        ),
        (
            '[criteria.x]\nreasons = "wheels.reason"\n',
            "criteria.x: accepted with reasons: must_appear and/or must_not_appear",
        ),
        (
            '[criteria.x]\nreasons = "max(x)"\nmust_appear = ["ABS"]\n',
            "criteria.x: reasons: 'max(x)' is not accepted, accepted: a signal",
        ),
        (
            '[criteria.x]\nreasons = "r"\nmust_appear = ["ABD"]\n',
            "criteria.x: must_appear: no reason 'ABD', did you mean ABS?",
        ),
        (
            '[criteria.x]\nvalue = "1"\nat_mots = 3\n',
            "criteria.x.at_mots: unknown key, did you mean at_most?",
        ),
        (
            '[criteria.x]\nvalue = "1"\nat_most = true\n',
            "criteria.x.at_most: True is not accepted, accepted: a number or a formula in quotes",
        ),
        (
            "demand_trace_nm = [[1.0, 3.0]]\n",
            "demand_trace_nm: [1.0] s, accepted: at least one point, 0 first, then rising",
        ),
        (
            "demand_trace_nm = [[0.0]]\n",
            "demand_trace_nm: [0.0] is not accepted, accepted: a list of [time_s, value]",
        ),
        (
            'cycle = "ece15"\nspeed_trace_kmh = [[0, 1]]\n',
            "speed_trace_kmh: accepted: either cycle or speed_trace_kmh",
        ),
    ],
)
def test_an_error_in_a_section_is_one_line_with_file_and_key(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(HubsimError) as caught:
        loaded(tmp_path, f"max_duration_s = 1.0\n{text}")
    assert str(caught.value).startswith(f"{tmp_path / 'mine.toml'}: {message}"), str(caught.value)
    assert "\n" not in str(caught.value)
