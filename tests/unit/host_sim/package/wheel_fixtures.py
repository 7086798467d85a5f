# SPDX-License-Identifier: Apache-2.0
"""The distribution as a wheel, and installed with all extras or without any."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from environments import EXTRAS, PROJECT, Installed, install


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel, with the build's own requirements taken from the tests' environment."""
    directory = tmp_path_factory.mktemp("wheel")
    beside = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"  # cmake, ninja
    arguments = ["--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check"]
    done = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", *arguments, "--wheel-dir", directory, PROJECT],
        env=os.environ | {"PATH": beside}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = directory.iterdir()
    return built


@pytest.fixture(scope="session")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Install the wheel with every extra."""
    return install(wheel, tmp_path_factory.mktemp("full"), EXTRAS)


@pytest.fixture(scope="session")
def bare(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Install the wheel without any extra."""
    return install(wheel, tmp_path_factory.mktemp("bare"), frozenset())
