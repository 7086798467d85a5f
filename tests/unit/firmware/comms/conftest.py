# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the protocol's tests."""

import os
from pathlib import Path

import pytest
from cantools.database.can import Database
from protocol import WHEEL_MASK, Comms, load


@pytest.fixture(scope="session")
def database() -> Database:
    return load()


@pytest.fixture(scope="session")
def all_wheels() -> Database:
    """Return the same file, loaded so that one DBC decodes all four wheels."""
    return load(WHEEL_MASK)


@pytest.fixture(scope="session")
def comms(tmp_path_factory: pytest.TempPathFactory) -> Comms:
    return Comms(Path(os.environ["HUBFOC_COMMS_LIBRARY"]), tmp_path_factory.mktemp("bare"))
