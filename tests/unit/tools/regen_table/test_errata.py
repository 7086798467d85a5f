# SPDX-License-Identifier: Apache-2.0
"""Every number in the paper's errata, recomputed from the circuit to its last digit.

tools/regen_table/DERIVATIONS.md, Errata of the paper: a list of errors by number, and a table whose
rows begin with such a number and end with what the paper has and what is right.
"""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from regen_table import braking, ideal, models, optimum, points, schema

ROOT = Path(__file__).resolve().parents[4]
ERRATA = (
    (ROOT / "tools" / "regen_table" / "DERIVATIONS.md")
    .read_text(encoding="utf-8")
    .partition("## Errata of the paper\n")[2]
    .partition("\n## ")[0]
)
TABLE_1_FLUX_WB = 0.0204
SPEED_RPM, TORQUE_NM, WARM_C = 424.4, -20.0, 25.0
SPEEDS_RPM = np.array([25.0, 50.0, 100.0, 150.0, 300.0, 424.4])
Numbers = tuple[float, ...]
Rows = list[tuple[Numbers, Numbers]]
"""Of one error: what the paper has and what is right, a pair for each row of the table."""


def omega_of(drive: schema.Drive, rpm: float) -> float:
    return rpm * math.pi / 30.0 * drive.motor.pole_pairs


def electrical(drive: schema.Drive) -> float:
    return omega_of(drive, SPEED_RPM)


def point(drive: schema.Drive) -> points.Record:
    return points.evaluate(drive, SPEED_RPM, TORQUE_NM, WARM_C, points.setting(drive))


def exact_optimum_nm(drive: schema.Drive, rpm: models.ArrayLike, warm_c: float) -> models.Array:
    """Magnitude of T_opt in N m."""
    omega = np.asarray(rpm) * omega_of(drive, 1.0)
    motor, inverter = models.machine(drive, warm_c), models.bridge(drive)
    return np.abs(optimum.closed_form(motor, inverter, omega).torque_optimal_nm)


def flux_linkage(drive: schema.Drive) -> Rows:
    """Rated torque, top speed, and (21) at 100 r/min, p omega psi^2 / (2 R) power-invariant."""
    motor, radius_m = drive.motor, drive.vehicle.wheel_radius_m
    rated_nm = 1.5 * motor.pole_pairs * TABLE_1_FLUX_WB * 30.0 * math.sqrt(2.0)
    top_rad_s = 53.0 / (math.sqrt(3.0) * TABLE_1_FLUX_WB) / motor.pole_pairs
    per_square = motor.pole_pairs * omega_of(drive, 100.0) / (2.0 * motor.phase_resistance_ohm)
    invariant_wb = math.sqrt(1.5) * TABLE_1_FLUX_WB
    return [
        ((motor.rated_torque_nm,), (rated_nm,)),
        ((60.0,), (3.6 * top_rad_s * radius_m,)),
        ((per_square * TABLE_1_FLUX_WB**2,), (per_square * invariant_wb**2,)),
    ]


def battery_bracket(drive: schema.Drive) -> Rows:
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    bracket = 53.0 - math.sqrt(53.0**2 - 4.0 * resistance * 4.0 * point(drive)["dc_power_w"])
    return [((bracket / (4.0 * resistance),), (bracket**2 / (4.0 * resistance),))]


def torque_current(drive: schema.Drive) -> float:
    """i_qt in A, peak: with i_d = 0 and L_d = L_q, T = 1.5 p psi i_qt."""
    return TORQUE_NM / (1.5 * drive.motor.pole_pairs * TABLE_1_FLUX_WB)


def iron_loss(drive: schema.Drive) -> Rows:
    """In power-invariant quantities, as the paper has them."""
    omega, inductance = electrical(drive), drive.motor.q_inductance_h
    iron = drive.motor.iron_loss_resistance_ohm
    assert iron is not None
    resistance = iron[0] + iron[1] * omega
    i_qt, flux = math.sqrt(1.5) * torque_current(drive), math.sqrt(1.5) * TABLE_1_FLUX_WB
    printed, right = (
        omega**2
        / resistance
        * ((inductance * i_qt) ** 2 + (factor * inductance**2 / resistance * i_qt + flux) ** 2)
        for factor in (omega**2, omega)
    )
    return [((printed,), (right,))]


def inverter_loss(drive: schema.Drive) -> Rows:
    """With the signed current of (15); then T_opt at 25 r/min and the power that returns there."""
    motor, inverter = models.machine(drive, WARM_C), models.bridge(drive)
    at = abs(point(drive)["current_q_a"])
    signed = inverter.square_w_per_a2 * at**2 - inverter.linear_w_per_a * at
    omega = omega_of(drive, 25.0)
    a, b, c = optimum.quadratic(motor, inverter, omega)
    currents = [-(b + sign * c) / (2.0 * a) for sign in (1.0, -1.0)]
    torques = [float(optimum.torque_at_zero_d_current(motor, omega, i)) for i in currents]
    returned = [
        -float(models.evaluate(motor, inverter, omega, 0.0, i).dc_power_w) for i in currents
    ]
    return [
        ((signed,), (float(inverter.loss_w(at)),)),
        ((torques[0],), (torques[1],)),
        ((returned[0],), (returned[1],)),
    ]


def third_line_of_20(drive: schema.Drive) -> Rows:
    omega, power = omega_of(drive, 600.0), drive.motor.max_power_w
    pole_pairs = drive.motor.pole_pairs
    return [((power / (omega * pole_pairs),), (pole_pairs * power / omega,))]


