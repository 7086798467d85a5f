# SPDX-License-Identifier: Apache-2.0
"""A test on the emulator that is killed leaves no emulator running."""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from dev_fixture import ROOT, write_program

SCRIPT = ROOT / "tests/target/run_on_qemu.cmake"
LONGEST_WAIT_S = 20.0


def is_running(process: int) -> bool:
    """Return False for a process that has ended or is a zombie."""
    try:
        status = Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except OSError:
        return False
    return status.rpartition(")")[2].split()[0] != "Z"


def wait_until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + LONGEST_WAIT_S
    while time.monotonic() < end and not condition():
        time.sleep(0.02)


def test_the_emulator_is_terminated_when_its_test_ends(tmp_path: Path) -> None:
    number = tmp_path / "number"
    emulator = tmp_path / "qemu"
    # It records its process number and continues, ignoring every signal that can be ignored.
    write_program(
        emulator,
        f"#!/bin/sh\ntrap '' TERM INT HUP\necho $$ > {number}.new\nmv {number}.new {number}\n"
        "while :; do sleep 0.1; done\n",
    )  # fmt: skip
    test = subprocess.Popen(
        ["cmake", f"-DQEMU={emulator}", "-DELF=none", "-DLIMIT=none", "-P", str(SCRIPT)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        wait_until(number.exists)
        emulated = int(number.read_text(encoding="utf-8"))
        assert is_running(emulated)
    finally:
        test.kill()
        test.wait()
    wait_until(lambda: not is_running(emulated))
    try:
        assert not is_running(emulated)
    finally:
        if is_running(emulated):
            os.kill(emulated, signal.SIGKILL)
