# SPDX-License-Identifier: Apache-2.0
"""Output files of every command: complete or absent, and nothing but regular files replaced.

* A regular file, or a name that does not exist yet, is written under a temporary name in the same
  directory and takes its name in one step. Its permissions are kept.
* A symbolic link remains a link; the file that it points to is replaced.
* A device, a FIFO, a terminal or an inherited descriptor (``/dev/null``, ``/dev/stdout``,
  ``/dev/fd/3``) is opened and written to.

Everything that goes wrong is an OutputError of one line that begins with the file's name. Standard
library only: the simulator writes its files through this module too.
"""

import contextlib
import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from regen_table.errors import OutputError

_DESCRIPTORS = {"/dev/stdin": 0, "/dev/stdout": 1, "/dev/stderr": 2}


@dataclass(frozen=True)
class _Target:
    """What a name stands for: the file to replace, or (``replaced`` is None) a stream."""

    name: Path
    replaced: Path | None
    mode: int


def check_writable(path: Path) -> None:
    """Raise OutputError for a name that cannot be written, before the work begins."""
    with _one_line(path):
        _check(_target(path))


def write_bytes(path: Path, content: bytes) -> None:
    """Write one file from memory."""
    write_files({path: content})


def write_text(path: Path, text: str) -> None:
    """Write one UTF-8 text file from memory, its line ends as they are."""
    write_files({path: text.encode("utf-8")})


def write_files(wanted: Mapping[Path, bytes], make_directories: bool = False) -> list[Path]:
    """Write files from memory, all of them or none, and return their names.

    A file that already has the wanted content is left untouched. Streams are written when every
    regular file has been made and before the first one takes its name: what has gone into a stream
    cannot be taken back, and a stream that fails leaves the files as they were.
    """
    regular: dict[Path, bytes] = {}
    streams: list[tuple[_Target, bytes]] = []
    for path, content in wanted.items():
        if make_directories:
            with _one_line(path.parent):
                path.parent.mkdir(parents=True, exist_ok=True)
        with _one_line(path):
            target = _target(path)
            _check(target)
            if target.replaced is None:
                streams.append((target, content))
            elif not target.replaced.exists() or target.replaced.read_bytes() != content:
                regular[path] = content

    def write_streams() -> None:
        for target, content in streams:
            with _one_line(target.name), _opened(target.name) as stream:
                _write_all(stream, content)

    _replace_all(regular, write_streams)
    return list(wanted)


def write_with(path: Path, write: Callable[[Path], object], suffix: str = "") -> None:
    """Let ``write`` make a temporary file that ends in ``suffix``, then put it in place.

    For a stream the temporary file is copied into it.
    """
    with _one_line(path):
        target = _target(path)
        _check(target)
        directory = None if target.replaced is None else target.replaced.parent
        temporary = _temporary(path.name, suffix, directory)
        try:
            write(temporary)
            if target.replaced is None:
                with _opened(path) as stream, temporary.open("rb") as made:
                    shutil.copyfileobj(made, _Stream(stream))
            else:
                temporary.chmod(target.mode)
                temporary.replace(target.replaced)
        finally:
            temporary.unlink(missing_ok=True)


class _Stream:
    """A descriptor as an object that ``shutil.copyfileobj`` writes to."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def write(self, part: bytes) -> int:
        _write_all(self._descriptor, part)
        return len(part)


def _target(path: Path) -> _Target:
    """Look up what a name stands for, links followed."""
    mask = os.umask(0o022)
    os.umask(mask)
    if _descriptor(path) is not None:
        return _Target(path, None, 0)
    try:
        found = path.stat()
    except FileNotFoundError:
        return _Target(path, path.resolve(), 0o666 & ~mask)
    if stat.S_ISREG(found.st_mode):
        return _Target(path, path.resolve(), stat.S_IMODE(found.st_mode))
    return _Target(path, None, found.st_mode)


def _check(target: _Target) -> None:
    """Refuse a directory, a place that does not exist and one without the right to write."""
    name, place = target.name, target.replaced
    if place is None:
        if stat.S_ISDIR(target.mode):
            raise OutputError(f"{name}: is a directory, accepted: the name of a file to write")
        if target.mode and not os.access(name, os.W_OK):
            raise OutputError(f"{name}: cannot be written: no permission")
        return
    if not place.parent.is_dir():
        raise OutputError(f"{name}: no directory {place.parent} to write to")
    if place.exists() and not os.access(place, os.W_OK):
        raise OutputError(f"{name}: cannot be written: the file is read-only")
    if not os.access(place.parent, os.W_OK | os.X_OK):
        raise OutputError(f"{name}: the directory {place.parent} cannot be written to")


def _replace_all(wanted: dict[Path, bytes], before_moving: Callable[[], None]) -> None:
    """Write every file beside its place, then move all; where a move fails, undo those done."""
    staged: list[tuple[Path, Path, Path]] = []  # name, temporary, place
    before: dict[Path, bytes | None] = {}
    try:
        for path, content in wanted.items():
            with _one_line(path):
                target = _target(path)
                assert target.replaced is not None
                temporary = _temporary(path.name, "", target.replaced.parent)
                staged.append((path, temporary, target.replaced))
                with temporary.open("wb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
                temporary.chmod(target.mode)
        before_moving()
        for path, temporary, place in staged:
            with _one_line(path):
                old = place.read_bytes() if place.exists() else None
                temporary.replace(place)
                before[place] = old
    except OutputError:
        for place, old in before.items():
            with contextlib.suppress(OSError):
                if old is None:
                    place.unlink()
                else:
                    place.write_bytes(old)
        raise
    finally:
        for _, temporary, _ in staged:
            temporary.unlink(missing_ok=True)


def _temporary(name: str, suffix: str, directory: Path | None) -> Path:
    """Make an empty temporary file in a directory (None: where the system keeps such files)."""
    handle, made = tempfile.mkstemp(prefix=f".{name[:100]}.", suffix=suffix, dir=directory)
    os.close(handle)
    return Path(made)


def _descriptor(path: Path) -> int | None:
    """Return the number of an inherited descriptor that a name stands for, or None."""
    known = _DESCRIPTORS.get(str(path))
    numbered = re.fullmatch(r"/(?:dev|proc/self)/fd/(\d+)", str(path))
    return known if numbered is None else int(numbered[1])


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[int]:
    """Open a stream for writing; an inherited descriptor keeps its position."""
    inherited = _descriptor(path)
    if inherited is None:
        descriptor = os.open(path, os.O_WRONLY | os.O_NOCTTY)
    else:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        descriptor = os.dup(inherited)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _write_all(descriptor: int, content: bytes) -> None:
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(descriptor, rest) :]


@contextlib.contextmanager
def _one_line(path: Path) -> Iterator[None]:
    """Turn an error of the operating system into one line about a file."""
    try:
        yield
    except (OSError, RuntimeError, ValueError) as error:
        if isinstance(error, OutputError):
            raise
        if isinstance(error, OSError) and error.strerror:
            reason = error.strerror
        elif isinstance(error, RuntimeError) and "loop" in str(error).lower():
            reason = "too many levels of symbolic links"
        elif isinstance(error, ValueError) and "null" in str(error):
            reason = "the name holds a null character"
        else:
            raise
        raise OutputError(f"{path}: cannot be written: {reason}") from error
