# SPDX-License-Identifier: Apache-2.0
from pathlib import Path
from typing import TextIO

import pytest
from hubsim import files
from hubsim.errors import HubsimError


def test_a_file_replaces_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    path.write_text("old", encoding="utf-8")
    files.write_text(path, "new\n")
    assert path.read_text(encoding="utf-8") == "new\n"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_half_way_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    path.write_text("old", encoding="utf-8")

    def fail(file: TextIO) -> None:
        file.write("half of it")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError, match="power cut"):
        files.write_with(path, fail)
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_places_that_cannot_be_written_are_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match="no directory"):
        files.check_writable(tmp_path / "none" / "out.txt")
    with pytest.raises(HubsimError, match="is a directory"):
        files.check_writable(tmp_path)
