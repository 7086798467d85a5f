# SPDX-License-Identifier: Apache-2.0
"""A small master of XCP: one wheel's signals and parameters, over UDP or its two CAN identifiers.

>>> with Service(Udp("127.0.0.1:40001")) as wheel:
...     wheel.signal("output.bus_voltage_v")
...     wheel.unlock(key)
...     wheel.write("driver.lost_hold_ms", [250])
...     wheel.store()
...     for sample in wheel.daq(["output.speed_rad_per_s"]): ...
...     wheel.scope(["fast_input.phase_current_code_a"], before=100)
"""

import socket
import struct
import time
from collections import deque
from collections.abc import Callable, Generator, Sequence
from typing import Protocol, Self

from hubfoc import addresses, measuring
from hubfoc.bus import Bus
from hubfoc.errors import HubfocError

TIMEOUT_S = 1.0
PACKET_BYTES = 8
SEED_BYTES = 6
WHEELS = 4
STAGING = 1
CALIBRATION = 1
_HEAD = struct.Struct("<HH")
_DATAGRAM_BYTES = 1 << 16
_LEAST_ANSWER = 0xFE  # numbers of packets from here on are answers, below them of DAQ
_ALIVE_S = 20.0  # between two commands: without any the wheel ends the session after a minute
_LATE_S = 60.0  # without a packet of a list
_MASK = 2**64 - 1
_REFUSALS = {
    0x22: "refused: the wheel's validator does not accept it (its shell says which field)",
    0x23: "refused: this wheel has no key, nothing can be changed; accepted: an image whose TOML"
          " has [service] key",
    0x25: "locked: accepted: the key of this wheel's [service] key",
    0x2A: "refused: more than the line carries: accepted: at most one packet a millisecond on CAN"
          " (every=), signals of the PWM period by UDP alone",
    0x33: "refused for now: only with the wheel at rest and switched off, and 10 s after three"
          " wrong keys; the scope's memory serves one at a time",
}  # fmt: skip


class Line(Protocol):
    """Packets to a wheel and back."""

    def send(self, packet: bytes) -> None:
        """Send one packet."""

    def receive(self, wait_s: float) -> bytes | None:
        """Return the next packet; None: there is none in this time."""

    def close(self) -> None:
        """Let it go."""


class Udp:
    """The port of a virtual vehicle's wheel."""

    def __init__(self, address: str) -> None:
        host, _, port = address.rpartition(":")
        if not host or not port.isdecimal():
            raise HubfocError(f"{address}: accepted: HOST:PORT, as 'hubfoc live' prints")
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((host, int(port)))
        self._counter = 0
        self._received: deque[bytes] = deque()  # a datagram has any number of packets

    def send(self, packet: bytes) -> None:
        """Send one packet."""
        self._counter = (self._counter + 1) % 0x10000
        self._socket.send(_HEAD.pack(len(packet), self._counter) + packet)

    def receive(self, wait_s: float) -> bytes | None:
        """Return the next packet; None: there is none in this time."""
        if not self._received:
            self._socket.settimeout(max(wait_s, 1e-3))
            try:
                datagram = self._socket.recv(_DATAGRAM_BYTES)
            except (TimeoutError, ConnectionError):
                return None
            at = 0
            while at + _HEAD.size <= len(datagram):
                begin = at + _HEAD.size
                at = begin + _HEAD.unpack_from(datagram, at)[0]
                self._received.append(datagram[begin:at])
        return self._received.popleft() if self._received else None

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


class Can:
    """Two identifiers of a bus."""

    def __init__(self, bus: Bus, base: int, wheel: int) -> None:
        self._bus, self._command, self._answer = bus, base + wheel, base + WHEELS + wheel

    def send(self, packet: bytes) -> None:
        """Send one packet."""
        self._bus.send(self._command, packet)

    def receive(self, wait_s: float) -> bytes | None:
        """Return the next packet; None: there is none in this time."""
        end_s = time.monotonic() + wait_s
        while (left_s := end_s - time.monotonic()) > 0.0:
            for identifier, data in self._bus.receive(left_s):
                if identifier == self._answer:
                    return data
        return None

    def close(self) -> None:
        """Leave the bus."""
        self._bus.close()


