# SPDX-License-Identifier: Apache-2.0
"""The other drawn motors whose iron saturates (`test_drawn_saturating.py` has the first ones)."""

from pathlib import Path

import drawn_torque
import pytest


@pytest.mark.parametrize("number", drawn_torque.NUMBERS[3:])
def test_every_other_drawn_motor_makes_the_torque_that_is_commanded(
    number: int, tmp_path: Path
) -> None:
    assert list(drawn_torque.misses(number, tmp_path)) == []
