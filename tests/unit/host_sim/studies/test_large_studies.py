# SPDX-License-Identifier: Apache-2.0
"""Every study of drawn cases as a whole: what it asks for holds for the firmware as it is."""

from pathlib import Path

import pytest
from studies import __main__ as command


@pytest.mark.parametrize(
    "name", ["blend_out", "coast", "edges", "envelope", "healthy", "stored_share"]
)
def test_a_whole_study_holds(name: str, tmp_path: Path) -> None:
    assert command.main([name, "-o", str(tmp_path)]) == 0
