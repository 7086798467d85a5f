# SPDX-License-Identifier: Apache-2.0
"""What the page is made of and told: accounts, limits, findings, the stream."""

import base64
import io
import json
import os
import re
import socket
import struct
from collections.abc import Iterator
from importlib.resources import files
from typing import Any, Self
from urllib.parse import urlsplit

import black_box_memory
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hubfoc.errors import HubfocError
from hubfoc.live import black_boxes, desk, exports, limits, page
from hubfoc.live.history import DRAWN, NOT_SHOWN, RETURNED, ROWS, History
from hubfoc.live.vehicle import SimulatedVehicle
from hubfoc.live.websocket import VERSION
from hubsim import cli, engine, reasons, scenario
from regen_table import schema

from tests.unit.host_sim.live.support import Running, running, until

MOST_BYTES = 400_000
# RFC 6455, section 1.3.
KEY, ACCEPTED = "dGhlIHNhbXBsZSBub25jZQ==", "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="


class Client:
    """A page without a browser."""

    def __init__(self, url: str, origin: str | None = None) -> None:
        place = urlsplit(url)
        self._socket = socket.create_connection((str(place.hostname), place.port or 0), timeout=30)
        lines = [
            f"GET {place.path}stream HTTP/1.1", f"Host: {place.netloc}", "Upgrade: websocket",
            "Connection: Upgrade", f"Sec-WebSocket-Key: {KEY}",
            f"Sec-WebSocket-Version: {VERSION}", f"Origin: {origin or f'http://{place.netloc}'}",
        ]  # fmt: skip
        self._socket.sendall("\r\n".join([*lines, "", ""]).encode())
        self._file = self._socket.makefile("rb")
        self.head = []
        while (line := self._file.readline().strip()) != b"":
            self.head.append(line.decode())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.shutdown(socket.SHUT_WR)
        while self._file.read(65536):  # its end: the service has taken the controls back
            pass
        self._file.close()
        self._socket.close()

    def say(self, **wanted: object) -> None:
        data, mask = json.dumps(wanted).encode(), os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
        head = struct.pack(">BB", 0x81, 0x80 | len(data)) if len(data) < 126 else struct.pack(
            ">BBH", 0x81, 0x80 | 126, len(data))  # fmt: skip
        self._socket.sendall(head + mask + masked)

    def hear(self) -> dict[str, Any] | bytes:
        kind, length = struct.unpack(">BB", self._file.read(2))
        if length == 126:
            (length,) = struct.unpack(">H", self._file.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self._file.read(8))
        data = self._file.read(length)
        return data if kind == 0x82 else dict(json.loads(data))

    def message(self, *kinds: str) -> dict[str, Any]:
        while True:
            message = self.hear()
            if isinstance(message, dict) and message["kind"] in kinds:
                return message

    def rows(self, curves: int) -> tuple[int, list[float], Any]:
        """Return the first row's number, the signals shown, and the curves' rows."""
        while True:
            message = self.hear()
            if isinstance(message, bytes):
                _, first, count, given = struct.unpack_from("<4I", message)
                if given == curves:
                    values = np.frombuffer(message, "<f4", offset=16)
                    cut = len(values) - count * curves
                    return first, values[:cut].tolist(), values[cut:].reshape(count, curves)


@pytest.fixture(scope="module")
def vehicle() -> Iterator[Running]:
    with running() as own:
        yield own


def test_the_page_is_one_document_of_at_most_400_kb() -> None:
    text = page.document()
    assert len(text.encode()) <= MOST_BYTES
    own = text.replace((files("hubfoc.live") / "browser" / page.LIBRARY).read_text("utf-8"), "")
    assert set(re.findall(r"https?://([\w.]+)", own)) == {"www.w3.org"}  # the name of SVG
    assert not re.search(r'\b(?:src|href)="(?!data:)', text)
    assert text.count("</script>") == 2


def test_modules_come_after_those_that_they_need() -> None:
    order = page.modules()
    assert order[-1] == "main.js"
    assert len(order) == len(set(order)) > 8
    for place, name in enumerate(order):
        assert set(page.modules(name)) <= set(order[: place + 1])


