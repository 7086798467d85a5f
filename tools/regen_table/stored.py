# SPDX-License-Identifier: Apache-2.0
"""Results on disk, found again by the content of everything they were made from.

Nothing depends on them: a result that is missing, damaged or cannot be written is made again.
In the repository they are in ``.dev/cache``, of an installed distribution in the user's cache.
``HUBFOC_CACHE_DIR`` names another directory; empty: nothing is kept. Standard library only.
"""

import contextlib
import hashlib
import os
import platform
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from regen_table import installation

VARIABLE = "HUBFOC_CACHE_DIR"
MOST_FILES = 1000  # then the older half goes
_DIGEST_BYTES = hashlib.sha256().digest_size


def directory() -> Path | None:
    """Return where results are kept; None: nowhere."""
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) if named else None
    if not installation.INSTALLED:
        return installation.ROOT / ".dev" / "cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hubfoc"


def by_content(kind: str, content: Iterable[bytes], make: Callable[[], bytes]) -> bytes:
    """Return what ``make`` returns, from disk where it was made of this content before.

    Parameters
    ----------
    kind : str
        What is made, as a part of a file's name.
    content : iterable of bytes
        Everything the result depends on besides Python and the machine.
    """
    place = directory()
    if place is None:
        return make()
    path = place / f"{kind}-{_key(content)}"
    found = _read(path)
    if found is None:
        found = make()
        with contextlib.suppress(OSError):
            _write(path, found)
    return found


def _key(content: Iterable[bytes]) -> str:
    total = hashlib.sha256(f"{platform.python_version()} {platform.machine()}".encode())
    for part in content:
        total.update(hashlib.sha256(part).digest())
    return total.hexdigest()


def _read(path: Path) -> bytes | None:
    """Return a result that is there and whole."""
    try:
        raw = path.read_bytes()
    except OSError:
        return None
    found = raw[_DIGEST_BYTES:]
    return found if hashlib.sha256(found).digest() == raw[:_DIGEST_BYTES] else None


def _write(path: Path, found: bytes) -> None:
    """Put a result into its place at once, for other processes read at any time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, temporary = tempfile.mkstemp(dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(hashlib.sha256(found).digest() + found)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    _tidy(path.parent)


def _tidy(place: Path) -> None:
    files = list(place.iterdir())
    if len(files) > MOST_FILES:
        files.sort(key=lambda path: path.stat().st_mtime)
        for path in files[: MOST_FILES // 2]:
            path.unlink(missing_ok=True)
