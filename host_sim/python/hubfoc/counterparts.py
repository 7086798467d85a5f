# SPDX-License-Identifier: Apache-2.0
"""Battery management and brake system of a bench: what a wheel needs besides its demand."""

import math
from collections.abc import Sequence
from threading import Event, Thread
from typing import Self

from hubsim import can_protocol

from hubfoc import bus as buses
from hubfoc.cyclic import Cyclic, Values, check
from hubfoc.errors import HubfocError

CONTACTORS = {"not_reported": 0, "closed": 1, "open": 2}
NO_CURRENT_A = can_protocol.MESSAGES["BatteryPeak"].signals["pack_current_a"].least


class Bms:
    """Sends BatteryLimits, and BatteryPeak where something in it is known, in their cycles.

    Parameters
    ----------
    channel, base
        As of ``hubfoc.Vehicle``.
    charge_a, discharge_a : float
        What the whole pack takes and gives, A, magnitudes.
    """

    def __init__(
        self, channel: str = buses.MULTICAST, base: int = can_protocol.BASE, *,
        charge_a: float, discharge_a: float,
    ) -> None:  # fmt: skip
        self._bus = buses.join(channel)
        self._limits: Values = {}
        self._peak: Values | None = None
        try:
            self.set(charge_a=charge_a, discharge_a=discharge_a)
        except HubfocError:
            self._bus.close()
            raise
        self._senders = [
            Cyclic(self._bus, "BatteryLimits", base, lambda: [self._limits]),
            Cyclic(
                self._bus, "BatteryPeak", base, lambda: None if self._peak is None else [self._peak]
            ),
        ]

    def __enter__(self) -> Self:
        """Return it itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Send no more, and leave the bus."""
        self.close()

    def set(
        self, *, charge_a: float, discharge_a: float, contactor: str = "closed",
        charge_peak_a: float | None = None, voltage_v: float | None = None,
        current_a: float | None = None,
    ) -> None:  # fmt: skip
        """Say from now on: limits, contactor, voltage and current (positive out of the pack)."""
        if contactor not in CONTACTORS:
            raise HubfocError(f"contactor {contactor!r}, accepted: {', '.join(CONTACTORS)}")
        limits = {
            "charge_current_a": charge_a,
            "discharge_current_a": discharge_a,
            "contactor": float(CONTACTORS[contactor]),
        }
        check("BatteryLimits", limits)
        peak = None
        if (charge_peak_a, voltage_v, current_a) != (None, None, None):
            peak = {
                "charge_peak_current_a": charge_peak_a or 0.0,
                "pack_voltage_v": voltage_v or 0.0,
                "pack_current_a": NO_CURRENT_A if current_a is None else current_a,
            }
            check("BatteryPeak", peak)
        self._limits, self._peak = limits, peak

    def close(self) -> None:
        """Send no more, and leave the bus."""
        for sender in self._senders:
            sender.close()
        self._bus.close()


class BrakeSystem:
    """Receives the wheels' hydraulic commands, and reports torques where there are sensors."""

    def __init__(self, channel: str = buses.MULTICAST, base: int = can_protocol.BASE) -> None:
        self._bus = buses.join(channel)
        self._base = base
        self._receivers = [can_protocol.Receiver("WheelBrake") for _ in range(4)]
        self._commands = [math.nan] * len(self._receivers)
        self._reported: list[Values] | None = None
        self._ends = Event()
        self._listener = Thread(target=self._listen, daemon=True)
        self._listener.start()
        self._sender = Cyclic(self._bus, "HydraulicFeedback", base, lambda: self._reported)

    def __enter__(self) -> Self:
        """Return it itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Report no more, and leave the bus."""
        self.close()

    def commands_nm(self) -> list[float | None]:
        """Return what each wheel wants of its hydraulic brake, N m.

        None: the wheel has handed over, or is silent for five cycles, or never spoke; the brake
        system brakes that wheel by the pedal.
        """
        out: list[float | None] = []
        for receiver, command in zip(self._receivers, self._commands, strict=True):
            receiver.timed_out(buses.now_ms())
            given = receiver.link == "VALID" and not math.isnan(command)
            out.append(command if given else None)
        return out

    def report(self, torques_nm: Sequence[float | None]) -> None:
        """Report measured torques from now on, one a wheel, N m; None: that sensor is wrong."""
        if len(torques_nm) != len(self._receivers):
            raise HubfocError(f"{len(torques_nm)} torques, accepted: {len(self._receivers)}")
        reported: list[Values] = [
            {"torque_valid": float(nm is not None), "measured_torque_nm": nm or 0.0}
            for nm in torques_nm
        ]
        for values in reported:
            check("HydraulicFeedback", values)
        self._reported = reported

    def close(self) -> None:
        """Report no more, and leave the bus."""
        self._sender.close()
        self._ends.set()
        self._listener.join()
        self._bus.close()

    def _listen(self) -> None:
        while not self._ends.is_set():
            for identifier, data in self._bus.receive(0.05):
                if can_protocol.message_of(identifier, self._base) == "WheelBrake":
                    self._take(identifier, data)

    def _take(self, identifier: int, data: bytes) -> None:
        wheel = identifier & can_protocol.WHEEL_MASK
        if self._receivers[wheel].receive(identifier, data, buses.now_ms()) == "used":
            values = can_protocol.decode("WheelBrake", data)
            assert values is not None
            valid = values["hydraulic_valid"] > 0.0
            self._commands[wheel] = values["hydraulic_torque_nm"] if valid else math.nan
