# SPDX-License-Identifier: Apache-2.0
"""A run in a process of its own, with a limit of time and of memory.

``python -m hubsim.swarm.contained`` reads tasks from standard input, a line of JSON each, forks a
process for each and answers with its record, a line of JSON. It has one thread, so forking is safe.
A process that dies, prints a sanitizer's report, takes too long or needs too much memory leaves a
record with a violation of ``process``.
"""

import json
import os
import resource
import select
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

from hubsim.swarm import judge, work
from hubsim.swarm.work import Record, Task

SECONDS = 300.0  # by the clock
CPU_SECONDS = 120
MEMORY_BYTES = 4 << 30  # of addresses
STACK_LINES = 3
_CHUNK = 1 << 16


def record_of(
    task: Task,
    do: Callable[[Task], Record] = work.done,
    seconds: float = SECONDS,
    memory_bytes: int = MEMORY_BYTES,
) -> Record:
    """Return the record of a run that has its own process."""
    reader, writer = os.pipe()
    began_s = time.monotonic()
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            os.close(reader)
            _child(task, do, writer, printed.fileno(), memory_bytes)
        os.close(writer)
        raw, late = _read(reader, began_s + seconds)
        if late:
            os.kill(child, signal.SIGKILL)
        _, status, used = os.wait4(child, 0)
        printed.seek(0)
        lines = printed.read().decode(errors="replace").splitlines()
    what = f"no end within {seconds:g} s" if late else _ended(status)
    if not what:
        found: Record = json.loads(raw)
        return found
    text = "; ".join([what, *(line.strip() for line in lines[-STACK_LINES:])])
    violation = {
        "invariant": judge.PROCESS, "wheel": None, "time_s": 0.0, "value": 1.0, "limit": 0.0,
        "unit": "1", "text": text, "share": None,
    }  # fmt: skip
    return {
        "seed": task["seed"], "config": task.get("config", ""), "drive": "", "kind": "",
        "image_crc32": None, "worst": {}, "violations": [violation], "coverage": [],
        "cpu_s": used.ru_utime + used.ru_stime,
    }  # fmt: skip


def _ended(status: int) -> str:
    """Return how a process ended; empty: well."""
    code = os.waitstatus_to_exitcode(status)
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    return f"exit status {code}" if code else ""


def _read(reader: int, until_s: float) -> tuple[bytes, bool]:
    """Read to the end or to a time; return what came and whether the time is over."""
    parts: list[bytes] = []
    with os.fdopen(reader, "rb", buffering=0) as pipe:
        while True:
            left_s = until_s - time.monotonic()
            ready, _, _ = select.select([pipe], [], [], max(left_s, 0.0))
            if not ready:
                return b"".join(parts), True
            part = pipe.read(_CHUNK)
            if not part:
                return b"".join(parts), False
            parts.append(part)


def _child(
    task: Task, do: Callable[[Task], Record], writer: int, printed: int, memory_bytes: int
) -> None:
    """Do a task and end; never returns."""
    status = 1
    try:
        os.dup2(printed, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        raw = json.dumps(do(task), allow_nan=False).encode()
        with os.fdopen(writer, "wb") as pipe:
            pipe.write(raw)
        status = 0
    except BaseException as error:
        os.write(2, f"{type(error).__name__}: {error}\n".encode())
    finally:
        os._exit(status)


def serve() -> None:
    """Answer tasks until there are no more."""
    for line in sys.stdin:
        task: Any = json.loads(line)
        print(json.dumps(record_of(task)), flush=True)


if __name__ == "__main__":
    serve()
