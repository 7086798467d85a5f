# SPDX-License-Identifier: Apache-2.0
"""What the tests of hubsim share: the paper's vehicle, and the command as a user calls it."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hubsim.engine import ROOT
from regen_table import schema
from regen_table.schema import Drive

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


@pytest.fixture
def drive() -> Drive:
    return schema.load(LU2013)


@pytest.fixture
def hubsim(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that calls the command in an empty directory."""

    def call(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "hubsim", *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    return call
