# SPDX-License-Identifier: Apache-2.0
"""The signals of a live vehicle for viewers that others have made: Foxglove and PlotJuggler.

Both get all signals of the history, a hundred times a second of simulated time, under the names
that they have everywhere. They only watch: nothing that a viewer sends is listened to.
"""

import importlib
import json
import math
import socket
import time
from collections.abc import Iterable, Sequence
from typing import Any, Protocol

import numpy as np
from hubsim.engine import Rows

from hubfoc.errors import HubfocError
from hubfoc.live.history import History

ROWS = 10  # of the history from one message to the next
LOCAL = "127.0.0.1"
NS = 1e9


class Viewer(Protocol):
    """What a row of signals can be shown to."""

    def begin(self, history: History) -> None:
        """Start with another vehicle, whose time is zero."""

    def show(self, time_s: float, row: Rows) -> None:
        """Send all signals at this time of the simulation."""

    def close(self) -> None:
        """Free what belongs to it."""


def _finite(value: float) -> float | None:
    """Return a number that JSON has."""
    return value if math.isfinite(value) else None


class PlotJuggler:
    """JSON in datagrams, for PlotJuggler's UDP server with its protocol "json".

    One object each: ``timestamp`` in seconds of simulated time (there: "use the field timestamp")
    and every signal by its name. Nothing tells whether somebody listens.

    Parameters
    ----------
    address : str
        ``HOST:PORT``.
    """

    def __init__(self, address: str) -> None:
        host, port = destination(address)
        try:
            family, kind, _, _, to = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise HubfocError(f"--plotjuggler {address}: {error}") from None
        self._socket = socket.socket(family, kind)
        self._socket.setblocking(False)
        self._to: Any = to
        self._names: list[str] = []

    def begin(self, history: History) -> None:
        """Start with another vehicle, whose time is zero."""
        self._names = history.names

    def show(self, time_s: float, row: Rows) -> None:
        """Send all signals at this time of the simulation."""
        values = dict(zip(self._names, map(_finite, row.tolist()), strict=True))
        text = json.dumps({"timestamp": time_s, **values}, separators=(",", ":"))
        try:
            self._socket.sendto(text.encode(), self._to)
        except OSError:  # nobody is there, or not as fast
            return

    def close(self) -> None:
        """Free the socket."""
        self._socket.close()


def destination(address: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``."""
    host, colon, port = address.rpartition(":")
    if not (colon and host and port.isdecimal() and 0 < int(port) < 65536):
        raise HubfocError(f"--plotjuggler {address}: accepted: HOST:PORT, PORT 1 to 65535")
    return host.strip("[]"), int(port)


def grouped(names: Iterable[str]) -> dict[str, list[str]]:
    """Return names by the part before their first dot."""
    out: dict[str, list[str]] = {}
    for name in names:
        out.setdefault(name.partition(".")[0], []).append(name)
    return out


def schema(members: Sequence[str], meanings: dict[str, tuple[str, str]]) -> dict[str, Any]:
    """Return the JSON schema of signals that share the part of their names before the first dot."""
    return {
        "type": "object",
        "properties": {
            name.partition(".")[2] or name: {
                "type": "number",
                "description": " ".join(f"{meanings[name][1]}, {meanings[name][0]}".split()),
            }
            for name in members
        },
    }


class Foxglove:
    """A server of Foxglove's WebSocket protocol on this machine, with the SDK of its makers.

    Topics are the parts of the names before the first dot (``/wheel0``, ``/battery``); what
    follows is the field. Times are the wall's at the start of the vehicle plus simulated time.

    Parameters
    ----------
    port : int
        On 127.0.0.1; 0: any that is free.
    """

    def __init__(self, port: int) -> None:
        try:  # only here: 54 MB that the virtual vehicle needs for this alone
            foxglove = importlib.import_module("foxglove")
        except ModuleNotFoundError:
            raise HubfocError("--foxglove needs a package: pip install 'hubfoc[live]'") from None
        self._made = foxglove
        self._context = foxglove.Context()
        try:
            self._server = foxglove.start_server(
                name="hubfoc", host=LOCAL, port=port, context=self._context
            )
        except (RuntimeError, OSError) as error:
            raise HubfocError(f"--foxglove {port}: {error}") from None
        self.url = f"ws://{LOCAL}:{self._server.port}"
        self._topics: list[tuple[Any, list[str], Any]] = []
        self._begun_ns = 0

    def begin(self, history: History) -> None:
        """Start with another vehicle, whose time is zero."""
        self._begun_ns = time.time_ns()
        self._server.clear_session()
        for channel, _, _ in self._topics:
            channel.close()
        self._topics = [
            (
                self._made.Channel(
                    f"/{group}", message_encoding="json", context=self._context,
                    schema=schema(members, history.meanings),
                ),
                [name.partition(".")[2] or name for name in members],
                history.places(members),
            )
            for group, members in grouped(history.names).items()
        ]  # fmt: skip

    def show(self, time_s: float, row: Rows) -> None:
        """Send all signals at this time of the simulation."""
        now_ns = self._begun_ns + round(NS * time_s)
        for channel, fields, places in self._topics:
            values = map(_finite, np.take(row, places).tolist())
            channel.log(dict(zip(fields, values, strict=True)), log_time=now_ns)

    def close(self) -> None:
        """End the server."""
        self._server.stop()


class Viewers:
    """All viewers of one live vehicle."""

    def __init__(self, viewers: Sequence[Viewer]) -> None:
        self._viewers = viewers
        self._history: History | None = None

    def show(self, history: History, time_s: float) -> None:
        """Take notice of another row of the history."""
        if history is not self._history:
            self._history = history
            for viewer in self._viewers:
                viewer.begin(history)
        if history.count % ROWS == 0:
            row = history.row
            for viewer in self._viewers:
                viewer.show(time_s, row)

    def close(self) -> None:
        """Free what belongs to them."""
        for viewer in self._viewers:
            viewer.close()
