# SPDX-License-Identifier: Apache-2.0
"""What a long command shows where there is no terminal."""

import time

import pytest
from hubsim import progress
from hubsim.words import counted


def test_without_a_terminal_a_line_tells_how_far_the_tasks_are(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.05)
    with progress.shown("runs") as bars:
        task = bars.add_task("stop", total=None)
        done = bars.add_task("other", total=3)
        bars.update(task, completed=4, total=9)
        bars.update(done, completed=3)
        time.sleep(0.4)
    lines = capsys.readouterr().err.splitlines()
    assert 1 <= len(lines) <= 3  # after 0.05, 0.15 and 0.35 s
    assert set(lines) == {"0 s: stop 4 of 9 runs"}


def test_a_short_command_shows_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert progress.FIRST_S == 2.0
    begun = time.monotonic()
    with progress.shown() as bars:
        bars.add_task("stop", total=3)
    assert time.monotonic() - begun < 1.0
    assert capsys.readouterr().err == ""


def test_one_thing_is_no_plural() -> None:
    assert [counted(number, "wheel") for number in (0, 1, 4)] == ["0 wheels", "1 wheel", "4 wheels"]
