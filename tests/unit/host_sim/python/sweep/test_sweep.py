# SPDX-License-Identifier: Apache-2.0
"""Sweeps as a user makes them.

The table does not depend on how it was computed, and its runs equal those of ``hubsim run``.
"""

import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hubsim.cli import DEFAULT_CONFIG
from hubsim.errors import HubsimError
from hubsim.sweep import conduct, plan, store, work

Hubsim = Callable[..., subprocess.CompletedProcess[str]]
PROGRESS = re.compile(r"\d+ s: \w+ 0 of 400 runs")  # of a machine that starts its workers slowly
QUICK = ("--set", "initial_speed_kmh=5", "--set", "drag=false")
JOB = work.Job(
    "stop",
    DEFAULT_CONFIG,
    None,
    ("initial_speed_kmh=5", "drag=false"),
    (("peak_a", "max(-battery.current_a)"),),
)
PLAN = plan.make(
    ["demand_nm=20,40,60", "plant.motor.phase_resistance_ohm=normal(0.031,0.002)"], 3, 5
)


def fresh(directory: Path, name: str) -> store.Store:
    return store.Store(directory / name, {"what": "test"}, "0123")


def test_a_row_equals_the_result_of_hubsim_run(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim(
        "sweep",
        "stop",
        *QUICK,
        "--vary",
        "demand_nm=20,60",
        "--vary",
        "brake.strategy=series_optimal,parallel_ratio",
        "--collect",
        "peak_a=max(-battery.current_a)",
        "--output",
        "out.parquet",
        "--workers",
        "2",
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "4 runs over demand_nm, brake.strategy: out.parquet",
        "4 of 4 met every criterion",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.parquet"]
    row = pq.read_table(tmp_path / "out.parquet").to_pylist()[3]
    assert (row["run"], row["demand_nm"], row["brake.strategy"], row["passed"]) == (
        3,
        60,
        "parallel_ratio",
        True,
    )
    assert (
        hubsim(
            "run",
            "stop",
            *QUICK,
            "--set",
            "demand_nm=60",
            "--strategy",
            "parallel_ratio",
            "--json",
            "one.json",
        ).returncode
        == 0
    )
    one = json.loads((tmp_path / "one.json").read_text(encoding="utf-8"))
    assert row["battery_returned_j"] == one["energy_j"]["battery_returned"]
    assert row["distance_m"] == one["distance_m"]
    assert row["criteria.distance"] == one["criteria"][0]["value"]
    assert row["peak_a"] > 0.0
    assert row["error"] is None


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the bytes of an uninterrupted sweep on one worker."""
    directory = tmp_path_factory.mktemp("whole")
    conduct.conduct(JOB, PLAN, fresh(directory, "a.parquet"), processes=1)
    return (directory / "a.parquet").read_bytes()


def test_results_do_not_depend_on_the_number_of_workers(tmp_path: Path, whole: bytes) -> None:
    table = conduct.conduct(JOB, PLAN, fresh(tmp_path, "a.parquet"), processes=2)
    assert table.num_rows == PLAN.runs == 9
    assert table["run"].to_pylist() == list(range(9))
    assert (tmp_path / "a.parquet").read_bytes() == whole


def test_resumed_sweep_gives_the_same_bytes(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = fresh(tmp_path, "a.parquet")
    assert begun.open() == set()
    parts = conduct.batches(PLAN)
    begun.put(1, work.do(JOB, *parts[1]))
    seen: list[int] = []
    again = fresh(tmp_path, "a.parquet")
    conduct.conduct(JOB, PLAN, again, processes=1, progress=lambda done, _: seen.append(done))
    assert seen[0] == len(parts[1][0])  # completed runs are not repeated
    assert len(seen) == len(parts)
    assert (tmp_path / "a.parquet").read_bytes() == whole
    assert list(tmp_path.iterdir()) == [tmp_path / "a.parquet"]


def test_runs_can_be_executed_by_an_external_scheduler(tmp_path: Path, whole: bytes) -> None:
    with conduct.workers(None, 1) as client:
        address = str(client.scheduler_info()["address"])
        conduct.conduct(JOB, PLAN, fresh(tmp_path, "a.parquet"), address=address)
    assert (tmp_path / "a.parquet").read_bytes() == whole


def test_two_concurrent_sweeps_are_independent() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with conduct.workers(None, 1) as one, conduct.workers(None, 1) as other:
            assert one.submit(int, "1").result() + other.submit(int, "2").result() == 3


def test_sweep_interrupted_by_control_c_can_be_resumed(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "hubsim",
        "sweep",
        "stop",
        "--vary",
        "demand_nm=range(8,9,400)",
        "--workers",
        "1",
        "--output",
        "out.parquet",
    ]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        parts = tmp_path / "out.parquet.parts"
        deadline = time.monotonic() + 100.0
        while (
            not list(parts.glob("0*.parquet"))
            and time.monotonic() < deadline
            and running.poll() is None
        ):
            time.sleep(0.2)
        running.send_signal(signal.SIGINT)
        _, printed = running.communicate(timeout=60)
    assert running.returncode == 130
    assert "the same command goes on where it stopped" in printed
    assert list(parts.glob("0*.parquet"))
    assert not (tmp_path / "out.parquet").exists()


def children_of(process: int) -> set[str]:
    """Return the identifiers of the processes that one has started, at any depth."""
    parents = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # which ended meanwhile
            parents[stat.parent.name] = stat.read_text().rpartition(")")[2].split()[1]
    found, last = {str(process)}, set[str]()
    while found != last:
        last = found
        found = found | {child for child, parent in parents.items() if parent in found}
    return found - {str(process)}


@pytest.mark.parametrize(
    "arguments",
    [
        ("sweep", "stop", "--vary", "demand_nm=range(2,3,400)", "--output", "out.parquet"),
        ("stops", "--count", "400", "--output", "stops"),
        ("faults", "--reduced"),
    ],
)
def test_control_c_while_workers_start_is_one_line(
    tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    """A terminal sends it to the workers too, which are loading Python then."""
    command = [sys.executable, "-m", "hubsim", *arguments, "--workers", "2"]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    ) as running:  # fmt: skip
        deadline = time.monotonic() + 100.0
        while len(children_of(running.pid)) < 2 and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.1)
        os.killpg(running.pid, signal.SIGINT)
        printed = "".join(running.communicate(timeout=100))
    assert running.returncode == 130
    lines = [line for line in printed.splitlines() if not PROGRESS.fullmatch(line)]
    assert lines in (
        ["hubsim: interrupted"],
        ["hubsim: interrupted; the same command goes on where it stopped"],
    )


def test_a_machine_whose_processes_cannot_reach_each_other_is_told_what_works(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(101, "Network is unreachable")

    monkeypatch.setattr(socket, "create_connection", refuse)
    with pytest.raises(HubsimError, match=r"Network is unreachable.*accepted: --workers 1"):
        conduct.conduct(JOB, PLAN, fresh(tmp_path, "a.parquet"))


def test_a_failed_run_is_reported_with_its_cause_and_the_others_continue(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim(
        "sweep",
        "stop",
        *QUICK,
        "--vary",
        "motor.d_inductance_h=76e-6,2.0",
        "--vary",
        "demand_nm=40",
        "--output",
        "out.parquet",
        "--workers",
        "1",
    )
    assert done.returncode == 1
    rows = pq.read_table(tmp_path / "out.parquet").to_pylist()
    assert rows[0]["error"] is None
    assert "inductance" in rows[1]["error"]
    assert "1 could not be run, the first because" in done.stdout


def test_partial_results_of_another_sweep_are_refused(tmp_path: Path, hubsim: Hubsim) -> None:
    fresh(tmp_path, "out.parquet").open()
    arguments = (
        "sweep",
        "stop",
        *QUICK,
        "--vary",
        "demand_nm=40,50",
        "--output",
        "out.parquet",
        "--workers",
        "1",
    )
    refused = hubsim(*arguments)
    assert refused.returncode == 2
    assert (
        "out.parquet.parts: holds parts of another sweep, accepted: the same command, another "
        "--output or --restart" in refused.stderr
    )
    assert hubsim(*arguments, "--restart").returncode == 0
    assert (tmp_path / "out.parquet").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("--vary", "demand_mn=1,2"),
            "hubsim: --set demand_mn: unknown key, did you mean demand_nm?",
        ),
        (
            ("--vary", "plant.road.slop=0,1"),
            "--set plant.road.slop: unknown key, did you mean plant.road.slope?",
        ),
        (
            ("--vary", "demand_nm=1,2", "--collect", "peak"),
            "--collect 'peak': accepted: COLUMN=FORMULA",
        ),
        (
            ("--vary", "demand_nm=1,2", "--collect", "p=max(battery.amps)"),
            "--collect p: no quantity 'battery.amps'",
        ),
        (
            ("--vary", "demand_nm=1,2", "--workers", "0"),
            "--workers 0: accepted: a whole number from 1",
        ),
        (
            ("--vary", "demand_nm=1,2", "--output", "none/out.parquet"),
            "none/out.parquet: no directory ",
        ),
        (
            ("--vary", "demand_nm=1,2", "--scheduler", "tcp://localhost:1"),
            "--scheduler tcp://localhost:1: no Dask scheduler answers there",
        ),
    ],
)
def test_an_error_is_one_line_before_the_first_run(
    hubsim: Hubsim, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    output = () if "--output" in arguments else ("--output", "out.parquet")
    done = hubsim("sweep", "stop", *QUICK, *arguments, *output)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_column_of_mixed_types_is_converted_to_one_type() -> None:
    table = store.as_table(
        [{"run": 0, "a": 1, "b": True, "c": None}, {"run": 1, "a": 2.5, "b": "x", "d": 3}]
    )
    assert table.schema.field("a").type == pa.float64()
    assert table.to_pylist() == [
        {"run": 0, "a": 1.0, "b": "True", "c": None, "d": None},
        {"run": 1, "a": 2.5, "b": "x", "c": None, "d": 3},
    ]