def optimum_of_21(drive: schema.Drive) -> Rows:
    motor, speed = models.machine(drive, WARM_C), SPEEDS_RPM * math.pi / 30.0
    printed = np.asarray(braking.paper_optimum_nm(motor, speed))
    return [(tuple(printed), tuple(exact_optimum_nm(drive, SPEEDS_RPM, WARM_C)))]


def torque_to_current(drive: schema.Drive) -> Rows:
    """Current of a torque, and the torque of the current without the iron loss's part."""
    plain = torque_current(drive)
    made = optimum.torque_at_zero_d_current(models.machine(drive, WARM_C), electrical(drive), plain)
    return [((plain,), (point(drive)["current_q_a"],)), ((TORQUE_NM,), (float(made),))]


def region_one(drive: schema.Drive) -> Rows:
    """Stored share of the kinetic energy with and without motor torque beyond T_zero, in %."""
    motor, inverter = models.machine(drive, WARM_C), models.bridge(drive)
    vehicle, battery = drive.vehicle, drive.battery
    top = 40.0 / 3.6 / vehicle.wheel_radius_m
    speed = (np.arange(4000, dtype=np.float64) + 0.5) * top / 4000
    zero = np.abs(optimum.closed_form(motor, inverter, speed * motor.pole_pairs).torque_zero_nm)
    resistance = battery.series_resistance_ohm + battery.polarisation_resistance_ohm
    kinetic_j = 0.5 * vehicle.mass_kg * (40.0 / 3.6) ** 2
    shares: tuple[list[float], list[float]] = ([], [])
    for demand in (40.0, 60.0, 120.0):
        best = np.minimum(demand, braking.capability_nm(drive, motor, inverter, speed))
        step_s = vehicle.mass_kg * vehicle.wheel_radius_m**2 * top / 4000 / (4.0 * demand)
        for share, electric in zip(shares, (np.where(demand > zero, 0.0, best), best), strict=True):
            power = 4.0 * braking.state_of_torque(motor, inverter, speed, -electric).dc_power_w
            chemical = models.battery_steady(53.0, resistance, power).chemical_power_w
            share.append(-100.0 * float(np.sum(chemical)) * step_s / kinetic_j)
    return [(tuple(shares[0]), tuple(shares[1]))]


def hot_winding(drive: schema.Drive) -> Rows:
    """Least and most of what 120 degC take off T_opt, in %, from 25 r/min up to the top speed."""
    speeds = np.linspace(25.0, drive.motor.max_speed_rpm, 500)
    share = 100.0 * (
        1.0 - exact_optimum_nm(drive, speeds, 120.0) / exact_optimum_nm(drive, speeds, WARM_C)
    )
    return [((0.0,), (float(np.min(share)), float(np.max(share))))]


def settled_branch(drive: schema.Drive) -> Rows:
    """Stored share of the kinetic energy with R_s + R_t, and with the RC branch at rest before."""
    settled, dynamic = (
        100.0
        * ideal.stop(
            drive, "series_optimal", 40.0, 40.0, WARM_C, battery=battery
        ).stored_share_of_kinetic
        for battery in ("settled", "dynamic")
    )
    return [((settled,), (dynamic,))]


STATED: dict[int, Callable[[schema.Drive], Rows]] = {
    1: flux_linkage,
    2: battery_bracket,
    3: iron_loss,
    4: inverter_loss,
    5: third_line_of_20,
    6: optimum_of_21,
    8: torque_to_current,
    9: region_one,
    10: hot_winding,
    11: settled_branch,
}
WITHOUT_CONSEQUENCE = {7}
"""The factor that is kept, because k_on and k_off belong to it."""


def numbers(cell: str) -> list[str]:
    return re.findall(r"-?\d+(?:\.\d+)?", cell)


def rows(error: int) -> list[tuple[list[str], list[str]]]:
    """What the table has for an error: the numbers of its last two columns, row by row."""
    found = re.findall(rf"^\| {error} \|.*\|([^|]+)\|([^|]+)\|$", ERRATA, re.MULTILINE)
    return [(numbers(paper), numbers(right)) for paper, right in found]


def agrees(printed: str, value: float) -> bool:
    """Whether a number is the printed one, rounded to its last digit."""
    decimals = len(printed.partition(".")[2])
    return abs(float(printed) - value) <= 0.5001 * 10.0**-decimals


@pytest.mark.parametrize("error", STATED)
def test_numbers_of_an_erratum_agree_with_the_circuit(paper: schema.Drive, error: int) -> None:
    stated, computed = rows(error), STATED[error](paper)
    assert len(stated) == len(computed)
    for printed_row, value_row in zip(stated, computed, strict=True):
        for printed, values in zip(printed_row, value_row, strict=True):
            assert len(printed) == len(values), (printed, values)
            pairs = list(zip(printed, values, strict=True))
            assert all(agrees(*pair) for pair in pairs), pairs


def test_every_erratum_has_numbers() -> None:
    listed = {int(number) for number in re.findall(r"^(\d+)\. ", ERRATA, re.MULTILINE)}
    in_table = {int(number) for number in re.findall(r"^\| (\d+) \|", ERRATA, re.MULTILINE)}
    assert listed == set(range(1, 1 + len(listed)))
    assert in_table == set(STATED) == listed - WITHOUT_CONSEQUENCE
