# SPDX-License-Identifier: Apache-2.0
"""Writing a configuration: <name>.c and <name>.bin together, or neither."""

from dataclasses import dataclass
from pathlib import Path

from regen_table import emit, image, installation, outputs
from regen_table.errors import CheckFailedError
from regen_table.schema import Drive

# In the repository, where its build looks for them; elsewhere, where the caller is.
GENERATED = (
    Path() if installation.INSTALLED else installation.ROOT / "firmware" / "config" / "generated"
)
FIGURES = Path("figures") if installation.INSTALLED else installation.ROOT / "build/report/figures"


@dataclass(frozen=True)
class Artefacts:
    """The files of one configuration, by their names below the output directory, and the image."""

    files: dict[str, bytes]
    image: bytes


def artefacts(drive: Drive) -> Artefacts:
    """Compute both files of a drive."""
    raw = image.build(drive)
    return Artefacts(
        {f"{drive.name}.c": emit.source(drive, raw).encode("ascii"), f"{drive.name}.bin": raw}, raw
    )


def write(drive: Drive, directory: Path) -> list[Path]:
    """Write both files of a drive and return their paths."""
    return write_all(artefacts(drive).files, directory)


def write_all(files: dict[str, bytes], directory: Path) -> list[Path]:
    """Put files into a directory all together or not at all."""
    found = {directory / name: content for name, content in files.items()}
    return outputs.write_files(found, make_directories=True)


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
