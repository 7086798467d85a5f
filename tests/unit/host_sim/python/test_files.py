# SPDX-License-Identifier: Apache-2.0
"""Outputs of the command: an existing file is unchanged or replaced as a whole.

The devices are safe to write to: /dev/full and /dev/null keep nothing. Their identity is compared
before and after, and a test that would replace one works on a link in its own directory.
"""

import csv
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path
from typing import TextIO

import hubsim
import pyarrow.parquet as pq
import pytest
from hubsim import cli, files
from hubsim.errors import HubsimError

STOP = (
    "run",
    "stop",
    "--set",
    "initial_speed_kmh=2",
    "--set",
    "demand_nm=60",
    "--signals",
    "time_s,vehicle.*",
)
OLD = "old content\n"


def identity(path: Path) -> tuple[int, int, int, int]:
    """Return the identity of a file, which a replacement does not have."""
    found = path.lstat()
    return found.st_dev, found.st_ino, stat.S_IFMT(found.st_mode), found.st_rdev


def call(*arguments: str | Path) -> int:
    return cli.main([str(argument) for argument in arguments])


def test_an_existing_file_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    path.write_text(OLD, encoding="utf-8")
    files.write_text(path, "new\n")
    assert path.read_text(encoding="utf-8") == "new\n"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_while_writing_leaves_only_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    path.write_text(OLD, encoding="utf-8")

    def fail(file: TextIO) -> None:
        file.write("half of it")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError, match="power cut"):
        files.write_with(path, fail)
    assert path.read_text(encoding="utf-8") == OLD
    assert list(tmp_path.iterdir()) == [path]


def test_unwritable_paths_are_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match="no directory"):
        files.check_writable(tmp_path / "none" / "out.txt")
    with pytest.raises(HubsimError, match="is a directory"):
        files.check_writable(tmp_path)


@pytest.mark.parametrize("kind", ["csv", "json", "parquet", "mdf", "layout"])
def test_a_full_device_is_an_error_in_one_line_and_stays_a_device(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    device = Path("/dev/full")
    before = identity(device)
    link = tmp_path / "out"
    link.symlink_to(device)
    other = () if kind != "json" else ("--csv", tmp_path / "a.csv")
    assert call(*STOP, f"--{kind}", link, *other) == 2
    assert (
        capsys.readouterr().err == f"hubsim: {link}: cannot be written: No space left on device\n"
    )
    assert (identity(device), link.readlink()) == (before, device)


@pytest.mark.parametrize("kind", ["csv", "parquet", "mdf", "layout"])
def test_the_null_device_accepts_any_output_and_stays_a_device(kind: str) -> None:
    device = Path("/dev/null")
    before = identity(device)
    assert call(*STOP, "--json", device, f"--{kind}", device) == 0
    assert identity(device) == before


def test_output_to_a_fifo_is_written_and_the_fifo_kept(tmp_path: Path) -> None:
    fifo = tmp_path / "out.csv"
    os.mkfifo(fifo)
    before = identity(fifo)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(fifo.read_text(encoding="utf-8")))
    reader.start()
    assert call(*STOP, "--csv", fifo) == 0
    reader.join(timeout=60)
    assert identity(fifo) == before
    assert call(*STOP, "--csv", tmp_path / "plain.csv") == 0
    assert read == [(tmp_path / "plain.csv").read_text(encoding="utf-8")]


@pytest.mark.parametrize("existing", [True, False])
def test_a_link_is_kept_and_its_target_replaced(tmp_path: Path, existing: bool) -> None:
    (tmp_path / "elsewhere").mkdir()
    target, link = tmp_path / "elsewhere" / "target.csv", tmp_path / "link.csv"
    link.symlink_to(Path("elsewhere") / "target.csv")
    if existing:
        target.write_text(OLD, encoding="utf-8")
        target.chmod(0o640)
    assert call(*STOP, "--csv", link) == 0
    assert link.readlink() == Path("elsewhere/target.csv")
    assert target.read_text(encoding="utf-8").startswith("time_s,")
    if existing:
        assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert sorted(tmp_path.rglob("*")) == sorted([link, target, target.parent])


def test_a_failed_run_leaves_every_output_unchanged(tmp_path: Path) -> None:
    outputs = {kind: tmp_path / f"out.{kind}" for kind in ("csv", "json", "parquet", "mdf")}
    for path in outputs.values():
        path.write_text(OLD, encoding="utf-8")
    named = [part for kind, path in outputs.items() for part in (f"--{kind}", path)]
    assert call("run", "stop", "--set", "motor.pole_pairs=0", *named) == 2
    assert {path.read_text(encoding="utf-8") for path in outputs.values()} == {OLD}
    assert sorted(tmp_path.iterdir()) == sorted(outputs.values())


