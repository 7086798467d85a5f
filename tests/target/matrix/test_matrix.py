# SPDX-License-Identifier: Apache-2.0
"""The matrix itself: every cell gives the same hashes, and one that differs is found."""

import subprocess
import sys
from pathlib import Path

import matrix
from test_pil import with_another_bit

CORTEX_M4 = next(cell for cell in matrix.CELLS if cell.name == "Cortex-M4 gcc -O2")


def test_every_cell_gives_the_same_hashes_in_whole_scenarios() -> None:
    done = subprocess.run(
        [sys.executable, matrix.__file__, "--whole"], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"in each of {len(matrix.CELLS)} cells, 0 differ" in done.stdout


def test_one_bit_of_a_cell_changes_its_hashes(tmp_path: Path) -> None:
    program = matrix.compiled(CORTEX_M4, "trace")
    changed = with_another_bit(program, "ANGLE_TABLE", 4 * 100, tmp_path / "changed")
    right, wrong = (matrix.sequences(CORTEX_M4, path) for path in (program, changed))
    assert len(right) == 15
    apart = [name.split(",")[0] for name in right if wrong.get(name) != right[name]]
    assert len(apart) > 10
