# SPDX-License-Identifier: Apache-2.0
"""The key of the lock of XCP: 16 bytes in a file of their own, and behind an image's checksum."""

import contextlib
import os
import re
import secrets
from pathlib import Path

from regen_table import layout
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

KEY_BYTES = 16
_TEXT = re.compile(rf"\s*([0-9a-fA-F]{{{2 * KEY_BYTES}}})\s*")


def draw() -> bytes:
    """Return a new key; all zero would be none."""
    return secrets.token_bytes(KEY_BYTES - 1) + bytes([secrets.randbelow(255) + 1])


def write(path: Path, key: bytes) -> None:
    """Write a key into a new file that its owner alone can read."""
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError as error:
        raise ConfigurationError(f"{path}: exists, accepted: a new file") from error
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be written: {error.strerror}") from error
    with os.fdopen(descriptor, "w", encoding="ascii") as file:
        file.write(key.hex() + "\n")


def read(path: Path) -> bytes:
    """Return the key of a file; a refusal never shows what stands in it."""
    text = ""
    with contextlib.suppress(UnicodeDecodeError):
        try:
            text = path.read_text(encoding="ascii")
        except OSError as error:
            raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from error
    found = _TEXT.fullmatch(text)
    key = bytes.fromhex(found[1]) if found else b""
    if not any(key):
        raise ConfigurationError(
            f"{path}: not a key, accepted: {2 * KEY_BYTES} hexadecimal digits, not all zero,"
            " as regen_table key writes them"
        )
    return key


def of(drive: Drive) -> bytes | None:
    """Return the key that a drive names; None: it names none."""
    return None if drive.service.key is None else read(drive.folder / drive.service.key)


def with_key(image: bytes, key: bytes | None) -> bytes:
    """Return an image with a key, or without one; its checksum does not cover the key."""
    at = layout.load().ffi.offsetof("config_t", "service_key")
    return image[:at] + (key or bytes(KEY_BYTES)) + image[at + KEY_BYTES :]