def test_one_file_for_two_outputs_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "out"
    assert call(*STOP, "--csv", path, "--json", path) == 2
    assert "named for two outputs" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_closed_standard_output_is_an_error_in_one_line() -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        command = [sys.executable, "-m", "hubsim", "list"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "hubsim: standard output: No space left on device\n"


def test_a_sweep_writes_csv_to_a_name_that_ends_in_csv(tmp_path: Path) -> None:
    sweep = ("sweep", "stop", "--set", "initial_speed_kmh=2", "--vary", "demand_nm=60,80")
    workers = ("--workers", "1")
    assert call(*sweep, "--output", tmp_path / "g.csv", *workers) == 0
    assert call(*sweep, "--output", tmp_path / "g.parquet", *workers) == 0
    table = pq.read_table(tmp_path / "g.parquet")
    with (tmp_path / "g.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    assert head == table.column_names
    for name, values in table.to_pydict().items():
        column = [row[head.index(name)] for row in rows]
        for text, value in zip(column, values, strict=True):
            if isinstance(value, float):
                assert float(text) == value, name
            else:
                assert text == ("" if value is None else str(value).lower()
                                if isinstance(value, bool) else str(value)), name  # fmt: skip
    assert len(rows) == 2


@pytest.mark.parametrize("name", ["g", "g.txt", "g.json"])
def test_a_sweep_refuses_an_unsupported_format(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    path = tmp_path / name
    assert call("sweep", "stop", "--vary", "demand_nm=60,80", "--output", path) == 2
    assert capsys.readouterr().err == (
        f"hubsim: {path}: accepted: a name that ends in .parquet or .csv\n"
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "{input}.toml"),
        ("run", "stop", "--config", "{input}.toml"),
        ("run", "stop", "--set", "cycle={input}.csv"),
        ("compare", "{input}.json", "stop"),
        ("compare", "{input}.csv", "stop"),
        ("compare", "{input}.parquet", "stop"),
        ("report", "{input}.json", "-o", "page.html"),
        ("sweep", "{input}.toml", "--vary", "demand_nm=60,80", "--output", "g.csv"),
    ],
)
@pytest.mark.parametrize("kind", ["binary", "directory", "zeros", "device"])
def test_binary_input_is_an_error_in_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    kind: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    name = next(a for a in arguments if "{input}" in a).partition("{input}")[2]
    path = tmp_path / f"input{name}"
    if kind == "directory":
        path.mkdir()
    elif kind == "device":
        path.symlink_to("/dev/null")
    else:
        path.write_bytes(bytes(range(256)) if kind == "binary" else bytes(1000))
    filled = [a.replace("{input}", str(tmp_path / "input")) for a in arguments]
    assert call(*filled) == 2
    error = capsys.readouterr().err
    assert error.startswith("hubsim: ")
    # A drive without a section has one line a section; everything else is one mistake.
    assert error.count("\n") == error.count(str(path)) or error.count("\n") == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_byte_order_mark_is_ignored(tmp_path: Path) -> None:
    scenario = "initial_speed_kmh = 2.0\ndemand_nm = 60.0\nstop_at_standstill = true\n"
    drive = cli.DEFAULT_CONFIG.read_text(encoding="utf-8")
    for encoding in ("utf-8", "utf-8-sig"):
        directory = tmp_path / encoding
        directory.mkdir()
        (directory / "mine.toml").write_text(scenario, encoding=encoding)
        (directory / "lu2013.toml").write_text(drive, encoding=encoding)
        outputs = ("--csv", directory / "out.csv")
        assert (
            call("run", directory / "mine.toml", "--config", directory / "lu2013.toml", *outputs)
            == 0
        )
        if encoding == "utf-8-sig":
            marked = (directory / "out.csv").read_bytes()
            (directory / "out.csv").write_bytes(b"\xef\xbb\xbf" + marked)
    plain, marked_path = (tmp_path / e / "out.csv" for e in ("utf-8", "utf-8-sig"))
    assert marked_path.read_bytes() == b"\xef\xbb\xbf" + plain.read_bytes()
    assert call("compare", plain, marked_path) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"demand": 4}, "demand: unknown key, did you mean demand_nm?"),
        ({"scenario": "stop", "demand": 4}, "demand: unknown key, did you mean demand_nm?"),
        ({"demand_nm": "much"}, "demand_nm: 'much' is not accepted, accepted: a number from 0"),
        ({"demand_nm": 4.0}, "drive: missing, accepted: a drive's .toml file or name"),
        ({"drive": "/", "demand_nm": 4.0}, "/: is a directory"),
        ({"drive": cli.DEFAULT_CONFIG, "scenario": 5}, "no scenario '5', accepted: "),
    ],
)
def test_the_error_for_invalid_arguments_of_bench_lists_the_accepted_ones(
    arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(HubsimError) as caught:
        hubsim.Bench(**arguments)  # type: ignore[arg-type]
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)
