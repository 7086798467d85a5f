# SPDX-License-Identifier: Apache-2.0
"""The judge's own mathematics, against definitions and circuit laws."""

import cmath
import math

import numpy as np
import pytest
from hubsim.swarm import motion
from hubsim.swarm.drives import numbered
from regen_table.schema import Drive

RANDOM = np.random.default_rng(7)
DRIVES = [numbered(k).drive for k in range(4)]


@pytest.mark.parametrize("rows", [1, 2, 3, 7, 64, 500])
def test_windows_are_those_of_their_definition(rows: int) -> None:
    values = RANDOM.normal(size=300)
    for k in (0, 1, rows - 1, 150, 299):
        if k < len(values):
            window = values[max(k - rows + 1, 0) : k + 1]
            assert motion.largest_of(values, rows)[k] == np.max(window)
            assert motion.smallest_of(values, rows)[k] == np.min(window)
            mean = np.mean(window) if k + 1 >= rows else 0.0
            assert motion.means_of(values, rows)[k] == pytest.approx(mean, abs=1e-12)


def test_the_longest_time_and_changes_in_a_window() -> None:
    flags = np.array([0, 1, 1, 0, 1, 1, 1, 0, 1], dtype=bool)
    assert motion.longest(flags) == (3, 4)
    assert motion.longest(~flags[1:3]) == (0, 0)
    values = np.array([0, 1, 0, 1, 1, 1, 1, 0], dtype=float)
    assert motion.changes_in(values, 3).tolist() == [0, 1, 2, 3, 2, 1, 0, 1]


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: drive.name)
@pytest.mark.parametrize("share", [0.02, 0.2, 1.0])
def test_a_short_circuit_obeys_the_voltage_equations(drive: Drive, share: float) -> None:
    motor = drive.motor
    speed = share * motor.max_speed_rpm * math.pi / 30.0
    omega = motor.pole_pairs * speed
    ohm = motor.phase_resistance_ohm + drive.inverter.switch_resistance_ohm
    equations = np.array(
        [[ohm, -omega * motor.q_inductance_h], [omega * motor.d_inductance_h, ohm]]
    )
    d, q = np.linalg.solve(equations, [0.0, -omega * motor.flux_linkage_wb])
    assert motion.short_a(drive, np.array([speed]))[0] == pytest.approx(math.hypot(d, q))
    heat_w = 1.5 * ohm * (d * d + q * q)  # all that the torque gives
    assert motion.short_nm(drive, np.array([speed]))[0] * speed == pytest.approx(heat_w)


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: drive.name)
def test_an_open_bridge_obeys_its_phasors(drive: Drive) -> None:
    motor, inverter = drive.motor, drive.inverter
    speed = motor.max_speed_rpm * math.pi / 30.0
    omega = motor.pole_pairs * speed
    bus_v = 0.6 * math.sqrt(3.0) * omega * motor.flux_linkage_wb
    torque, charge = motion.open_nm(drive, np.array([speed]), np.array([bus_v]))
    phase_v = 2.0 / math.pi * (bus_v + 2.0 * inverter.diode_forward_voltage_v)
    current = charge[0] * bus_v / (1.5 * phase_v)
    ohm = motor.phase_resistance_ohm + inverter.diode_resistance_ohm
    reactance = omega * 0.5 * (motor.d_inductance_h + motor.q_inductance_h)
    emf = phase_v + complex(ohm, reactance) * current
    assert abs(emf) == pytest.approx(omega * motor.flux_linkage_wb)
    power_w = 1.5 * abs(emf) * current * math.cos(cmath.phase(emf))
    assert torque[0] * speed == pytest.approx(power_w)
    high_v = 1.01 * math.sqrt(3.0) * omega * motor.flux_linkage_wb
    assert [x[0] for x in motion.open_nm(drive, np.array([speed]), np.array([high_v]))] == [
        0.0,
        0.0,
    ]