def test_accounts_are_those_of_the_simulation() -> None:
    """Battery: terminal work = chemical work - heat - stored in polarisation. Brakes: their heat.

    A stop from 40 km/h, sampled each millisecond: sums of rows against integrals.
    """
    drive = schema.load(cli.DEFAULT_CONFIG)
    _, stop, beside = scenario.load("stop", {}, drive)
    with SimulatedVehicle(drive, stop, beside) as vehicle:
        history = History(vehicle)
        while not vehicle.ended:
            vehicle.step([])
            history.record(vehicle)
        latest = dict(zip(history.names, history.latest(history.places(history.names)),
                          strict=True))  # fmt: skip
        terminal_j = sum(
            sign * vehicle.value(f"energy.{name}_j")
            for name, sign in (("chemical", 1), ("battery", -1), ("polarisation", -1))
        )
        hydraulic_j = vehicle.value("energy.hydraulic_j")
    assert latest[DRAWN] - latest[RETURNED] == pytest.approx(terminal_j, rel=0.01)
    assert latest[RETURNED] > 10.0 * latest[DRAWN]
    assert history.cost_j.sum() == pytest.approx(hydraulic_j, rel=0.01)
    codes = reasons.codes()
    of_lines = [limits.cost_of_lines(of_wheel) for of_wheel in history.cost_j]
    assert of_lines[0]["BLEND_OUT"] + of_lines[0]["LOSS_OPTIMUM"] + of_lines[0]["TORQUE_RATE"] > (
        0.9 * history.cost_j[0].sum()
    )
    assert sum(of_lines[0].values()) == pytest.approx(
        history.cost_j[0].sum() - history.cost_j[0, codes["NONE"]]
    )


def test_the_last_minute_is_kept() -> None:
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        history = History(vehicle)
        assert not any(NOT_SHOWN.search(name) for name in history.names)
        place = history.places(["time_s"])
        vehicle.step([])
        for _ in range(ROWS + 500):
            history.record(vehicle)
        first, rows = history.rows(0, place)
        assert first + len(rows) == history.count == ROWS + 500
        assert len(rows) >= ROWS - 1
        first, rows = history.rows(ROWS + 490, place)
        assert (first, len(rows)) == (ROWS + 490, 10)
        assert history.latest(place)[0] == pytest.approx(0.001)


def test_every_line_of_the_firmwares_table_has_its_reasons() -> None:
    header = engine.ROOT / "firmware" / "torque" / "include" / "torque" / "torque_limits.h"
    table = header.read_text(encoding="utf-8").partition("#define TORQUE_LINES")[2]
    lines = re.findall(r"X\((\w+), (?:true|false)\)", table)
    assert set(lines) - {"RETURNED_PEAK"} == set(limits.texts())  # its reasons are RETURNED's
    assert {name for names in limits.REASONS.values() for name in names} <= set(reasons.codes())


def test_the_shells_table_is_read_whole() -> None:
    """The tightest bound of a side is its smallest."""
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        inquiry = limits.Inquiry()
        inquiry.wanted = {2}
        while 2 not in inquiry.tables:
            vehicle.step([])
            inquiry.ask(vehicle)
            inquiry.received(2, vehicle.serial_take(2), vehicle.time_s)
            assert vehicle.time_s < 5.0
    _, lines = inquiry.tables[2]
    header = engine.ROOT / "firmware" / "torque" / "include" / "torque" / "torque_limits.h"
    table = header.read_text(encoding="utf-8").partition("#define TORQUE_LINES")[2]
    assert [line.name for line in lines] == re.findall(r"X\((\w+), (?:true|false)\)", table)
    for bounds, stars in (
        ([line.driving_nm for line in lines], [line.tightest_driving for line in lines]),
        ([line.braking_nm for line in lines], [line.tightest_braking for line in lines]),
    ):
        known = [bound for bound in bounds if bound is not None]
        assert bounds[stars.index(True)] == min(known)


def test_who_types_at_a_terminal_has_the_shell_alone() -> None:
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        inquiry = limits.Inquiry()
        inquiry.wanted = {1}
        vehicle.step([])
        inquiry.typed(1, vehicle.time_s)
        for _ in range(1000):
            vehicle.step([])
            inquiry.ask(vehicle)
            written = vehicle.serial_take(1)
            assert inquiry.received(1, written, vehicle.time_s) == written
        assert inquiry.tables == {}


