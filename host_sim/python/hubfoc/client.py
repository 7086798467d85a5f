# SPDX-License-Identifier: Apache-2.0
"""The vehicle's computer in a few lines: demands to the wheels, and what they say of themselves."""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from threading import Thread
from typing import Self

from hubsim import can_protocol, engine, reasons

from hubfoc import bus as buses
from hubfoc.cyclic import Cyclic, check, cycle_s
from hubfoc.errors import HubfocError

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
DIRECTIONS = {"neutral": 0, "forward": 1, "reverse": 2}
SENT_BY_WHEELS = ("WheelState", "WheelBrake", "WheelDrive", "WheelPower", "WheelHealth",
                  "WheelAhead", "WheelAvailable", "WheelEnergy")  # fmt: skip
END_CYCLES = 10  # zero demands before the sender falls silent
LISTEN_CYCLES = 10  # before the first demand, whether somebody else sends some


@dataclass(frozen=True)
class WheelStatus:
    """What one wheel last said, in the units of the names; None: not said, or not available.

    ``lost`` names the messages that have come but come no more (five cycles).
    """

    mode: str | None
    fault: str | None
    speed_rad_s: float | None
    motor_torque_nm: float | None
    motor_torque_uncertainty_nm: float | None  # one standard deviation of it; information
    torque_limit: str | None
    hydraulic_torque_nm: float | None  # commanded; None also while the wheel hands over
    brake_available_nm: float | None
    drive_available_nm: float | None
    brake_ahead_nm: float | None  # expected 300 ms later, as the next
    drive_ahead_nm: float | None
    bus_voltage_v: float | None
    bus_current_a: float | None
    winding_temperature_c: float | None
    warning: str | None
    waits_for: str | None  # before it drives; empty: for nothing
    drawn_wh: float | None  # energies and friction's share of the braking work since the start
    returned_wh: float | None
    friction_percent: float | None
    life_drawn_wh: float | None  # and for life
    life_returned_wh: float | None
    life_friction_percent: float | None
    lost: tuple[str, ...]


@dataclass
class Wheel:
    """One wheel as seen from the bus."""

    position: str
    base: int = can_protocol.BASE
    receivers: dict[str, can_protocol.Receiver] = field(
        default_factory=lambda: {name: can_protocol.Receiver(name) for name in SENT_BY_WHEELS}
    )
    values: dict[str, Mapping[str, float]] = field(default_factory=dict)

    def take(self, identifier: int, data: bytes, now_ms: int) -> None:
        """Use a frame of this wheel if its protection lets it."""
        name = can_protocol.message_of(identifier, self.base)
        if (
            name in self.receivers
            and self.receivers[name].receive(identifier, data, now_ms) == "used"
        ):
            values = can_protocol.decode(name, data)
            assert values is not None
            self.values[name] = {**self.values.get(name, {}), **values}

    def status(self, now_ms: int | None = None) -> WheelStatus:
        """Return what the wheel last said; ``now_ms`` of another clock than the wall's."""
        now_ms = buses.now_ms() if now_ms is None else now_ms
        for receiver in self.receivers.values():
            receiver.timed_out(now_ms)

        def latest(message: str, signal: str) -> float | None:
            value = self.values.get(message, {}).get(signal)
            return None if value is None or math.isnan(value) else value

        def reason(message: str, signal: str) -> str | None:
            code = latest(message, signal)
            return None if code is None else reasons.identifier(int(code))

        mode = latest("WheelState", "mode")
        return WheelStatus(
            mode=None if mode is None else engine.mode_text(mode),
            fault=reason("WheelState", "fault_reason"),
            speed_rad_s=latest("WheelState", "speed_rad_s"),
            motor_torque_nm=latest("WheelState", "motor_torque_estimate_nm"),
            motor_torque_uncertainty_nm=latest("WheelPower", "motor_torque_uncertainty_nm"),
            torque_limit=reason("WheelDrive", "torque_reason"),
            hydraulic_torque_nm=latest("WheelBrake", "hydraulic_torque_nm")
            if latest("WheelBrake", "hydraulic_valid")
            else None,
            brake_available_nm=latest("WheelBrake", "electric_brake_available_nm"),
            drive_available_nm=latest("WheelAvailable", "drive_available_nm"),
            brake_ahead_nm=latest("WheelAhead", "electric_brake_ahead_nm"),
            drive_ahead_nm=latest("WheelAhead", "drive_ahead_nm"),
            bus_voltage_v=latest("WheelPower", "bus_voltage_v"),
            bus_current_a=latest("WheelPower", "bus_current_a"),
            winding_temperature_c=latest("WheelHealth", "winding_temperature_c"),
            warning=reason("WheelHealth", "warning_reason"),
            waits_for=None
            if (waits_for := latest("WheelAvailable", "waits_for")) is None
            else reasons.waits_for(int(waits_for)),
            drawn_wh=latest("WheelEnergy", "drawn_wh"),
            returned_wh=latest("WheelEnergy", "returned_wh"),
            friction_percent=latest("WheelEnergy", "friction_percent"),
            life_drawn_wh=latest("WheelEnergy", "life_drawn_wh"),
            life_returned_wh=latest("WheelEnergy", "life_returned_wh"),
            life_friction_percent=latest("WheelEnergy", "life_friction_percent"),
            lost=tuple(n for n, r in self.receivers.items() if r.link == "TIMED_OUT"),
        )


