# SPDX-License-Identifier: Apache-2.0
"""Flux maps: the same map from every kind of file, what is refused, and constants of a torque."""

import json
import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest
from pyarrow import parquet
from regen_table import cli, flux_files, flux_map
from regen_table.errors import ConfigurationError
from regen_table.flux_map import FluxMap

Array = npt.NDArray[np.float64]
PUBLISHED = Path(__file__).parent / "motulator" / "baldor_400rpm_map.npz"
AXIS_D = np.linspace(-40.0, 20.0, 13)
AXIS_Q = np.linspace(-50.0, 50.0, 21)
PAIRS = 4
FLUX_WB, D_H, Q_H = 0.05, 4e-4, 9e-4


def of(flux: Callable[[Array, Array], tuple[Array, Array]]) -> FluxMap:
    i_d, i_q = np.meshgrid(AXIS_D, AXIS_Q, indexing="ij")
    return FluxMap(AXIS_D, AXIS_Q, *flux(i_d, i_q))


def linear(i_d: Array, i_q: Array) -> tuple[Array, Array]:
    return FLUX_WB + D_H * i_d, Q_H * i_q


def saturating(i_d: Array, i_q: Array) -> tuple[Array, Array]:
    """Derivatives of the co-energy FLUX_WB i_d + D_H i_d^2/2 + a^2 Q_H ln cosh(i_q/a) - cross term.

    The cross term, k i_d i_q^2/2, makes psi_d fall and psi_q rise with the other current.
    """
    knee, cross = 40.0, 2e-6
    psi_q = knee * Q_H * np.tanh(i_q / knee) - cross * i_d * i_q
    return FLUX_WB + D_H * i_d - 0.5 * cross * i_q**2, psi_q


def rows(found: FluxMap) -> dict[str, Array]:
    i_d, i_q = np.meshgrid(found.i_d_a, found.i_q_a, indexing="ij")
    values = (i_d, i_q, found.psi_d_wb, found.psi_q_wb)
    return {n: v.ravel() for n, v in zip(flux_files.COLUMNS, values, strict=True)}


