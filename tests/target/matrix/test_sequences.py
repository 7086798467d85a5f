# SPDX-License-Identifier: Apache-2.0
"""The trace sequences in the cells that no other test of the preset compiles."""

from pathlib import Path

import matrix
import pytest
from test_pil import with_another_bit

COMPARED_ELSEWHERE = (
    "Cortex-M4 gcc -O2",
    "Cortex-M4 gcc -O0",
    "Cortex-M3 gcc -O2",
    "Cortex-M0+ gcc -Os",
)
"""With x86-64 gcc -O2, by trace_..._is_the_hosts_bit_for_bit (on_qemu.cmake)."""
LINK = "x86-64 gcc -O2"
CELLS = {cell.name: cell for cell in matrix.CELLS if cell.name not in COMPARED_ELSEWHERE}
CHANGED = "Cortex-M4 gcc -Os"


@pytest.fixture(scope="module")
def programs() -> dict[str, Path]:
    return {name: matrix.compiled(cell, "trace") for name, cell in CELLS.items()}


def test_the_other_cells_are_cells_of_the_matrix() -> None:
    assert len(CELLS) + len(COMPARED_ELSEWHERE) == len(matrix.CELLS)
    assert LINK in CELLS


def test_sequences_have_the_hashes_of_gcc_o2_in_every_cell(programs: dict[str, Path]) -> None:
    found = {name: matrix.sequences(CELLS[name], program) for name, program in programs.items()}
    assert found[LINK]
    apart = [f"{cell}: {name}" for cell, hashes in found.items()
             for name in found[LINK].keys() | hashes.keys()
             if hashes.get(name) != found[LINK].get(name)]  # fmt: skip
    assert apart == []


def test_one_bit_of_a_cell_changes_its_hashes(programs: dict[str, Path], tmp_path: Path) -> None:
    program = programs[CHANGED]
    changed = with_another_bit(program, "ANGLE_TABLE", 4 * 100, tmp_path / "changed")
    right, wrong = (matrix.sequences(CELLS[CHANGED], path) for path in (program, changed))
    apart = [name for name in right if wrong.get(name) != right[name]]
    assert len(apart) > 10