def test_a_command_is_answered_between_two_tables() -> None:
    """The shell names itself; `limits` is asked five times a second all the time."""
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        inquiry = limits.Inquiry()
        inquiry.wanted = {0}
        found = inquiry.command(1, "version", 0.0), inquiry.command(0, "version", 0.0)
        while not all(answer.done() for answer in found) or 0 not in inquiry.tables:
            vehicle.step([])
            inquiry.ask(vehicle)
            for wheel in (0, 1):
                assert inquiry.received(wheel, vehicle.serial_take(wheel), vehicle.time_s) == b""
            assert vehicle.time_s < 5.0
        assert all("hubfoc" in answer.result() for answer in found)
        assert 1 not in inquiry.tables
        inquiry.typed(0, vehicle.time_s)
        with pytest.raises(HubfocError, match="somebody types"):
            inquiry.command(0, "version", vehicle.time_s)
        forgotten = inquiry.command(1, "version", vehicle.time_s)
        inquiry.begin()
        with pytest.raises(HubfocError, match="begun again"):
            forgotten.result()


def test_a_shell_without_an_answer_is_given_up() -> None:
    class Silent:
        time_s = 0.0

        def serial_type(self, wheel: int, text: bytes) -> None:
            """Take it and do nothing."""

    silent, inquiry = Silent(), limits.Inquiry()
    answer = inquiry.command(0, "version", 0.0)
    inquiry.ask(silent)  # type: ignore[arg-type]
    silent.time_s = limits.COMMAND_S - 0.1
    inquiry.ask(silent)  # type: ignore[arg-type]
    assert not answer.done()
    silent.time_s = limits.COMMAND_S
    inquiry.command(0, "version", silent.time_s)
    inquiry.ask(silent)  # type: ignore[arg-type]
    with pytest.raises(HubfocError, match="does not answer"):
        answer.result()


def test_the_black_box_shows_what_the_fault_did(vehicle: Running) -> None:
    """The gate driver reports a fault while the wheel drives: the bridge opens, currents end.

    Without current the inverter has the battery's voltage. The program began with the vehicle, and
    the page had the finding by CAN: at most a cycle of WheelState later, 10 ms.
    """
    with Client(vehicle.url) as own:
        own.say(do="blackbox", wheel=3)
        none = own.message("blackbox")
        assert (none["reason"], none["panels"]) == (None, [])
        assert none["lines"]
        until(lambda: vehicle.value("wheel3.mode") == 4)
        for _ in range(20):
            own.say(do="drive", accelerator=0.5, brake=0, direction="forward")
            own.message("state")
            if vehicle.value("wheel3.speed_rad_per_s") > 2.0:
                break
        own.say(do="change", change={"fault": "gate_driver", "wheel": "rear_right"})
        while not (lines := own.message("state")["findings"]):
            pass
        found = next(line for line in lines if line["wheel"] == 3 and line["kind"] == "fault")
        battery_v = vehicle.value("battery.voltage_v")
        until(lambda: vehicle.value("time_s") > found["from_s"] + 0.6)  # half a second more
        own.say(do="blackbox", wheel=3)
        shown = own.message("blackbox")
        own.say(do="change", change={"scenario": None})
    assert shown["reason"] == found["reason"]
    assert shown["text"] == found["text"]
    assert 0.0 <= found["from_s"] - shown["fault_s"] < 0.012
    currents, bus, torque, speed = shown["panels"]
    fast_s, slow_s = np.array(currents["time_s"]), np.array(speed["time_s"])
    assert fast_s[[0, -1]] == pytest.approx([0.005 - 399 / 20000, 0.005])
    assert slow_s[[0, -1]] == pytest.approx([0.5 - 1.99, 0.5])
    phases_a = np.array([curve["values"] for curve in currents["curves"]])
    assert np.abs(phases_a.sum(axis=0)).max() < 1.0  # three times half a code
    assert np.abs(phases_a[:, fast_s < -1e-3]).max() > 10.0
    assert np.abs(phases_a[:, fast_s > 3e-3]).max() < 0.5
    assert np.array(bus["curves"][0]["values"])[-20:] == pytest.approx(battery_v, rel=0.02)
    estimate_nm = np.array(torque["curves"][1]["values"])
    assert estimate_nm[slow_s < 0.0][-5:].min() > 5.0
    drag_nm = estimate_nm[slow_s > 0.05]  # iron and bearings
    assert np.all((drag_nm <= 0.0) & (drag_nm > -1.0))
    assert np.array(speed["curves"][0]["values"])[slow_s > 0.0].min() > 1.5