def _rotated(x: int, bits: int) -> int:
    return (x << bits | x >> (64 - bits)) & _MASK


def mac(key: bytes, message: int) -> int:
    """Return SipHash-2-4 of eight bytes (firmware/comms/include/comms/mac.h)."""
    k0 = int.from_bytes(key[:8], "little")
    k1 = int.from_bytes(key[8:], "little")
    a, b = k0 ^ 0x736F6D6570736575, k1 ^ 0x646F72616E646F6D
    c, d = k0 ^ 0x6C7967656E657261, k1 ^ 0x7465646279746573
    for block, rounds in ((message, 2), (8 << 56, 2), (None, 4)):
        if block is None:
            c ^= 0xFF
        else:
            d ^= block
        for _ in range(rounds):
            a, c = (a + b) & _MASK, (c + d) & _MASK
            b, d = _rotated(b, 13) ^ a, _rotated(d, 16) ^ c
            a = _rotated(a, 32)
            c, a = (c + b) & _MASK, (a + d) & _MASK
            b, d = _rotated(b, 17) ^ c, _rotated(d, 21) ^ a
            c = _rotated(c, 32)
        if block is not None:
            a ^= block
    return a ^ b ^ c ^ d


class Service:
    """A session with one wheel."""

    def __init__(self, line: Line) -> None:
        self._line = line
        self._signals = {row.name: row for row in addresses.signals()}
        self._fields = {row.name: row for row in addresses.fields()}
        self._measured: deque[bytes] = deque()
        self._packet_bytes = PACKET_BYTES
        try:
            self.connect()
        except HubfocError:
            line.close()
            raise

    def __enter__(self) -> Self:
        """Return the session itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self._line.send(b"\xfe")
        self._line.close()

    def connect(self) -> None:
        """Begin a session; what was unlocked is locked."""
        self._packet_bytes = int.from_bytes(self.ask(b"\xff\x00")[3:5], "little")
        self._measured.clear()

    def ask(self, packet: bytes) -> bytes:
        """Send a command and return its answer."""
        while self._answer(0.0) is not None:
            pass  # it came too late
        self._line.send(packet)
        answer = self._answer(TIMEOUT_S)
        if answer is None:
            raise HubfocError("no answer: accepted: a wheel that runs, with XCP")
        if answer[:1] == b"\xff":
            return answer[1:]
        code = answer[1] if len(answer) > 1 else -1
        raise HubfocError(_REFUSALS.get(code, f"refused with the code 0x{code:02X} of XCP"))

    def _answer(self, wait_s: float) -> bytes | None:
        """Return the next answer; packets of DAQ before it are kept."""
        end_s = time.monotonic() + wait_s
        while True:
            packet = self._line.receive(max(0.0, end_s - time.monotonic()))
            if packet is None or packet[0] >= _LEAST_ANSWER:
                return packet
            self._measured.append(packet)

    def _next_measured(self) -> bytes:
        end_s = time.monotonic() + _LATE_S
        while not self._measured:
            packet = self._line.receive(TIMEOUT_S)
            if packet is not None and packet[0] < _LEAST_ANSWER:
                return packet
            if time.monotonic() > end_s:
                raise HubfocError("no packets any more: accepted: a wheel that runs")
        return self._measured.popleft()

    def read(self, address: int, count: int) -> bytes:
        """Return bytes of signals or of the page."""
        self.ask(b"\xf6\x00\x00\x00" + struct.pack("<I", address))
        out = b""
        while len(out) < count:
            out += self.ask(bytes([0xF5, min(PACKET_BYTES - 1, count - len(out))]))
        return out

    def signal(self, name: str) -> int:
        """Return the raw value of a signal, such as ``output.speed_rad_per_s`` in mrad/s."""
        if name not in self._signals:
            raise HubfocError(f"{name}: no such signal, accepted: those of 'hubfoc a2l'")
        answer = self.ask(b"\xf4\x04\x00\x00" + struct.pack("<I", self._signals[name].address))
        return int(struct.unpack("<i", answer)[0])

    def _chosen(self, names: Sequence[str]) -> list[addresses.Signal]:
        for name in names:
            if name not in self._signals:
                raise HubfocError(f"{name}: no such signal, accepted: those of 'hubfoc a2l'")
        return [self._signals[name] for name in names]

    def daq(
        self, names: Sequence[str], *, fast: bool = False, every: int | None = None
    ) -> Generator[measuring.Sample]:
        """Yield raw values of each slow step, until the iterator is closed.

        Parameters
        ----------
        names : sequence of str
            Signals, of the slow step and of the PWM period.
        fast : bool
            Of each PWM period, at most eight signals, by UDP alone.
        every : int, optional
            How many steps or periods lie between two samples; default: as few as the line carries.
        """
        plan = measuring.plan(self._chosen(names), self._packet_bytes, fast=fast)
        self._set_list(plan, plan.least if every is None else every)
        try:
            asked_s = 0.0
            for sample in measuring.samples(plan, self._next_measured):
                if sample.time_s - asked_s > _ALIVE_S:
                    asked_s = sample.time_s
                    self.ask(b"\xfd")
                yield sample
        finally:
            self.ask(b"\xe3\x00" + plan.list_number)
            self._measured.clear()

    def _set_list(self, plan: measuring.Plan, every: int) -> None:
        self.ask(b"\xe3\x00" + plan.list_number)
        for number, odt in enumerate(plan.odts):
            for k, signal in enumerate(odt):
                self.ask(b"\xe2\x00" + plan.list_number + bytes([number, k]))
                entry = bytes([0xE1, 0xFF, signal.least_bytes, 0])
                self.ask(entry + struct.pack("<I", signal.address))
        if not 1 <= every <= measuring.EVERY_MOST:
            raise HubfocError(f"every: {every}, accepted: 1 to {measuring.EVERY_MOST}")
        mode = b"\xe0\x10" + plan.list_number + plan.list_number
        self.ask(mode + bytes([every, 0]))
        self._measured.clear()
        self.ask(b"\xde\x01" + plan.list_number)

    def _scope_word(self, name: str) -> int:
        address = addresses.scope_words()[name]
        answer = self.ask(b"\xf4\x04\x00\x00" + struct.pack("<I", address))
        return int(struct.unpack("<i", answer)[0])

    def _set_scope(self, name: str, value: int) -> None:
        self.ask(b"\xf6\x00\x00\x00" + struct.pack("<I", addresses.scope_words()[name]))
        self.ask(b"\xf0\x04" + struct.pack("<i", value))

    def scope(
        self, names: Sequence[str], *, trigger: measuring.Trigger | None = None, before: int = 0,
        rows: int = 0, every: int = 1, wait_s: float | None = None,
        armed: Callable[[], None] | None = None,
    ) -> measuring.Recording:  # fmt: skip
        """Record up to eight signals at the PWM frequency around a trigger.

        Parameters
        ----------
        names : sequence of str
            Signals, in raw values.
        trigger : Trigger, optional
            What it waits for; default: nothing.
        before : int
            Rows before the trigger's.
        rows : int
            Of the record; 0: as many as the wheel's memory holds.
        every : int
            PWM periods a row.
        wait_s : float, optional
            For the trigger and the rows after it; default: for ever.
        armed : callable, optional
            Called as soon as it waits.
        """
        chosen = self._chosen(names)
        if self._scope_word("memory_bytes") == 0:
            raise HubfocError("this wheel has no scope")
        self._arm(chosen, trigger or measuring.Trigger(), before, rows, every)
        if armed is not None:
            armed()
        end_s = None if wait_s is None else time.monotonic() + wait_s
        while self._scope_word("phase") != measuring.COMPLETE:
            if end_s is not None and time.monotonic() > end_s:
                self._set_scope("run", 0)
                raise HubfocError(f"nothing has triggered in {wait_s:g} s")
            time.sleep(measuring.LOOK_S)
        state = {name: self._scope_word(name) for name in addresses.STATES}
        data = self.read(addresses.RECORD, state["record_rows"] * state["row_bytes"])
        frequency_hz = self.field("drive.pwm_frequency_Hz")[0]
        return measuring.recording(chosen, state, data, before, every / frequency_hz)

    def scope_rows(self, names: Sequence[str]) -> int:
        """Return how many rows of these signals the wheel's memory holds at least."""
        row_bytes = addresses.SIGNAL_BYTES * max(len(self._chosen(names)), 1)
        return self._scope_word("memory_bytes") // row_bytes

    def _arm(
        self, chosen: Sequence[addresses.Signal], trigger: measuring.Trigger, before: int,
        rows: int, every: int,
    ) -> None:  # fmt: skip
        if not 1 <= len(chosen) <= addresses.CHANNELS:
            raise HubfocError(f"{len(chosen)} signals, accepted: 1 to {addresses.CHANNELS}")
        self._set_scope("run", 0)
        for k in range(addresses.CHANNELS):
            self._set_scope(f"signal_{k}", chosen[k].place if k < len(chosen) else -1)
        self._set_scope("trigger", trigger.kind)
        self._set_scope("level", trigger.level)
        if trigger.signal is not None:
            self._set_scope("trigger_signal", self._chosen([trigger.signal])[0].place)
        for name, value in (("before_rows", before), ("rows", rows), ("periods", every)):
            self._set_scope(name, value)
        self._set_scope("run", 1)

    def field(self, name: str) -> list[int]:
        """Return the values of one field of the configuration in force."""
        field = self._fields[name]
        data = self.read(field.address, (field.info.count or 1) * field.value_bytes)
        return values_of(bytes(field.address - addresses.PAGE) + data, field)

    def values(self) -> dict[str, list[int]]:
        """Return every field of the configuration in force."""
        page = self.read(addresses.PAGE, addresses.page_bytes())
        return {name: values_of(page, field) for name, field in self._fields.items()}

    def unlock(self, key: bytes) -> None:
        """Open the staging page, a copy of the one in force."""
        seed = self.ask(bytes([0xF8, 0, CALIBRATION]))
        if seed[0] > 0:
            answer = mac(key, int.from_bytes(seed[1 : 1 + SEED_BYTES], "little"))
            self.ask(bytes([0xF7, SEED_BYTES]) + answer.to_bytes(8, "little")[:SEED_BYTES])
        self.ask(bytes([0xEB, 2, 0, STAGING]))

    def write(self, name: str, values: Sequence[int]) -> None:
        """Change a field of the staging page."""
        field = self._fields.get(name)
        if field is None:
            raise HubfocError(f"{name}: no such field, accepted: those of 'hubfoc params get'")
        count = field.info.count or 1
        if len(values) != count:
            raise HubfocError(f"{name}: {len(values)} values, accepted: {count}")
        for value in values:
            if not field.info.lowest <= value <= field.info.highest:
                raise HubfocError(f"{name}: {value}, accepted: {field.info.lowest} to"
                                  f" {field.info.highest} {field.info.unit}")  # fmt: skip
        data = struct.pack(f"<{count}{'i' if field.value_bytes == 4 else 'h'}", *values)
        self.ask(b"\xf6\x00\x00\x00" + struct.pack("<I", field.address))
        for at in range(0, len(data), PACKET_BYTES - 2):
            part = data[at : at + PACKET_BYTES - 2]
            self.ask(bytes([0xF0, len(part)]) + part)

    def store(self) -> None:
        """Have the staging page checked, stored and used; the wheel restarts."""
        self.ask(b"\xf9\x01\x00\x00")


def values_of(page: bytes, field: addresses.Field) -> list[int]:
    """Return a field's values in a page."""
    count = field.info.count or 1
    kind = "i" if field.value_bytes == struct.calcsize("<i") else "h"
    return list(struct.unpack_from(f"<{count}{kind}", page, field.address - addresses.PAGE))
