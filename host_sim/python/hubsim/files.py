# SPDX-License-Identifier: Apache-2.0
"""Files that commands read and write, with one line for everything that can go wrong.

Writing follows the rules of ``regen_table.outputs``: a regular file is replaced completely or not
at all, a link stays a link, a device or FIFO is written to.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from regen_table import outputs
from regen_table.errors import OutputError

from hubsim.errors import HubsimError


def read_bytes(path: Path, most_bytes: int | None = None) -> bytes:
    """Return a file's content, refusing one that is longer than ``most_bytes``."""
    try:
        if path.is_dir():
            raise HubsimError(f"{path}: is a directory, accepted: a file")
        with path.open("rb") as file:
            content = file.read() if most_bytes is None else file.read(most_bytes + 1)
    except FileNotFoundError:
        raise HubsimError(f"{path}: file not found") from None
    except (OSError, ValueError) as error:
        if isinstance(error, HubsimError):
            raise
        cause = getattr(error, "strerror", None) or error
        raise HubsimError(f"{path}: cannot be read: {cause}") from error
    if most_bytes is not None and len(content) > most_bytes:
        raise HubsimError(f"{path}: larger than {most_bytes} bytes, accepted: at most that")
    return content


def read_text(path: Path, most_bytes: int | None = None) -> str:
    """Return a text file's content, without the byte-order mark that some editors write."""
    content = read_bytes(path, most_bytes)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise HubsimError(f"{path}: not UTF-8 text (byte {error.start})") from error
    if "\0" in text:
        raise HubsimError(f"{path}: not text (byte {content.index(0)} is zero)")
    return text.replace("\r\n", "\n")


def check_writable(path: Path) -> None:
    """Refuse what could not be written, before the work begins."""
    with _own_error():
        outputs.check_writable(path)


def check_distinct(paths: list[Path]) -> None:
    """Refuse two outputs that would replace each other."""
    files = [path.resolve() for path in paths if not path.exists() or path.is_file()]
    for path in files:
        if files.count(path) > 1:
            raise HubsimError(f"{path}: named for two outputs, accepted: a file for each")


def make_directory(path: Path) -> None:
    """Make a directory and its parents, or raise an error with the cause."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise HubsimError(
            f"{path}: cannot be made: {getattr(error, 'strerror', None) or error}"
        ) from error


def write_text(path: Path, text: str) -> None:
    """Write a text file."""
    with _own_error():
        outputs.write_text(path, text)


def write_with(path: Path, write: Callable[[TextIO], object]) -> None:
    """Let ``write`` fill a text file that takes its name when it is complete."""

    def fill(temporary: Path) -> None:
        with temporary.open("w", encoding="utf-8", newline="\n") as file:
            write(file)

    write_by_name(path, fill)


def write_by_name(path: Path, write: Callable[[Path], object], suffix: str = "") -> None:
    """Let ``write`` make a file under a name ending in ``suffix``.

    The file takes its own name when it is complete.
    """
    with _own_error():
        outputs.write_with(path, write, suffix)


@contextmanager
def _own_error() -> Iterator[None]:
    try:
        yield
    except OutputError as error:
        raise HubsimError(str(error)) from error
