# SPDX-License-Identifier: Apache-2.0
"""Measured flux maps as iron of the simulated motor, against the co-energy that they are from."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hubsim import iron, run, scenario
from hubsim.engine import ROOT
from hubsim.errors import HubsimError
from hubsim_command import Hubsim
from regen_table.flux_files import COLUMNS
from regen_table.flux_map import FluxMap
from regen_table.schema import Drive

Array = npt.NDArray[np.float64]
PUBLISHED = ROOT / "tests/unit/tools/regen_table/motulator/baldor_400rpm_map.npz"
AXIS_D = np.linspace(-90.0, 60.0, 16)
AXIS_Q = np.linspace(-90.0, 90.0, 37)
KNEE_A, CROSS = 60.0, 5e-8  # of psi_q; of the co-energy -CROSS i_d i_q^2/2


def saturating(drive: Drive, i_d: Array | float, i_q: Array | float) -> tuple[Array, Array]:
    """Return the slopes of a co-energy: psi_q bends with i_q, cross-saturation between both."""
    motor = drive.motor
    psi_d = motor.flux_linkage_wb + motor.d_inductance_h * np.asarray(i_d) - 0.5 * CROSS * i_q**2
    bent = KNEE_A * motor.q_inductance_h * np.tanh(np.asarray(i_q) / KNEE_A)
    return psi_d, bent - CROSS * i_d * np.asarray(i_q)


def constant(drive: Drive, i_d: Array, i_q: Array) -> tuple[Array, Array]:
    motor = drive.motor
    return motor.flux_linkage_wb + motor.d_inductance_h * i_d, motor.q_inductance_h * i_q


def grid() -> tuple[Array, Array]:
    i_d, i_q = np.meshgrid(AXIS_D, AXIS_Q, indexing="ij")
    return i_d, i_q


def write(path: Path, flux: tuple[Array, Array]) -> Path:
    table = np.stack([part.ravel() for part in (*grid(), *flux)], axis=1)
    np.savetxt(path, table, "%.12g", ",", header=",".join(COLUMNS), comments="")
    return path


def rows_of(drive: Drive, signals: list[str], **keys: object) -> Array:
    settings = {"initial_speed_kmh": 20.0, "demand_nm": 35.0, "noise": False, **keys}
    without_iron_loss = {
        "motor.iron_loss_resistance_ohm": 0.0,
        "motor.iron_loss_resistance_slope_ohm_s": 0.0,
    }
    engine, _ = run.prepare(drive, scenario.load("stop", settings)[1], Path("/"), without_iron_loss)
    with engine:
        engine.start()
        engine.choose(signals)
        return engine.run(1.0)


def test_constant_inductances_are_the_motor_s_own_and_leave_nothing_for_the_spline(
    drive: Drive,
) -> None:
    found = iron.of(FluxMap(AXIS_D, AXIS_Q, *constant(drive, *grid())))
    assert found.flux_linkage_wb == pytest.approx(drive.motor.flux_linkage_wb, rel=1e-12)
    assert found.d_inductance_h == pytest.approx(drive.motor.d_inductance_h, rel=1e-12)
    assert found.q_inductance_h == pytest.approx(drive.motor.q_inductance_h, rel=1e-12)
    assert found.residual_a < 1e-9
    energy_j = 0.5 * drive.motor.q_inductance_h * AXIS_Q[-1] ** 2
    assert np.max(np.abs(found.coefficient_j)) < 1e-9 * energy_j


def test_a_map_of_the_drive_s_constants_stops_the_vehicle_as_the_constants_do(
    drive: Drive, tmp_path: Path
) -> None:
    """Four stages in place of the exact step: 1e-6 A, and another last bit of the converters."""
    path = write(tmp_path / "constant.csv", constant(drive, *grid()))
    signals = ["vehicle.speed_m_per_s", "wheel0.motor_torque_nm"]
    plain = rows_of(drive, signals)
    mapped = rows_of(drive, signals, plant_flux_map=str(path))
    assert mapped[:, 0] == pytest.approx(plain[:, 0], abs=2e-4)
    assert mapped[20:, 1] == pytest.approx(plain[20:, 1], abs=0.3)
    assert plain[-1, 1] < -30.0


def test_the_simulated_torque_is_that_of_the_co_energy_at_the_simulated_currents(
    drive: Drive, tmp_path: Path
) -> None:
    """3/2 p (psi_d i_q - psi_q i_d) of the written-down fluxes, and not that of constants."""
    path = write(tmp_path / "map.csv", saturating(drive, *grid()))
    signals = ["wheel0.current_d_a", "wheel0.current_q_a", "wheel0.motor_torque_nm"]
    i_d, i_q, torque = np.mean(rows_of(drive, signals, plant_flux_map=str(path))[50:], axis=0)
    assert i_q < -20.0
    psi_d, psi_q = saturating(drive, i_d, i_q)
    pairs = drive.motor.pole_pairs
    assert torque == pytest.approx(1.5 * pairs * (psi_d * i_q - psi_q * i_d), rel=2e-3)
    assert torque != pytest.approx(1.5 * pairs * drive.motor.flux_linkage_wb * i_q, rel=3e-3)


def test_between_the_points_the_spline_is_closer_to_the_law_than_a_bilinear_map(
    drive: Drive,
) -> None:
    """Currents of the law at fluxes in the middle of its cells, from the spline's slopes."""
    found = FluxMap(AXIS_D, AXIS_Q, *saturating(drive, *grid()))
    fitted = iron.of(found)
    assert fitted.residual_a < 0.005 * AXIS_Q[-1]  # at the end of the knee
    i_d, i_q = (
        part.ravel()
        for part in np.meshgrid(
            0.5 * (AXIS_D[1:] + AXIS_D[:-1]), 0.5 * (AXIS_Q[1:] + AXIS_Q[:-1]), indexing="ij"
        )
    )
    psi_d, psi_q = saturating(drive, i_d, i_q)
    bilinear_d, bilinear_q = found.flux_wb(i_d, i_q)
    own_h = drive.motor.q_inductance_h / np.cosh(i_q / KNEE_A) ** 2  # dpsi_q/di_q, cross term apart
    bilinear_a = np.hypot(
        (bilinear_d - psi_d) / drive.motor.d_inductance_h, (bilinear_q - psi_q) / own_h
    )
    spline_d, spline_q = slopes(fitted, psi_d - fitted.flux_linkage_wb, psi_q)
    spline_a = np.hypot(spline_d - i_d, spline_q - i_q)
    assert np.mean(spline_a) < 0.5 * np.mean(bilinear_a)


