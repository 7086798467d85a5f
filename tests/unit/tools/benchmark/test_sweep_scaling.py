# SPDX-License-Identifier: Apache-2.0
"""The measurement of a sweep's scaling executes the stated runs.

The speed of the machine is not tested.
"""

import json
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[4] / "tools" / "benchmark" / "sweep_scaling.py"


def call(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(SCRIPT), *arguments],
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )


def test_one_and_two_workers_give_the_same_table() -> None:
    done = call("--runs", "8", "--workers", "2", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["one"]["workers"], found["more"]["workers"]) == (1, 2)
    assert found["one"]["runs"] == found["more"]["runs"] == 8
    assert found["same_table"] is True
    assert found["ratio"] > 0.0


def test_too_few_runs_for_a_throughput_are_refused() -> None:
    done = call("--runs", "4")
    assert done.returncode == 2
    assert "accepted: --runs from 8" in done.stderr
