# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python API share: the paper's vehicle, read once."""

import sys

import hubsim
import pytest
from hubsim.engine import ROOT

# The command that test_report_command.py calls.
sys.path.append(str(ROOT / "tests" / "unit" / "host_sim" / "support"))

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"
WITH_ANGLE = {"rotor.sensor": "angle"}


@pytest.fixture(scope="session")
def config() -> hubsim.Configuration:
    return hubsim.load_configuration(LU2013)


@pytest.fixture(scope="session")
def angle_config() -> hubsim.Configuration:
    return hubsim.load_configuration(LU2013, WITH_ANGLE)
