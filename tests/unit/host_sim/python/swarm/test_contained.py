# SPDX-License-Identifier: Apache-2.0
"""A run that crashes, hangs or eats memory is a violation with its seed."""

import faulthandler
import os
import signal
import time
from typing import Any

import pytest
from hubsim.swarm import contained
from hubsim.swarm.work import Record, Task

TASK: Task = {"seed": 17, "drives": 4, "healthy": False}


def good(task: Task) -> Record:
    return {"seed": task["seed"], "violations": []}


def crash(_task: Task) -> Record:
    faulthandler.disable()  # pytest's own report of the crash
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def report(_task: Task) -> Record:
    os.write(2, b"runtime error: signed integer overflow\n")
    os._exit(23)


def hang(_task: Task) -> Record:
    time.sleep(60.0)
    raise AssertionError


def eat(_task: Task) -> Record:
    return {"seed": len(bytearray(1 << 40)), "violations": []}


def mistake(_task: Task) -> Record:
    raise ValueError("no such thing")


def infinite(_task: Task) -> Record:
    return {"seed": float("inf"), "violations": []}


def test_a_good_run_gives_its_record() -> None:
    assert contained.record_of(TASK, good) == {"seed": 17, "violations": []}


@pytest.mark.parametrize(
    ("do", "text"),
    [
        (crash, "ended by SIGSEGV"),
        (report, "exit status 23; runtime error: signed integer overflow"),
        (hang, "no end within 0.3 s"),
        (eat, "MemoryError"),
        (mistake, "ValueError: no such thing"),
        (infinite, "ValueError: Out of range float"),
    ],
)
def test_what_does_not_end_well_is_a_violation(do: Any, text: str) -> None:  # noqa: ANN401
    began_s = time.monotonic()
    found = contained.record_of(TASK, do, seconds=0.3 if do is hang else 30.0)
    assert time.monotonic() - began_s < 20.0
    (violation,) = found["violations"]
    assert violation["invariant"] == "process"
    assert text in violation["text"]
    assert found["seed"] == 17


def test_the_caller_goes_on_unharmed() -> None:
    for do in (crash, good):
        found = contained.record_of(TASK, do)
    assert found == good(TASK)
