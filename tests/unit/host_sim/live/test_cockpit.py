# SPDX-License-Identifier: Apache-2.0
"""Pedals of the page: who has them, what is demanded, and when nothing is."""

import itertools
import time
from pathlib import Path

import pytest
import unlike_axles
from hubfoc import HubfocError
from hubfoc.bus import Frame
from hubfoc.live.cockpit import FULL_S, SILENT_S, Cockpit
from hubsim import can_protocol, cli
from regen_table import schema

FIRST, SECOND = object(), object()
FOREIGN = can_protocol.encode("Demand", {"brake_torque_nm": 5.0})


@pytest.fixture
def cockpit() -> Cockpit:
    out = Cockpit(schema.load(cli.DEFAULT_CONFIG))
    out.take(FIRST)
    return out


def demands(cockpit: Cockpit, from_s: float, to_s: float) -> list[dict[str, float]]:
    """Return what is demanded of the first wheel, millisecond by millisecond."""
    found = []
    for k in range(round(1e3 * from_s), round(1e3 * to_s)):
        frames = cockpit.frames(1e-3 * k, [], silent=False)
        assert len(frames) in (0, 4)
        found += [can_protocol.decode("Demand", data) for _, data in frames[:1]]
    return [values for values in found if values is not None]


def test_every_ten_milliseconds_all_wheels_get_the_demand_of_the_pedal(cockpit: Cockpit) -> None:
    cockpit.drive(FIRST, 0.5, 0.0, "forward")
    found = demands(cockpit, 0.0, 1.0)
    assert len(found) == 100
    assert found[-1]["drive_torque_nm"] == pytest.approx(0.5 * cockpit.drive_nm)
    assert found[-1]["direction"] == 1.0
    steps = [b["drive_torque_nm"] - a["drive_torque_nm"] for a, b in itertools.pairwise(found)]
    assert max(steps) <= cockpit.drive_nm * 0.01 / FULL_S + 0.2  # a step of the signal
    cockpit.drive(FIRST, 0.5, 0.0, "reverse")
    assert demands(cockpit, 1.0, 1.1)[-1]["drive_torque_nm"] == pytest.approx(
        -0.5 * cockpit.drive_nm
    )


def test_a_withdrawn_torque_is_gone_in_one_demand_and_stays_away(cockpit: Cockpit) -> None:
    """In neutral a wheel drops its driving torque at once (firmware/torque, Demand)."""
    cockpit.drive(FIRST, 1.0, 0.0, "forward")
    assert demands(cockpit, 0.0, 0.5)[-1]["drive_torque_nm"] == pytest.approx(cockpit.drive_nm)
    with pytest.raises(HubfocError, match="watches"):
        cockpit.withdraw(SECOND)
    cockpit.withdraw(FIRST)
    cockpit.drive(FIRST, 1.0, 0.2, "forward")
    found = demands(cockpit, 0.5, 1.0)
    assert {(values["direction"], values["drive_torque_nm"]) for values in found} == {(0.0, 0.0)}
    assert found[-1]["brake_torque_nm"] == pytest.approx(0.2 * cockpit.brake_nm, rel=0.01)
    cockpit.drive(FIRST, 0.0, 0.0, "forward")
    cockpit.drive(FIRST, 1.0, 0.0, "forward")
    last = demands(cockpit, 1.0, 1.5)[-1]
    assert last["direction"] == 1.0
    assert last["drive_torque_nm"] == pytest.approx(cockpit.drive_nm)


def test_wheels_of_two_kinds_get_the_same_part_of_their_torques(tmp_path: Path) -> None:
    """Half the pedal: 20 N m of 40 in front, 10 of 20 at the rear."""
    front, rear = map(schema.load, unlike_axles.files(tmp_path, {}))
    cockpit = Cockpit(front, rear)
    cockpit.take(FIRST)
    cockpit.drive(FIRST, 0.5, 0.0, "forward")
    frames: list[Frame] = []
    for k in range(500):
        frames = cockpit.frames(1e-3 * k, [], silent=False) or frames
    found = [can_protocol.decode("Demand", data) for _, data in frames]
    torques_nm = [values["drive_torque_nm"] for values in found if values is not None]
    assert torques_nm == pytest.approx([20.0, 20.0, 10.0, 10.0], abs=0.11)


