# SPDX-License-Identifier: Apache-2.0
"""``hubsim swarm`` as a user calls it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hubsim_command import Hubsim

FEW = ("--drives", "4", "--workers", "1")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--seeds", "5:5"), "A below B"),
        (("--seeds", "x"), "A:B"),
        (("--hours", "0"), "above 0"),
        (("--seed", "-1"), "--seed"),
        (("--drives", "0"), "1 to 400"),
        (("--drives", "401"), "1 to 400"),
        (("--seed", "1", "--seeds", "0:2"), "not allowed"),
        (("--reduce", "1"), "both or neither"),
        (("-o", "s.toml"), "both or neither"),
        (("--reduce", "1", "-o", "s.txt"), ".toml"),
        (("--json", "s.txt"), ".json"),
        (("--seed", "1", "--output", "d"), "--seeds or --hours"),
        (("--config", "lu2013"), "with --scenario"),
        (("--scenario", "missing.toml"), "file not found"),
        (("--helthy",), "--healthy"),
    ],
)
def test_a_wrong_call_is_refused_in_one_line(
    hubsim: Hubsim, arguments: tuple[str, ...], words: str
) -> None:
    done = hubsim("swarm", *arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert done.stdout == ""


def test_runs_are_kept_and_not_made_again(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim("swarm", "--seeds", "0:3", *FEW, "--output", "kept", "--json", "all.json")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-3].startswith("3 runs, 0 with a violation")
    runs = tmp_path / "kept" / "runs.jsonl"
    before, whole = runs.read_bytes(), json.loads((tmp_path / "all.json").read_bytes())
    assert len(before.splitlines()) == whole["runs"] == 3
    runs.write_bytes(before + before.splitlines()[0][:40])  # a line that was cut off
    again = hubsim("swarm", "--seeds", "0:3", *FEW, "--output", "kept", "--json", "again.json")
    assert again.stdout == done.stdout
    assert runs.read_bytes().startswith(before)
    assert json.loads((tmp_path / "again.json").read_bytes()) == whole
    more = hubsim("swarm", "--seeds", "2:4", *FEW, "--output", "kept")
    assert "2 runs, " in more.stdout
    other = hubsim("swarm", "--seeds", "0:3", "--healthy", *FEW, "--output", "kept")
    assert other.returncode == 2
    assert "another commit, engine or options" in other.stderr


def test_one_seed_shows_what_it_came_to_and_is_the_same_every_time(hubsim: Hubsim) -> None:
    first, second = (hubsim("swarm", "--seed", "1", "--drives", "4") for _ in range(2))
    assert first.returncode == second.returncode == 0
    lines = [line for line in first.stdout.splitlines() if "processor time" not in line]
    assert lines == [line for line in second.stdout.splitlines() if "processor time" not in line]
    assert any(line.startswith("  stopping_distance: ") for line in lines)


def test_a_seed_that_violates_nothing_is_not_reduced(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim("swarm", "--reduce", "1", "--drives", "4", "-o", "s.toml")
    assert (done.returncode, done.stdout) == (0, "seed 1 violates nothing\n")
    assert not (tmp_path / "s.toml").exists()


def test_ctrl_c_keeps_finished_runs_and_ends_every_process(tmp_path: Path) -> None:
    options = ("--seeds", "0:1000", *FEW, "--output", "kept")
    command = (sys.executable, "-m", "hubsim", "swarm", *options)
    runs = tmp_path / "kept" / "runs.jsonl"
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:  # fmt: skip
        until_s = time.monotonic() + 120.0
        while not (runs.is_file() and runs.stat().st_size) and time.monotonic() < until_s:
            time.sleep(0.05)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    last = error.splitlines()[-1]
    assert last == "hubsim: interrupted; the same command goes on where it stopped"
    assert "Traceback" not in error
    assert all(json.loads(line)["violations"] == [] for line in runs.read_text().splitlines())
    assert children
    assert not any(_runs(int(child)) for child in children)


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True
