# SPDX-License-Identifier: Apache-2.0
"""Optimum and limits with flux maps: constants by the older search, others by brute force.

Brute force is a circuit written down a second time in complex numbers, on SciPy's interpolation of
the same map, with i_q by bisection and i_d on dense grids.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from regen_table import flux_optimum, joint
from regen_table.flux_map import FluxMap, checked
from regen_table.flux_optimum import FluxMotor
from regen_table.models import Bridge, Machine
from scipy.interpolate import RegularGridInterpolator

Array = npt.NDArray[np.float64]
SEED = 34
DRAWN = 14
INVERTER = Bridge(0.9, 0.012)


def machine(flux_wb: float, d_h: float, q_h: float, pairs: int, iron_ohm: float) -> Machine:
    return Machine(pairs, 25.0, 0.03, d_h, q_h, flux_wb, iron_ohm, 0.003)


def constant_map(motor: Machine, current_a: float) -> FluxMap:
    axis_d = np.linspace(-2.5, 2.0, 19) * current_a
    axis_q = np.linspace(-2.0, 2.0, 25) * current_a
    i_d, i_q = np.meshgrid(axis_d, axis_q, indexing="ij")
    psi_d = np.asarray(motor.flux_wb) + motor.d_inductance_h * i_d
    return FluxMap(axis_d, axis_q, psi_d, motor.q_inductance_h * i_q)


CONSTANT = {
    "in-wheel motor": (machine(0.0204, 76e-6, 76e-6, 23, 1.5), 75.0, 21.0),
    "interior magnets": (machine(0.09, 4e-4, 1.1e-3, 4, 8.0), 300.0, 180.0),
    "L_d above L_q": (machine(0.05, 9e-4, 7e-4, 5, np.inf), 60.0, 90.0),
}


@pytest.mark.parametrize("name", CONSTANT)
def test_a_map_of_constant_inductances_has_the_optimum_of_the_constants(name: str) -> None:
    motor, current_a, voltage_v = CONSTANT[name]
    mapped = FluxMotor(motor, constant_map(motor, current_a))
    limits = joint.Limits(current_a, voltage_v)
    for share in (0.1, 0.6, 1.3, -0.8):
        omega = share * voltage_v / float(np.asarray(motor.flux_wb))
        best = flux_optimum.best_braking(mapped, INVERTER, omega, limits)
        wanted = joint.best_braking(motor, INVERTER, omega, limits)
        assert bool(best.feasible) == bool(wanted.feasible)
        assert best.state.dc_power_w == pytest.approx(float(wanted.state.dc_power_w), rel=1e-7)
        torques = float(wanted.torque_nm) * np.array([0.2, 0.7, -0.3])
        one = flux_optimum.least_power(mapped, INVERTER, omega, torques, limits)
        other = joint.least_power(motor, INVERTER, omega, torques, limits)
        assert np.array_equal(one.feasible, other.feasible)
        there = other.feasible
        assert one.state.dc_power_w[there] == pytest.approx(
            other.state.dc_power_w[there], rel=1e-7, abs=1e-6
        )
        assert one.torque_nm[there] == pytest.approx(torques[there], rel=1e-9)


def test_weaker_magnets_of_a_map_of_constants_are_those_of_the_constants() -> None:
    motor, current_a, voltage_v = CONSTANT["interior magnets"]
    weak = replace(motor, flux_wb=0.92 * 0.09)
    mapped = flux_optimum.motor_of(motor, constant_map(motor, current_a), 0.92)
    assert mapped.shift_a == pytest.approx(-0.08 * 0.09 / 4e-4)
    limits = joint.Limits(current_a, voltage_v)
    for omega in (200.0, 2000.0, 3500.0):
        best = flux_optimum.best_braking(mapped, INVERTER, omega, limits)
        wanted = joint.best_braking(weak, INVERTER, omega, limits)
        assert best.state.dc_power_w == pytest.approx(float(wanted.state.dc_power_w), rel=1e-7)


def drawn() -> Iterator[tuple[FluxMotor, float, float, float]]:
    """Saturating motors of 0.2 to 150 kW, L_q/L_d 0.8 to 8, without magnets from 1.5 on.

    Motor, current, voltage and speed. Fluxes are slopes of the co-energy psi i_d + K_d^2 L_d
    ln cosh(i_d/K_d) + K_q^2 L_q ln cosh(i_q/K_q) - c i_d i_q^2/2.
    """
    rng = np.random.default_rng(SEED)
    for n in range(DRAWN):
        power_w = 200.0 * 750.0 ** rng.uniform()
        saliency = 0.8 * 10.0 ** rng.uniform()
        voltage_v = 20.0 * (power_w / 200.0) ** 0.45
        current_a = power_w / (1.5 * voltage_v * 0.6)
        omega = rng.uniform(400.0, 2500.0)
        whole_wb = 0.8 * voltage_v / omega
        magnets = 0.0 if saliency >= 1.5 and n % 3 == 0 else rng.uniform(0.3, 1.0)
        d_h = rng.uniform(0.25, 0.6) * whole_wb / current_a / max(1.0, 0.4 * saliency)
        q_h = saliency * d_h
        knee = rng.uniform(0.8, 3.0) * current_a
        cross = rng.uniform(0.0, 0.1) * min(d_h, q_h) / current_a
        axis_d = np.linspace(-1.2, 0.8, 17) * current_a
        axis_q = np.linspace(-1.2, 1.2, 21) * current_a
        i_d, i_q = np.meshgrid(axis_d, axis_q, indexing="ij")
        psi_d = magnets * whole_wb + 2.0 * knee * d_h * np.tanh(i_d / knee / 2.0)
        psi_q = knee * q_h * np.tanh(i_q / knee)
        found = FluxMap(axis_d, axis_q, psi_d - 0.5 * cross * i_q**2, psi_q - cross * i_d * i_q)
        ohm = 0.04 * voltage_v / current_a
        motor = Machine(4, 25.0, ohm, 0.0, 0.0, 0.0, 25.0 * voltage_v / current_a, 0.01)
        yield FluxMotor(motor, checked(found)[0]), current_a, voltage_v, omega * rng.uniform(0.2, 2)


class Brute:
    """The circuit in complex numbers; every current inside the limits is tried."""

    def __init__(self, motor: FluxMotor, current_a: float, voltage_v: float, omega: float) -> None:
        flux = motor.flux
        self.machine, self.omega = motor.machine, omega
        self.current_a, self.voltage_v = current_a, voltage_v
        self.ends = flux.i_d_a[0], flux.i_d_a[-1], flux.i_q_a[-1]
        self.flux = RegularGridInterpolator(
            (flux.i_d_a, flux.i_q_a), flux.psi_d_wb + 1j * flux.psi_q_wb
        )

    def torque_nm(self, i_d: Array, i_q: Array) -> Array:
        current = i_d + 1j * i_q
        linked = self.flux(np.stack([i_d, i_q], axis=-1))
        return np.asarray(1.5 * self.machine.pole_pairs * (np.conj(linked) * current).imag)

    def power_w(self, i_d: Array, i_q: Array) -> Array:
        """DC power; infinite outside the limits."""
        linked = self.flux(np.stack([i_d, i_q], axis=-1))
        emf = 1j * self.omega * linked
        iron_ohm = self.machine.iron_ohm + self.machine.iron_ohm_s * self.omega
        current = i_d + 1j * i_q + emf / iron_ohm
        voltage = self.machine.resistance_ohm * current + emf
        power = 1.5 * (voltage * np.conj(current)).real
        most = 1.0 + 1e-9
        size = np.abs(current)
        inside = (size <= most * self.current_a) & (np.abs(voltage) <= most * self.voltage_v)
        lost = INVERTER.linear_w_per_a * size + INVERTER.square_w_per_a2 * size**2
        return np.asarray(np.where(inside, power + lost, np.inf))

    def least_power_w(self, torque_nm: float) -> float:
        low, high = self.ends[:2]
        best = np.inf
        for _ in range(5):
            i_d = np.linspace(low, high, 401)
            i_q = self.quadrature(torque_nm, i_d)
            power = np.where(np.isnan(i_q), np.inf, self.power_w(i_d, np.nan_to_num(i_q)))
            k = int(np.argmin(power))
            best = min(best, float(power[k]))
            step = 3.0 * (i_d[1] - i_d[0])
            low, high = max(i_d[k] - step, self.ends[0]), min(i_d[k] + step, self.ends[1])
        return best

    def quadrature(self, torque_nm: float, i_d: Array) -> Array:
        end = np.copysign(self.ends[2], torque_nm)
        near, far = np.zeros_like(i_d), np.full_like(i_d, end)
        sign = np.sign(torque_nm)
        for _ in range(40):
            middle = 0.5 * (near + far)
            below = sign * self.torque_nm(i_d, middle) < abs(torque_nm)
            near, far = np.where(below, middle, near), np.where(below, far, middle)
        exact = sign * self.torque_nm(i_d, far) >= abs(torque_nm) * (1.0 - 1e-9)
        return np.asarray(np.where(exact, far, np.nan))


def test_least_power_and_best_braking_equal_brute_force_within_1e_6() -> None:
    """Of the power turned over, shaft or DC."""
    compared = 0
    for motor, current_a, voltage_v, omega in drawn():
        limits = joint.Limits(current_a, voltage_v)
        brute = Brute(motor, current_a, voltage_v, omega)
        least, most = flux_optimum.torque_limits_nm(motor, INVERTER, omega, limits)
        if not least < 0.0:
            continue
        torques = np.array([0.35 * least, 0.9 * least, 0.6 * most])
        found = flux_optimum.least_power(motor, INVERTER, omega, torques, limits)
        for n, torque in enumerate(torques):
            if not found.feasible[n]:
                continue
            power = float(found.state.dc_power_w[n])
            wanted = brute.least_power_w(float(torque))
            scale = max(abs(wanted), abs(torque) * omega / motor.machine.pole_pairs)
            assert power == pytest.approx(wanted, abs=1e-6 * scale), (motor, torque)
            compared += 1
        best = flux_optimum.best_braking(motor, INVERTER, omega, limits)
        returned = float(best.state.dc_power_w)
        near = float(best.torque_nm) * np.array([0.97, 0.995, 0.9995, 1.0005, 1.005, 1.03])
        others = [brute.least_power_w(float(torque)) for torque in near]
        assert returned <= min(others) + 1e-6 * max(abs(returned), 1e-3 * voltage_v * current_a)
    assert compared > 2 * DRAWN


def test_torque_limits_equal_the_best_of_all_currents_and_the_identity_of_the_voltage() -> None:
    generating_has_more = 0
    for motor, current_a, voltage_v, omega in drawn():
        limits = joint.Limits(current_a, voltage_v)
        least, most = flux_optimum.torque_limits_nm(motor, INVERTER, omega, limits)
        brute = Brute(motor, current_a, voltage_v, omega)
        axis_d = np.linspace(*brute.ends[:2], 301)
        axis_q = np.linspace(-brute.ends[2], brute.ends[2], 301)
        i_d, i_q = (part.ravel() for part in np.meshgrid(axis_d, axis_q))
        inside = np.isfinite(brute.power_w(i_d, i_q))
        if not np.any(inside):
            continue
        torque = brute.torque_nm(i_d, i_q)[inside]
        span = float(np.ptp(torque))
        assert least == pytest.approx(float(np.min(torque)), abs=0.01 * span)
        assert most == pytest.approx(float(np.max(torque)), abs=0.01 * span)
        assert least <= np.min(torque) + 1e-6 * span
        assert most >= np.max(torque) - 1e-6 * span
        ends = flux_optimum.least_power(motor, INVERTER, omega, np.array([least, most]), limits)
        made = ends.state
        currents = made.current_d_a + 1j * made.current_q_a
        resistance = np.asarray(motor.machine.resistance_ohm)
        emf = made.voltage_d_v + 1j * made.voltage_q_v - resistance * currents
        iron_ohm = motor.machine.iron_ohm + motor.machine.iron_ohm_s * omega
        k = 1.0 + resistance / iron_ohm
        square = (
            k**2 * np.abs(emf) ** 2
            + 4.0 / 3.0 * k * resistance * omega * made.torque_nm / motor.machine.pole_pairs
            + resistance**2 * np.abs(currents - emf / iron_ohm) ** 2
        )
        assert square == pytest.approx(made.voltage_v**2, rel=1e-9)
        generating_has_more += -least > 1.001 * most
    assert generating_has_more >= 3


def test_torques_beyond_the_map_are_not_possible() -> None:
    motor, current_a, _ = CONSTANT["interior magnets"]
    mapped = FluxMotor(motor, constant_map(motor, current_a))
    far = np.array([2.0 * mapped.strongest_nm(), -3.0 * mapped.strongest_nm()])
    found = flux_optimum.least_power(mapped, INVERTER, 100.0, far, joint.Limits(1e6, 1e6))
    assert not np.any(found.feasible)
