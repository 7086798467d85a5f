# SPDX-License-Identifier: Apache-2.0
"""Files that are there completely or not at all."""

import contextlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

from hubsim.errors import HubsimError


def check_writable(path: Path) -> None:
    """Refuse early, before the work, what could not be written after it."""
    if path.is_dir():
        raise HubsimError(f"{path}: is a directory, accepted: the name of a file to write")
    if not path.parent.is_dir():
        raise HubsimError(f"{path}: no directory {path.parent} to write to")
    if not os.access(path.parent, os.W_OK):
        raise HubsimError(f"{path}: the directory {path.parent} cannot be written to")


def write_text(path: Path, text: str) -> None:
    """Write a file in one move."""
    write_with(path, lambda file: file.write(text))


def write_with(path: Path, write: Callable[[TextIO], object]) -> None:
    """Let ``write`` fill a text file that takes its name only when it is complete."""

    def fill(temporary: Path) -> None:
        with temporary.open("w", encoding="utf-8", newline="\n") as file:
            write(file)

    write_by_name(path, fill)


def write_by_name(path: Path, write: Callable[[Path], object], suffix: str = "") -> None:
    """Let ``write`` make a file under another name, ending in ``suffix``, that takes its own only when it is complete."""
    check_writable(path)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            raise HubsimError(f"{path}: cannot be written: {error.strerror}") from error
        raise


def _umask() -> int:
    """Return the process's file mode mask, which can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
