# SPDX-License-Identifier: Apache-2.0
"""What was recorded of a virtual vehicle, and run through the same C again."""

import json
import os
import resource
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
from hubfoc import HubfocError, Simulation, Vehicle, cli, replay
from hubfoc.live import desk, parameters, replays
from hubfoc.live.clock import Clock
from hubfoc.live.vehicle import POSITIONS
from hubfoc.live.world import World
from hubfoc.recording import Part, Recording
from hubfoc.service import Service, Udp
from hubsim import configuration, steps
from hubsim.cli import DEFAULT_CONFIG
from hubsim.engine import Steps
from hubsim.errors import HubsimError
from regen_table import layout

from tests.unit.host_sim.live.support import running, until

DRIVEN_MS = 600
Run = Callable[..., tuple[int, str, dict[str, Any]]]


def _drive(world: World, milliseconds: int) -> None:
    for _ in range(milliseconds):
        world.vehicle.step([])


def _record(world: World, path: Path) -> None:
    """Record a stop, in the middle of which a wheel loses a current sensor and the road rises."""
    world.change({"scenario": "stop"})
    world.change({"record": str(path)})
    _drive(world, DRIVEN_MS // 2)
    world.change({"slope": 0.03})
    world.change({"fault": "current_a_dead", "wheel": "rear_left"})
    _drive(world, DRIVEN_MS // 2)
    world.change({"record": None})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return where a vehicle was recorded as stop.parquet and stop.csv."""
    out = tmp_path_factory.mktemp("recordings")
    with World(DEFAULT_CONFIG) as world:
        _record(world, out / "stop.parquet")
        _record(world, out / "stop.csv")
    return out


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    def call(file: Path, *options: str) -> tuple[int, str, dict[str, Any]]:
        found = tmp_path / "found.json"
        found.unlink(missing_ok=True)
        status = cli.main(["replay", str(file), *options, "--json", str(found)])
        shown = "".join(capsys.readouterr())
        return status, shown, json.loads(found.read_text()) if found.exists() else {}

    return call


def _other_parameters(tmp_path: Path) -> Path:
    """Return the drive with a current loop of two thirds of its bandwidth."""
    text = Path(DEFAULT_CONFIG).read_text(encoding="utf-8")
    line = next(row for row in text.splitlines() if row.startswith("current_bandwidth_hz"))
    hertz = float(line.split("=")[1].split("#")[0])
    path = tmp_path / f"{Path(DEFAULT_CONFIG).name}"
    path.write_text(text.replace(line, f"current_bandwidth_hz = {hertz / 1.5:.0f}.0"))
    return path


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_the_recorded_parameters_give_every_output_bit_for_bit(
    folder: Path, run: Run, ending: str
) -> None:
    status, shown, found = run(folder / f"stop.{ending}")
    assert status == 0
    assert "every output equal" in shown
    assert found["equal"] and found["inputs_complete"] and not found["open_loop"]
    assert found["first_difference"] is None
    # Every millisecond has a slow step of each wheel, and those before time 0.
    assert found["slow_steps"] >= DRIVEN_MS * len(POSITIONS)
    drive = configuration.load(DEFAULT_CONFIG).drive
    assert drive is not None
    pwm_hz = drive.inverter.pwm_frequency_hz
    assert found["fast_steps"] == pytest.approx(found["slow_steps"] * pwm_hz / 1e3, rel=1e-3)


def test_one_bit_of_one_input_is_found(folder: Path, tmp_path: Path, run: Run) -> None:
    """The lowest bit of a code of the phase whose lower switch is closed longest, so it is used."""
    table = pq.read_table(folder / "stop.parquet")
    name = "fast_input.phase_current_code_b"
    column = table[name].to_numpy(zero_copy_only=False).copy()
    chosen = pc.and_(pc.equal(table["wheel"], 1), pc.equal(table["step"], "fast"))
    rows = np.flatnonzero(chosen.to_numpy(zero_copy_only=False))[:-2000]
    counts = [table[f"fast_output.compare_counts_{x}"].to_numpy()[rows] for x in "abc"]
    row = rows[np.argmin(counts, axis=0) == 1][-1]
    column[row] += 1 - 2 * (int(column[row]) & 1)
    changed = table.set_column(
        table.schema.get_field_index(name), table.schema.field(name),
        pa.array(column, pa.int32(), mask=np.isnan(column)),
    )  # fmt: skip
    pq.write_table(changed, tmp_path / "flipped.parquet", row_group_size=100_000)
    status, shown, found = run(tmp_path / "flipped.parquet")
    assert status == 1
    first = found["first_difference"]
    assert first["wheel"] == "front_right"
    assert first["signal"].startswith("fast_output.compare_counts_")
    assert first["recorded"] != first["replayed"]
    # The voltage of this very sample's step is another one.
    assert first["step"] == table["number"][row].as_py()
    assert "first difference" in shown


def test_other_parameters_are_said_to_be_open_loop(folder: Path, tmp_path: Path, run: Run) -> None:
    status, shown, found = run(
        folder / "stop.parquet", "--config", str(_other_parameters(tmp_path))
    )
    assert status == 0
    assert found["open_loop"] and not found["equal"]
    assert "no motor turned by it" in shown
    assert found["largest"]["fast_output.compare_counts_a"] > 0


def test_the_same_parameters_in_another_file_are_not_others(
    folder: Path, tmp_path: Path, run: Run
) -> None:
    copy = tmp_path / "copy.toml"
    copy.write_bytes(Path(DEFAULT_CONFIG).read_bytes())
    status, _, found = run(folder / "stop.parquet", "--config", str(copy))
    assert status == 0
    assert found["equal"] and not found["open_loop"]


def test_a_vehicle_simulated_again_repeats_itself(folder: Path, run: Run) -> None:
    """Fault and slope come again in their milliseconds, so plant and controllers are the same."""
    status, shown, found = run(folder / "stop.parquet", "--simulate")
    assert status == 0
    assert found["equal"] and found["simulated"] and not found["open_loop"]
    assert "closed loop" in shown


def test_with_other_parameters_the_simulated_wheels_brake_by_them(
    folder: Path, tmp_path: Path
) -> None:
    """A quarter of the current into the battery leaves its voltage lower, where it is simulated."""
    drive = configuration.load(DEFAULT_CONFIG).drive
    assert drive is not None
    image = configuration.image_of(drive)
    config: Any = layout.load().ffi.from_buffer("config_t *", image)
    quarter_ma = config.battery.max_charge_current_mA // 4
    limited = configuration.changed_image(image, {("battery", "max_charge_current_mA"): quarter_ma})
    place = len(steps.inputs(steps.SLOW)) + steps.outputs(steps.SLOW).index("bus_voltage_mV")
    highest_mv: list[int] = []
    for other, simulate in ((None, False), (replay.parameters_of(limited), True)):
        voltages_mv = [0]

        def take(part: Part, now: Steps, into: list[int] = voltages_mv) -> None:
            rows = (now["kind"] == steps.SLOW) & (part.time_s > 0.0)
            into.append(int(now["values"][rows, place].max()))

        found = replay.compared(
            Recording(folder / "stop.parquet"), other, simulate=simulate, take=take
        )
        assert not found.open_loop
        assert found.equal is (other is None)
        highest_mv.append(max(voltages_mv))
    assert highest_mv[1] < highest_mv[0]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda t: t.drop_columns(["slow_input.drive_torque_mNm"]), "no column slow_input."),
        (lambda t: t.replace_schema_metadata({}), "no provenance"),
        (lambda t: pa.concat_tables([t.slice(0, 9000), t.slice(9001)]), "steps of wheel 0 are"),
        (lambda t: t.slice(0, 0), "no step"),
    ],
)  # fmt: skip
def test_an_incomplete_recording_is_refused_in_one_line(
    folder: Path, tmp_path: Path, run: Run, change: Callable[[pa.Table], pa.Table], why: str
) -> None:
    pq.write_table(change(pq.read_table(folder / "stop.parquet")), tmp_path / "part.parquet")
    status, shown, _ = run(tmp_path / "part.parquet")
    assert status == 2
    assert shown.count("\n") == 1
    assert "not the complete inputs of a controller" in shown
    assert why in shown


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("absent.parquet", None, "file not found"),
        ("stop.mf4", b"", "accepted: a file that ends in"),
        ("text.parquet", b"no table", "cannot be read"),
        ("text.csv", b"no table\n", "not the complete inputs"),
    ],
)
def test_what_is_no_recording_is_refused_in_one_line(
    tmp_path: Path, run: Run, name: str, content: bytes | None, why: str
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    status, shown, _ = run(tmp_path / name)
    assert (status, shown.count("\n")) == (2, 1)
    assert why in shown


def test_a_recording_holds_no_key(folder: Path) -> None:
    """The vehicle's key opens its service; a recording is given away."""
    size = layout.load().size_bytes
    at = layout.load().ffi.offsetof("config_t", "service_key")
    images = {
        image
        for group in Recording(folder / "stop.parquet").groups()
        for part in group.parts
        for image in part.images
    }
    assert len(images) == len(POSITIONS)
    for image in images:
        assert len(image) == size
        assert not any(image[at : at + 16])


def test_a_recording_says_where_it_is_from(folder: Path) -> None:
    origin = Recording(folder / "stop.parquet").provenance
    assert origin["start"] == "boot"
    assert origin["scenario"] == "stop"
    assert len(origin["commit"].rstrip("+")) in {7, 40}
    stored = configuration.load(DEFAULT_CONFIG).image
    at = layout.load().ffi.offsetof("config_t", "crc32")
    (axle,) = origin["axles"]
    assert int(axle["config_crc32"], 16) == int.from_bytes(stored[at : at + 4], "little")


def test_record_takes_what_others_do_to_the_vehicle(
    tmp_path: Path, run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    """A vehicle that runs begins again, and a slope set by another program is in the file."""
    path = tmp_path / "live.parquet"
    with running(paced=False) as live:
        status = cli.main(["record", str(path), "--url", live.url, "--for", "0.5"])
        assert status == 0
        assert f"{path}: recorded" in capsys.readouterr().out
        world = Simulation(live.url)
        world.record(tmp_path / "second.parquet")
        world.set(slope=0.02)
        until(lambda: world.state()["recording_s"] > 0.3)
        world.stop_recording()
    events = [e for g in Recording(tmp_path / "second.parquet").groups() for e in g.events]
    assert any(e.parameter == "road.slope" and e.value == 0.02 for e in events)
    for file in (path, tmp_path / "second.parquet"):
        for options in ((), ("--simulate",)):
            assert run(file, *options)[2]["equal"]


def test_a_recording_ends_where_the_vehicle_begins_again(tmp_path: Path) -> None:
    with World(DEFAULT_CONFIG) as world:
        world.change({"record": str(tmp_path / "a.parquet")})
        _drive(world, 20)
        assert world.change({"scenario": None})["recording_s"] is None
        until(lambda: world.recorded == tmp_path / "a.parquet")
        _drive(world, 20)
    found = replay.compared(Recording(tmp_path / "a.parquet"), None, simulate=False)
    assert found.slow_steps == 20 * len(POSITIONS)


def test_each_axle_is_replayed_with_its_own_parameters(tmp_path: Path) -> None:
    rear = tmp_path / "rear.toml"
    rear.write_bytes(_other_parameters(tmp_path).read_bytes())
    with World(DEFAULT_CONFIG, rear=rear) as world:
        world.change({"record": str(tmp_path / "axles.parquet")})
        _drive(world, 200)
        world.change({"record": None})
    recording = Recording(tmp_path / "axles.parquet")
    assert [axle["drive"] for axle in recording.provenance["axles"]] == ["lu2013", "rear"]
    images = {part.wheel: part.images[0] for group in recording.groups() for part in group.parts}
    for wheel, of_the_same_axle in ((1, True), (2, False)):
        of_the_first = replay.parameters_of(images[wheel])(images[0])
        assert replay.same_parameters(of_the_first, images[0]) is of_the_same_axle
    for simulate in (False, True):
        assert replay.compared(recording, None, simulate=simulate).equal


def test_a_file_that_cannot_be_written_is_refused_and_nothing_begins_again(
    tmp_path: Path,
) -> None:
    with World(DEFAULT_CONFIG) as world:
        _drive(world, 5)
        number = world.number
        with pytest.raises(HubfocError, match=r"\.parquet or \.csv"):
            world.change({"record": str(tmp_path / "a.txt")})
        with pytest.raises(HubfocError, match="a\\.parquet"):
            world.change({"record": str(tmp_path / "absent" / "a.parquet")})
        assert world.number == number


def test_a_page_s_recording_ends_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(desk, "RECORDED_MS", 30)
    with World(DEFAULT_CONFIG) as world:
        own = desk.Desk(world, Clock(paced=False))
        world.change({"record": True})
        for _ in range(40):
            world.vehicle.step(own.before([]))
            own.after()
        until(lambda: world.recorded is not None)
        state = own.state(None)
        assert state["recording_s"] is None
        found = replay.compared(Recording(Path(state["recorded"])), None, simulate=False)
    assert found.equal
    assert found.slow_steps == 30 * len(POSITIONS)
    assert not Path(state["recorded"]).exists()  # in a folder that goes with its vehicle


@pytest.mark.parametrize("groups", [10, 100_000])
def test_a_curve_shows_the_bounds_of_what_was_recorded_and_replayed(
    folder: Path, monkeypatch: pytest.MonkeyPatch, groups: int
) -> None:
    """In engineering units: mrad/s are rad/s, against the table's own column."""
    monkeypatch.setattr(replays, "GROUPS", groups)
    found = replays.run(folder / "stop.parquet", 2, {}, simulate=False)
    assert found.equal
    drawn = replays.curve(found, "speed_rad_per_s")
    table = pq.read_table(folder / "stop.parquet")
    chosen = pc.and_(pc.equal(table["wheel"], 2), pc.equal(table["step"], "slow"))
    rad_s = table.filter(chosen)["slow_output.speed_mrad_s"].to_numpy() / 1e3
    assert drawn["recorded"] == drawn["replayed"]
    assert len(drawn["time_s"]) == len(drawn["recorded"]) <= max(2 * groups, len(rad_s))
    assert max(drawn["recorded"]) == pytest.approx(rad_s.max())
    assert min(drawn["recorded"]) == pytest.approx(rad_s.min())
    assert drawn["time_s"] == sorted(drawn["time_s"])
    if groups > len(rad_s):
        assert drawn["recorded"] == pytest.approx(list(rad_s))


def test_other_values_of_a_field_are_replayed_open_loop(folder: Path) -> None:
    """The stop was made with all of the motor's 40 N m, of which 30 would be commanded."""
    values = {"motor.max_torque_mNm": [30000]}
    found = replays.run(folder / "stop.parquet", 0, values, simulate=False)
    assert found.open_loop
    commanded = replays.curve(found, "motor_torque_command_nm")
    assert min(commanded["recorded"]) == -40.0
    assert min(commanded["replayed"]) == -30.0
    with pytest.raises(HubsimError, match=r"configuration refused: motor\.max_torque_mNm: 0,"):
        replays.run(folder / "stop.parquet", 0, {"motor.max_torque_mNm": [0]}, simulate=False)


def test_a_wheel_that_is_switched_on_stores_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not while a program's demand is on the bus; when the page has switched off it is stored."""
    field = "driver.lost_hold_ms"
    with running() as live:
        address, key = live.gateways.wheels[1].address, live.world.vehicle.key
        before = _values(address)[field]
        wanted = {field: [before[0] + 1]}
        with Vehicle(live.channel) as car, monkeypatch.context() as patched:
            car.demand()
            until(lambda: car.front_right.status().mode == "RUN")
            patched.setattr(parameters, "OFF_S", 0.2)
            with pytest.raises(HubfocError, match="switched on, accepted: while nobody drives"):
                parameters.store(address, key, wanted)
            assert _values(address)[field] == before
        cockpit = live.desk.cockpit
        until(lambda: not cockpit.foreign)
        cockpit.switched_off = True
        live.do(lambda: cockpit.take(object()))
        parameters.store(address, key, wanted)
        assert _values(address)[field] == wanted[field]
        assert _values(live.gateways.wheels[2].address)[field] == before


def _values(address: str) -> dict[str, list[int]]:
    with Service(Udp(address)) as wheel:
        return wheel.values()


def test_a_file_that_cannot_grow_is_said_and_leaves_none(tmp_path: Path) -> None:
    """As on a disk that is full: the process that writes may write 1000 bytes of a file."""
    with World(DEFAULT_CONFIG) as world:
        world.change({"record": str(tmp_path / "a.parquet")})
        assert world.recorder is not None
        resource.prlimit(world.recorder.pid, resource.RLIMIT_FSIZE, (1000, 1000))
        _drive(world, 20)
        world.change({"record": None})
        until(lambda: not world.state()["completes"])
        failure = world.state()["recording_failed"]
        assert failure.startswith(f"{tmp_path / 'a.parquet'}: cannot be written: ")
        assert "too large" in failure.lower()
        assert world.recorded is None
    assert not list(tmp_path.iterdir())


def test_a_writer_that_dies_is_said_and_the_vehicle_goes_on(tmp_path: Path) -> None:
    with World(DEFAULT_CONFIG) as world:
        world.change({"record": str(tmp_path / "a.parquet")})
        _drive(world, 5)
        assert world.recorder is not None
        os.kill(world.recorder.pid, signal.SIGKILL)
        _drive(world, 50)
        world.change({"record": None})
        until(lambda: not world.state()["completes"])
        assert world.state()["recording_failed"].endswith("the process that writes it has ended")
        assert world.recorded is None
    assert not list(tmp_path.iterdir())


def test_another_process_writes_the_recording(tmp_path: Path) -> None:
    """What the vehicle's process does beside the vehicle itself, of which it would be late.

    Handing 16 000 steps a second over is copying them: a tenth of what the vehicle takes. Making
    columns of them in a thread beside it was three quarters.
    """
    with World(DEFAULT_CONFIG) as world:
        world.change({"record": str(tmp_path / "a.parquet")})
        whole_s, own_s = time.process_time(), time.thread_time()
        _drive(world, 2000)
        own_s = time.thread_time() - own_s
        world.change({"record": None})
        while world.recorded is None:
            time.sleep(0.2)
        whole_s = time.process_time() - whole_s
    assert whole_s - own_s < 0.25 * own_s