def slopes(found: iron.Iron, x: Array, y: Array) -> tuple[Array, Array]:
    """Return the currents of fluxes, by differences of the energy, B-splines by convolution."""

    def basis(place: Array, count: int) -> Array:
        distance = np.abs(place[:, np.newaxis] - np.arange(-1, count - 1))
        near = 2.0 / 3.0 - distance**2 + 0.5 * distance**3
        far = np.maximum(2.0 - distance, 0.0) ** 3 / 6.0
        return np.asarray(np.where(distance < 1.0, near, far))

    def energy(x: Array, y: Array) -> Array:
        rows, columns = found.coefficient_j.shape
        of_d = basis((x - found.d_first_wb) / found.d_step_wb, rows)
        of_q = basis((y - found.q_first_wb) / found.q_step_wb, columns)
        straight = 0.5 * (x**2 / found.d_inductance_h + y**2 / found.q_inductance_h)
        return np.asarray(straight + np.sum((of_d @ found.coefficient_j) * of_q, axis=1))

    h = 1e-7
    return (energy(x + h, y) - energy(x - h, y)) / (2.0 * h), (
        energy(x, y + h) - energy(x, y - h)
    ) / (2.0 * h)


def test_the_map_that_motulator_publishes_is_nearly_one_of_an_energy() -> None:
    """Its currents, up to 26 A, from the slopes of one function: within 0.15 A."""
    assert iron.load(PUBLISHED).residual_a < 0.15


def test_a_map_that_is_no_energy_s_or_no_file_is_refused_in_one_line(
    monkeypatch: pytest.MonkeyPatch, hubsim: Hubsim
) -> None:
    monkeypatch.setattr(iron, "LARGEST_RESIDUAL", 1e-3)
    with pytest.raises(HubsimError, match=r"no energy has these fluxes.*accepted: 0\.02 A"):
        iron.load(PUBLISHED)
    missing = hubsim("run", "stop", "--set", "plant_flux_map=missing.csv")
    assert missing.returncode != 0
    assert "missing.csv: file not found" in missing.stderr
    assert missing.stderr.count("\n") == 1
