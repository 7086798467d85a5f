# SPDX-License-Identifier: Apache-2.0
"""``solve`` against brute force over fine current grids, with the circuit written down a second
time.

The reference below is in POWER-INVARIANT quantities, solves the iron-loss branch as a linear system
instead of by a formula, and finds every optimum by scanning: only the circuit laws are shared with
the package.
"""

import functools
import math
import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
from regen_table import points, schema

Array = npt.NDArray[np.float64]
K = math.sqrt(1.5)  # power-invariant quantity over peak quantity
TOLERANCE = 1e-3
PARTS = 4 if "HUBFOC_FOR_LONG" in os.environ else 2  # of four, of the random drives


@dataclass(frozen=True)
class Circuit:
    """A drive at one speed and temperature, power-invariant."""

    drive: schema.Drive
    omega: float
    temperature: float

    def conductance(self) -> float:
        if self.drive.motor.iron_loss_resistance_ohm is None:
            return 0.0
        a0, a1 = self.drive.motor.iron_loss_resistance_ohm
        return 1.0 / (a0 + a1 * abs(self.omega))

    def flux(self) -> float:
        return K * self.drive.motor.flux_linkage_wb

    def terminal(self, i_dt: Array | float, i_qt: Array | float) -> tuple[Array, Array]:
        """Add the iron currents to torque currents."""
        motor, w = self.drive.motor, self.omega
        v_d, v_q = -w * motor.q_inductance_h * i_qt, w * (motor.d_inductance_h * i_dt + self.flux())
        return np.asarray(i_dt + v_d * self.conductance()), np.asarray(
            i_qt + v_q * self.conductance()
        )

    def powers(self, i_d: Array | float, i_q: Array | float) -> dict[str, Array]:
        motor, inverter = self.drive.motor, self.drive.inverter
        resistance = motor.phase_resistance_ohm * (
            1.0
            + motor.resistance_temperature_coefficient_per_k
            * (self.temperature - motor.reference_temperature_c)
        )
        psi, l_d, l_q, w = self.flux(), motor.d_inductance_h, motor.q_inductance_h, self.omega
        conductance = self.conductance()
        # i = i_t + v / R_i with v = w (-L_q i_qt, L_d i_dt + psi): two equations for i_t
        system = np.array([[1.0, -w * l_q * conductance], [w * l_d * conductance, 1.0]])
        inverse = np.linalg.inv(system)
        right_q = i_q - w * psi * conductance
        i_dt, i_qt = (
            inverse[0, 0] * i_d + inverse[0, 1] * right_q,
            inverse[1, 0] * i_d + inverse[1, 1] * right_q,
        )
        v_d, v_q = -w * l_q * i_qt, w * (l_d * i_dt + psi)
        u_d, u_q = resistance * i_d + v_d, resistance * i_q + v_q
        square = np.asarray(i_d**2 + i_q**2)
        peak = math.sqrt(2.0 / 3.0) * np.sqrt(square)
        dead = 2.0 * inverter.dead_time_s * inverter.pwm_frequency_hz
        bridge = (
            1.5 * peak**2 * inverter.switch_resistance_ohm * (1.0 - dead)
            + (
                6.0 / math.pi * inverter.diode_forward_voltage_v * peak
                + 1.5 * peak**2 * inverter.diode_resistance_ohm
            )
            * dead
            + 3.0
            * (inverter.turn_on_loss_j_per_a + inverter.turn_off_loss_j_per_a)
            * peak
            * inverter.pwm_frequency_hz
            / math.pi
        )
        return {
            "i_d": np.asarray(i_d),
            "i_q": np.asarray(i_q),
            "torque": np.asarray(motor.pole_pairs * (psi * i_qt + (l_d - l_q) * i_dt * i_qt)),
            "dc": u_d * i_d + u_q * i_q + bridge,
            "copper": resistance * square,
            "iron": conductance * (v_d**2 + v_q**2),
            "inverter": bridge,
            "current": np.sqrt(square) / K,
            "voltage": np.hypot(u_d, u_q) / K,
        }


