# SPDX-License-Identifier: Apache-2.0
"""A reference for the vehicle's computer: pedals in, a demand for each wheel out.

VEHICLE.md says why. Pure: no bus, no clock; called once in each cycle of Demand (10 ms) with what
the wheels last said.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from hubfoc.client import DIRECTIONS, WheelStatus
from hubfoc.cyclic import Values

AXLES = ((0, 1), (2, 3))  # left and right wheel, in front and at the rear
RUNNING = ("RUN", "LIMP")
STANDSTILL_RAD_S = 0.1
CYCLE_S = 0.010


@dataclass(frozen=True)
class Driver:
    """What the driver wants of the whole vehicle, in each cycle."""

    is_on: bool  # key on, no charging cable, not in transport mode
    direction: str = "forward"
    drive_nm: float = 0.0  # sum over all wheels, magnitude
    brake_nm: float = 0.0  # likewise
    acknowledges: bool = False  # a fault, at standstill


class Computer:
    """Shares torque among the axles, and equally between left and right.

    Parameters
    ----------
    front_share : float
        Of the driving torque that the front axle makes, 0 to 1. With axles that differ, the share
        of its motors in the torque of all: then each motor has the same part to make.
    brake_front_share : float, optional
        Of the braking torque; absent: as of the driving torque.
    rate_nm_per_s : float
        With which the driving torque of a wheel rises; it falls at once.
    has_hydraulic : bool
        Every wheel has a hydraulic brake that fills what its motor does not make. Without one the
        braking torque of an axle is that of its weaker motor.
    """

    def __init__(
        self,
        *,
        front_share: float = 0.5,
        brake_front_share: float | None = None,
        rate_nm_per_s: float = 400.0,
        has_hydraulic: bool = True,
    ) -> None:
        brake_share = front_share if brake_front_share is None else brake_front_share
        self._drive_shares = (front_share, 1.0 - front_share)
        self._brake_shares = (brake_share, 1.0 - brake_share)
        self._rise_nm = rate_nm_per_s * CYCLE_S
        self._has_hydraulic = has_hydraulic
        self._direction = "neutral"
        self._drive_nm = [0.0, 0.0]  # of each wheel of an axle

    def step(self, driver: Driver, wheels: Sequence[WheelStatus]) -> list[Values]:
        """Return the signals of Demand for each wheel, front left first."""
        self._choose_direction(driver, wheels)
        demands: list[Values] = [{}] * len(wheels)
        for axle, pair in enumerate(AXLES):
            both = [wheels[k] for k in pair]
            drive_nm = self._drive(axle, driver, both)
            brake_nm = self._brake(axle, driver, both)
            for k in pair:
                demands[k] = self._demand(driver, wheels, drive_nm, brake_nm)
        return demands

    def _choose_direction(self, driver: Driver, wheels: Sequence[WheelStatus]) -> None:
        """Take another direction at standstill only; a wheel refuses it as well."""
        if not driver.is_on:
            self._direction = "neutral"
        elif driver.direction != self._direction and _stands(wheels):
            self._direction = driver.direction

    def _drive(self, axle: int, driver: Driver, both: Sequence[WheelStatus]) -> float:
        """Return the driving torque of each wheel: what the weaker one can make, now and soon.

        Without a frame of one of the two its axle does not drive. What one axle cannot make the
        other does not take over: the driver has a vehicle that is weaker, not one that steers.
        """
        wanted_nm = self._drive_shares[axle] * driver.drive_nm / len(both)
        if self._direction == "neutral" or driver.brake_nm > 0.0:
            wanted_nm = 0.0
        limit_nm = min(map(_drivable_nm, both))
        self._drive_nm[axle] = min(wanted_nm, limit_nm, self._drive_nm[axle] + self._rise_nm)
        return self._drive_nm[axle]

    def _brake(self, axle: int, driver: Driver, both: Sequence[WheelStatus]) -> float:
        """Return the braking torque of each wheel, of both its brakes.

        It is never reduced where hydraulic brakes fill: a wheel commands its own. A wheel that is
        silent or has handed over is braked by the brake system's own path, by the same pedal.
        """
        wanted_nm = self._brake_shares[axle] * driver.brake_nm / len(both)
        if self._has_hydraulic:
            return wanted_nm
        return min(wanted_nm, *(wheel.brake_available_nm or 0.0 for wheel in both))

    def _demand(
        self, driver: Driver, wheels: Sequence[WheelStatus], drive_nm: float, brake_nm: float
    ) -> Values:
        released = driver.drive_nm == 0.0 and driver.brake_nm == 0.0
        return {
            "enable": float(driver.is_on),
            "direction": float(DIRECTIONS[self._direction]),
            "fault_reset": float(driver.acknowledges and released and _stands(wheels)),
            "abs_motor_share_percent": 0.0,
            "drive_torque_nm": -drive_nm if self._direction == "reverse" else drive_nm,
            "brake_torque_nm": brake_nm,
        }


def _stands(wheels: Sequence[WheelStatus]) -> bool:
    """Return whether every wheel says that it stands; a silent one does not."""
    return all(
        wheel.speed_rad_s is not None
        and "WheelState" not in wheel.lost
        and abs(wheel.speed_rad_s) < STANDSTILL_RAD_S
        for wheel in wheels
    )


def _drivable_nm(wheel: WheelStatus) -> float:
    """Return what a wheel can drive with, now and 300 ms later; 0 if that is not known."""
    known = wheel.mode in RUNNING and not wheel.lost
    torques = (wheel.drive_available_nm, wheel.drive_ahead_nm)
    return min((nm or 0.0 for nm in torques), default=0.0) if known else 0.0
