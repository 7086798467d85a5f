# SPDX-License-Identifier: Apache-2.0
"""What the tests of hubsim share: the paper's vehicle, and the command as a user calls it."""

import sys
from pathlib import Path

import pytest
from hubsim.engine import ROOT
from regen_table import schema
from regen_table.schema import Drive

sys.path.append(str(ROOT / "tests" / "unit" / "host_sim" / "support"))
from hubsim_command import Hubsim, hubsim_in

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


@pytest.fixture
def drive() -> Drive:
    return schema.load(LU2013)


@pytest.fixture
def hubsim(tmp_path: Path) -> Hubsim:
    """Return a function that calls the command in an empty directory."""
    return hubsim_in(tmp_path)
