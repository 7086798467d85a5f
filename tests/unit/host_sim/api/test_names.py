# SPDX-License-Identifier: Apache-2.0
"""Names that users import from the package, wherever their modules are."""

import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import hubsim
import pytest
from hubsim import _MODULES as MODULES

FLOOR = (
    *("can_protocol", "configuration", "controller", "emulator", "engine", "errors", "files"),
    *("progress", "reasons", "variables", "words"),
)


def test_every_public_name_is_there() -> None:
    assert all(hasattr(hubsim, name) for name in hubsim.__all__)
    assert set(hubsim.__all__) <= set(dir(hubsim))


def test_the_can_protocol_needs_the_standard_library_alone(tmp_path: Path) -> None:
    """A client of the bus is not a simulator: one folder on a bare Python."""
    shutil.copytree(Path(hubsim.__file__).parent, tmp_path / "hubsim")
    program = (
        f"import sys; sys.path.append({str(tmp_path)!r})\n"
        "from hubsim import can_protocol\n"
        "print(can_protocol.decode('Demand', can_protocol.encode('Demand', {'enable': 1})[1]))\n"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", program],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "'enable': 1.0" in done.stdout


@pytest.mark.parametrize("group", MODULES)
def test_modules_of_groups_can_be_had_from_the_package(group: str) -> None:
    for name in MODULES[group]:
        assert getattr(hubsim, name) is importlib.import_module(f"hubsim.{group}.{name}")


def test_the_imports_of_examples_and_notebook_work_in_a_new_interpreter() -> None:
    program = (
        "from hubsim import run, scenario, stops\n"
        "from hubsim.engine import ROOT\n"
        f"from hubsim import {', '.join(FLOOR)}\n"
        "print(run.prepare.__name__, scenario.load.__name__, stops.simulate.__name__)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "prepare load simulate\n"


def test_a_name_that_is_not_there_is_refused() -> None:
    with pytest.raises(AttributeError, match="module 'hubsim' has no attribute 'colour'"):
        _ = hubsim.colour
