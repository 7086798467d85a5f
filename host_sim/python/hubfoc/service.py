# SPDX-License-Identifier: Apache-2.0
"""A small master of XCP: one wheel's signals and parameters, over UDP or its two CAN identifiers.

>>> with Service(Udp("127.0.0.1:40001")) as wheel:
...     wheel.signal("output.bus_voltage_v")
...     wheel.unlock(key)
...     wheel.write("driver.lost_hold_ms", [250])
...     wheel.store()
"""

import socket
import struct
import time
from collections.abc import Sequence
from typing import Protocol, Self

from hubfoc import addresses
from hubfoc.bus import Bus
from hubfoc.errors import HubfocError

TIMEOUT_S = 1.0
PACKET_BYTES = 8
SEED_BYTES = 6
WHEELS = 4
STAGING = 1
CALIBRATION = 1
_HEAD = struct.Struct("<HH")
_MASK = 2**64 - 1
_REFUSALS = {
    0x22: "refused: the wheel's validator does not accept it (its shell says which field)",
    0x23: "refused: this wheel has no key, nothing can be changed; accepted: an image whose TOML"
          " has [service] key",
    0x25: "locked: accepted: the key of this wheel's [service] key",
    0x33: "refused for now: only with the wheel at rest and switched off, and 10 s after three"
          " wrong keys",
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

    def send(self, packet: bytes) -> None:
        """Send one packet."""
        self._counter = (self._counter + 1) % 0x10000
        self._socket.send(_HEAD.pack(len(packet), self._counter) + packet)

    def receive(self, wait_s: float) -> bytes | None:
        """Return the next packet; None: there is none in this time."""
        self._socket.settimeout(max(wait_s, 1e-3))
        try:
            return self._socket.recv(_HEAD.size + PACKET_BYTES)[_HEAD.size :]
        except (TimeoutError, ConnectionError):
            return None

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
        self.connect()

    def __enter__(self) -> Self:
        """Return the session itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self._line.send(b"\xfe")
        self._line.close()

    def connect(self) -> None:
        """Begin a session; what was unlocked is locked."""
        self.ask(b"\xff\x00")

    def ask(self, packet: bytes) -> bytes:
        """Send a command and return its answer."""
        while self._line.receive(0.0) is not None:
            pass  # an answer that came too late
        self._line.send(packet)
        answer = self._line.receive(TIMEOUT_S)
        if answer is None:
            raise HubfocError("no answer: accepted: a wheel that runs, with XCP")
        if answer[:1] == b"\xff":
            return answer[1:]
        code = answer[1] if len(answer) > 1 else -1
        raise HubfocError(_REFUSALS.get(code, f"refused with the code 0x{code:02X} of XCP"))

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
