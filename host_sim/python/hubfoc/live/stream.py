# SPDX-License-Identifier: Apache-2.0
"""What goes to a page and comes from it, over one WebSocket.

To the page, as text (JSON with ``kind``): ``hello`` once for each vehicle, ``state`` five times a
second, ``refused`` with the reason. As binary, little endian, sixty times a second: the vehicle's
number, the first row, how many rows, how many curves (4 bytes each), then as 32-bit floats the
signals of hello's ``shown`` now, and the rows of the chosen curves. From the page, as text: JSON
with ``do`` (``Desk.do``), or ``curves`` with their names. What takes seconds (``SLOW``) a thread
of its own does, one at a time for a page, and answers with ``parameters``, ``replay``,
``blackbox``, ``armed`` and ``scope``, ``step`` or ``file`` (in base64); ``replayed``
asks for another signal of the latest replay.
"""

import base64
import json
import struct
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from threading import Thread
from typing import Any

import numpy as np
from hubsim.errors import HubsimError
from regen_table.errors import ConfigurationError

from hubfoc.errors import HubfocError
from hubfoc.live import black_boxes, exports, parameters, replays, scopes, step_tests
from hubfoc.live.desk import Desk
from hubfoc.live.orders import Orders
from hubfoc.live.service import Handler
from hubfoc.live.websocket import WebSocket, opened

UPDATE_S = 1.0 / 60.0
STATE_S = 0.2
CURVES = 24
SLOW = ("parameters", "store", "replay", "blackbox", "scope", "step", "export")
ANSWER_S = 30.0  # of a wheel's shell, whose vehicle may be slower than the clock
# Of whoever wrote what a page wants, or of the vehicle.
MISTAKES = (
    *(HubfocError, HubsimError, ConfigurationError),
    *(ValueError, KeyError, TypeError, AttributeError, OverflowError),
)
ABOUT = ("wheel", "words", "open_loop", "simulated", "equal")  # of a replay
ROWS_AT_ONCE = 60000

Message = dict[str, Any]  # to the page, with its ``kind``


def refusal(why: str) -> Message:
    """Of what a page wants, with the reason."""
    return {"kind": "refused", "why": why}


