# SPDX-License-Identifier: Apache-2.0
"""What a page can show beside runs: the map of the best torque, and stops at constant demand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from hubsim.report.reading import Array


class MapLike(Protocol):
    """The loss-optimal braking torque over wheel speed.

    Arrays of shape (points,), torques as magnitudes in N m.
    """

    @property
    def temperature_c(self) -> float:
        """Of the winding."""

    @property
    def wheel_radius_m(self) -> float:
        """Rolling radius."""

    @property
    def speed_rad_s(self) -> Array:
        """Of the wheel."""

    @property
    def optimal_nm(self) -> Array:
        """What returns the most energy."""

    @property
    def zero_nm(self) -> Array:
        """Beyond it braking takes energy out of the battery."""

    @property
    def limit_nm(self) -> Array:
        """Torque and power limits of the motor."""


class CurveLike(Protocol):
    """Share of the kinetic energy that stops of one strategy store (1) over the demand at a wheel (N m)."""

    @property
    def strategy(self) -> str:
        """Name of the strategy."""

    @property
    def demand_nm(self) -> Sequence[float]:
        """Of the simulated stops, rising."""

    @property
    def stored(self) -> Sequence[float]:
        """By the simulated stops."""

    @property
    def settled(self) -> Sequence[float]:
        """By ideal stops of the same demands whose battery is in steady state throughout."""

    @property
    def ideal_demand_nm(self) -> Sequence[float]:
        """Of the ideal stops, rising."""

    @property
    def ideal(self) -> Sequence[float]:
        """By the ideal stops, whose battery is at rest before each."""


@dataclass(frozen=True)
class Extras:
    """Maps by the name of the vehicle, and the curves of one vehicle's stops."""

    maps: Mapping[str, MapLike] = field(default_factory=dict)
    stops: Sequence[CurveLike] = ()
    command: str = "./tools/dev sim"
