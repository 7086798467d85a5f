# SPDX-License-Identifier: Apache-2.0
"""XCP by UDP, a port a wheel: packets to and from the wheel's line beside CAN.

A packet is behind its length and a counter, two bytes each, as the standard lays them out for
Ethernet. A command is a datagram of its own; what a wheel sends in a step shares datagrams.
"""

import socket
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol, Self

HOST = "127.0.0.1"
PACKET_BYTES = 40  # hal/packets.h
DATAGRAM_BYTES = 1400
_HEAD = struct.Struct("<HH")


class Wheels(Protocol):
    """Those behind the ports."""

    def packet_send(self, wheel: int, packet: bytes) -> None:
        """Give a wheel a packet."""

    def packets_take(self, wheel: int) -> list[bytes]:
        """Return what a wheel has sent since last time."""


@dataclass
class Gateway:
    """One wheel's port."""

    command: int  # identifiers of the same service on CAN
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

    def receive(self) -> bytes | None:
        """Return the next packet; what is none is left out."""
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
        return packet

    def send(self, packets: Sequence[bytes]) -> None:
        """Send what the wheel sent to the tool that spoke last."""
        datagram = b""
        for packet in packets:
            if len(datagram) + _HEAD.size + len(packet) > DATAGRAM_BYTES:
                self._put(datagram)
                datagram = b""
            datagram += _HEAD.pack(len(packet), self._counter) + packet
            self._counter = (self._counter + 1) % 0x10000
        if datagram:
            self._put(datagram)

    def _put(self, datagram: bytes) -> None:
        if self._tool is None:
            return
        try:
            self._socket.sendto(datagram, self._tool)
        except (BlockingIOError, ConnectionError):
            return

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


class Gateways:
    """The ports of all wheels; none where the configuration has no XCP."""

    WHEELS = 4  # answers have the identifiers behind the commands of all wheels

    def __init__(self, base: int, wheels: int) -> None:
        self.wheels = [
            Gateway(base + k, base + self.WHEELS + k) for k in range(wheels if base else 0)
        ]

    def __enter__(self) -> Self:
        """Return the ports themselves."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close them."""
        for wheel in self.wheels:
            wheel.close()

    def receive(self, to: Wheels) -> None:
        """Hand at most one packet to each wheel."""
        for wheel, gateway in enumerate(self.wheels):
            packet = gateway.receive()
            if packet is not None:
                to.packet_send(wheel, packet)

    def send(self, of: Wheels) -> None:
        """Hand what the wheels sent to the tools."""
        for wheel, gateway in enumerate(self.wheels):
            gateway.send(of.packets_take(wheel))
