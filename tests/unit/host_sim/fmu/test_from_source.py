# SPDX-License-Identifier: Apache-2.0
"""An FMU can be built from its own sources and then gives the same results.

Its binary links only the C library.
"""

import itertools
import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest
from fmpy import simulate_fmu
from fmpy.build import build_platform_binary
from importer import VERSIONS, path_of

KINDS = ("controller", "vehicle")


@pytest.mark.parametrize(("kind", "fmi"), itertools.product(KINDS, VERSIONS))
def test_the_binary_links_only_the_c_library(kind: str, fmi: int, tmp_path: Path) -> None:
    folder = Path(fmpy.extract(str(path_of(kind, fmi)), str(tmp_path)))
    (binary,) = folder.glob("binaries/*/*.so")
    listing = subprocess.run(
        ["readelf", "-d", str(binary)], capture_output=True, text=True, check=True
    ).stdout
    needed = {line.split("[")[1].rstrip("]") for line in listing.splitlines() if "(NEEDED)" in line}
    assert needed <= {"libc.so.6", "libm.so.6"}
    names = subprocess.run(
        ["nm", "-D", "--defined-only", str(binary)], capture_output=True, text=True, check=True
    ).stdout
    exported = {line.split()[2] for line in names.splitlines()}
    assert all(name.startswith(f"fmi{fmi}") for name in exported), (
        "more than the standard's functions can be seen from outside"
    )


@pytest.mark.parametrize("fmi", VERSIONS if "HUBFOC_FOR_LONG" in os.environ else VERSIONS[-1:])
def test_an_fmu_built_from_its_own_sources_gives_the_same_outputs(
    fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(
        "CMAKE_GENERATOR", "Ninja"
    )  # the generator of the project; make may be missing
    path = path_of("vehicle", fmi)
    starts = {"run.initial_speed_m_per_s": 5.0, "driver.brake_demand_nm": 20.0}
    wanted = [
        "vehicle.speed_m_per_s",
        "wheel0.motor_torque_nm",
        "battery.current_a",
        "energy.chemical_j",
        "wheel3.mode",
    ]

    def run(unit: str) -> bytes:
        found = simulate_fmu(
            unit,
            start_values=starts,
            stop_time=0.5,
            output_interval=0.05,
            step_size=0.05,
            output=wanted,
        )
        return bytes(found.tobytes())

    delivered = run(str(path))
    folder = Path(fmpy.extract(str(path), str(tmp_path / "unit")))
    shutil.rmtree(folder / "binaries")
    (tmp_path / "build").mkdir()
    build_platform_binary(folder, build_dir=tmp_path / "build")
    assert run(str(folder)) == delivered