class Vehicle:
    """A vehicle on a CAN bus: listens from the start, sends demands from the first on.

    Parameters
    ----------
    channel : str
        The bus, as ``hubfoc live --can``; of a virtual vehicle: what it printed.
    base : int
        Lowest identifier of the vehicle, ``[vehicle] can_base`` of its configuration.

    The demand last given is repeated in its cycle, end-to-end protected. At the end of the context
    it is zero for ten cycles, then no more demand is sent, and the wheels' brakes follow their
    configuration for a lost one.
    """

    def __init__(self, channel: str = buses.MULTICAST, base: int = can_protocol.BASE) -> None:
        self._base = base
        self._bus = buses.join(channel)
        self.wheels = [Wheel(position, base) for position in WHEELS]
        self.front_left, self.front_right, self.rear_left, self.rear_right = self.wheels
        self._demands: list[dict[str, float]] | None = None
        self._foreign_ms: int | None = None  # when somebody else's demand came last
        self._ends = False
        self._listener = Thread(target=self._listen, daemon=True)
        self._listener.start()
        self._sender = Cyclic(self._bus, "Demand", base, lambda: self._demands)

    def __enter__(self) -> Self:
        """Return the vehicle itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Demand nothing any more, and leave the bus."""
        self.close()

    def demand(
        self, drive_nm: float = 0.0, brake_nm: float = 0.0, *, direction: str = "forward",
        acknowledge: bool = False, wheels: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:  # fmt: skip
        """Demand torque of every wheel until the next call.

        Parameters
        ----------
        drive_nm, brake_nm : float
            At each wheel, N m, magnitudes; reverse drives backwards by ``direction``.
        acknowledge : bool
            Acknowledge faults as long as this demand is sent.
        wheels : mapping, optional
            Other torques for wheels by position: ``{"rear_left": {"brake_nm": 10}}``.
        """
        self._refuse_second_sender()
        if direction not in DIRECTIONS:
            raise HubfocError(f"direction {direction!r}, accepted: {', '.join(DIRECTIONS)}")
        own = dict(wheels or {})
        if unknown := set(own) - set(WHEELS):
            raise HubfocError(f"wheel {min(unknown)!r}, accepted: {', '.join(WHEELS)}")
        demands = []
        for position in WHEELS:
            torques = {"drive_nm": drive_nm, "brake_nm": brake_nm, **own.get(position, {})}
            sign = -1.0 if direction == "reverse" else 1.0
            values = {
                "enable": 1.0,
                "fault_reset": float(acknowledge),
                "direction": float(DIRECTIONS[direction]),
                "abs_motor_share_percent": 0.0,
                "drive_torque_nm": sign * torques["drive_nm"],
                "brake_torque_nm": torques["brake_nm"],
            }
            check("Demand", values)
            demands.append(values)
        self._demands = demands

    def close(self) -> None:
        """Demand nothing any more, and leave the bus."""
        if self._ends:
            return
        if self._demands is not None:
            zero = {"drive_torque_nm": 0.0, "brake_torque_nm": 0.0}
            self._demands = [{**values, **zero} for values in self._demands]
            time.sleep(END_CYCLES * cycle_s("Demand"))
        self._sender.close()
        self._ends = True
        self._listener.join()
        self._bus.close()

    def _refuse_second_sender(self) -> None:
        listen_s = LISTEN_CYCLES * cycle_s("Demand")
        if self._demands is None:
            time.sleep(listen_s)
        last_ms = self._foreign_ms
        if last_ms is not None and buses.now_ms() - last_ms < 1e3 * listen_s:
            raise HubfocError("another sender's demand is on this bus, accepted: one sender")

    def _listen(self) -> None:
        while not self._ends:
            for identifier, data in self._bus.receive(0.05):
                self._take(identifier, data)

    def _take(self, identifier: int, data: bytes) -> None:
        name = can_protocol.message_of(identifier, self._base)
        if name == "Demand":
            self._foreign_ms = buses.now_ms()
        elif name in SENT_BY_WHEELS:
            wheel = self.wheels[identifier & can_protocol.WHEEL_MASK]
            wheel.take(identifier, data, buses.now_ms())
