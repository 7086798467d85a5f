# SPDX-License-Identifier: Apache-2.0
"""How long the sensors may show no current although the current loop asks for one."""

from pathlib import Path

import pytest
from regen_table import loops, schema

MOTORS = Path(__file__).resolve().parents[4] / "tools" / "motors"


@pytest.mark.parametrize("name", ["lu2013", "ebike36v", "scooter48v", "ipm400v"])
def test_a_small_reference_passes_the_dead_time_before_it_counts_as_missing(name: str) -> None:
    """The regulator alone, in a cold winding, against the voltage that three legs lose at zero.

    And sensors that are dead from the start hide less than what trips.
    """
    drive = schema.load(MOTORS / f"{name}.toml")
    inverter = drive.inverter
    gains = loops.axis_gains(drive, drive.motor.q_inductance_h)
    cold = 0.85  # of the resistance that k_i is scaled to, at -20 degC
    lost_v = inverter.dead_time_s * inverter.pwm_frequency_hz * drive.battery.max_voltage_v
    reference_a = 48.0 / 32768.0 * inverter.current_full_scale_a
    periods = 0
    while (
        gains.proportional * reference_a + cold * gains.integral * reference_a * periods
        < 4.0 / 3.0 * lost_v
    ):
        periods += 1
    missing_as = 1e-3 * loops.current_missing_ms(drive) * inverter.current_full_scale_a
    assert reference_a * periods / inverter.pwm_frequency_hz < missing_as
    hidden_a = gains.integral * missing_as * inverter.pwm_frequency_hz
    hidden_a /= drive.motor.phase_resistance_ohm + inverter.switch_resistance_ohm
    assert hidden_a < loops.overcurrent_pu(drive) * inverter.current_full_scale_a
