# SPDX-License-Identifier: Apache-2.0
"""Steady states of the simulated drive with firmware against the closed-form loss models of
regen_table.
"""

import math

import numpy as np
import pytest
from one_wheel import accounts, quarter, started
from regen_table import models
from regen_table.models import State
from regen_table.schema import Drive

SPEEDS_RPM = np.linspace(60.0, 420.0, 10)
TORQUES_NM = (-38.0, -30.0, -22.0, -14.0, -6.0, 6.0, 14.0, 22.0, 30.0, 38.0)
SETTLE_S, WINDOW_S = 0.6, 0.5
# Off by name: the RC branch settles at once; a very large mass keeps the speed constant.
ON_A_ROLLER = {"vehicle.mass_kg": 1e6, "battery.polarisation_capacitance_f": 1e-3}


def mean_d_current_a(drive: Drive, sampled_a: float, emf_v: float, omega: float) -> float:
    """Remove the sampling error by the PWM ripple from a d current.

    The voltage is constant in the stator frame while the rotor turns by w T: in the rotor frame it
    varies by
    +-w T / 2, its d part through v w (t - T/2). At the period's end that is v w T / 2, so the iron
    current deviates from its mean by v w T / (2 R_i); the winding current is the integral, a
    parabola whose end exceeds its mean by v w T^2 / (12 L).
    """
    period = 1.0 / drive.inverter.pwm_frequency_hz
    assert drive.motor.iron_loss_resistance_ohm is not None
    a0, a1 = drive.motor.iron_loss_resistance_ohm
    in_iron = emf_v * omega * period / (2.0 * (a0 + a1 * omega))
    return sampled_a - in_iron - emf_v * omega * period**2 / (12.0 * drive.motor.d_inductance_h)


def model_at(drive: Drive, omega: float, current_d_a: float, torque_nm: float) -> State:
    """Evaluate the loss models at a torque and a d current.

    With surface magnets the torque is a straight line over i_q.
    """
    motor, bridge = models.machine(drive, 25.0), models.bridge(drive)
    at_0, at_1 = (
        float(models.evaluate(motor, bridge, omega, current_d_a, q).torque_nm) for q in (0.0, 1.0)
    )
    current_q = (torque_nm - at_0) / (at_1 - at_0)
    return models.evaluate(motor, bridge, omega, current_d_a, current_q)


@pytest.mark.parametrize("rpm", SPEEDS_RPM)
def test_torque_and_every_loss_equal_those_of_the_closed_form_models(rpm: float) -> None:
    drive = quarter()
    for asked in TORQUES_NM:
        keys = {
            "initial_speed_kmh": rpm * math.pi / 30.0 * 0.25 * 3.6,
            "demand_nm": 0.0,
            "drive_nm": asked,
            "stop_at_standstill": False,
        }
        with started(drive, {**keys, "max_duration_s": 10.0}, ON_A_ROLLER) as engine:
            engine.run(SETTLE_S)
            before, impulse = accounts(engine), engine.value("wheel0.motor_torque_nm")
            engine.choose(["wheel0.current_d_a"])
            sampled_d_a = float(engine.run(WINDOW_S).mean())
            mean_w = {
                key: (value - before[key]) / WINDOW_S for key, value in accounts(engine).items()
            }
            torque = (engine.value("wheel0.motor_torque_nm") - impulse) / WINDOW_S
            omega = engine.value("vehicle.speed_m_per_s") / 0.25 * drive.motor.pole_pairs
        emf = omega * drive.motor.flux_linkage_wb
        state = model_at(drive, omega, mean_d_current_a(drive, sampled_d_a, emf, omega), torque)
        resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
        pack = models.battery_steady(
            models.open_circuit_voltage_v(drive, None), resistance, state.dc_power_w
        )
        assert torque == pytest.approx(asked, rel=0.005)
        assert mean_w["copper_j"] == pytest.approx(float(state.loss_copper_w), rel=0.005)
        assert mean_w["iron_j"] == pytest.approx(float(state.loss_iron_w), rel=0.005)
        inverter_w = mean_w["conduction_j"] + mean_w["diode_j"] + mean_w["switching_j"]
        assert inverter_w == pytest.approx(float(state.loss_inverter_w), rel=0.005)
        assert mean_w["battery_j"] == pytest.approx(float(pack.loss_w), rel=0.005)
