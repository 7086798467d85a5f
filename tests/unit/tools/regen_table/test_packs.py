# SPDX-License-Identifier: Apache-2.0
"""A battery pack with a power trace.

Closed form at constant power, and properties independent of the RC branch.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from regen_table import STRATEGIES, ideal, models, packs, schema
from scipy import integrate

Change = Callable[[dict[str, Any]], schema.Drive]
OPEN_V, SERIES_OHM, RESISTANCE_OHM, CAPACITANCE_F = 53.0, 0.012, 0.010, 3000.0
BRANCH = (RESISTANCE_OHM, CAPACITANCE_F)
DEMANDS_NM = (5.0, 20.0, 40.0, 60.0, 120.0)


def constant(
    power_w: float, duration_s: float, steps: int, series_ohm: float = SERIES_OHM
) -> packs.Flow:
    return packs.dynamic(
        OPEN_V, series_ohm, BRANCH, np.full(steps, power_w), np.full(steps, duration_s / steps)
    )


def overvoltage(found: packs.Flow, power_w: float) -> float:
    return math.copysign(math.sqrt(2.0 * found.left_in_branch_j / CAPACITANCE_F), power_w)


@pytest.mark.parametrize("power_w", [-6000.0, -300.0, 4000.0])
@pytest.mark.parametrize("duration_s", [2.0, 12.0, 90.0])
def test_constant_power_follows_the_closed_form(power_w: float, duration_s: float) -> None:
    """Without R_s the current is P / (u_oc - u), so C du/dt = P/(u_oc - u) - u/R, whose time
    integrates by partial fractions.

    (u_oc - u) / [(u - a)(u - b)] with a, b the roots of u^2 - u_oc u + P R.
    """
    u = overvoltage(constant(power_w, duration_s, 4000, series_ohm=0.0), power_w)
    root = math.sqrt(OPEN_V**2 - 4.0 * power_w * RESISTANCE_OHM)
    a, b = (OPEN_V - root) / 2.0, (OPEN_V + root) / 2.0
    logarithms = (OPEN_V - a) * math.log(abs((u - a) / a)) - (OPEN_V - b) * math.log(
        abs((u - b) / b)
    )
    assert RESISTANCE_OHM * CAPACITANCE_F * logarithms / (a - b) == pytest.approx(
        duration_s, rel=2e-5
    )


@pytest.mark.parametrize("power_w", [-6000.0, 4000.0])
def test_charge_at_constant_power_is_the_integral_over_the_branch_voltage(
    power_w: float,
) -> None:
    """The integral of i dt is that of i C du / (i - u/R).

    R_s is contained in i, the root of i (u_oc - u - R_s i) = P.
    """
    found = constant(power_w, 10.0, 4000)

    def current(u: float) -> float:
        internal_drop_v = OPEN_V - u
        return (internal_drop_v - math.sqrt(internal_drop_v**2 - 4.0 * SERIES_OHM * power_w)) / (
            2.0 * SERIES_OHM
        )

    def charge(u: float) -> float:
        return current(u) * CAPACITANCE_F / (current(u) - u / RESISTANCE_OHM)

    end = overvoltage(found, power_w)
    assert found.chemical_j == pytest.approx(OPEN_V * integrate.quad(charge, 0.0, end)[0], rel=1e-7)
    heat = integrate.quad(
        lambda u: charge(u) * (SERIES_OHM * current(u) + u**2 / RESISTANCE_OHM / current(u)),
        0.0,
        end,
    )[0]
    assert found.heat_j == pytest.approx(heat, rel=1e-6)
    assert found.chemical_j == pytest.approx(
        power_w * 10.0 + found.heat_j + found.left_in_branch_j, rel=1e-12
    )


def test_a_long_step_settles_the_branch_and_a_zero_step_has_no_effect() -> None:
    for power in (-6000.0, 4000.0):
        steady = models.battery_steady(OPEN_V, SERIES_OHM + RESISTANCE_OHM, power)
        long = constant(power, 1e9, 1)
        assert long.chemical_j == pytest.approx(float(steady.chemical_power_w) * 1e9, rel=1e-6)
        short = constant(power, 1e-3, 1)
        unpolarised = models.battery_steady(OPEN_V, SERIES_OHM, power)
        assert short.chemical_j == pytest.approx(
            float(unpolarised.chemical_power_w) * 1e-3, rel=1e-6
        )


def test_more_power_at_every_time_stores_more_energy() -> None:
    rng = np.random.default_rng(8)
    for _ in range(100):
        seconds = rng.uniform(0.01, 4.0, 60)
        power = rng.uniform(-8000.0, 6000.0, 60)
        less = power + rng.uniform(0.0, 500.0, 60) * rng.integers(0, 2, 60)
        more, fewer = (
            packs.dynamic(OPEN_V, SERIES_OHM, BRANCH, trace, seconds) for trace in (power, less)
        )
        assert more.chemical_j <= fewer.chemical_j


def test_half_the_step_quarters_the_error() -> None:
    seconds = 16.0
    fine = constant(-6000.0, seconds, 4096).chemical_j
    coarse, halved = (constant(-6000.0, seconds, steps).chemical_j - fine for steps in (16, 32))
    assert coarse / halved == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_energy_with_a_dynamic_branch_lies_between_settled_and_no_branch(
    change: Change, strategy: str
) -> None:
    drive = change({})
    for demand in DEMANDS_NM:

        def share(changes: dict[str, Any], battery: str, demand: float = demand) -> float:
            found = ideal.stop(change(changes), strategy, demand, 40.0, 25.0, battery=battery)
            assert abs(found.residual_relative) < 1e-9
            return found.stored_share_of_kinetic

        settled, moving = share({}, "settled"), share({}, "dynamic")
        assert settled < moving < share({"battery.polarisation_resistance_ohm": 0.0}, "settled")
        # Time constants far below and far above the duration of the stop are those two limits.
        assert share({"battery.polarisation_capacitance_f": 1e-3}, "dynamic") == pytest.approx(
            settled, abs=1e-7
        )
        slow = share({"battery.polarisation_capacitance_f": 1e7}, "dynamic")
        assert slow == pytest.approx(
            share({"battery.polarisation_resistance_ohm": 0.0}, "settled"), abs=1e-5
        )
        off = share({"battery.polarisation_resistance_ohm": 0.0}, "dynamic")
        assert off == pytest.approx(
            share({"battery.polarisation_resistance_ohm": 0.0}, "settled"), rel=1e-12
        )
    energies = ideal.stop(drive, strategy, 40.0, 40.0, 25.0, battery="dynamic").energy_j
    assert 0.0 < energies.polarisation < energies.battery


def test_series_optimal_stores_the_most_with_a_dynamic_branch(
    random_drives: list[schema.Drive],
) -> None:
    for drive in random_drives[::40]:
        top = 0.9 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m * 3.6
        for demand in drive.motor.rated_torque_nm * np.array([0.7, 4.0]):
            stored = {
                s: (
                    ideal.stop(
                        drive, s, float(demand), top, 80.0, battery="dynamic"
                    ).stored_share_of_kinetic
                )
                for s in STRATEGIES
            }
            assert stored["series_optimal"] >= max(stored.values()) - 1e-9