def zoom_1d(cost: Callable[[Array], Array], low: float, high: float) -> float:
    """Return the argument of the smallest cost, by grids of 401 points that narrow around the best
    one.
    """
    for _ in range(5):
        x = np.linspace(low, high, 401)
        best = int(np.argmin(cost(x)))
        low, high = float(x[max(best - 2, 0)]), float(x[min(best + 2, 400)])
    return 0.5 * (low + high)


def zoom_2d(cost: Callable[[Array, Array], Array], half: float) -> tuple[float, float]:
    """Return (i_d, i_q) of the smallest cost in a square: for every i_d of a narrowing grid, a
    narrowing grid of i_q.

    A square grid fails at an oblique limit: its best point is the one closest to the limit instead
    of the optimum.
    """
    left, right, i_d, i_q = -half, half, 0.0, 0.0
    for outer in range(6):
        columns = np.linspace(left, right, 21 if outer else 121)
        low, high = np.full_like(columns, -half), np.full_like(columns, half)
        for inner in range(9):
            rows = np.linspace(low, high, 11 if inner else 81)
            values = cost(np.broadcast_to(columns, rows.shape), rows)
            best = np.argmin(values, axis=0)
            step = rows[1] - rows[0]
            middle = np.take_along_axis(rows, best[np.newaxis], axis=0)[0]
            low, high = np.maximum(middle - step, -half), np.minimum(middle + step, half)
        winner = int(np.argmin(np.min(values, axis=0)))
        i_d, i_q = float(columns[winner]), float(middle[winner])
        left, right = (
            float(columns[max(winner - 1, 0)]),
            float(columns[min(winner + 1, columns.size - 1)]),
        )
    return i_d, i_q


def close(found: float, expected: float, scale: float) -> bool:
    """Within 0.1 %, or within rounding relative to the drive's rating for very small expected
    values.
    """
    return abs(found - expected) <= TOLERANCE * abs(expected) + 1e-7 * scale


def circuit_of(drive: schema.Drive, rng: np.random.Generator) -> tuple[Circuit, float, float]:
    """Return a drive's circuit at a random speed (r/min) and winding temperature (degC), and these
    two.
    """
    speed, temperature = (
        float(drive.motor.max_speed_rpm * rng.uniform(0.03, 1.0)),
        float(rng.uniform(-20.0, 150.0)),
    )
    return (
        Circuit(drive, speed * math.pi / 30.0 * drive.motor.pole_pairs, temperature),
        speed,
        temperature,
    )


def battery(drive: schema.Drive, power: float) -> tuple[float, float]:
    """Chemical power and loss of the pack, by iterating u_b = u_oc - R i_b."""
    voltage = open_circuit(drive)
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    current = 0.0
    for _ in range(200):
        current = power / (voltage - resistance * current)
    return voltage * current, resistance * current**2


def open_circuit(drive: schema.Drive) -> float:
    voltage = drive.battery.open_circuit_voltage_v
    assert isinstance(voltage, float)
    return voltage


def check_point(
    drive: schema.Drive, record: points.Record, found: dict[str, Array], suffix: str
) -> None:
    scale = drive.motor.max_power_w
    chemical, loss = battery(drive, drive.vehicle.driven_wheels * float(found["dc"]))
    expected = {
        "dc_power_w": float(found["dc"]),
        "loss_copper_w": float(found["copper"]),
        "loss_iron_w": float(found["iron"]),
        "loss_inverter_w": float(found["inverter"]),
        "battery_power_w": chemical,
        "loss_battery_w": loss,
    }
    for key, value in expected.items():
        assert close(record[key + suffix], value, scale), (
            drive.name,
            key + suffix,
            record[key + suffix],
            value,
        )
    # As a vector: at the largest torque of the current limit i_d is close to zero and without
    # influence.
    current = math.hypot(found["i_d"], found["i_q"]) / K
    off = math.hypot(
        record["current_d_a" + suffix] - found["i_d"] / K,
        record["current_q_a" + suffix] - found["i_q"] / K,
    )
    assert off <= TOLERANCE * current + 1e-7 * drive.motor.max_phase_current_a, (
        drive.name,
        "current" + suffix,
    )


