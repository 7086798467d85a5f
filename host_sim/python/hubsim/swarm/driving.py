# SPDX-License-Identifier: Apache-2.0
"""The feet of one driver, who does what a list of phases says.

Torques at each driven wheel in N m, speeds in m/s.
"""

from dataclasses import dataclass

import numpy as np
from regen_table.schema import Drive

from hubsim.run.plant import STANDARD_GRAVITY_M_PER_S2
from hubsim.swarm.vehicles import BRAKE, COAST, CRAWL_M_PER_S, HOLD, REVERSE, Phase, top_m_per_s

STEP_S = 0.02  # of the driver
SLOPE_S = 1.0  # in which the road becomes another one
BANDWIDTH = 1.0  # of the driver's speed regulator, 1/s
FASTEST_SHARE = 0.97  # of the largest speed: here a coasting driver brakes
FORWARD, BACKWARD = 1.0, 2.0  # directions
STANDS_M_PER_S = 0.02


@dataclass(frozen=True)
class Pedals:
    """Pedals, drive direction and road of one step, by the names of their parameters."""

    drive_nm: float
    brake_nm: float
    direction: float
    slope: float

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters of the simulated world."""
        return {
            "driver.drive_demand_nm": self.drive_nm,
            "driver.brake_demand_nm": self.brake_nm,
            "driver.direction": self.direction,
            "road.slope": self.slope,
        }


class Driver:
    """One driver.

    Parameters
    ----------
    inertia : float
        A driven wheel's share of the mass times the radius, kg m.
    drive_s, brake_s : float
        For the whole travel of a pedal.
    """

    def __init__(self, drive: Drive, inertia: float, drive_s: float, brake_s: float) -> None:
        self._inertia, self._drive_s, self._brake_s = inertia, drive_s, brake_s
        self._top = top_m_per_s(drive)
        self._most_drive = drive.motor.max_torque_nm
        self._most_brake = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
        self._drive = self._brake = self._slope = 0.0

    def wants(self, phase: Phase, speed: float) -> tuple[float, float]:
        """Return accelerator, negative lift-off braking, and brake pedal."""
        if phase.kind in (HOLD, BRAKE):
            return 0.0, phase.torque_nm
        pull = self._inertia * STANDARD_GRAVITY_M_PER_S2 * self._slope
        if phase.kind == COAST:
            fast = speed > FASTEST_SHARE * self._top or speed < -CRAWL_M_PER_S
            return -phase.torque_nm, abs(pull) + 0.1 * self._most_drive if fast else 0.0
        sign = -1.0 if phase.kind == REVERSE else 1.0
        error = phase.speed_share * self._top - sign * speed
        wanted = self._inertia * BANDWIDTH * error + sign * pull
        return sign * float(np.clip(wanted, 0.0, phase.torque_nm)), max(-wanted, 0.0)

    def step(self, phase: Phase, speed: float) -> Pedals:
        """Move pedals and road by one step."""
        drive, brake = self.wants(phase, speed)
        self._drive = _towards(self._drive, drive, self._most_drive * STEP_S / self._drive_s)
        self._brake = _towards(
            self._brake,
            min(brake, self._most_brake),
            self._most_brake * STEP_S / self._brake_s,
        )
        self._slope = _towards(self._slope, phase.slope, 0.24 * STEP_S / SLOPE_S)
        direction = BACKWARD if phase.kind == REVERSE else FORWARD
        return Pedals(self._drive, self._brake, direction, self._slope)


def _towards(value: float, end: float, step: float) -> float:
    return value + min(max(end - value, -step), step)
