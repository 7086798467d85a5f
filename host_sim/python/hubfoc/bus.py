# SPDX-License-Identifier: Apache-2.0
"""A CAN bus by its name on a command line.

``udp_multicast`` is a bus of this machine alone, for any number of programs;
``udp_multicast:GROUP`` names it by an IPv4 multicast group. ``virtual`` is a bus within one Python
process; anything else is the name of a SocketCAN channel.
"""

import ipaddress
import socket
import time
from collections import deque
from pathlib import Path
from threading import Lock

import can

from hubfoc.errors import HubfocError

Frame = tuple[int, bytes]
EXTENDED = 1 << 31  # in an identifier: it has 29 bits, as in hal/can.h
MULTICAST = "udp_multicast"
VIRTUAL = "virtual"
FIRST_GROUP = ipaddress.IPv4Address("239.74.163.2")  # python-can's own default
GROUPS = 16  # vehicles on one machine
BIT_RATE = 500_000
ECHOES = 256  # of one's own frames that may be under way
ACCEPTED = f"accepted: {MULTICAST}, {MULTICAST}:GROUP, {VIRTUAL}, or a SocketCAN channel"
CHANNELS = Path("/sys/class/net")


class Bus:
    """Classic data frames with identifiers of 11 bits, in and out; with EXTENDED ones, out alone.

    ``name`` is that by which others find the bus. A multicast group gives back what one sends
    oneself, which a CAN controller does not: those frames are left out.
    """

    def __init__(self, port: can.BusABC, name: str, mark: socket.socket | None = None) -> None:
        self.name = name
        self._port = port
        self._mark = mark
        self._echoes = name.startswith(MULTICAST)
        self._sent: deque[Frame] = deque(maxlen=ECHOES)
        self._lock = Lock()  # several threads may send while one receives

    def send(self, identifier: int, data: bytes) -> None:
        """Send a frame; an OSError or CanError where the bus takes none."""
        extended = identifier >= EXTENDED
        if self._echoes and not extended:
            with self._lock:
                self._sent.append((identifier, data))
        self._port.send(
            can.Message(arbitration_id=identifier & ~EXTENDED, data=data, is_extended_id=extended)
        )

    def receive(self, wait_s: float) -> list[Frame]:
        """Return what has come, after waiting for the first frame at most this long."""
        frames: list[Frame] = []
        message = self._port.recv(wait_s)
        while message is not None:
            frame = (message.arbitration_id, bytes(message.data))
            is_data = not message.is_extended_id and not message.is_remote_frame
            if is_data and not self._is_echo(frame):
                frames.append(frame)
            message = self._port.recv(0.0)
        return frames

    def _is_echo(self, frame: Frame) -> bool:
        with self._lock:
            if frame not in self._sent:
                return False
            self._sent.remove(frame)
            return True

    def close(self) -> None:
        """Leave the bus."""
        self._port.shutdown()
        if self._mark is not None:
            self._mark.close()


def _group(text: str) -> ipaddress.IPv4Address:
    try:
        group = ipaddress.IPv4Address(text)
    except ipaddress.AddressValueError as error:
        raise HubfocError(f"{MULTICAST}:{text}: accepted: an IPv4 multicast group") from error
    if not group.is_multicast:
        raise HubfocError(f"{MULTICAST}:{text}: accepted: 224.0.0.0 to 239.255.255.255")
    return group


def now_ms() -> int:
    """Return the clock of receivers."""
    return int(1e3 * time.monotonic())


def join(name: str) -> Bus:
    """Return a bus that others use too."""
    return Bus(_open(name), name)


def _open(name: str) -> can.BusABC:
    interface, _, channel = name.partition(":")
    try:
        if interface == MULTICAST:
            group = _group(channel) if channel else FIRST_GROUP
            return can.Bus(interface=MULTICAST, channel=str(group), hop_limit=0, fd=False)
        if interface == VIRTUAL:
            return can.Bus(interface=VIRTUAL, channel=channel or "hubfoc")
        if not (CHANNELS / name).exists():
            raise HubfocError(f"{name}: no such bus, {ACCEPTED}")
        return can.Bus(interface="socketcan", channel=name, bitrate=BIT_RATE)
    except (can.CanError, OSError) as error:
        raise HubfocError(f"{name}: cannot be joined: {error}") from error


def _mark(group: ipaddress.IPv4Address) -> socket.socket | None:
    """Reserve a group on this machine; None: another vehicle has it."""
    mark = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        mark.bind(f"\0hubfoc-vehicle-{group}")
    except OSError:
        mark.close()
        return None
    return mark


def reserve(name: str) -> Bus:
    """Return a bus for a vehicle: of multicast groups one on which no other vehicle of ours is."""
    interface, _, channel = name.partition(":")
    if interface != MULTICAST:
        return join(name)
    wanted = [_group(channel)] if channel else [FIRST_GROUP + k for k in range(GROUPS)]
    for group in wanted:
        mark = _mark(group)
        if mark is not None:
            shown = f"{MULTICAST}:{group}"
            return Bus(_open(shown), shown, mark)
    raise HubfocError(f"{name}: another vehicle has this bus, accepted: another group")