def as_csv(path: Path, found: FluxMap, seed: int | None = None) -> Path:
    """Write a map, its rows in any order."""
    table = np.stack(list(rows(found).values()), axis=1)
    if seed is not None:
        np.random.default_rng(seed).shuffle(table)
    lines = [",".join(flux_files.COLUMNS), *(",".join(f"{v:.12g}" for v in row) for row in table)]
    path.write_text("# 80 degC\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_every_kind_of_file_holds_the_same_map(tmp_path: Path) -> None:
    wanted = of(saturating)
    complex_file, axes_file = tmp_path / "complex.npz", tmp_path / "axes.npz"
    grid = rows(wanted)
    shape = wanted.psi_d_wb.shape
    current = (grid["i_d_a"] + 1j * grid["i_q_a"]).reshape(shape)
    np.savez(complex_file, i_s_dq=current, psi_s_dq=wanted.psi_d_wb + 1j * wanted.psi_q_wb)
    np.savez(
        axes_file,
        i_d_a=AXIS_D,
        i_q_a=AXIS_Q,
        psi_d_wb=wanted.psi_d_wb,
        psi_q_wb=wanted.psi_q_wb,
    )
    parquet.write_table(pa.table(grid), tmp_path / "map.parquet")
    for path in (
        as_csv(tmp_path / "map.csv", wanted, seed=3),
        tmp_path / "map.parquet",
        complex_file,
        axes_file,
    ):
        found, checks = flux_files.load(path)
        assert found.i_d_a == pytest.approx(AXIS_D)
        assert found.i_q_a == pytest.approx(AXIS_Q)
        assert found.psi_d_wb == pytest.approx(wanted.psi_d_wb, rel=1e-9, abs=1e-12)
        assert found.psi_q_wb == pytest.approx(wanted.psi_q_wb, rel=1e-9, abs=1e-12)
        assert checks.asymmetry_wb < 1e-9
        assert checks.reciprocity_share < 1e-3  # of a co-energy: what the grid leaves


def test_the_map_that_motulator_publishes_is_read_as_it_is() -> None:
    """Its own arrays, read without the importer: one point, and the torque of another."""
    with np.load(PUBLISHED) as stored:
        current, flux = stored["i_s_dq"], stored["psi_s_dq"]
    found, checks = flux_files.load(PUBLISHED)
    assert found.psi_d_wb.shape == current.shape
    j, k = 4, 20
    psi_d, psi_q = found.flux_wb(current.real[j, k], current.imag[j, k])
    assert float(psi_d) == pytest.approx(flux.real[j, k])
    assert float(psi_q) == pytest.approx(flux.imag[j, k])
    torque = found.torque_nm(2, current.real[j, k], current.imag[j, k])
    assert float(torque) == pytest.approx(3.0 * (np.conj(flux[j, k]) * current[j, k]).imag)
    assert not checks.mirrored
    assert 0.0 < checks.reciprocity_share < 0.1


def test_half_a_map_is_mirrored(tmp_path: Path) -> None:
    whole = of(saturating)
    half = replace(
        whole,
        i_q_a=AXIS_Q[10:],
        psi_d_wb=whole.psi_d_wb[:, 10:],
        psi_q_wb=whole.psi_q_wb[:, 10:],
    )
    found, checks = flux_files.load(as_csv(tmp_path / "half.csv", half))
    assert checks.mirrored
    assert found.i_q_a == pytest.approx(AXIS_Q)
    assert found.psi_q_wb == pytest.approx(whole.psi_q_wb, abs=1e-12)
    assert found.psi_d_wb == pytest.approx(whole.psi_d_wb, rel=1e-9)


def test_a_small_asymmetry_is_taken_out_and_its_amount_returned() -> None:
    """1 mWb on psi_q everywhere: half of the difference of two points of opposite i_q."""
    whole = of(linear)
    found, checks = flux_map.checked(replace(whole, psi_q_wb=whole.psi_q_wb + 1e-3))
    assert checks.asymmetry_wb == pytest.approx(1e-3)
    assert found.psi_q_wb == pytest.approx(whole.psi_q_wb, abs=1e-12)


def bent(change: Callable[[Array, Array], tuple[Array, Array]]) -> FluxMap:
    def flux(i_d: Array, i_q: Array) -> tuple[Array, Array]:
        one, other = change(i_d, i_q)
        psi_d, psi_q = linear(i_d, i_q)
        return psi_d + one, psi_q + other

    return of(flux)


REFUSED = {
    "asymmetrical": (bent(lambda d, q: (0 * d, 4e-3 + 0 * q)), "0.004 Wb beside symmetry at i_d ="),
    "psi_q falls": (
        bent(
            lambda d, q: (0 * d, -1.2e-3 * np.where(np.abs(q) > 30.0, q - 30.0 * np.sign(q), 0.0))
        ),
        "psi_q changes by -0.0015 Wb after i_d = -40 A, i_q = -50 A, accepted: a flux that rises",
    ),
    "psi_d falls": (bent(lambda d, q: (-5e-4 * d, 0 * q)), "psi_d changes by -0.0005 Wb after"),
    "magnets turned": (
        bent(lambda d, q: (-0.1 + 0 * d, 0 * q)),
        "psi_d = -0.05 Wb without current",
    ),
    "not reciprocal": (
        bent(lambda d, q: (1e-5 * q * q, 0 * q)),
        "A, 238% of the smallest inductance there",  # 2 10^-5 47.5 H in the outer cells, of 0.4 mH
    ),
}


@pytest.mark.parametrize("mistake", REFUSED)
def test_what_is_no_motor_s_map_is_refused_with_place_and_value(mistake: str) -> None:
    found, answer = REFUSED[mistake]
    with pytest.raises(ConfigurationError, match="accepted: ") as refused:
        flux_map.checked(found)
    assert answer in str(refused.value)
    assert "\n" not in str(refused.value)


WRONG_FILES = {
    "another heading": ("i_d,i_q,psi_d,psi_q\n1,2,3,4\n", "", "accepted: a table with the columns"),
    "a word": ("i_d_a,i_q_a,psi_d_wb,psi_q_wb\n0,0,1,0\n1,0,x,0\n", ":3", "psi_d_wb 'x', accepted"),
    "twice": ("i_d_a,i_q_a,psi_d_wb,psi_q_wb\n0,0,1,0\n0,0,2,0\n", ":3", "a second time"),
    "a hole": (
        "i_d_a,i_q_a,psi_d_wb,psi_q_wb\n0,0,1,0\n1,1,2,1\n0,1,1,1\n",
        "",
        "nothing at i_d = 1 A, i_q = 0 A, accepted: every point of a grid",
    ),
    "too small": ("i_d_a,i_q_a,psi_d_wb,psi_q_wb\n-1,0,1,0\n0,0,2,0\n", "", "i_d: 2 values"),
}


@pytest.mark.parametrize("mistake", WRONG_FILES)
def test_a_wrong_file_is_refused_in_one_line(
    mistake: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content, line, answer = WRONG_FILES[mistake]
    path = tmp_path / "map.csv"
    path.write_text(content, encoding="utf-8")
    assert cli.main(["flux", str(path), "--pole-pairs", "4"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{path}{line}: ")
    assert answer in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_bytes_that_are_no_map_are_refused_in_one_line(
    ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"map.{ending}"
    for content in (b"", b"PK\x03\x04 not really", None):
        if content is None:
            path.unlink()
        else:
            path.write_bytes(content)
        assert cli.main(["flux", str(path), "--pole-pairs", "4"]) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"{path}: ")
        assert error.count("\n") == 1


def test_constants_of_a_linear_motor_are_its_own() -> None:
    """Least current for a torque: i_d = (psi - sqrt(psi^2 + 8 dL^2 I^2))/(4 dL), dL = L_q - L_d."""
    found = flux_map.constants(of(linear), PAIRS, 6.0)
    assert found.flux_linkage_wb == pytest.approx(FLUX_WB, rel=1e-9)
    assert found.d_inductance_h == pytest.approx(D_H, rel=1e-9)
    assert found.q_inductance_h == pytest.approx(Q_H, rel=1e-9)
    assert found.torque_nm == pytest.approx(6.0, rel=1e-3)
    current, salient = math.hypot(found.i_d_a, found.i_q_a), Q_H - D_H
    best = (FLUX_WB - math.sqrt(FLUX_WB**2 + 8.0 * (salient * current) ** 2)) / (4.0 * salient)
    assert found.i_d_a == pytest.approx(best, abs=0.01 * current)


def test_without_saliency_the_least_current_has_no_d_part() -> None:
    found = flux_map.constants(of(lambda d, q: (FLUX_WB + D_H * d, D_H * q)), PAIRS, 6.0)
    assert found.i_d_a == pytest.approx(0.0, abs=1e-9)
    assert found.d_inductance_h == pytest.approx(D_H, rel=1e-9)


def test_constants_make_the_torque_of_a_saturating_motor_exact_where_they_are_from() -> None:
    """And only there: at twice its current this motor's L_q has fallen, and constants say more."""
    motor = of(saturating)
    found = flux_map.constants(motor, PAIRS, 6.0)
    currents = np.array([found.i_d_a]), np.array([found.i_q_a])
    psi_d, psi_q = saturating(*currents)
    true = 1.5 * PAIRS * (psi_d * currents[1] - psi_q * currents[0])
    assert found.torque_at(PAIRS, *currents) == pytest.approx(true, rel=2e-3)
    errors = flux_map.torque_errors(motor, found, PAIRS)
    assert errors[-1].torque_nm > 6.0
    assert errors[-1].error_share > 0.02


def test_a_torque_or_a_current_beyond_the_map_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(as_csv(tmp_path / "map.csv", of(linear)))
    command = ["flux", path, "--pole-pairs", str(PAIRS)]
    assert cli.main([*command, "--torque-nm", "500"]) == 2
    assert "500 N m, accepted: above zero, up to " in capsys.readouterr().err
    assert cli.main([*command, "--max-current-a", "45"]) == 2
    assert capsys.readouterr().err == (
        f"{path}: -i_d up to 40 A, accepted: a map up to the largest phase current, 45 A\n"
    )


@pytest.mark.parametrize("pairs", ["2.5", "0", "61", "-1", "four"])
def test_pole_pairs_are_a_whole_number(pairs: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(["flux", str(PUBLISHED), f"--pole-pairs={pairs}"])
    assert end.value.code == 2
    error = capsys.readouterr().err
    assert f"{pairs!r}, accepted: a whole number from 1 to 60" in error
    assert error.count("\n") == 1


def test_the_command_writes_keys_and_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    keys, out = tmp_path / "keys.toml", tmp_path / "out.json"
    command = ["flux", str(PUBLISHED), "--pole-pairs", "2", "--torque-nm", "20"]
    assert cli.main([*command, "-o", str(keys), "--json", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "21 x 27 points, i_d from -20 to 20 A, i_q up to 26 A" in printed
    written = tomllib.loads(keys.read_text(encoding="utf-8"))["motor"]
    found = json.loads(out.read_text(encoding="utf-8"))
    assert set(written) == {"flux_linkage_wb", "d_inductance_h", "q_inductance_h"}
    for name, value in written.items():
        assert found["constants"][name] == pytest.approx(value, rel=1e-4)
    assert found["constants"]["torque_nm"] == pytest.approx(20.0, rel=1e-3)
    assert found["torque_errors"][-1]["current_a"] == pytest.approx(20.0)
    assert not found["checks"]["mirrored"]