def check_zero_d_current(drive: schema.Drive, rng: np.random.Generator) -> bool:
    """Compare one drive at one random condition; returns whether it can regenerate there."""
    circuit, speed, temperature = circuit_of(drive, rng)
    record = points.solve(drive, speed, temperature, points.setting(drive))
    widest = (
        4.0 * K * circuit.omega * drive.motor.flux_linkage_wb / drive.motor.phase_resistance_ohm
    )
    torques, currents = drive.motor.max_torque_nm, drive.motor.max_phase_current_a

    def power(i_q: Array) -> Array:
        return circuit.powers(0.0, i_q)["dc"]

    best = zoom_1d(power, -widest, 0.0)
    possible = bool(circuit.powers(0.0, best)["dc"] < 0.0)
    best = best if possible else 0.0
    boundary = (
        zoom_1d(lambda i: np.abs(power(i)) + 1e30 * (i > best), -widest, 1.01 * best)
        if possible
        else 0.0
    )
    optimal = float(circuit.powers(0.0, best)["torque"])
    assert record["regeneration_possible"] == possible
    assert record["current_d_a"] == 0.0
    assert close(record["current_q_a"], best / K, currents)
    assert close(record["torque_optimal_nm"], optimal, torques)
    assert close(record["torque_zero_nm"], float(circuit.powers(0.0, boundary)["torque"]), torques)
    assert close(record["torque_idle_nm"], float(circuit.powers(0.0, 0.0)["torque"]), torques)
    check_point(drive, record, circuit.powers(0.0, best), "")
    limit = min(
        drive.motor.max_torque_nm, drive.motor.max_power_w / (speed * math.pi / 30.0), abs(optimal)
    )
    assert close(record["torque_optimal_limited_nm"], -limit, torques)
    clamped = zoom_1d(
        lambda i: np.abs(circuit.powers(0.0, i)["torque"] + limit),
        2.0 * best if possible else -0.01 * widest,
        0.01 * widest,
    )
    check_point(drive, record, circuit.powers(0.0, clamped), "_limited")
    return possible


def test_every_result_of_solve_agrees_with_a_scan_over_the_current(
    random_drives: list[schema.Drive],
) -> None:
    rng = np.random.default_rng(1)
    possible = [check_zero_d_current(drive, rng) for drive in random_drives]
    assert (
        sum(possible) > 180
    )  # the drives are plausible: almost all can regenerate at almost any speed


