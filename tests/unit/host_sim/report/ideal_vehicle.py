# SPDX-License-Identifier: Apache-2.0
"""A vehicle without controllers that gives plausible runs.

Steady-state machine, exact driving, instant brakes.

Quantities and equations are those of Lu et al. 2013 with peak phase flux; one sample lasts
``STEP_S``.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

STEP_S = 0.05
MASS_KG, RADIUS_M, WHEELS = 660.0, 0.25, 4
DRAG_N_S2_PER_M2, ROLLING_N = 0.5 * 1.2 * 1.4 * 0.4, 0.014 * 660.0 * 9.81
PAIRS, FLUX_WB, RESISTANCE_OHM = 23, 0.0204, 0.031
SWITCH_OHM, INVERTER_W_PER_A = 0.0035, 0.25
CELLS_V, BATTERY_OHM = 53.0, 0.022
OPTIMUM_NM_PER_RAD_S, MOST_NM, RATED_NM, SHARE = 4.7, 40.0, 40.0, 0.2
LOSS_OPTIMUM, MAX_TORQUE, ELECTRIC_SHARE = 1, 2, 14
TEXTS = {
    "1": "more torque would return less energy",
    "2": "motor torque limit",
    "14": "fixed electric share of the parallel brake",
}

STRATEGIES = ("parallel_ratio", "parallel_free_travel", "series_optimal")

# ECE-15: s and km/h.
ECE15 = (
    (0, 0), (11, 0), (15, 15), (23, 15), (28, 0), (49, 0), (54, 15), (56, 15), (61, 32), (85, 32),
    (96, 0), (117, 0), (122, 15), (124, 15), (133, 35), (135, 35), (143, 50), (155, 50), (163, 35),
    (176, 35), (188, 0), (195, 0),
)  # fmt: skip


@dataclass
class Run:
    """A run in the form that the simulator gives to the report."""

    cycle: str
    strategy: str
    summary: dict[str, Any]
    time_s: Array
    signals: dict[str, Array]
    vehicle: str = "lu2013"


def electric_torque(strategy: str, demand: Array, speed_rad_s: Array) -> tuple[Array, Array]:
    """Braking torque of one motor in N·m for a demand, both as magnitudes, and the reason why it is
    less.
    """
    best = np.minimum(OPTIMUM_NM_PER_RAD_S * speed_rad_s, MOST_NM)
    offered, reason = {
        "parallel_ratio": (
            np.minimum(SHARE * demand, MOST_NM),
            np.full(demand.shape, ELECTRIC_SHARE),
        ),
        "parallel_free_travel": (np.minimum(demand, RATED_NM), np.full(demand.shape, MAX_TORQUE)),
        "series_optimal": (
            np.minimum(demand, best),
            np.where(best < MOST_NM, LOSS_OPTIMUM, MAX_TORQUE),
        ),
    }[strategy]
    return offered, np.where(offered < demand - 1e-9, reason, 0)


def drive(strategy: str = "series_optimal", mass_kg: float = MASS_KG, cycle: str = "ece15") -> Run:
    """Drive the urban cycle, slowed by 60/80 as in the paper, and compute its energy accounts."""
    points = np.array(ECE15, dtype=np.float64)
    time = np.arange(0.0, points[-1, 0] + 0.5 * STEP_S, STEP_S)
    speed = np.interp(time, points[:, 0], points[:, 1]) * 0.75 / 3.6
    middle = 0.5 * (speed[1:] + speed[:-1])
    acceleration = np.diff(speed) / STEP_S
    drag, rolling = DRAG_N_S2_PER_M2 * middle**2, np.where(middle > 0.0, ROLLING_N, 0.0)
    wanted = (mass_kg * acceleration + drag + rolling) * RADIUS_M / WHEELS
    braking = wanted < 0.0
    omega = middle / RADIUS_M
    demand = np.where(braking, -wanted, 0.0)
    electric, reason = electric_torque(strategy, demand, omega)
    hydraulic = demand - electric
    motor = np.where(braking, -electric, wanted)
    current = motor / (1.5 * PAIRS * FLUX_WB)
    copper = 1.5 * RESISTANCE_OHM * current**2
    iron = 1.5 * (PAIRS * omega * FLUX_WB) ** 2 / (1.5 + 0.006 * PAIRS * omega)
    inverter = INVERTER_W_PER_A * np.abs(current) + 1.5 * SWITCH_OHM * current**2
    bus = WHEELS * (motor * omega + copper + iron + inverter)
    amperes = 2.0 * bus / (CELLS_V + np.sqrt(CELLS_V**2 - 4.0 * BATTERY_OHM * bus))
    powers = {
        "battery": BATTERY_OHM * amperes**2,
        "inverter": WHEELS * inverter,
        "copper": WHEELS * copper,
        "iron": WHEELS * iron,
        "hydraulic": WHEELS * hydraulic * omega,
        "bearing": np.zeros(omega.shape),
    }
    chemical = CELLS_V * amperes

    def joules(watts: Array, when: npt.NDArray[np.bool_]) -> float:
        return float(np.sum(watts[when]) * STEP_S)

    always = np.ones(braking.shape, dtype=np.bool_)
    while_braking = {name: joules(power, braking) for name, power in powers.items()}
    while_driving = {name: joules(power, ~braking) for name, power in powers.items()}
    work, returned = joules(WHEELS * demand * omega, braking), -joules(chemical, braking)
    energy = {name: joules(power, always) for name, power in powers.items()} | {
        "traction": joules(chemical, ~braking),
        "braking_at_wheels": work,
        "battery_returned": returned,
        "drag": joules(drag * middle, always),
        "rolling": joules(rolling * middle, always),
        "climbed": 0.0,
        "stored_kinetic": 0.5 * mass_kg * (speed[-1] ** 2 - speed[0] ** 2),
    }
    heat = sum(energy[name] for name in (*powers, "drag", "rolling"))
    summary = {
        "cycle": cycle,
        "strategy": strategy,
        "energy_j": energy,
        "while_driving_j": while_driving,
        "while_braking_j": while_braking,
        "residual_relative": (
            abs(energy["traction"] - returned - heat - energy["stored_kinetic"])
            / energy["traction"]
        ),
        "braking_share_stored": returned / work,
        "reason_texts": dict(TEXTS),
    }
    intervals = {
        "driver.drive_nm": np.where(braking, 0.0, wanted),
        "driver.brake_nm": demand,
        "battery.voltage_v": CELLS_V - BATTERY_OHM * amperes,
        "battery.current_a": amperes,
        "wheel0.motor_torque_nm": motor,
        "wheel0.hydraulic_torque_nm": hydraulic,
        "vehicle.acceleration_m_per_s2": acceleration,
        "wheel0.current_q_a": current,
        "wheel0.current_d_a": np.zeros(current.shape),
        "wheel0.winding_temperature_c": 25.0 + np.cumsum(copper) * STEP_S / 3000.0,
        "wheel0.reason": reason.astype(np.float64),
    }
    signals = {name: np.append(values, values[-1]) for name, values in intervals.items()}
    signals |= {
        "driver.reference_m_per_s": speed,
        "vehicle.speed_m_per_s": speed - 0.02 * np.sin(time) * (speed > 0.0),
    }
    return Run(cycle, strategy, summary, time, signals)


def three() -> list[Run]:
    """Drive under all strategies."""
    return [drive(strategy) for strategy in STRATEGIES]
