# SPDX-License-Identifier: Apache-2.0
# From firmware/comms/hubfoc.dbc and can_protocol.py.in by firmware/comms/generate.py; not edited.
"""The CAN protocol of a wheel: layout, end-to-end protection and receiver of every message.

For simulators, test benches and logs. Nothing but the standard library is needed. Physical values
are those of hubfoc.dbc, in the unit of a signal's name; meaning and cycle of every message are in
firmware/comms/README.md.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

FRAME_BYTES: Final = 8
VERSION: Final = 2  # of the protocol; frames of another one are not intact
BASE: Final = 0x100  # lowest identifier, unless [vehicle] can_base says otherwise
WHEEL_MASK: Final = 3  # lowest bits of an identifier: which wheel
STEP_MAX: Final = 3  # of the counter: frames lost in a row, and one
QUALIFYING_FRAMES: Final = 3  # in order, the last of them is the first used
TIMEOUT_CYCLES: Final = 5  # without a usable frame
P2_DATA_IDS: Final = bytes.fromhex("40 d0 ea 7a 80 10 2a ba 20 b0 8a 1a e0 70 4a da")


@dataclass(frozen=True)
class Signal:
    """One signal of a frame, little endian."""

    start: int  # bit, from the lowest of byte 0
    length: int  # bits
    signed: bool
    step: float
    least: float
    most: float
    not_available: int | None = None  # steps that stand for a quantity beyond the range
    only: tuple[str, int] | None = None  # in frames whose signal of this name has this value

    def holds(self, raw: int) -> bool:
        """Return whether this many steps are within the range."""
        return round(self.least / self.step) <= raw <= round(self.most / self.step)

    def steps(self, value: float) -> int:
        """Return the nearest whole steps; NaN is a quantity that is not available."""
        if math.isnan(value):
            if self.not_available is None:
                raise ValueError("NaN, but it is always available")
            return self.not_available
        raw = round(value / self.step)
        if not self.holds(raw):
            raise ValueError(f"{value:g} is not in {self.least:g} .. {self.most:g}")
        return raw


@dataclass(frozen=True)
class Message:
    """One message; its identifier is that of the front left wheel with the base ``BASE``."""

    identifier: int
    each_wheel: bool  # has an identifier of its own for each wheel
    cycle_ms: int
    profile: int  # of AUTOSAR's end-to-end protection
    signals: Mapping[str, Signal]


MESSAGES: Final[Mapping[str, Message]] = {
    "Demand": Message(
        0x100,
        True,
        10,
        5,
        {
            "crc": Signal(0, 16, False, 1.0, 0.0, 65535.0),
            "counter": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "enable": Signal(24, 1, False, 1.0, 0.0, 1.0),
            "fault_reset": Signal(25, 1, False, 1.0, 0.0, 1.0),
            "abs_active": Signal(26, 1, False, 1.0, 0.0, 1.0),
            "direction": Signal(27, 2, False, 1.0, 0.0, 2.0),
            "abs_motor_share_percent": Signal(29, 7, False, 1.0, 0.0, 100.0),
            "drive_torque_nm": Signal(36, 14, True, 0.2, -1638.2, 1638.2),
            "brake_torque_nm": Signal(50, 14, False, 0.2, 0.0, 3276.6),
        },
    ),
    "HydraulicFeedback": Message(
        0x120,
        True,
        20,
        5,
        {
            "crc": Signal(0, 16, False, 1.0, 0.0, 65535.0),
            "counter": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "torque_valid": Signal(24, 1, False, 1.0, 0.0, 1.0),
            "measured_torque_nm": Signal(32, 18, False, 0.1, 0.0, 20000.0),
        },
    ),
    "BatteryLimits": Message(
        0x140,
        False,
        100,
        5,
        {
            "crc": Signal(0, 16, False, 1.0, 0.0, 65535.0),
            "counter": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "contactor": Signal(24, 2, False, 1.0, 0.0, 2.0),
            "charge_current_a": Signal(26, 19, False, 0.1, 0.0, 32000.0),
            "discharge_current_a": Signal(45, 19, False, 0.1, 0.0, 32000.0),
        },
    ),
    "BatteryPeak": Message(
        0x144,
        False,
        100,
        5,
        {
            "crc": Signal(0, 16, False, 1.0, 0.0, 65535.0),
            "counter": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "charge_peak_current_a": Signal(24, 12, False, 0.5, 0.0, 2047.5),
            "pack_voltage_v": Signal(36, 14, False, 0.1, 0.0, 1638.3),
            "pack_current_a": Signal(50, 14, True, 0.2, -1638.4, 1638.2),
        },
    ),
    "WheelState": Message(
        0x180,
        True,
        10,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "mode": Signal(12, 4, False, 1.0, 0.0, 15.0),
            "fault_reason": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "motor_torque_estimate_nm": Signal(24, 19, True, 0.1, -20000.0, 20000.0, -262144),
            "stop_lamp": Signal(43, 1, False, 1.0, 0.0, 1.0),
            "speed_rad_s": Signal(44, 20, True, 0.01, -5200.0, 5200.0, -524288),
        },
    ),
    "WheelBrake": Message(
        0x184,
        True,
        10,
        5,
        {
            "crc": Signal(0, 16, False, 1.0, 0.0, 65535.0),
            "counter": Signal(16, 8, False, 1.0, 0.0, 255.0),
            "hydraulic_valid": Signal(24, 1, False, 1.0, 0.0, 1.0),
            "hydraulic_torque_nm": Signal(25, 15, False, 0.1, 0.0, 3276.7),
            "electric_brake_available_nm": Signal(40, 15, False, 0.1, 0.0, 3276.6, 32767),
            "demand_counter": Signal(56, 8, False, 1.0, 0.0, 255.0),
        },
    ),
    "WheelDrive": Message(
        0x188,
        True,
        20,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "direction": Signal(12, 2, False, 1.0, 0.0, 2.0),
            "current_q_a": Signal(14, 17, True, 0.1, -6000.0, 6000.0, -65536),
            "motor_torque_command_nm": Signal(31, 17, True, 0.1, -6553.5, 6553.5, -65536),
            "torque_reason": Signal(48, 8, False, 1.0, 0.0, 255.0),
            "hydraulic_reason": Signal(56, 8, False, 1.0, 0.0, 255.0),
        },
    ),
    "WheelPower": Message(
        0x18C,
        True,
        100,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "bus_voltage_v": Signal(16, 16, False, 0.1, 0.0, 2000.0, 65535),
            "bus_current_a": Signal(32, 17, True, 0.1, -6000.0, 6000.0, -65536),
            "motor_torque_uncertainty_nm": Signal(49, 15, False, 0.05, 0.0, 1638.3, 32767),
        },
    ),
    "WheelHealth": Message(
        0x190,
        True,
        100,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "demand_link": Signal(12, 2, False, 1.0, 0.0, 3.0),
            "battery_link": Signal(14, 2, False, 1.0, 0.0, 3.0),
            "winding_temperature_c": Signal(16, 13, True, 0.1, -200.0, 300.0),
            "hydraulic_link": Signal(29, 2, False, 1.0, 0.0, 3.0),
            "switch_temperature_c": Signal(32, 13, True, 0.1, -200.0, 300.0),
            "peak_link": Signal(45, 2, False, 1.0, 0.0, 3.0),
            "demand_errors": Signal(48, 4, False, 1.0, 0.0, 15.0),
            "battery_errors": Signal(52, 4, False, 1.0, 0.0, 15.0),
            "warning_reason": Signal(56, 8, False, 1.0, 0.0, 255.0),
        },
    ),
    "WheelAhead": Message(
        0x194,
        True,
        50,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "electric_brake_ahead_nm": Signal(12, 18, False, 0.1, 0.0, 20000.0, 262143),
            "ahead_reason": Signal(30, 8, False, 1.0, 0.0, 255.0),
            "drive_ahead_nm": Signal(38, 18, False, 0.1, 0.0, 20000.0, 262143),
            "drive_ahead_reason": Signal(56, 8, False, 1.0, 0.0, 255.0),
        },
    ),
    "WheelAvailable": Message(
        0x198,
        True,
        100,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "drive_available_nm": Signal(12, 18, False, 0.1, 0.0, 20000.0, 262143),
            "drive_available_reason": Signal(30, 8, False, 1.0, 0.0, 255.0),
            "waits_for": Signal(38, 8, False, 1.0, 0.0, 255.0),
            "electric_brake_available_reason": Signal(46, 8, False, 1.0, 0.0, 255.0),
        },
    ),
    "WheelEnergy": Message(
        0x19C,
        True,
        500,
        2,
        {
            "crc": Signal(0, 8, False, 1.0, 0.0, 255.0),
            "counter": Signal(8, 4, False, 1.0, 0.0, 15.0),
            "account": Signal(12, 1, False, 1.0, 0.0, 1.0),
            "drawn_wh": Signal(13, 22, False, 0.1, 0.0, 419430.2, 4194303, ("account", 0)),
            "life_drawn_wh": Signal(13, 22, False, 5.0, 0.0, 11930460.0, None, ("account", 1)),
            "returned_wh": Signal(35, 22, False, 0.1, 0.0, 419430.2, 4194303, ("account", 0)),
            "life_returned_wh": Signal(35, 22, False, 5.0, 0.0, 11930460.0, None, ("account", 1)),
            "friction_percent": Signal(57, 7, False, 1.0, 0.0, 100.0, 127, ("account", 0)),
            "life_friction_percent": Signal(57, 7, False, 1.0, 0.0, 100.0, 127, ("account", 1)),
        },
    ),
}


def _crc(crc: int, content: bytes, polynomial: int, bits: int) -> int:
    """Return a CRC, the highest bit of a byte first, that goes on over more bytes."""
    for byte in content:
        crc ^= byte << (bits - 8)
        for _ in range(8):
            crc = (crc << 1) ^ (polynomial if crc >> (bits - 1) & 1 else 0)
        crc &= (1 << bits) - 1
    return crc


def checksum(profile: int, data: bytes, identifier: int) -> int:
    """Return the checksum that a frame with this content and identifier has to carry."""
    if profile == 5:
        content = data[2:] + (0x1000 ^ identifier).to_bytes(2, "little")
        return _crc(0xFFFF, content, 0x1021, 16)
    data_id = P2_DATA_IDS[data[1] & 0xF] ^ (identifier & 0xFF)
    content = data[1:] + bytes([data_id])
    return _crc(0xFF, content, 0x2F, 8) ^ 0xFF


def intact(profile: int, data: bytes, identifier: int) -> bool:
    """Return whether a frame carries the checksum of its content."""
    if len(data) != FRAME_BYTES:
        return False
    carried = int.from_bytes(data[: 2 if profile == 5 else 1], "little")
    return carried == checksum(profile, data, identifier)


def counter_of(profile: int, data: bytes) -> int:
    """Return the counter in a frame."""
    return data[2] if profile == 5 else data[1] & 0xF


def protect(profile: int, data: bytes, identifier: int, counter: int) -> bytes:
    """Return the frame with counter and checksum."""
    out = bytearray(data)
    if profile == 5:
        out[2] = counter & 0xFF
        out[:2] = checksum(profile, bytes(out), identifier).to_bytes(2, "little")
    else:
        out[1] = (out[1] & ~0xF & 0xFF) | (counter & 0xF)
        out[0] = checksum(profile, bytes(out), identifier)
    return bytes(out)


def identifier_of(name: str, wheel: int = 0, base: int = BASE) -> int:
    """Return the identifier of a message of one wheel."""
    message = MESSAGES[name]
    return base + message.identifier - BASE + (wheel if message.each_wheel else 0)


def message_of(identifier: int, base: int = BASE) -> str | None:
    """Return the name of the message that an identifier is of; None if there is none."""
    in_dbc = identifier - base + BASE
    for name, message in MESSAGES.items():
        if in_dbc & ~(WHEEL_MASK if message.each_wheel else 0) == message.identifier:
            return name
    return None


def encode(
    name: str, values: Mapping[str, float], *, wheel: int = 0, counter: int = 0, base: int = BASE
) -> tuple[int, bytes]:
    """Return identifier and content of a complete frame; signals not named are zero.

    A value is rounded to whole steps; one beyond its range, or that this frame does not carry, is a
    ValueError. NaN is a quantity that is not available, where the signal has a number for it.
    """
    message = MESSAGES[name]
    word = 0
    for key, value in values.items():
        signal = message.signals[key]
        if signal.only is not None and values.get(signal.only[0], 0.0) != signal.only[1]:
            raise ValueError(f"{name}.{key}: only with {signal.only[0]} {signal.only[1]}")
        try:
            raw = signal.steps(value)
        except ValueError as error:
            raise ValueError(f"{name}.{key}: {error}") from None
        word |= (raw & ((1 << signal.length) - 1)) << signal.start
    identifier = identifier_of(name, wheel, base)
    content = word.to_bytes(FRAME_BYTES, "little")
    return identifier, protect(message.profile, content, identifier, counter)


def decode(name: str, data: bytes) -> dict[str, float] | None:
    """Return the values of the signals in a frame; None if its length or a value is out of range.

    NaN is a quantity that is not available.
    """
    if len(data) != FRAME_BYTES:
        return None
    word = int.from_bytes(data, "little")
    values: dict[str, float] = {}
    for key, signal in MESSAGES[name].signals.items():
        if signal.only is not None and values[signal.only[0]] != signal.only[1]:
            continue
        raw = word >> signal.start & ((1 << signal.length) - 1)
        if signal.signed and raw >> (signal.length - 1):
            raw -= 1 << signal.length
        if raw == signal.not_available:
            values[key] = math.nan
            continue
        if not signal.holds(raw):
            return None
        values[key] = raw * signal.step
    return values


@dataclass
class Receiver:
    """One message's receiver, as comms/e2e.h: qualification, order and timeout of its sender."""

    name: str
    step_max: int = STEP_MAX
    link: str = "NO_DATA"
    counter: int = 0
    in_order: int = 0
    refreshed_ms: int = 0
    counts: dict[str, int] = field(default_factory=dict)

    def _count(self, what: str) -> str:
        self.counts[what] = self.counts.get(what, 0) + 1
        return what

    def timed_out(self, now_ms: int) -> bool:
        """Return True once: when no frame was usable for five cycles."""
        timeout_ms = TIMEOUT_CYCLES * MESSAGES[self.name].cycle_ms
        started = self.link in ("QUALIFYING", "VALID")
        if not started or now_ms - self.refreshed_ms < timeout_ms:
            return False
        self.link = "TIMED_OUT"
        self._count("timeouts")
        return True

    def receive(self, identifier: int, data: bytes, now_ms: int) -> str:
        """Return what becomes of a frame: "used", or why it is not.

        That is "not_qualified", "repeated", "wrong_sequence", "implausible" or "damaged".
        """
        self.timed_out(now_ms)
        message = MESSAGES[self.name]
        if not intact(message.profile, data, identifier):
            return self._count("damaged")
        if decode(self.name, data) is None:
            return self._count("implausible")
        counter = counter_of(message.profile, data)
        if self.link not in ("QUALIFYING", "VALID"):
            self.link, self.counter, self.in_order = "QUALIFYING", counter, 1
            self.refreshed_ms = now_ms
            return "not_qualified"
        return self._continue(counter, now_ms)

    def _continue(self, counter: int, now_ms: int) -> str:
        """Return what becomes of an intact frame of a sender that is known."""
        mask = 0xFF if MESSAGES[self.name].profile == 5 else 0xF
        step = counter - self.counter & mask
        if step == 0:
            return self._count("repeated")
        if step > self.step_max:
            self.link, self.counter, self.in_order = "QUALIFYING", counter, 1
            return self._count("wrong_sequence")
        self.counter = counter
        self.counts["lost"] = self.counts.get("lost", 0) + step - 1
        if self.link == "QUALIFYING":
            self.in_order += 1
            if self.in_order < QUALIFYING_FRAMES:
                return "not_qualified"
            self.link = "VALID"
        self.refreshed_ms = now_ms
        return self._count("used")
