# SPDX-License-Identifier: Apache-2.0
"""Input files: text and tables of numbers; errors are reported in one line."""

import csv
from collections.abc import Callable
from pathlib import Path

from regen_table.errors import ConfigurationError

MAX_TABLE_BYTES = 256 << 20  # a recording of minutes at 100 kHz


def read_text(path: Path, most_bytes: int, what: str) -> str:
    """Return a text file's content, without the byte-order mark that some editors write.

    ``what`` names what is needed, as in "a TOML file".
    """
    try:
        if path.is_dir():
            raise ConfigurationError(f"{path}: is a directory, {what} is needed")
        with path.open("rb") as file:
            raw = file.read(most_bytes + 1)
    except FileNotFoundError:
        raise ConfigurationError(f"{path}: file not found") from None
    except ConfigurationError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise ConfigurationError(f"{path}: cannot be read: {reason}") from error
    if len(raw) > most_bytes:
        raise ConfigurationError(f"{path}: larger than {most_bytes} bytes, accepted: {what}")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigurationError(
            f"{path}: not UTF-8 text (byte {error.start}), {what} is needed"
        ) from error
    if "\0" in text:
        raise ConfigurationError(
            f"{path}: not text (byte {raw.index(0)} is zero), {what} is needed"
        )
    return text


def read_table(path: Path, what: str, suits: Callable[[list[str]], bool]) -> dict[str, list[str]]:
    """Return the columns of a CSV file by their headings, cells as text."""
    return read_numbered_table(path, what, suits)[0]


def read_numbered_table(
    path: Path, what: str, suits: Callable[[list[str]], bool]
) -> tuple[dict[str, list[str]], list[int]]:
    """Return the columns of a CSV file by their headings, and the line of the file of each row.

    Lines that begin with # are comments. Refused are headings that do not suit and a row that is
    too short or too long.
    """
    text = read_text(path, MAX_TABLE_BYTES, what)
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.startswith("#")
    ]
    try:
        rows = list(csv.reader(line for _, line in numbered))
    except csv.Error as error:
        raise ConfigurationError(f"{path}: accepted: {what} ({error})") from error
    heading, body = (rows[0], rows[1:]) if rows else ([], [])
    names = [name.strip() for name in heading]
    if not suits(names):
        raise ConfigurationError(f"{path}: accepted: {what}")
    lines = [number for number, _ in numbered[1:]]
    for number, row in zip(lines, body, strict=False):
        if len(row) != len(names):
            raise ConfigurationError(
                f"{path}:{number}: {len(row)} cells and the heading has {len(names)}, accepted:"
                f" {what}"
            )
    columns: dict[str, list[str]] = {name: [row[k] for row in body] for k, name in enumerate(names)}
    return columns, lines
