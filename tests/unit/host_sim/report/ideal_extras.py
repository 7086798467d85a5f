# SPDX-License-Identifier: Apache-2.0
"""A plausible map and plausible stops for the report.

The ideal vehicle's optimum, and curves that increase and decrease.
"""

from dataclasses import dataclass

import numpy as np

from tests.unit.host_sim.report.ideal_vehicle import (
    MOST_NM,
    OPTIMUM_NM_PER_RAD_S,
    RADIUS_M,
    STRATEGIES,
    Array,
)


@dataclass
class Map:
    temperature_c: float
    wheel_radius_m: float
    speed_rad_s: Array
    optimal_nm: Array
    zero_nm: Array
    limit_nm: Array


@dataclass
class Curve:
    strategy: str
    demand_nm: tuple[float, ...]
    stored: tuple[float, ...]
    settled: tuple[float, ...]
    ideal_demand_nm: tuple[float, ...]
    ideal: tuple[float, ...]


def best_map() -> Map:
    speed = np.linspace(0.0, 67.0, 50)
    best = OPTIMUM_NM_PER_RAD_S * speed
    return Map(25.0, RADIUS_M, speed, best, 2.0 * best, np.full(50, MOST_NM))


def curves() -> list[Curve]:
    ideal_nm = (5.0, 20.0, 40.0, 80.0, 120.0)
    shares = {
        "parallel_ratio": (-0.14, 0.11, 0.15, 0.16, 0.16),
        "parallel_free_travel": (0.64, 0.81, 0.74, 0.37, 0.25),
    }
    shares["series_optimal"] = (0.64, 0.81, 0.76, 0.38, 0.25)
    return [
        Curve(
            name,
            (5.0, 40.0, 120.0),
            (s[0], s[2] + 0.01, s[4]),
            (s[0], s[2] - 0.007, s[4]),
            ideal_nm,
            s,
        )
        for name, s in zip(STRATEGIES, shares.values(), strict=True)
    ]
