# SPDX-License-Identifier: Apache-2.0
"""Plausible drives of either type at random, always the same ones, for the tests in Python and in
C++.
"""

import contextlib
from typing import Any

import numpy as np
from regen_table import schema
from regen_table.errors import ConfigurationError

Tree = dict[str, Any]
COUNT = 200


def drives() -> list[schema.Drive]:
    """Return two hundred drives of 100 W to 100 kW."""
    rng = np.random.default_rng(20130703)
    found: list[schema.Drive] = []
    while len(found) < COUNT:
        name = f"random{len(found)}"
        with contextlib.suppress(ConfigurationError):  # as of a PWM too slow for the speed
            found.append(schema.parse(random_tree(rng), name, f"{name}.toml"))
    return found


def random_tree(rng: np.random.Generator) -> Tree:
    """Return a plausible drive of 100 W to 100 kW.

    Per-unit losses and reactances of real machines, scaled.
    """
    power, speed = (
        10 ** rng.uniform(2.0, 5.0),
        10 ** rng.uniform(2.3, 3.9),
    )  # W, r/min at rated torque
    bus = float(np.clip(24.0 * (power / 100.0) ** 0.45 * rng.uniform(0.7, 1.5), 20.0, 900.0))
    pole_pairs, interior = int(rng.integers(2, 31)), bool(rng.integers(2))
    shaft = speed * np.pi / 30.0
    # At most what one and a half of it may be on CAN.
    omega, torque = shaft * pole_pairs, min(power / shaft, 1092.0)
    flux = bus / np.sqrt(3.0) * rng.uniform(0.55, 0.95) / omega
    current = torque / (1.5 * pole_pairs * flux)
    impedance = flux * omega / current
    inductance = impedance / omega * rng.uniform(0.1, 0.6)
    iron = (
        [impedance * rng.uniform(8.0, 40.0), impedance / omega * rng.uniform(0.0, 30.0)]
        if rng.random() < 0.85
        else None
    )
    drop = bus * rng.uniform(0.001, 0.02)
    frequency = float(rng.choice([8e3, 10e3, 16e3, 20e3]))
    tree: Tree = {
        "motor": {
            "name": "random",
            "type": "ipmsm" if interior else "spmsm",
            "pole_pairs": pole_pairs,
            "phase_resistance_ohm": impedance * rng.uniform(0.01, 0.08),
            "reference_temperature_c": float(rng.choice([20.0, 25.0])),
            "resistance_temperature_coefficient_per_k": 0.00393,
            "d_inductance_h": inductance,
            "q_inductance_h": inductance * (rng.uniform(1.2, 3.5) if interior else 1.0),
            "flux_linkage_wb": flux,
            "iron_loss_resistance_ohm": iron,
            "friction_torque_nm": 0.005 * torque,
            "viscous_friction_nm_s": 0.005 * torque / shaft,
            "rated_torque_nm": torque,
            "max_torque_nm": 1.5 * torque,
            "max_power_w": 1.3 * power,
            "max_phase_current_a": 1.8 * current,
            "max_speed_rpm": speed,
            "max_winding_temperature_c": 160.0,
        },
        "inverter": {
            "switch_resistance_ohm": impedance * rng.uniform(0.002, 0.02),
            "diode_forward_voltage_v": rng.uniform(0.6, 1.5),
            "diode_resistance_ohm": impedance * 0.01,
            "dead_time_s": 1e-6,
            "pwm_frequency_hz": frequency,
            "turn_on_loss_j_per_a": 0.5 * drop / frequency,
            "turn_off_loss_j_per_a": 0.5 * drop / frequency,
            "current_full_scale_a": 2.5 * current,
            "voltage_full_scale_v": 1.4 * bus,
        },
        "battery": {
            "open_circuit_voltage_v": bus,
            "series_resistance_ohm": 0.02 * bus * bus / power / 4.0,
            "polarisation_resistance_ohm": 0.01 * bus * bus / power / 4.0,
            "polarisation_capacitance_f": 1000.0,
            "capacity_ah": power / bus,
            "max_charge_current_a": 3.0 * power / bus,
            "max_discharge_current_a": 3.0 * power / bus,
            "max_voltage_v": 1.2 * bus,
            "min_voltage_v": 0.7 * bus,
        },
        "vehicle": {
            "mass_kg": power / 10.0,
            "wheel_radius_m": 0.25,
            "frontal_area_m2": 1.0,
            "drag_coefficient": 0.4,
            "rolling_resistance": 0.01,
            "driven_wheels": int(rng.integers(1, 5)),
        },
        "brake": {
            "strategy": "series_optimal",
            "parallel_electric_share": 0.2,
            "electric_rated_torque_nm": torque,
            "hydraulic_dead_time_s": 0.04,
            "hydraulic_time_constant_s": 0.06,
            "hydraulic_rate_nm_per_s": 10.0 * torque,
            "max_hydraulic_torque_nm": min(8.0 * torque, 3276.7),
        },
        "control": {
            "current_bandwidth_hz": frequency / 20.0,
            "torque_rate_nm_per_s": 10.0 * torque,
            "handover_start_rpm": 0.04 * speed,
            "handover_end_rpm": 0.015 * speed,
        },
        "table": {
            "speed_points": 33,
            "temperature_points": 3,
            "temperature_range_c": [-20.0, 150.0],
        },
    }
    if iron is None:
        del tree["motor"]["iron_loss_resistance_ohm"]
    return tree
