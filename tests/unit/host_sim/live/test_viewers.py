# SPDX-License-Identifier: Apache-2.0
"""What other people's viewers receive, read as their protocols are published."""

import base64
import json
import os
import socket
import struct
from typing import Any

import numpy as np
import pytest
from hubfoc.errors import HubfocError
from hubfoc.live.history import History
from hubfoc.live.vehicle import SimulatedVehicle
from hubfoc.live.viewers import ROWS, Foxglove, PlotJuggler, Viewers, destination
from hubsim import cli
from regen_table import schema

SUBSCRIBED = 7
MESSAGE_DATA = 1  # first byte of a binary message of Foxglove's protocol
STEPS = 5 * ROWS


class Studio:
    """A reader of Foxglove's WebSocket protocol: its topics, and the messages of one."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=30)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            "GET / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Upgrade: websocket",
            "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Protocol: foxglove.sdk.v1",
        ]  # fmt: skip
        self._socket.sendall("\r\n".join([*lines, "", ""]).encode())
        self._file = self._socket.makefile("rb")
        assert b"101" in self._file.readline()
        while self._file.readline().strip():
            pass

    def close(self) -> None:
        self._socket.sendall(struct.pack(">BB", 0x88, 0x80) + bytes(4))
        self._file.close()
        self._socket.close()

    def hear(self) -> bytes:
        kind, length = struct.unpack(">BB", self._file.read(2))
        if length == 126:
            (length,) = struct.unpack(">H", self._file.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self._file.read(8))
        assert kind in (0x81, 0x82)
        return self._file.read(length)

    def channels(self, wanted: int) -> dict[str, dict[str, Any]]:
        found: dict[str, dict[str, Any]] = {}
        while len(found) < wanted:
            text = json.loads(self.hear())
            if text["op"] == "advertise":
                found |= {channel["topic"]: channel for channel in text["channels"]}
        return found

    def subscribe(self, channel: int) -> None:
        wanted = [{"id": SUBSCRIBED, "channelId": channel}]
        data = json.dumps({"op": "subscribe", "subscriptions": wanted}).encode()
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
        assert len(data) < 126
        self._socket.sendall(struct.pack(">BB", 0x81, 0x80 | len(data)) + mask + masked)

    def message(self) -> tuple[int, dict[str, float]]:
        while (data := self.hear())[0] != MESSAGE_DATA:
            pass
        subscription, time_ns = struct.unpack_from("<IQ", data, 1)
        assert subscription == SUBSCRIBED
        return time_ns, json.loads(data[13:])


@pytest.fixture
def history() -> History:
    with SimulatedVehicle(schema.load(cli.DEFAULT_CONFIG)) as vehicle:
        recorded = History(vehicle)
        for _ in range(STEPS):
            vehicle.step([])
            recorded.record(vehicle)
        return recorded


def test_plotjuggler_gets_every_signal_by_its_name(history: History) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(30)
        viewer = PlotJuggler(f"127.0.0.1:{listener.getsockname()[1]}")
        shown = Viewers([viewer])
        shown.show(history, 0.25)
        sent = json.loads(listener.recv(1 << 16))
        shown.close()
    assert sent.pop("timestamp") == 0.25
    assert list(sent) == history.names
    assert list(sent.values()) == history.row.tolist()


def test_a_viewer_gets_one_row_of_ten_and_what_is_not_finite_is_null(history: History) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(30)
        viewer = PlotJuggler(f"127.0.0.1:{listener.getsockname()[1]}")
        shown = Viewers([viewer])
        history.row[0] = np.nan
        for _ in range(2 * ROWS):
            history.count += 1
            shown.show(history, history.count / 1e3)
        sent = [json.loads(listener.recv(1 << 16)) for _ in range(2)]
        shown.close()
    assert [round(1e3 * one["timestamp"]) for one in sent] == [STEPS + ROWS, STEPS + 2 * ROWS]
    assert sent[0][history.names[0]] is None


def test_foxglove_is_told_topics_units_and_values(history: History) -> None:
    viewer = Foxglove(0)
    viewer.begin(history)
    studio = Studio(int(viewer.url.rpartition(":")[2]))
    topics = {name.partition(".")[0] for name in history.names}
    channels = studio.channels(len(topics))
    assert set(channels) == {f"/{topic}" for topic in topics}
    channel = channels["/wheel0"]
    assert channel["encoding"] == "json"
    properties = json.loads(channel["schema"])["properties"]
    unit, meaning = history.meanings["wheel0.motor_torque_nm"]
    assert properties["motor_torque_nm"]["description"] == f"{meaning}, {unit}"
    studio.subscribe(channel["id"])
    sent_s = 0.0
    received: list[tuple[int, dict[str, float]]] = []
    studio._socket.settimeout(0.2)
    while not received:  # the subscription takes a while to arrive
        sent_s += 0.01
        viewer.show(sent_s, history.row)
        try:
            received.append(studio.message())
        except TimeoutError:
            studio._file = studio._socket.makefile("rb")
    time_ns, values = received[0]
    studio.close()
    viewer.close()
    expected = {
        name.partition(".")[2]: history.row[k]
        for k, name in enumerate(history.names)
        if name.startswith("wheel0.")
    }
    assert values == expected
    assert abs(time_ns - viewer._begun_ns - round(1e9 * sent_s)) <= 2_000_000_000


def test_where_nobody_can_be_is_one_line() -> None:
    for address in ("9870", "localhost:", "localhost:0", ":9870", "localhost:65536"):
        with pytest.raises(HubfocError, match="accepted: HOST:PORT"):
            destination(address)
    with pytest.raises(HubfocError, match="plotjuggler"):
        PlotJuggler("no.such.host.invalid:9870")
    first = Foxglove(0)
    port = int(first.url.rpartition(":")[2])
    with pytest.raises(HubfocError, match=f"--foxglove {port}"):
        Foxglove(port)
    first.close()
