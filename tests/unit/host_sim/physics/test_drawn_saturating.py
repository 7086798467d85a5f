# SPDX-License-Identifier: Apache-2.0
"""Drawn motors whose iron saturates make the torque that is commanded, without a fault."""

from pathlib import Path

import drawn_torque
import pytest


@pytest.mark.parametrize("number", drawn_torque.NUMBERS[:2])
def test_a_drawn_motor_makes_the_torque_that_is_commanded(number: int, tmp_path: Path) -> None:
    assert list(drawn_torque.misses(number, tmp_path)) == []
