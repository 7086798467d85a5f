# SPDX-License-Identifier: Apache-2.0
"""The trace sequences in the cell that no build has: 32 bits on the host.

The whole matrix is ``test_matrix.py`` (label ``full``).
"""

import os
from pathlib import Path

import matrix
from test_pil import with_another_bit

HERE, CELL, CORE = (
    next(cell for cell in matrix.CELLS if cell.name == name)
    for name in ("x86-64 gcc -O2", "x86 32-bit gcc -O2", "Cortex-M4 gcc -O2")
)


def sequences_here() -> dict[str, str]:
    """Return the hashes of the host's build."""
    program = Path(os.environ["HUBFOC_BUILD_DIR"], "tests", "target", "hubfoc_trace")
    return matrix.sequences(HERE, program)


def test_sequences_have_the_same_hashes_in_32_bits() -> None:
    right = sequences_here()
    assert len(right) >= 15
    assert matrix.sequences(CELL, matrix.compiled(CELL, "trace")) == right


def test_one_bit_of_a_program_changes_its_hashes(tmp_path: Path) -> None:
    program = Path(os.environ["HUBFOC_TRACE_ELF"])
    changed = with_another_bit(program, "ANGLE_TABLE", 4 * 100, tmp_path / "changed")
    wrong = matrix.sequences(CORE, changed)
    apart = [name for name, right in sequences_here().items() if wrong.get(name) != right]
    assert len(apart) > 10
