# SPDX-License-Identifier: Apache-2.0
"""A battery leaves where its bus rises most: the capacitors keep the devices' rating.

Directed vehicles in closed loop, each with its drive's own capacitor and with what tolerance and
age may leave of it (regen_table.bus_capacitor.LEFT_SHARE).
"""

import numpy as np
import pytest
from hubsim.engine import Rows
from hubsim.sweep import cases, drives
from regen_table import bus_capacitor, models
from regen_table.schema import Drive
from studies.coast import runs as coast

COUNT = 20  # one vehicle for each of the instants
SEED = 11
FAST = (1.05, 1.1)  # of the largest speed
NEARLY_EMPTY_V = (40.0, 43.0)  # lu2013, 40 V empty
SMALL_F = 1e-3
UNKNOWN_STATE = 0.5


def with_capacitor(drive: Drive, farad: float) -> Drive:
    inverter = drive.inverter.model_copy(update={"bus_capacitance_f": farad})
    return drive.model_copy(update={"inverter": inverter})


def case_of(
    name: str, share: Rows, number: int, demand: str, speeds: tuple[float, float]
) -> coast.Case:
    """Speed, charge and slope at these shares of their ranges; the battery's own range is wide."""
    drive = drives.drive_named(name)
    low, high = NEARLY_EMPTY_V
    soc, volts = UNKNOWN_STATE, low + (high - low) * float(share[1])
    if not isinstance(drive.battery.open_circuit_voltage_v, float | int):
        soc = float(share[1])
        volts = models.open_circuit_voltage_v(drive, soc)
    top_kmh = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
    speed = speeds[0] + (speeds[1] - speeds[0]) * float(share[0])
    instant = number % coast.INSTANTS
    cut_s = coast.FIRST_CUT_S + (coast.LAST_CUT_S - coast.FIRST_CUT_S) * instant / (
        coast.INSTANTS - 1
    )
    slope = coast.SLOPE_PERCENT[0] * float(share[2])
    return coast.Case(name, speed * top_kmh, slope, soc, volts, demand, round(cut_s, 4))


def highest_v(drive: Drive, case: coast.Case) -> float:
    return float(np.max(coast.simulated(drive, case)[:, coast.BUS]))


def downhill(name: str, speeds: tuple[float, float], demands: tuple[str, ...]) -> list[coast.Case]:
    def one(drive: str, number: int, share: Rows) -> coast.Case:
        return case_of(drive, share, number, demands[number % len(demands)], speeds)

    return cases.hypercube((name,), COUNT, SEED, 3, one)


def test_paper_s_vehicle_above_its_speed_on_an_almost_empty_pack_keeps_75_v() -> None:
    """No current within 75 A holds the voltage, the diodes conduct when the contactor opens.

    1 mF a wheel does not take what windings and EMF give; 2.46 mF do, and four fifths of them.
    """
    drive = drives.drive_named("lu2013")
    vehicles = downhill("lu2013", FAST, (coast.COAST, coast.DRIVE))
    small = [highest_v(with_capacitor(drive, SMALL_F), case) for case in vehicles]
    assert max(small) > 75.0
    own_f = drive.inverter.bus_capacitance_f
    for farad in (own_f, bus_capacitor.LEFT_SHARE * own_f):
        found = [highest_v(with_capacitor(drive, farad), case) for case in vehicles]
        assert max(found) < 75.0, farad
        # The derivation bounds it, without a drive's size of margin.
        bound = bus_capacitor.worst_bus_v(drive, farad)
        assert max(found) < bound < 1.15 * max(found)


@pytest.mark.parametrize("name", drives.DRIVES)
def test_full_regeneration_ends_below_the_rating_with_four_fifths_of_the_capacitor(
    name: str,
) -> None:
    drive = drives.drive_named(name)
    left = with_capacitor(drive, bus_capacitor.LEFT_SHARE * drive.inverter.bus_capacitance_f)
    found = [highest_v(left, case) for case in downhill(name, (0.3, 1.1), (coast.BRAKE,))]
    rating = drive.inverter.device_voltage_v
    assert rating is not None
    bound = bus_capacitor.worst_bus_v(drive, left.inverter.bus_capacitance_f)
    assert max(found) < bound < rating
