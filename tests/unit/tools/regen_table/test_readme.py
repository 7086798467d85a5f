# SPDX-License-Identifier: Apache-2.0
"""Every number in README.md about an error of the paper, recomputed from the circuit to its last
digit.
"""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from regen_table import braking, ideal, models, optimum, points, schema

ROOT = Path(__file__).resolve().parents[4]
README = " ".join(
    (ROOT / "tools" / "regen_table" / "README.md").read_text(encoding="utf-8").split()
)
TABLE_1_FLUX_WB = 0.0204
SPEED_RPM, TORQUE_NM, WARM_C = 424.4, -20.0, 25.0
Numbers = Callable[[schema.Drive], tuple[float, ...]]


def agrees(printed: str, value: float) -> bool:
    """Whether a number is the printed one, rounded to its last digit."""
    decimals = len(printed.partition(".")[2])
    return abs(float(printed) - value) <= 0.5001 * 10.0**-decimals


def omega_of(drive: schema.Drive, rpm: float) -> float:
    return rpm * math.pi / 30.0 * drive.motor.pole_pairs


def electrical(drive: schema.Drive) -> float:
    return omega_of(drive, SPEED_RPM)


def point(drive: schema.Drive) -> points.Record:
    return points.evaluate(drive, SPEED_RPM, TORQUE_NM, WARM_C, points.setting(drive))


def right_losses(drive: schema.Drive) -> tuple[float, ...]:
    at = point(drive)
    return at["loss_copper_w"], at["loss_iron_w"], at["loss_inverter_w"], at["loss_battery_w"]


def evidence_of_peak_flux(drive: schema.Drive) -> tuple[float, ...]:
    peak = 30.0 * math.sqrt(2.0)
    top = (
        53.0
        / (math.sqrt(3.0) * TABLE_1_FLUX_WB)
        / drive.motor.pole_pairs
        * drive.vehicle.wheel_radius_m
        * 3.6
    )
    return peak, 1.5 * drive.motor.pole_pairs * TABLE_1_FLUX_WB * peak, top


def flux_in_equation_21(drive: schema.Drive) -> tuple[float, ...]:
    """(21) in power-invariant quantities: p omega psi^2 / (2 R)."""
    per_square = (
        drive.motor.pole_pairs * omega_of(drive, 100.0) / (2.0 * drive.motor.phase_resistance_ohm)
    )
    invariant = math.sqrt(1.5) * TABLE_1_FLUX_WB
    return invariant, per_square * TABLE_1_FLUX_WB**2, per_square * invariant**2


def battery_bracket(drive: schema.Drive) -> tuple[float, ...]:
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    bracket = 53.0 - math.sqrt(53.0**2 - 4.0 * resistance * 4.0 * point(drive)["dc_power_w"])
    return bracket / (4.0 * resistance), bracket**2 / (4.0 * resistance)


def torque_current(drive: schema.Drive) -> float:
    """i_qt in A, peak: with i_d = 0 and L_d = L_q, T = 1.5 p psi i_qt."""
    return TORQUE_NM / (1.5 * drive.motor.pole_pairs * TABLE_1_FLUX_WB)


def printed_iron_loss(drive: schema.Drive) -> tuple[float, ...]:
    omega, inductance = electrical(drive), drive.motor.q_inductance_h
    iron = drive.motor.iron_loss_resistance_ohm
    assert iron is not None
    resistance, i_qt, flux = (
        iron[0] + iron[1] * omega,
        math.sqrt(1.5) * torque_current(drive),
        math.sqrt(1.5) * TABLE_1_FLUX_WB,
    )
    losses = [
        omega**2
        / resistance
        * ((inductance * i_qt) ** 2 + (factor * inductance**2 / resistance * i_qt + flux) ** 2)
        for factor in (omega**2, omega)
    ]
    return losses[0], losses[1]


def signed_inverter_loss(drive: schema.Drive) -> tuple[float, ...]:
    motor, inverter, at = (
        models.machine(drive, WARM_C),
        models.bridge(drive),
        abs(point(drive)["current_q_a"]),
    )
    signed = inverter.square_w_per_a2 * at**2 - inverter.linear_w_per_a * at
    omega = omega_of(drive, 25.0)
    a, b, c = optimum.quadratic(motor, inverter, omega)
    wrong, right = (-(b + sign * c) / (2.0 * a) for sign in (1.0, -1.0))
    power = [
        float(models.evaluate(motor, inverter, omega, 0.0, i).dc_power_w) for i in (wrong, right)
    ]
    torques = [float(optimum.torque_at_zero_d_current(motor, omega, i)) for i in (wrong, right)]
    return (
        signed,
        float(inverter.loss_w(at)),
        torques[0],
        100.0 * (1.0 - power[0] / power[1]),
        torques[1],
    )


def third_line_of_20(drive: schema.Drive) -> tuple[float, ...]:
    omega, power = omega_of(drive, 600.0), drive.motor.max_power_w
    return power / (omega * drive.motor.pole_pairs), drive.motor.pole_pairs * power / omega


def smaller_than_21(drive: schema.Drive) -> tuple[float, ...]:
    motor, inverter = models.machine(drive, WARM_C), models.bridge(drive)
    speed = np.array([25.0, 50.0, 100.0, 150.0, 300.0, 424.4]) * math.pi / 30.0
    exact = np.abs(optimum.closed_form(motor, inverter, speed * motor.pole_pairs).torque_optimal_nm)
    return tuple(100.0 * (1.0 - exact / braking.paper_optimum_nm(motor, speed)))


