# SPDX-License-Identifier: Apache-2.0
"""Objects that are compiled again only if something that they are made of has changed."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

_WORD = re.compile(r"(?:\\.|\S)+")


def _record(made: Path) -> Path:
    return made.with_name(made.name + ".json")


def is_current(command: Sequence[str], made: Path) -> bool:
    """Return whether an object was made by this command from files that are older than it."""
    record = _record(made)
    if not made.is_file() or not record.is_file():
        return False
    before = json.loads(record.read_text(encoding="utf-8"))
    if before["command"] != list(command):
        return False
    files = [Path(name) for name in before["files"]]
    made_ns = made.stat().st_mtime_ns
    return all(file.is_file() and file.stat().st_mtime_ns <= made_ns for file in files)


def compile_if_changed(
    command: Sequence[str], made: Path, execute: Callable[[list[str]], object]
) -> None:
    """Compile an object if it is not current.

    Parameters
    ----------
    command
        The compiler, or a launcher and the compiler, and its options without ``-o``.
    made
        The object.
    execute
        Runs a command, and raises an exception if it fails.
    """
    if is_current(command, made):
        return
    _record(made).unlink(missing_ok=True)
    depends = made.with_name(made.name + ".d")
    execute([*command, "-MD", "-MF", str(depends), "-o", str(made)])
    text = depends.read_text(encoding="utf-8").partition(":")[2].replace("\\\n", " ")
    files = [re.sub(r"\\(.)", r"\1", word) for word in _WORD.findall(text)]
    files += filter(None, map(shutil.which, command[:2]))  # a launcher and the compiler
    content = {"command": list(command), "files": [str(Path(name).absolute()) for name in files]}
    _record(made).write_text(json.dumps(content), encoding="utf-8")
