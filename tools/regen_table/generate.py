# SPDX-License-Identifier: Apache-2.0
"""Writing a configuration: <name>.c and <name>.bin together, or neither."""

import contextlib
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

from regen_table import emit, image
from regen_table.errors import CheckFailedError, ConfigurationError
from regen_table.schema import Drive

_ROOT = Path(__file__).resolve().parents[2]
GENERATED = _ROOT / "firmware" / "config" / "generated"
FIGURES = _ROOT / "build" / "report" / "figures"


@dataclass(frozen=True)
class Artefacts:
    """The files of one configuration: their names below the output directory and their bytes."""

    files: dict[str, bytes]


def artefacts(drive: Drive) -> Artefacts:
    """Compute both files of a drive."""
    raw = image.build(drive)
    return Artefacts(
        {f"{drive.name}.c": emit.source(drive, raw).encode("ascii"), f"{drive.name}.bin": raw}
    )


def write(drive: Drive, directory: Path) -> list[Path]:
    """Write both files of a drive and return their paths."""
    return write_all(artefacts(drive).files, directory)


def write_all(files: dict[str, bytes], directory: Path) -> list[Path]:
    """Put files into a directory all together or not at all."""
    return write_files({directory / name: content for name, content in files.items()})


def write_files(wanted: dict[Path, bytes]) -> list[Path]:
    """Write files all together or not at all; a file that is already right is left untouched."""
    directory = next(iter(wanted), Path()).parent
    try:
        for directory in {path.parent: None for path in wanted}:
            directory.mkdir(parents=True, exist_ok=True)
        before = {path: path.read_bytes() if path.exists() else None for path in wanted}
        _replace(
            {path: content for path, content in wanted.items() if before[path] != content}, before
        )
    except OSError as error:
        raise ConfigurationError(
            f"{error.filename or directory}: cannot be written: {error.strerror}"
        ) from error
    return list(wanted)


def check(drive: Drive, directory: Path) -> None:
    """Compare both files of a drive with what a directory holds.

    Raises CheckFailedError with one line.
    """
    for name, content in artefacts(drive).files.items():
        path = directory / name
        try:
            same = path.read_bytes() == content
        except FileNotFoundError:
            raise CheckFailedError(f"{path}: missing; write it with ./tools/dev table") from None
        except OSError as error:
            raise CheckFailedError(f"{path}: cannot be read: {error.strerror}") from error
        if not same:
            raise CheckFailedError(
                f"{path}: differs from what its TOML file generates; renew it with ./tools/dev table"
            )


def _replace(wanted: dict[Path, bytes], before: dict[Path, bytes | None]) -> None:
    """Write every file beside its place, then move all.

    If a move fails, those already moved are put back.
    """
    staged: dict[Path, Path] = {}
    moved: list[Path] = []
    try:
        for path, content in wanted.items():
            staged[path] = _stage(path, content)
        for path, temporary in staged.items():
            temporary.replace(path)
            moved.append(path)
    except OSError:
        for path in moved:
            old = before[path]
            with contextlib.suppress(OSError):
                if old is None:
                    path.unlink()
                else:
                    path.write_bytes(old)
        raise
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)


def _stage(path: Path, content: bytes) -> Path:
    """Write a temporary file in the same directory, with the rights a new file has."""
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error  # not the temporary's name
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary
