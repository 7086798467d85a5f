# SPDX-License-Identifier: Apache-2.0
"""Many runs: servers that contain them, records as they come, and where they are kept.

``DIR/runs.jsonl`` has a line for every run that is done, ``DIR/swarm.json`` says what they are of:
commit, engine, options. The same command goes on where an interrupted one stopped.
"""

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.swarm.work import Record, Task

NOTE, RUNS = "swarm.json", "runs.jsonl"
ENDS_S = 5.0  # that a server has to end

Shown = Callable[[Record], None]


class Server:
    """A process that makes one run after another, each in a process of its own."""

    def __init__(self) -> None:
        command = (sys.executable, "-m", "hubsim.swarm.contained")
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )
        self._left = b""

    def begin(self, task: Task) -> None:
        """Hand a task over."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(task).encode() + b"\n")
            self._process.stdin.flush()
        except BrokenPipeError as error:
            raise HubsimError("swarm: a process that makes runs has ended") from error

    def fileno(self) -> int:
        """Return what becomes readable when an answer comes."""
        assert self._process.stdout is not None
        return self._process.stdout.fileno()

    def answer(self) -> Record | None:
        """Return the record that has come, None until it is whole."""
        part = os.read(self.fileno(), 1 << 20)
        if not part:
            raise HubsimError("swarm: a process that makes runs has ended")
        self._left += part
        line, end, left = self._left.partition(b"\n")
        if not end:
            return None
        self._left = left
        found: Record = json.loads(line)
        return found

    def end(self) -> None:
        """End it, and the run that it makes."""
        with ExitStack() as stack:
            stack.callback(self._process.wait)
            try:
                os.killpg(self._process.pid, 9)
            except ProcessLookupError:
                return


@contextmanager
def servers(count: int) -> Iterator[list[Server]]:
    """Provide servers that end with the block."""
    with ExitStack() as stack:
        found = []
        for _ in range(count):
            server = Server()
            stack.callback(server.end)
            found.append(server)
        yield found


def records(tasks: Iterable[Task], workers: int, until_s: float = float("inf")) -> Iterator[Record]:
    """Yield records as they come; no task begins after a time (``time.monotonic``)."""
    waiting = iter(tasks)
    with servers(workers) as idle:
        busy: list[Server] = []

        def feed() -> None:
            while idle and time.monotonic() < until_s:
                task = next(waiting, None)
                if task is None:
                    return
                idle[-1].begin(task)
                busy.append(idle.pop())

        feed()
        while busy:
            ready, _, _ = select.select(busy, [], [])
            for server in ready:
                found = server.answer()
                if found is not None:
                    busy.remove(server)
                    idle.append(server)
                    yield found
            feed()


class Kept:
    """Records in a directory."""

    def __init__(self, directory: Path, described: Mapping[str, Any]) -> None:
        self._directory, self._described = directory, dict(described)

    def open(self) -> dict[int, Record]:
        """Begin, or go on; return the records that are there, by seed."""
        files.make_directory(self._directory)
        note, runs = self._directory / NOTE, self._directory / RUNS
        if note.is_file():
            if _read(note) != self._described:
                raise HubsimError(f"{note}: holds runs of another commit, engine or options, "
                                  "accepted: another --output")  # fmt: skip
        else:
            files.write_text(note, json.dumps(self._described, indent=2) + "\n")
        return {record["seed"]: record for record in _lines(runs)} if runs.is_file() else {}

    def put(self, record: Record) -> None:
        """Keep a record: a line that is there whole, or is left out when it is read."""
        try:
            with (self._directory / RUNS).open("a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
        except OSError as error:
            raise HubsimError(f"{self._directory / RUNS}: {error.strerror}") from error

    def scenario(self, seed: int, text: str) -> str:
        """Write the scenario of a seed that failed; return its path."""
        path = self._directory / f"seed{seed}.toml"
        files.write_text(path, text)
        return str(path)


def _read(note: Path) -> object:
    try:
        return json.loads(files.read_text(note))
    except (ValueError, RecursionError):
        return None


def _lines(runs: Path) -> Iterator[Record]:
    """Yield whole lines; the last one may have been cut off."""
    for line in files.read_text(runs).splitlines():
        try:
            yield json.loads(line)
        except ValueError:
            continue