def torque_to_current(drive: schema.Drive) -> tuple[float, ...]:
    plain = torque_current(drive)
    brakes_with = -float(
        optimum.torque_at_zero_d_current(models.machine(drive, WARM_C), electrical(drive), plain)
    )
    return point(drive)["current_q_a"], plain, brakes_with


def region_one(drive: schema.Drive) -> tuple[float, ...]:
    """Share of a stop's energy lost with zero motor torque beyond T_zero, over demands.

    The stop is 40 km/h, steps as there.
    """
    motor, inverter = models.machine(drive, WARM_C), models.bridge(drive)
    speed = (np.arange(4000, dtype=np.float64) + 0.5) * (
        40.0 / 3.6 / 4000 / drive.vehicle.wheel_radius_m
    )
    zero = np.abs(optimum.closed_form(motor, inverter, speed * motor.pole_pairs).torque_zero_nm)
    lost = []
    for demand in (40.0, 60.0, 120.0):
        best = np.minimum(demand, braking.capability_nm(drive, motor, inverter, speed))
        resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
        stored = []
        for electric in (best, np.where(demand > zero, 0.0, best)):
            power = 4.0 * braking.state_of_torque(motor, inverter, speed, -electric).dc_power_w
            stored.append(
                -float(np.sum(models.battery_steady(53.0, resistance, power).chemical_power_w))
            )
        lost.append(100.0 * (stored[0] - stored[1]) / stored[0])
    return tuple(lost)


def hot_winding(drive: schema.Drive) -> tuple[float, ...]:
    """Least and most, from 25 r/min up to the top speed."""
    omega = omega_of(drive, 1.0) * np.linspace(25.0, drive.motor.max_speed_rpm, 500)
    cold, hot = (
        optimum.closed_form(models.machine(drive, t), models.bridge(drive), omega).torque_optimal_nm
        for t in (25.0, 120.0)
    )
    share = 100.0 * (1.0 - hot / cold)
    return float(np.min(share)), float(np.max(share))


def unsettled_battery(drive: schema.Drive) -> tuple[float, ...]:
    settled, dynamic = (
        ideal.stop(drive, "series_optimal", 40.0, 40.0, WARM_C, battery=b)
        for b in ("settled", "dynamic")
    )
    return (100.0 * (dynamic.stored_share_of_kinetic - settled.stored_share_of_kinetic),)


N = r"(-?\d+(?:\.\d+)?)"
STATED: list[tuple[str, Numbers]] = [
    (rf"copper {N}, iron {N}, inverter {N} W a motor, battery {N} W for four", right_losses),
    (
        rf"1\.5 \* 23 \* 0\.0204 \* {N} = {N} N m \(30 are rated\) and 53 V reach {N} km/h",
        evidence_of_peak_flux,
    ),
    (
        (
            rf"sqrt\(3/2\) \* 0\.0204 = {N} Wb\. With 0\.0204 in \(21\), T_opt at 100 r/min is {N}"
            rf" instead of {N} N m"
        ),
        flux_in_equation_21,
    ),
    (rf'it gives {N} "W", a gain, where {N} W are lost', battery_bracket),
    (rf"It gives {N} W instead of {N} W\.", printed_iron_loss),
    (
        rf"in the inverter, {N} W instead of \+{N} W, and the optimum would move to {N} N m at 25"
        r" r/min, "
        rf"where {N} % less power comes back than at the right {N} N m",
        signed_inverter_loss,
    ),
    (rf"gives {N} N m at 600 r/min instead of {N} N m", third_line_of_20),
    (
        rf"smaller by {N}, {N}, {N}, {N}, {N}, {N} % at 25, 50, 100, 150, 300, 424 r/min",
        smaller_than_21,
    ),
    (
        (
            rf"-20 N m take {N} A, not the {N} A of T/\(1\.5 p psi\): a controller without that"
            rf" term brakes with {N} N m"
        ),
        torque_to_current,
    ),
    (rf"a stop from 40 km/h stores {N}, {N} and {N} % less at 40, 60 and 120 N m", region_one),
    (rf"A winding at 120 degC takes {N} to {N} % off T_opt", hot_winding),
    (rf"\({N} % of the kinetic energy at 40 N m for the paper's vehicle\)", unsettled_battery),
]


@pytest.mark.parametrize(
    ("pattern", "numbers"), STATED, ids=[numbers.__name__ for _, numbers in STATED]
)
def test_figures_of_the_readme_agree_with_the_circuit(
    paper: schema.Drive, pattern: str, numbers: Numbers
) -> None:
    found = re.search(pattern, README)
    assert found, pattern
    computed = numbers(paper)
    assert len(found.groups()) == len(computed)
    for printed, value in zip(found.groups(), computed, strict=True):
        assert agrees(printed, value), (printed, value)


def test_every_erratum_has_a_number() -> None:
    errata = README.partition("## Errata of the paper")[2].partition("## Figures")[0]
    entries = re.split(r" \d\. (?=\*\*)", errata)[1:]
    assert entries
    without = [
        entry for entry in entries if not any(re.search(pattern, entry) for pattern, _ in STATED)
    ]
    # The factor that is retained makes no difference.
    assert len(without) == 1
    assert without[0].startswith("**(13)** counts three switching events")
