# SPDX-License-Identifier: Apache-2.0
"""``hubfoc params`` and its session with a wheel of a virtual vehicle, by UDP and by CAN."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hubfoc import HubfocError, addresses, cli, params, service
from hubfoc.service import Service, Udp
from hubsim import configuration
from hubsim.cli import DEFAULT_CONFIG
from hubsim.engine import ROOT
from regen_table import installation, schema, service_key

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


def _changed(image: bytes) -> bytes:
    """Return an image with another value in a scalar and in a list of each section."""
    values: dict[tuple[str, str], int | list[int]] = {}
    for field in addresses.fields():
        section, _, name = field.name.partition(".")
        found = service.values_of(image, field)
        other = [field.info.lowest if value != field.info.lowest else value + 1 for value in found]
        kind = (section, "list" if field.info.count else "scalar")
        if kind not in {(key[0], "list" if isinstance(v, list) else "scalar")
                        for key, v in values.items()}:  # fmt: skip
            values[section, name] = other if field.info.count else other[0]
    return configuration.changed_image(image, values)


@pytest.mark.parametrize("base_name", ["its own", "another"])
@pytest.mark.parametrize("name", ["ebike36v", "ipm400v", "lu2013", "scooter48v", "wheel24v"])
def test_an_exported_file_makes_the_image_byte_for_byte(
    tmp_path: Path, name: str, base_name: str
) -> None:
    """Of every drive that comes along, as it is and with other values, by any drive's file."""
    shipped = (ROOT / "firmware" / "config" / "generated" / f"{name}.bin").read_bytes()
    base = installation.drive_file(name if base_name == "its own" else "m365")
    for image in (shipped, _changed(shipped)):
        path = tmp_path / f"{name}.toml"
        path.write_text(params.exported(image[: addresses.page_bytes()], base), encoding="utf-8")
        assert configuration.image_of(schema.load(path)) == image
        # Exported once more, by the file that was exported: the same again.
        again = params.exported(shipped[: addresses.page_bytes()], path)
        path.write_text(again, encoding="utf-8")
        assert configuration.image_of(schema.load(path)) == shipped


def test_a_file_without_differences_is_the_drive_s_own(tmp_path: Path) -> None:
    base = installation.drive_file("lu2013")
    image = configuration.load(base).image
    assert params.exported(image[: addresses.page_bytes()], base) == base.read_text("utf-8")
    assert not list(tmp_path.iterdir())


def test_a_wheel_s_parameters_come_back_as_a_file(
    run: Run, ready: dict[str, object], tmp_path: Path
) -> None:
    """What ``set`` has stored stands in the file, and the file is what ``diff`` finds equal."""
    assert run("set", f"{FIELD}=210", "--key", str(ready["key"])) == (0, "")
    path = tmp_path / "lu2013.toml"
    assert run("export", "lu2013", str(path)) == (0, "")
    assert f'"{FIELD}" = 210' in path.read_text(encoding="utf-8")
    assert run("diff", str(path)) == (0, "")
    status, shown = run("export", "lu2013", str(tmp_path / "mine.toml"))
    assert (status, shown.count("\n")) == (2, 1)
    assert "accepted: a file lu2013.toml" in shown
