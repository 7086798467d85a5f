# SPDX-License-Identifier: Apache-2.0
"""The motor of 400 V around half of the EMF observer's speed, 3.3 km/h: healthy, and displaced."""

import random
from pathlib import Path

import numpy as np
import pytest
from hubsim import reasons, run
from hubsim.engine import Rows
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep.faults_sweep import BRAKE_S, STOP, Group, _Vehicle, drive_of, stop_s

SIGNALS = (
    *("vehicle.speed_m_per_s", "wheel0.motor_torque_nm"),
    *("wheel0.fault_reason", "wheel0.warning_reason"),
)
SPEED, TORQUE, FAULT, WARNING = range(len(SIGNALS))
KMH = 1.0 / 3.6
# Draws in which the torque that changes turned the observed flux for 5 to 8 ms, by more than 60
# degrees, and those in which 30 degrees without a current lasted for long.
TURNED = (226, 579, 777, 969, 2008, 2419, 2462)


def healthy_ride(number: int) -> Rows:
    """Return a ride at up to 14 km/h on a slope, eight demands up to 2.5 times the rated torque.

    A motor that is not quite what it is configured as: L_q and L_d by 5 %, flux 0.85 to 1.05,
    resistance 0.8 to 1.3, dead time 0.5 to 1.5 times.
    """
    draw = random.Random(number)
    uniform = draw.uniform
    config = draw.choice(["ipm400v", "ipm400v", "lu2013"])
    drive = drive_of(config, draw.choice(["angle", "encoder"]))
    motor, inverter = drive.motor, drive.inverter
    q, d, r, psi = uniform(0.95, 1.05), uniform(0.95, 1.05), uniform(0.8, 1.3), uniform(0.85, 1.05)
    speed_kmh, slope = uniform(1.0, 14.0) * draw.choice([1, 1, 1, -1]), uniform(-8.0, 8.0)
    scenario = Scenario(
        initial_speed_kmh=speed_kmh,
        slope_percent=slope,
        record_interval_s=0.001,
        max_duration_s=60.0,
        plant={
            "bus.capacitance_f": drive.vehicle.driven_wheels * inverter.bus_capacitance_f,
            "motor.d_inductance_h": motor.d_inductance_h * d,
            "motor.q_inductance_h": motor.q_inductance_h * q,
            "motor.phase_resistance_ohm": motor.phase_resistance_ohm * r,
            "motor.flux_linkage_wb": motor.flux_linkage_wb * psi,
            "inverter.dead_time_s": inverter.dead_time_s * uniform(0.5, 1.5),
            "battery.initial_soc": uniform(0.15, 0.95),
            "sensors.current_noise_a": uniform(0.0, 0.004) * inverter.current_full_scale_a,
        },
    )
    engine, _ = run.prepare(drive, scenario, Path(), {})
    stops.as_one_wheel(engine, drive)
    engine.start()
    engine.choose(SIGNALS)
    parts = []
    with engine:
        for part in range(8):
            torque_nm = uniform(-2.5, 2.5) * motor.rated_torque_nm
            torque_nm = -abs(torque_nm) if part % 3 == 0 else torque_nm
            engine.set("driver.drive_demand_nm", max(torque_nm, 0.0))
            engine.set("driver.brake_demand_nm", max(-torque_nm, 0.0))
            parts.append(engine.run(uniform(0.15, 1.2)))
    return np.concatenate(parts)


def test_a_healthy_sensor_has_no_name_near_half_of_the_observer_s_speed() -> None:
    for number in (*TURNED, *range(30)):
        rows = healthy_ride(number)
        found = {reasons.shown(code) for code in np.unique(rows[:, (FAULT, WARNING)]) if code}
        assert not any(name.startswith("ROTOR") for name in found), (number, found)


def displaced(sensor: str, share: float, part: float, fault: dict[str, float]) -> Rows:
    """Return the rest of a stop, from a part of its time on, with the fault."""
    drive = drive_of("ipm400v", sensor)
    group = Group("ipm400v", sensor, STOP, share * drive.motor.rated_torque_nm)
    at_s = round(BRAKE_S + part * stop_s(group), 3)
    vehicle = _Vehicle(group, [at_s])
    with vehicle.engine as engine:
        engine.restore(vehicle.states[at_s])
        engine.choose(SIGNALS)
        for name, value in fault.items():
            engine.set(name, value)
        return vehicle.engine.run(1.6 * (vehicle.end_s - at_s))


# Sensor, demand in rated torques, when in the stop; 7.4 to 4.7 km/h. Slips in electrical degrees a
# second, jumps in degrees.
@pytest.mark.parametrize(
    ("sensor", "share", "part"),
    [("angle", 0.8, 0.75), ("encoder", 1.6, 0.8), ("angle", 2.5, 0.83), ("encoder", 2.5, 0.8)],
)
def test_a_sensor_that_is_displaced_there_drives_for_milliseconds(
    sensor: str, share: float, part: float
) -> None:
    slips = [{"fault.rotor_slip_deg_per_s": rate} for rate in (-360.0, -90.0, 45.0, 90.0, 360.0)]
    jumps = [{"fault.rotor_jump_deg": deg} for deg in (-165.0, -90.0, 45.0, 75.0, 105.0, 180.0)]
    for fault in (*slips, *jumps):
        rows = displaced(sensor, share, part, fault)
        moving = np.abs(rows[:, SPEED]) > 0.05
        wrong = moving & (rows[:, TORQUE] * np.sign(rows[:, SPEED]) > 2.0)
        # 12 ms of the longest rule, what the observer needs to follow, and a torque that ramps out.
        assert np.count_nonzero(wrong) <= 30, fault
        size = np.abs(rows[:, SPEED])
        assert np.max(size - np.minimum.accumulate(size)) < 0.2 * KMH, fault
