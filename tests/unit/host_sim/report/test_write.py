# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest
from hubsim.errors import HubsimError
from hubsim.report import write_report

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_vehicle import three


def test_the_page_is_the_only_file_written(tmp_path: Path) -> None:
    directory = tmp_path / "build" / "report"
    write_report(three(), directory)
    assert [path.name for path in directory.iterdir()] == ["index.html"]
    text = (directory / "index.html").read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>")
    documents.read(text)


def test_an_existing_page_is_replaced_and_other_files_are_unchanged(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("old", encoding="utf-8")
    (tmp_path / "summary.json").write_text("{}", encoding="utf-8")
    write_report(three(), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.html", "summary.json"]
    assert "old" not in (tmp_path / "index.html").read_text(encoding="utf-8")[:10]
    assert (tmp_path / "summary.json").read_text(encoding="utf-8") == "{}"


def test_a_directory_that_cannot_be_created_is_an_error_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("here", encoding="utf-8")
    with pytest.raises(HubsimError, match=r"report: cannot be made: ") as caught:
        write_report(three(), tmp_path / "file" / "report")
    assert "\n" not in str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_page_that_cannot_be_replaced_leaves_no_partial_file(tmp_path: Path) -> None:
    (tmp_path / "index.html" / "inside").mkdir(parents=True)
    with pytest.raises(HubsimError, match="is a directory"):
        write_report(three(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["index.html"]


def test_an_empty_list_of_runs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match="accepted: at least one"):
        write_report([], tmp_path)
    assert not list(tmp_path.iterdir())