def test_a_terminals_log_is_drawn_as_well(vehicle: Running) -> None:
    drive = vehicle.desk.drive_of(0)
    found = black_boxes.shown(black_box_memory.printed(black_box_memory.memory()), drive)
    assert found["reason"] == "OVERCURRENT"
    phase_a = found["panels"][0]["curves"][0]["values"]
    full_a = drive.inverter.current_full_scale_a
    assert phase_a == pytest.approx([n / 2048 * full_a for n in range(400)], abs=1e-3)


def mcap_records(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield operation code and content of every record of an MCAP file (mcap.dev/spec).

    A chunk's records come in its place. Its content: times and size (8 bytes each), a checksum (4),
    the compression's name and the records, each with its length before it.
    """
    assert content[:8] == content[-8:] == b"\x89MCAP0\r\n"

    def within(data: bytes) -> Iterator[tuple[int, bytes]]:
        at = 0
        while at < len(data):
            code, length = struct.unpack_from("<BQ", data, at)
            yield code, data[at + 9 : at + 9 + length]
            at += 9 + length

    for code, record in within(content[8:-8]):
        if code != 0x06:
            yield code, record
            continue
        (size,) = struct.unpack_from("<Q", record, 16)
        (named,) = struct.unpack_from("<I", record, 28)
        kind = record[32 : 32 + named].decode()
        packed = record[40 + named :]
        yield from within(pa.decompress(packed, size, kind, asbytes=True) if kind else packed)


def test_curves_as_mcap_have_their_names_units_and_times() -> None:
    """Channel 0x04: number, schema, topic. Message 0x05: channel, number, two times, JSON."""
    columns = {
        "time_s": np.array([-0.001, 0.0, 0.001]),
        "wheel0.motor_torque_nm": np.array([1.5, 2.5, 3.5]),
        "battery.soc": np.array([0.5, 0.25, 0.125]),
    }
    meanings = {"wheel0.motor_torque_nm": ("N.m", "its torque"), "battery.soc": ("1", "charge")}
    topics: dict[int, str] = {}
    found: dict[str, list[tuple[int, dict[str, float]]]] = {}
    schemas = []
    for code, record in mcap_records(exports.content("mcap", columns, meanings)):
        if code == 0x03:
            schemas.append(record)
        elif code == 0x04:
            number, _, length = struct.unpack_from("<HHI", record)
            topics[number] = record[8 : 8 + length].decode()
        elif code == 0x05:
            number, _, time_ns, _ = struct.unpack_from("<HIQQ", record)
            found.setdefault(topics[number], []).append((time_ns, json.loads(record[22:])))
    assert set(found) == {"/wheel0", "/battery"}
    assert any(b"its torque, N.m" in text for text in schemas)
    rows = found["/wheel0"]
    assert [row["motor_torque_nm"] for _, row in rows] == [1.5, 2.5, 3.5]
    assert [row["time_s"] for _, row in rows] == [-0.001, 0.0, 0.001]
    assert np.diff([time_ns for time_ns, _ in rows]).tolist() == [1_000_000, 1_000_000]
    assert [row["soc"] for _, row in found["/battery"]] == [0.5, 0.25, 0.125]


def test_the_scope_records_what_the_page_chooses_in_its_units(vehicle: Running) -> None:
    """At rest: no current, the battery's voltage at the inverter, a sampled value each period."""
    with Client(vehicle.url) as own:
        until(lambda: vehicle.value("wheel2.mode") == 4)
        names = ["fast_input.phase_current_code_a", "output.bus_voltage_v"]
        own.say(do="scope", wheel=2, signals=names, trigger="none", on="", level="",
                    before=0.25, every=1)  # fmt: skip
        found = own.message("scope")
        battery_v = vehicle.value("battery.voltage_v")
        own.say(do="scope", wheel=2, signals=names, trigger="rises", on="nonsense", level="1",
                    before=0, every=1)  # fmt: skip
        assert "no such signal to trigger on" in own.message("refused")["why"]
        own.say(do="export", of="scope", format="parquet")
        content = base64.b64decode(own.message("file")["content"])
        own.say(do="export", of="scope", format="xls")
        assert own.message("refused")["why"] == "'xls': accepted: parquet, mcap"
    period_s = 1.0 / schema.load(cli.DEFAULT_CONFIG).inverter.pwm_frequency_hz
    assert np.diff(found["time_s"]) == pytest.approx(period_s, rel=1e-3)
    assert found["time_s"][0] < 0.0 < found["time_s"][-1]
    current, bus = found["curves"]
    assert (current["unit"], bus["unit"]) == ("A", "V")
    assert np.abs(current["values"]).max() < 0.5
    assert bus["values"] == pytest.approx(np.full(len(bus["values"]), battery_v), rel=0.01)
    table = pq.read_table(io.BytesIO(content))
    assert table.column_names == ["time_s", *names]
    assert table[names[0]].to_pylist() == pytest.approx(current["values"], rel=1e-6)


def test_the_stream_opens_as_the_standard_says_and_only_for_its_own_page(vehicle: Running) -> None:
    with Client(vehicle.url) as own:
        assert own.head[0].startswith("HTTP/1.1 101") or own.head[0].startswith("HTTP/1.0 101")
        assert f"Sec-WebSocket-Accept: {ACCEPTED}" in own.head
        assert own.message("hello")["vehicle"] == "lu2013"
    with Client(vehicle.url, origin="http://elsewhere") as other:
        assert " 403 " in other.head[0]


def test_the_first_page_has_the_controls_until_it_is_gone(vehicle: Running) -> None:
    until(lambda: vehicle.desk.cockpit.owner is None)
    with Client(vehicle.url) as first:
        assert first.message("state")["controls"] == "own"
        with Client(vehicle.url) as second:
            assert second.message("state")["controls"] == "another page"
            second.say(do="take")
            assert "another page has the controls" in second.message("refused")["why"]
            second.say(do="change", change={"slope": 0.1})
            assert "this page watches" in second.message("refused")["why"]
            first.say(do="release")
            while second.message("state")["controls"] != "free":
                pass
            second.say(do="take")
            while second.message("state")["controls"] != "own":
                pass
    until(lambda: vehicle.desk.cockpit.owner is None)


def test_rows_of_chosen_curves_follow_each_other(vehicle: Running) -> None:
    with Client(vehicle.url) as own:
        hello = own.message("hello")
        assert set(hello["shown"]) <= set(hello["signals"])
        own.say(do="curves", names=["time_s", "battery.soc", "nonsense"])
        first, shown, rows = own.rows(2)
        for _ in range(5):
            following, shown, more = own.rows(2)
            assert following == first + len(rows)
            first, rows = following, more
        assert len(shown) == len(hello["shown"])
        assert rows[:, 0] == pytest.approx(1e-3 * (first + 1 + np.arange(len(rows))), abs=1e-5)


def test_what_no_page_can_want_is_refused_in_a_line(vehicle: Running) -> None:
    with Client(vehicle.url) as own:
        own.say(do="fly")
        assert own.message("refused")["why"] == "'fly' is not accepted"
        own.say(do="drive", accelerator=2, brake=0, direction="forward")
        assert "accepted: 0 to 1" in own.message("refused")["why"]
        own.say(do="change", change={"fault": "current_a_dea"})
        assert "did you mean" in own.message("refused")["why"]


def test_another_scenario_is_another_vehicle_for_the_page(vehicle: Running) -> None:
    with Client(vehicle.url) as own:
        before = own.message("hello")["number"]
        own.say(do="change", change={"scenario": "hill_hold"})
        again = own.message("hello")
        assert again["number"] == before + 1
        assert own.message("state")["scenario"] == "hill_hold"
        first, _, _ = own.rows(0)
        assert first < 5000
        own.say(do="change", change={"scenario": None})


def test_signals_of_the_page_are_known(vehicle: Running) -> None:
    known = vehicle.desk.history.meanings
    assert {f"wheel0.{name}" for name in desk.OF_WHEEL} <= set(known)
    assert set(desk.OF_VEHICLE) <= set(known)