class Page:
    """One page in a browser."""

    def __init__(self, desk: Desk, orders: Orders, socket: WebSocket) -> None:
        self._desk, self._orders, self._socket = desk, orders, socket
        self._curves: list[str] = []
        self._next = 0  # row
        self._number = -1  # of the vehicle that the page knows
        self._closed = False
        self._busy = False
        self._replayed: replays.Replayed | None = None
        self._scope: scopes.Found | None = None

    def run(self) -> None:
        """Serve the page until it is gone."""
        self._orders.call(lambda: self._desk.arrive(self))
        writer = Thread(target=self._write, daemon=True)
        writer.start()
        try:
            while (text := self._socket.receive()) is not None:
                self._take(text)
        except OSError:
            pass
        finally:
            self._closed = True
            self._orders.call(lambda: self._desk.leave(self))
            writer.join()

    def _take(self, text: str) -> None:
        try:
            wanted = json.loads(text)
            if wanted.get("do") == "curves":
                self._choose([str(name) for name in wanted["names"]])
            elif wanted.get("do") in SLOW:
                self._begin(wanted)
            elif wanted.get("do") == "replayed":
                self._send(self._curve(str(wanted["signal"])))
            else:
                self._orders.call(lambda: self._desk.do(self, wanted))
        except (HubfocError, ValueError, KeyError, TypeError, AttributeError) as error:
            self._refuse(str(error))

    def _begin(self, wanted: dict[str, Any]) -> None:
        """Do what takes seconds, in a thread of its own."""
        if self._busy:
            raise HubfocError("still at work, accepted: one at a time")
        self._busy = True
        Thread(target=self._do_slowly, args=(wanted,), daemon=True).start()

    def _do_slowly(self, wanted: dict[str, Any]) -> None:
        doing = {
            "parameters": self._parameters,
            "store": self._store,
            "replay": self._replay,
            "blackbox": self._black_box,
            "scope": self._record_scope,
            "step": self._step_test,
            "export": self._export,
        }
        try:
            answer = doing[wanted["do"]](wanted)
        except MISTAKES as error:
            answer = refusal(str(error))
        except OSError:
            return  # the page is gone
        finally:
            self._busy = False  # before the answer: the page may ask again at once
        with suppress(OSError):
            self._send(answer)

    def _parameters(self, wanted: Mapping[str, Any]) -> Message:
        wheel = int(wanted["wheel"])
        rows = parameters.rows(self._desk.address(wheel), self._desk.drive_of(wheel))
        return {"kind": "parameters", "wheel": wheel, "rows": rows}

    def _store(self, wanted: Mapping[str, Any]) -> Message:
        """Switch the vehicle off for as long as wheels keep values and restart."""
        desk, cockpit = self._desk, self._desk.cockpit
        wheels = [int(wheel) for wheel in wanted["wheels"]]
        self._orders.call(lambda: cockpit.check(self))
        cockpit.switched_off = True
        try:
            for wheel in wheels:
                parameters.store(desk.address(wheel), desk.simulation.vehicle.key, wanted["values"])
        finally:
            cockpit.switched_off = False
        return self._parameters({"wheel": wheels[0]})

    def _replay(self, wanted: Mapping[str, Any]) -> Message:
        file = self._desk.simulation.recorded
        if file is None:
            raise HubfocError("nothing is recorded, accepted: after a recording")
        found = replays.run(
            file, int(wanted["wheel"]), wanted["values"], simulate=bool(wanted["simulate"])
        )
        self._replayed = found
        return self._curve(str(wanted["signal"]))

    def _black_box(self, wanted: Mapping[str, Any]) -> Message:
        """Read a wheel's record through its shell, or from a terminal's log that the page has."""
        wheel, log = int(wanted["wheel"]), wanted.get("log")
        answer = str(log) if log is not None else self._answer_of(wheel, black_boxes.COMMAND)
        found = black_boxes.shown(answer, self._desk.drive_of(wheel))
        return {"kind": "blackbox", "wheel": wheel, **found}

    def _record_scope(self, wanted: Mapping[str, Any]) -> Message:
        wheel = int(wanted["wheel"])
        with self._desk.session(wheel) as session:
            drive = self._desk.drive_of(wheel)
            found = scopes.record(session, drive, wanted, lambda: self._send({"kind": "armed"}))
        self._scope = found
        return {"kind": "scope", "wheel": wheel, **found.message()}

    def _step_test(self, wanted: Mapping[str, Any]) -> Message:
        """End the driving torque of the vehicle, and look at one wheel's current meanwhile."""
        wheel, cockpit = int(wanted["wheel"]), self._desk.cockpit
        self._orders.call(lambda: cockpit.check(self))
        with self._desk.session(wheel) as session:
            found = step_tests.record(
                session, self._desk.drive_of(wheel),
                lambda: self._orders.call(lambda: cockpit.withdraw(self)),
            )  # fmt: skip
        return {"kind": "step", "wheel": wheel, **found.message()}

    def _export(self, wanted: Mapping[str, Any]) -> Message:
        """Curves as a file: of the scope, or rows of the vehicle's signals."""
        columns: exports.Columns
        meanings: exports.Meanings
        if wanted["of"] == "scope":
            if self._scope is None:
                raise HubfocError("nothing is recorded, accepted: after a recording of the scope")
            columns, meanings = self._scope.columns(), scopes.signals()
        else:
            names = [str(name) for name in wanted["names"]]
            meanings = self._desk.history.meanings
            columns = self._desk.history.columns(names, int(wanted["from"]), int(wanted["to"]))
        kind = str(wanted["format"])
        content = exports.content(kind, columns, meanings)
        coded = base64.b64encode(content).decode("ascii")
        return {"kind": "file", "name": f"hubfoc.{kind}", "content": coded}

    def _answer_of(self, wheel: int, command: str) -> str:
        answer = self._orders.call(lambda: self._desk.shell(wheel, command))
        try:
            return answer.result(ANSWER_S)
        except TimeoutError as error:
            raise HubfocError("no answer, accepted: while the time goes on") from error

    def _curve(self, signal: str) -> Message:
        found = self._replayed
        if found is None:
            raise HubfocError("nothing is replayed, accepted: after a replay")
        about = {name: getattr(found, name) for name in ABOUT}
        return {"kind": "replay", **about, **replays.curve(found, signal)}

    def _refuse(self, why: str) -> None:
        with suppress(OSError):
            self._send(refusal(why))

    def _choose(self, names: Sequence[str]) -> None:
        known = self._desk.history.meanings
        self._curves = [name for name in names if name in known][:CURVES]
        self._next = 0

    def _write(self) -> None:
        due_s = state_s = time.monotonic()
        try:
            while not self._closed:
                now_s = time.monotonic()
                if now_s >= state_s:
                    state_s = now_s + STATE_S
                    self._write_state()
                self._write_rows()
                due_s = max(due_s + UPDATE_S, now_s)
                time.sleep(max(due_s - time.monotonic(), 0.0))
        except OSError:
            self._closed = True

    def _write_state(self) -> None:
        state = self._orders.call(lambda: self._desk.state(self))
        if state["number"] != self._number:
            self._send(self._orders.call(self._desk.hello))
            self._number, self._next = state["number"], 0
            self._choose(self._curves)
        self._send(state)

    def _write_rows(self) -> None:
        history, curves = self._desk.history, self._curves
        if self._desk.number != self._number or history.count == self._next:
            return
        first, rows = history.rows(self._next, history.places(curves))
        if history.count == 0 or len(rows) == 0:
            return
        self._next = first + len(rows)
        shown = history.latest(history.places(self._desk.shown))
        head = struct.pack("<4I", self._number, first, len(rows), len(curves))
        self._socket.send_binary(
            head, shown.astype("<f4").tobytes(), np.ascontiguousarray(rows, "<f4").tobytes()
        )

    def _send(self, value: dict[str, Any]) -> None:
        self._socket.send_text(json.dumps(value))


def serve(desk: Desk, orders: Orders, handler: Handler) -> None:
    """Serve one request to ``stream``."""
    socket = opened(handler)
    if socket is not None:
        Page(desk, orders, socket).run()
