# SPDX-License-Identifier: Apache-2.0
"""The simulated world through its local service: road, battery, faults, scenario, time."""

import math
import urllib.error
import urllib.request
from collections.abc import Iterator
from email.message import Message

import pytest
from hubfoc import HubfocError, Simulation, Vehicle
from hubfoc.live import service
from hubfoc.live.faults import values_of
from hubsim.scenario import faults

from tests.unit.host_sim.live.support import Running, running, until


@pytest.fixture(scope="module")
def vehicle() -> Iterator[Running]:
    with running(paced=False) as own:
        yield own


@pytest.fixture
def world(vehicle: Running) -> Simulation:
    out = Simulation(vehicle.url)
    out.scenario(None)
    return out


def parameters(vehicle: Running, names: set[str]) -> dict[str, float]:
    found = vehicle.do(lambda: {name: vehicle.world.vehicle.get(name) for name in names})
    assert isinstance(found, dict)
    return found


def test_road_battery_and_temperature_are_set(vehicle: Running, world: Simulation) -> None:
    state = world.set(slope=-0.04, friction=0.25, soc=0.83, temperature_c=96.0)
    assert state["slope"] == -0.04
    assert state["friction"] == 0.25
    assert state["soc"] == pytest.approx(0.83, abs=1e-4)
    assert vehicle.value("wheel2.winding_temperature_c") == 96.0
    assert vehicle.value("wheel2.switch_temperature_c") == 96.0


def test_a_full_pack_takes_no_current(vehicle: Running, world: Simulation) -> None:
    until(lambda: vehicle.value("bms.charge_a") > 0.0)
    world.set(soc=1.0)
    until(lambda: vehicle.value("bms.charge_a") == 0.0)


def test_the_time_stands_and_runs_again(vehicle: Running, world: Simulation) -> None:
    stood_s = world.pause()["time_s"]
    assert world.state()["time_s"] == stood_s
    world.go_on()
    until(lambda: world.state()["time_s"] > stood_s)
    del vehicle


def test_a_scenario_drives_and_at_its_end_the_time_stands(
    vehicle: Running, world: Simulation
) -> None:
    """From 40 km/h, two thirds of the top speed, to standstill."""
    begun = world.scenario("stop")
    assert begun["scenario"] == "stop"
    until(lambda: world.state()["paused"])
    assert world.state()["ended"] == "the scenario is over"
    assert abs(vehicle.value("vehicle.speed_m_per_s")) < 0.05
    again = world.scenario(None)
    assert again["ended"] is None
    assert again["time_s"] < 1.0
    assert "udds" in world.scenarios()


def test_every_fault_that_is_not_refused_comes_and_goes(
    vehicle: Running, world: Simulation
) -> None:
    """Afterwards every parameter that any fault touches is what it was."""
    world.pause()
    listed = {line["name"]: line for line in world.faults()}
    assert set(listed) == set(faults.table())
    touched = {p for name in listed for p in (*values_of(name, None), *values_of(name, 1))}
    healthy = parameters(vehicle, touched)
    possible = [name for name, line in listed.items() if line["refused"] is None]
    assert len(possible) > 100
    for name in possible:
        wheel = "front_right" if listed[name]["one_wheel"] else None
        state = world.fault(name, wheel=wheel)
        assert state["faults"][name]["wheel"] == wheel
        expected = values_of(name, None if wheel is None else 1)
        assert parameters(vehicle, set(expected)) == expected
        assert world.fault(name, on=False)["faults"] == {}
    assert parameters(vehicle, touched) == healthy


def test_faults_that_contradict_each_other_replace_each_other(
    vehicle: Running, world: Simulation
) -> None:
    world.pause()
    world.fault("winding_sensor_open")
    assert set(world.fault("current_a_dead")["faults"]) == {"winding_sensor_open", "current_a_dead"}
    state = world.fault("current_b_gain")
    assert set(state["faults"]) == {"winding_sensor_open", "current_b_gain"}
    assert parameters(vehicle, {"fault.current_stuck"}) == {"fault.current_stuck": 0.0}


def test_one_broken_wheel_says_what_is_wrong_and_the_others_nothing(
    vehicle: Running, world: Simulation
) -> None:
    """The reasons that are right by physics are those of the list of expected reasons."""
    with Vehicle(vehicle.channel) as car:
        until(lambda: car.rear_left.status().mode == "READY")
        world.fault("winding_sensor_shorted", wheel="rear_left")
        right = set(faults.expected()["winding_sensor_shorted"])
        until(lambda: car.rear_left.status().warning in right)
        assert car.rear_right.status().warning == "NONE"


@pytest.mark.parametrize(
    ("wanted", "why"),
    [
        ({"slope": 3.0}, r"slope: .*accepted: -1 to 1"),
        ({"soc": math.nan}, "soc: nan is not accepted, accepted: a number"),
        ({"tilt": 1.0}, "'tilt' is not accepted, accepted: slope, friction, soc"),
    ],
)
def test_a_setting_that_cannot_be_is_one_line(
    world: Simulation, wanted: dict[str, float], why: str
) -> None:
    with pytest.raises(HubfocError, match=why):
        world.set(**wanted)


@pytest.mark.parametrize(
    ("name", "wheel", "why"),
    [
        ("current_a_dea", None, "no fault 'current_a_dea', did you mean"),
        ("encoder_index_lost", None, "only with: encoder"),
        ("state_bit", None, "accepted: 0 with the whole application"),
        ("contactor_opens", "rear_left", "it is of the whole vehicle"),
        ("current_a_dead", "spare", "wheel 'spare', accepted: front_left"),
    ],
)
def test_a_fault_that_cannot_be_is_one_line(
    world: Simulation, name: str, wheel: str | None, why: str
) -> None:
    with pytest.raises(HubfocError, match=why):
        world.fault(name, wheel=wheel)


def test_a_scenario_or_fault_that_is_not_there_is_one_line(world: Simulation) -> None:
    with pytest.raises(HubfocError, match="no scenario 'stopp'"):
        world.scenario("stopp")
    with pytest.raises(HubfocError, match="current_a_dead: no such fault is there"):
        world.fault("current_a_dead", on=False)


def test_without_the_token_or_from_another_origin_nothing_answers(vehicle: Running) -> None:
    base = vehicle.url.removesuffix("/").rpartition("/")[0]
    with pytest.raises(HubfocError, match="accepted: the address that hubfoc live printed"):
        Simulation(f"{base}/guessed/")
    with pytest.raises(HubfocError, match="no virtual vehicle answers"):
        Simulation(f"http://{service.HOST}:1/token/")
    headers: tuple[dict[str, str], ...] = (
        {"Origin": "http://elsewhere"}, {"Host": "elsewhere"},
    )  # fmt: skip
    for own in headers:
        request = urllib.request.Request(f"{vehicle.url}simulation", b"{}", own)
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=30)
        assert refused.value.code == 403
        assert isinstance(refused.value.headers, Message)