def check_joint(drive: schema.Drive, rng: np.random.Generator) -> None:
    circuit, speed, temperature = circuit_of(drive, rng)
    record = points.solve(drive, speed, temperature, points.setting(drive, free_d_current=True))
    most, voltage = drive.motor.max_phase_current_a, open_circuit(drive) / math.sqrt(3.0)
    limit = min(drive.motor.max_torque_nm, drive.motor.max_power_w / (speed * math.pi / 30.0))
    # The optimum is flat in torque: a scan places the power better than the torque, whose error is
    # relative to the whole torque.
    torques = 20.0 * drive.motor.max_torque_nm

    def cost(i_d: Array, i_q: Array, what: str, strongest: float) -> Array:
        found = circuit.powers(i_d, i_q)
        outside = [
            found["current"] / most - 1.0,
            found["voltage"] / voltage - 1.0,
            -found["torque"] / strongest - 1.0,
        ]
        outside += [found["torque"] / drive.motor.max_torque_nm]  # no driving
        if what == "torque":
            outside += [found["dc"] / drive.motor.max_power_w]  # nothing taken from the battery
        worst = np.max(np.maximum(np.stack(outside), 0.0), axis=0)
        return np.where(worst > 1e-9, 1e30 * (1.0 + worst), found[what])

    for suffix, strongest in (("", 1e9), ("_limited", limit)):
        bounded = functools.partial(cost, what="dc", strongest=strongest)
        best = circuit.powers(*zoom_2d(bounded, K * most))
        found = record["dc_power_w" + suffix]
        # A scan can only be worse than the optimum: never better than the solution, and within 0.1
        # % of it.
        assert found <= float(best["dc"]) + 1e-6 * drive.motor.max_power_w, (drive.name, suffix)
        check_point(drive, record, best, suffix)
        assert close(
            record["torque_optimal_limited_nm" if suffix else "torque_optimal_nm"],
            float(best["torque"]),
            torques,
        ), drive.name
        if not suffix:
            assert record["regeneration_possible"] == (float(best["dc"]) < 0.0)
    assert close(record["torque_idle_nm"], float(circuit.powers(0.0, 0.0)["torque"]), torques)
    edge = circuit.powers(*zoom_2d(lambda a, b: cost(a, b, "torque", 1e9), K * most))
    assert close(record["torque_zero_nm"], float(edge["torque"]), torques), drive.name


@pytest.mark.parametrize("part", range(PARTS))
def test_the_joint_optimum_agrees_with_a_scan_over_both_currents(
    random_drives: list[schema.Drive], part: int
) -> None:
    rng = np.random.default_rng(2 + part)
    for drive in random_drives[part::4]:
        check_joint(drive, rng)


def check_torque(drive: schema.Drive, rng: np.random.Generator) -> bool:
    """Compare the least power of a random torque, driving or braking.

    Returns whether any current inside the limits makes it.
    """
    circuit, speed, temperature = circuit_of(drive, rng)
    strongest = min(drive.motor.max_torque_nm, drive.motor.max_power_w / (speed * math.pi / 30.0))
    torque = float(rng.uniform(-1.0, 1.0)) * strongest
    record = points.evaluate(
        drive, speed, torque, temperature, points.setting(drive, free_d_current=True)
    )
    most, voltage = drive.motor.max_phase_current_a, open_circuit(drive) / math.sqrt(3.0)
    flux, saliency = circuit.flux(), drive.motor.d_inductance_h - drive.motor.q_inductance_h

    def powers(i_dt: Array | float) -> dict[str, Array]:
        i_qt = torque / (drive.motor.pole_pairs * (flux + saliency * i_dt))
        return circuit.powers(*circuit.terminal(i_dt, i_qt))

    def cost(i_dt: Array) -> Array:
        found = powers(i_dt)
        outside = np.maximum(
            np.maximum(found["current"] / most, found["voltage"] / voltage) - 1.0, 0.0
        )
        return np.where(outside > 1e-9, 1e30 * (1.0 + outside), found["dc"])

    highest = 3.0 * K * most if saliency >= 0.0 else min(3.0 * K * most, -0.99 * flux / saliency)
    best = zoom_1d(cost, -3.0 * K * most, highest)
    inside = bool(cost(np.array([best]))[0] < 1e30)
    assert inside == (not {"phase_current", "phase_voltage"} & set(record["limits_exceeded"])), (
        drive.name
    )
    if inside:
        assert record["dc_power_w"] <= float(powers(best)["dc"]) + 1e-6 * drive.motor.max_power_w, (
            drive.name
        )
        check_point(drive, record, powers(best), "")
    return inside


def test_the_least_power_of_a_torque_agrees_with_a_scan_driving_and_braking(
    random_drives: list[schema.Drive],
) -> None:
    rng = np.random.default_rng(9)
    inside = [check_torque(drive, rng) for drive in random_drives for _ in range(2)]
    assert sum(inside) > 300
