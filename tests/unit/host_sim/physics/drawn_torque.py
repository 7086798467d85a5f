# SPDX-License-Identifier: Apache-2.0
"""Torque of a drawn motor that saturates, plant and controller from the same map."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import saturating_drives
from hubsim import reasons
from hubsim.run.bench import Bench

# Of every third of the swarm's those whose map the generator accepts.
NUMBERS = (4, 10, 16, 7, 13, 19, 22, 28, 31, 34, 37, 40, 43, 46, 49, 52, 55, 58, 61, 64)
SPEED_SHARES = (0.15, 0.6, 1.0)
TORQUE_SHARES = (-1.0, -0.3, 0.05, 0.6)
SETTLED_S, MEAN_ROWS = 0.4, 100
OF_COMMAND, OF_LARGEST = 0.02, 0.005  # accepted errors of torque
SIGNALS = ("motor_torque_nm", "command_nm", "first_fault_reason", "warning_reason")


def misses(number: int, folder: Path) -> Iterator[str]:
    """Yield what is wrong at each speed and demand; torque is shaft torque in steady state."""
    config = saturating_drives.drawn(number, folder)
    assert config.drive is not None
    motor, radius_m = config.drive.motor, config.drive.vehicle.wheel_radius_m
    for speed_share in SPEED_SHARES:
        speed = speed_share * motor.max_speed_rpm * math.pi / 30.0
        friction = motor.friction_torque_nm + motor.viscous_friction_nm_s * speed
        with Bench(
            config,
            "stop",
            plant={"vehicle.mass_kg": 1e6, "thermal.winding_temperature_c": 25.0},
            record=[f"wheel0.{name}" for name in SIGNALS],
            initial_speed_kmh=3.6 * speed * radius_m,
            noise=False,
            record_interval_s=0.001,
            max_duration_s=60.0,
        ) as bench:
            for share in TORQUE_SHARES:
                bench.set("driver.brake_demand_nm", max(-share, 0.0) * motor.max_torque_nm)
                bench.set("driver.drive_demand_nm", max(share, 0.0) * motor.max_torque_nm)
                airgap, command, fault, warning = bench.run(SETTLED_S).rows.T
                made = float(np.mean(airgap[-MEAN_ROWS:])) - friction
                wanted = float(np.mean(command[-MEAN_ROWS:]))
                named = reasons.shown(max(fault)) + reasons.shown(max(warning))
                accepted = OF_COMMAND * abs(wanted) + OF_LARGEST * motor.max_torque_nm
                if named or abs(made - wanted) > accepted:
                    yield f"{speed_share} {share}: {made:.3f} of {wanted:.3f} N m {named}"
