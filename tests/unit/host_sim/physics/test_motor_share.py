# SPDX-License-Identifier: Apache-2.0
"""Below a limit the motor makes what the hydraulic brake does not make, and says which limit."""

from typing import Any

import hubsim
import numpy as np
import pytest
from hubsim import reasons
from hubsim.engine import ROOT

SIGNALS = (
    "time_s", "vehicle.speed_m_per_s", "wheel0.command_nm", "wheel0.hydraulic_torque_nm",
    "wheel0.reason", "wheel0.limit_braking_nm", "wheel0.limit_braking_reason",
)  # fmt: skip
STOPS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("ebike36v", {"initial_speed_kmh": 37.3, "demand_nm": 8.16, "winding_temperature_c": -13.0,
                  "ambient_temperature_c": -13.0, "initial_soc": 0.998}),
    ("ebike36v", {"initial_speed_kmh": 37.3, "demand_nm": 30.0}),
    ("scooter48v", {"initial_speed_kmh": 25.0, "demand_nm": 30.0}),
    ("scooter48v", {"initial_speed_kmh": 25.0, "demand_nm": 60.0, "initial_soc": 0.95}),
    ("lu2013", {"initial_speed_kmh": 50.0, "demand_nm": 80.0}),
    ("ipm400v", {"initial_speed_kmh": 100.0, "demand_nm": 300.0}),
)  # fmt: skip


@pytest.mark.parametrize(("name", "keys"), STOPS)
def test_motor_makes_what_its_limit_and_the_hydraulic_brake_leave(
    name: str, keys: dict[str, Any]
) -> None:
    config = hubsim.load_configuration(ROOT / "tools" / "motors" / f"{name}.toml")
    with hubsim.Bench(
        config, record=SIGNALS, record_interval_s=0.005, stop_at_standstill=True, **keys
    ) as bench:
        rows = bench.run()
    rolls = (rows["time_s"] > 0.6) & (rows["vehicle.speed_m_per_s"] > 1.5)
    line_nm = rows["wheel0.limit_braking_nm"]
    left_nm = keys["demand_nm"] - rows["wheel0.hydraulic_torque_nm"]
    missing_nm = np.minimum(line_nm, left_nm) + rows["wheel0.command_nm"]
    assert np.max(missing_nm[rolls] / line_nm[rolls]) < 0.01
    limited = rolls & (line_nm < 0.999 * keys["demand_nm"])
    same = rows["wheel0.reason"] == rows["wheel0.limit_braking_reason"]
    assert np.mean(same[limited]) > 0.9  # the lines cross within a recorded row
    assert not np.any(rows["wheel0.reason"][limited] == reasons.codes()["TORQUE_RATE"])
