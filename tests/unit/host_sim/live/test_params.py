# SPDX-License-Identifier: Apache-2.0
"""``hubfoc params`` and its session with a wheel of a virtual vehicle, by UDP and by CAN."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hubfoc import HubfocError, cli, service
from hubfoc.service import Service, Udp
from hubsim.cli import DEFAULT_CONFIG
from regen_table import service_key

Run = Callable[..., tuple[int, str]]
FIELD = "driver.lost_hold_ms"


@pytest.fixture(scope="module")
def ready() -> Iterator[dict[str, object]]:
    """Return what a vehicle of its own process says of itself."""
    command = [sys.executable, "-m", "hubfoc", "live", "--ready-json", "--no-page"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        first_line = json.loads(process.stdout.readline())
        yield first_line
        process.send_signal(signal.SIGINT)
        process.wait()
    assert not Path(first_line["key"]).exists()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], ready: dict[str, object]) -> Run:
    wheels = ready["wheels"]
    assert isinstance(wheels, list)

    def call(*arguments: str) -> tuple[int, str]:
        status = cli.main(["params", *arguments, "--udp", wheels[2]["xcp"]["udp"]])
        return status, "".join(capsys.readouterr())

    return call


def test_a_value_is_stored_and_then_differs_from_the_file(
    run: Run, ready: dict[str, object]
) -> None:
    status, shown = run("get", "driver.lost_")
    assert (status, shown) == (0, f"{FIELD} 300 ms\n")
    assert run("diff", str(DEFAULT_CONFIG)) == (0, "")
    assert run("set", f"{FIELD}=250", "--key", str(ready["key"])) == (0, "")
    assert run("diff", str(DEFAULT_CONFIG)) == (1, f"{FIELD}: wheel 250, file 300\n")


@pytest.mark.parametrize(
    ("assignment", "why"),
    [
        ("driver.lost_hold=1", "no such field"),
        (f"{FIELD}=10001", "10001, accepted: 0 to 10000 ms"),
        (f"{FIELD}=1,2", "2 values, accepted: 1"),
        (FIELD, "accepted: SECTION.FIELD=VALUE"),
        ("motor.rated_torque_mNm=1638200", "the wheel's validator does not accept it"),
    ],
)
def test_what_is_not_accepted_is_one_line(
    run: Run, ready: dict[str, object], assignment: str, why: str
) -> None:
    status, shown = run("set", assignment, "--key", str(ready["key"]))
    assert status == 2
    assert why in shown
    assert shown.count("\n") == 1


def test_another_key_is_one_line_without_the_key(run: Run, tmp_path: Path) -> None:
    key = service_key.draw()
    service_key.write(tmp_path / "other.key", key)
    status, shown = run("set", f"{FIELD}=1", "--key", str(tmp_path / "other.key"))
    assert status == 2
    assert "locked: accepted: the key of this wheel" in shown
    assert key.hex() not in shown


def test_a_bus_has_the_same_wheels(
    ready: dict[str, object], capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--can", str(ready["can"]), "--wheel", "front_right"]
    assert cli.main(["params", "get", "vehicle.wheel_position", *arguments]) == 0
    assert capsys.readouterr().out == "vehicle.wheel_position 1\n"


def test_nobody_there_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service, "TIMEOUT_S", 0.05)
    with pytest.raises(HubfocError, match="no answer: accepted: a wheel that runs"):
        Service(Udp("127.0.0.1:9"))
    with pytest.raises(HubfocError, match="accepted: HOST:PORT"):
        Udp("somewhere")


def test_a_signal_is_read_by_its_name(ready: dict[str, object]) -> None:
    wheels = ready["wheels"]
    assert isinstance(wheels, list)
    with Service(Udp(wheels[3]["xcp"]["udp"])) as wheel:
        assert wheel.signal("input.selftest_passed") == 1
        with pytest.raises(HubfocError, match="no such signal"):
            wheel.signal("output.none")
