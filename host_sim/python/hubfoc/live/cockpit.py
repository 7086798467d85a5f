# SPDX-License-Identifier: Apache-2.0
"""Pedals of the page: who has them, and the demand that is sent because of them."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

from hubsim import can_protocol
from regen_table.schema import Drive

from hubfoc.bus import Frame
from hubfoc.client import DIRECTIONS
from hubfoc.cyclic import cycle_s
from hubfoc.errors import HubfocError

SILENT_S = 0.5  # without a word of the page that has the controls, its pedals are released
FOREIGN_S = 0.1  # of simulated time, without a demand of somebody else
ACKNOWLEDGE_S = 0.3
ROUNDING_S = 1e-6
FULL_S = 0.3  # in which a pedal moves over its whole travel


@dataclass
class Pedals:
    """What the page wants, in shares of the travel."""

    accelerator: float = 0.0
    brake: float = 0.0
    direction: str = "forward"


class Cockpit:
    """Sends ``Demand`` in its cycle of simulated time, as long as a page has the controls.

    While another sender's demand is on the bus, none is sent. A page that says no more for
    ``SILENT_S`` has released its pedals.
    """

    def __init__(self, drive: Drive, rear: Drive | None = None) -> None:
        self._ends_nm = [_ends_nm(axle) for axle in (drive, rear or drive)]
        self.drive_nm, self.brake_nm = self._ends_nm[0]
        self.owner: object | None = None
        self.switched_off = False  # the page's demands ask for no torque
        self._withdrawn = False  # no driving torque until the accelerator has been let go
        self._base = drive.vehicle.can_base
        self._pedals = Pedals()
        self._reached = [0.0, 0.0]  # accelerator and brake, at most FULL_S for the whole travel
        self._message_s = -math.inf
        self._foreign_s = -math.inf
        self._acknowledge_until_s = -math.inf
        self._due_s = 0.0
        self._counter = 0
        self._time_s = 0.0

    def begin(self) -> None:
        """Start with another vehicle, whose time is zero."""
        self.switched_off = self._withdrawn = False
        self._reached = [0.0, 0.0]
        self._foreign_s = self._acknowledge_until_s = -math.inf
        self._due_s = self._time_s = 0.0

    @property
    def foreign(self) -> bool:
        """Whether somebody else's demand is on the bus."""
        return self._time_s - self._foreign_s < FOREIGN_S

    def take(self, owner: object) -> None:
        """Give the controls to a page; refused while another one has them."""
        if self.owner not in (None, owner):
            raise HubfocError("another page has the controls, accepted: after it lets them go")
        if self.foreign:
            raise HubfocError("another sender's demand is on this bus, accepted: one sender")
        self.owner = owner
        self._withdrawn = False
        self._pedals = Pedals()
        self._message_s = time.monotonic()

    def release(self, owner: object) -> None:
        """Take the controls from a page, if it has them."""
        if self.owner is owner:
            self.owner = None

    def drive(self, owner: object, accelerator: float, brake: float, direction: str) -> None:
        """Do what the page that has the controls wants."""
        self.check(owner)
        if direction not in DIRECTIONS:
            raise HubfocError(f"direction {direction!r}, accepted: {', '.join(DIRECTIONS)}")
        if not (0.0 <= accelerator <= 1.0 and 0.0 <= brake <= 1.0):
            raise HubfocError("accelerator, brake: accepted: 0 to 1")
        self._pedals = Pedals(accelerator, brake, direction)
        self._withdrawn = self._withdrawn and accelerator > 0.0
        self._message_s = time.monotonic()

    def withdraw(self, owner: object) -> None:
        """End the driving torque in one step, until the accelerator has been let go."""
        self.check(owner)
        self._withdrawn = True

    def acknowledge(self, owner: object) -> None:
        """Acknowledge faults, with released pedals."""
        self.check(owner)
        self._acknowledge_until_s = self._time_s + ACKNOWLEDGE_S

    def check(self, owner: object) -> None:
        """Refuse what a page without the controls wants."""
        if self.owner is not owner:
            raise HubfocError("this page watches, accepted: from the page that has the controls")

    def frames(self, time_s: float, received: Sequence[Frame], *, silent: bool) -> list[Frame]:
        """Return the demands of this millisecond."""
        self._time_s = time_s
        if any(can_protocol.message_of(i, self._base) == "Demand" for i, _ in received):
            self._foreign_s = time_s
        if time_s < self._due_s - ROUNDING_S:
            return []
        self._due_s = time_s + cycle_s("Demand")
        if self.owner is None or self.foreign or silent:
            self._reached = [0.0, 0.0]
            return []
        values = self._values()
        self._counter = (self._counter + 1) % 256
        return [
            can_protocol.encode(
                "Demand", values[wheel // 2], wheel=wheel, counter=self._counter, base=self._base
            )
            for wheel in range(4)
        ]

    def _values(self) -> list[dict[str, float]]:
        """Return the demand of a wheel in front and of one at the rear."""
        pedals = self._pedals
        acknowledges = self._time_s < self._acknowledge_until_s
        if acknowledges or time.monotonic() - self._message_s > SILENT_S:
            pedals = Pedals(direction=pedals.direction)
        if self._withdrawn:  # a wheel in neutral drops its driving torque, without a rate
            pedals = Pedals(brake=pedals.brake, direction="neutral")
            self._reached[0] = 0.0
        rise = cycle_s("Demand") / FULL_S
        for k, wanted in enumerate((pedals.accelerator, pedals.brake)):
            self._reached[k] += min(max(wanted - self._reached[k], -rise), rise)
        accelerator, brake = self._reached
        sign = -1.0 if pedals.direction == "reverse" else 1.0
        return [
            {
                "enable": float(not self.switched_off),
                "fault_reset": float(acknowledges),
                "direction": float(DIRECTIONS[pedals.direction]),
                "abs_motor_share_percent": 0.0,
                "drive_torque_nm": sign * accelerator * drive_nm,
                "brake_torque_nm": brake * brake_nm,
            }
            for drive_nm, brake_nm in self._ends_nm
        ]


def _ends_nm(drive: Drive) -> tuple[float, float]:
    """Return the ends of accelerator and brake pedal at one wheel."""
    brake_nm = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    most_nm = can_protocol.MESSAGES["Demand"].signals["brake_torque_nm"].most
    return drive.motor.max_torque_nm, min(brake_nm, most_nm)
