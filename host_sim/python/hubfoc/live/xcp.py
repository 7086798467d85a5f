# SPDX-License-Identifier: Apache-2.0
"""XCP by UDP, a port a wheel: packets to and from the wheel's two CAN identifiers.

A datagram is a packet of at most eight bytes behind its length and a counter, two bytes each, as
the standard lays them out for Ethernet. The wheel itself knows CAN alone, so whoever is on the bus
reads the answers as well.
"""

import socket
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

from hubfoc.bus import Frame

HOST = "127.0.0.1"
WHEELS = 4  # answers have the identifiers behind the commands of all wheels
PACKET_BYTES = 8
_HEAD = struct.Struct("<HH")


@dataclass
class Gateway:
    """One wheel's port."""

    command: int  # identifier
    answer: int
    _socket: socket.socket = field(
        default_factory=lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    )
    _tool: tuple[str, int] | None = None  # that spoke last
    _counter: int = 0

    def __post_init__(self) -> None:
        """Take a port that is free."""
        self._socket.bind((HOST, 0))
        self._socket.setblocking(False)

    @property
    def address(self) -> str:
        """Where a tool finds the wheel."""
        host, port = self._socket.getsockname()
        return f"{host}:{port}"

    def receive(self) -> Frame | None:
        """Return the next packet as the wheel gets it; what is none is left out."""
        try:
            datagram, tool = self._socket.recvfrom(_HEAD.size + PACKET_BYTES + 1)
        except (BlockingIOError, ConnectionError):
            return None
        packet = datagram[_HEAD.size :]
        if len(datagram) <= _HEAD.size or len(packet) > PACKET_BYTES:
            return None
        if _HEAD.unpack_from(datagram)[0] != len(packet):
            return None
        self._tool = tool
        return self.command, packet

    def send(self, packet: bytes) -> None:
        """Send what the wheel answered to the tool that asked last."""
        if self._tool is None:
            return
        try:
            self._socket.sendto(_HEAD.pack(len(packet), self._counter) + packet, self._tool)
        except (BlockingIOError, ConnectionError):
            return
        self._counter = (self._counter + 1) % 0x10000

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


class Gateways:
    """The ports of all wheels; none where the configuration has no XCP."""

    def __init__(self, base: int, wheels: int) -> None:
        self.wheels = [Gateway(base + k, base + WHEELS + k) for k in range(wheels if base else 0)]
        self._by_answer = {wheel.answer: wheel for wheel in self.wheels}

    def __enter__(self) -> Self:
        """Return the ports themselves."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close them."""
        for wheel in self.wheels:
            wheel.close()

    def receive(self) -> list[Frame]:
        """Return at most one packet for each wheel, as frames."""
        found = [wheel.receive() for wheel in self.wheels]
        return [frame for frame in found if frame is not None]

    def send(self, frames: Sequence[Frame]) -> None:
        """Hand the answers among the vehicle's frames to the tools."""
        for identifier, data in frames:
            if identifier in self._by_answer:
                self._by_answer[identifier].send(data)
