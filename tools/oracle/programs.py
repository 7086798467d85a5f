# SPDX-License-Identifier: Apache-2.0
"""The oracle's C programs (tests/oracle/program.h says what they print)."""

import os
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

from oracle.baseline import ROOT, Hashes, OracleError

_BUILD = Path(os.environ.get("HUBFOC_BUILD_DIR", ROOT / "build" / "host"))
BUILT = Path(os.environ.get("HUBFOC_ORACLE_DIR", _BUILD / "tests" / "oracle"))
_ENTRY = re.compile(r"entry (.*): (\w{16}) (\w{16}) (\w{16}) (\w{16}) (\d+) (\d+)")
_REACHED = re.compile(r"reached (\w+) (\d+): (\d+)")

Reached = dict[tuple[str, int], int]


def run(
    program: str, arguments: Sequence[object] = (), with_bytes: bool = False
) -> tuple[dict[str, Hashes], Reached]:
    """Run a program; return its entries by name and what they reached."""
    path = BUILT / f"oracle_{program}"
    try:
        done = subprocess.run(
            [path, *map(str, arguments)], capture_output=True, text=True, check=False
        )
    except OSError as error:
        raise OracleError(f"{path}: cannot be run: {error.strerror}") from error
    if done.returncode != 0:
        what = done.stderr.strip() or f"ended with {done.returncode}"
        raise OracleError(f"{path.name} {' '.join(map(str, arguments))}: {what}")
    entries: dict[str, Hashes] = {}
    reached: Reached = {}
    for line in done.stdout.splitlines():
        if entry := _ENTRY.fullmatch(line):
            fast, slow, events, given = (int(entry[k], 16) for k in range(2, 6))
            steps = int(entry[6]), int(entry[7])
            entries[entry[1]] = Hashes.of(fast, slow, events, given if with_bytes else 0, *steps)
        elif found := _REACHED.fullmatch(line):
            reached[found[1], int(found[2])] = int(found[3])
        else:
            raise OracleError(f"{path.name}: prints {line!r}")
    return entries, reached
