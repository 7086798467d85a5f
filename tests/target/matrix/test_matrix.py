# SPDX-License-Identifier: Apache-2.0
"""The whole matrix: every cell gives the same hashes."""

import subprocess
import sys

import matrix


def test_every_cell_gives_the_same_hashes_in_whole_scenarios() -> None:
    done = subprocess.run(
        [sys.executable, matrix.__file__, "--whole"], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"in each of {len(matrix.CELLS)} cells, 0 differ" in done.stdout