def test_counter_and_checksum_are_those_of_a_sender(cockpit: Cockpit) -> None:
    receiver = can_protocol.Receiver("Demand")
    answers = [
        receiver.receive(*cockpit.frames(0.01 * k, [], silent=False)[2], 10 * k)
        for k in range(300)  # beyond the counter's end
    ]
    assert answers[: can_protocol.QUALIFYING_FRAMES - 1] == ["not_qualified"] * 2
    assert set(answers[2:]) == {"used"}


def test_a_page_that_says_no_more_has_released_its_pedals(
    cockpit: Cockpit, monkeypatch: pytest.MonkeyPatch
) -> None:
    cockpit.drive(FIRST, 0.0, 1.0, "forward")
    assert demands(cockpit, 0.0, 0.5)[-1]["brake_torque_nm"] > 0.0
    later_s = time.monotonic() + 1.1 * SILENT_S
    monkeypatch.setattr(time, "monotonic", lambda: later_s)
    assert demands(cockpit, 0.5, 1.0)[-1]["brake_torque_nm"] == 0.0


def test_one_page_has_the_controls_and_the_others_watch(cockpit: Cockpit) -> None:
    with pytest.raises(HubfocError, match="another page has the controls"):
        cockpit.take(SECOND)
    with pytest.raises(HubfocError, match="this page watches"):
        cockpit.drive(SECOND, 0.1, 0.0, "forward")
    with pytest.raises(HubfocError, match="this page watches"):
        cockpit.acknowledge(SECOND)
    cockpit.release(SECOND)
    assert demands(cockpit, 0.0, 0.1)
    cockpit.release(FIRST)
    assert demands(cockpit, 0.1, 0.5) == []
    cockpit.take(SECOND)
    assert demands(cockpit, 0.5, 0.6)[-1]["drive_torque_nm"] == 0.0


def test_while_somebody_else_demands_nothing_is_sent(cockpit: Cockpit) -> None:
    assert cockpit.frames(0.0, [FOREIGN], silent=False) == []
    assert demands(cockpit, 0.001, 0.09) == []
    assert demands(cockpit, 0.09, 0.2) != []
    cockpit.release(FIRST)
    cockpit.frames(0.3, [FOREIGN], silent=False)
    with pytest.raises(HubfocError, match="another sender's demand is on this bus"):
        cockpit.take(FIRST)


def test_faults_are_acknowledged_for_a_moment_with_released_pedals(cockpit: Cockpit) -> None:
    cockpit.drive(FIRST, 1.0, 0.0, "forward")
    demands(cockpit, 0.0, 1.0)
    cockpit.acknowledge(FIRST)
    found = demands(cockpit, 1.0, 2.0)
    flags = [values["fault_reset"] for values in found]
    assert sum(flags) in (29, 30, 31)
    assert flags == sorted(flags, reverse=True)
    assert min(values["drive_torque_nm"] for values in found) < 1.0


@pytest.mark.parametrize(("accelerator", "brake"), [(1.5, 0.0), (0.0, -0.1), (float("nan"), 0.0)])
def test_a_pedal_beyond_its_travel_is_refused(
    cockpit: Cockpit, accelerator: float, brake: float
) -> None:
    with pytest.raises(HubfocError, match="accepted: 0 to 1"):
        cockpit.drive(FIRST, accelerator, brake, "forward")
    with pytest.raises(HubfocError, match="direction 'up'"):
        cockpit.drive(FIRST, 0.0, 0.0, "up")
