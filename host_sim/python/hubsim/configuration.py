# SPDX-License-Identifier: Apache-2.0
"""What a controller is configured with and a plant is made of.

A drive's TOML file, or the image a controller is flashed with. Images are computed once for a
drive with any braking strategy, and kept on disk (regen_table/stored.py).
"""

import hashlib
import threading
import tomllib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from regen_table import STRATEGIES, flux_constants, installation, layout, schema, stored
from regen_table.errors import ConfigurationError
from regen_table.fields_section import Fields
from regen_table.schema import Drive

from hubsim import files
from hubsim.errors import HubsimError

MAX_IMAGE_BYTES = 1 << 16


@dataclass(frozen=True)
class Configuration:
    """The configuration of one controller.

    Where it came from a TOML file, with everything known about its drive.

    Attributes
    ----------
    name : str
        Of the file, without its ending.
    image : bytes
        ``config_t`` as the firmware reads it. Whether the firmware accepts it is said where it is
        loaded.
    drive : Drive or None
        What the TOML file says; None where only an image is known. A plant can only be made of a
        drive.
    """

    name: str
    image: bytes
    drive: Drive | None = None


def load(path: str | Path, settings: Mapping[str, Any] | None = None) -> Configuration:
    """Read a configuration.

    Parameters
    ----------
    path : str or Path
        A drive's ``.toml`` file, the bare name of one that comes along ("lu2013"), or a ``.bin``
        image made from one (``./tools/dev table``).
    settings : mapping, optional
        ``"section.key"`` to value, in the file's units, on top of a TOML file; None takes an
        optional key away.

    Raises
    ------
    HubsimError
        In one line: which file, which key, what is accepted.
    """
    path = installation.drive_file(path)
    if path.suffix == ".bin":
        if settings:
            raise HubsimError(
                f"{path}: an image cannot be changed, accepted: settings on top of a .toml file"
            )
        return Configuration(path.stem, files.read_bytes(path, MAX_IMAGE_BYTES))
    try:
        drive = schema.load(path)
        if settings:
            drive = _changed(drive, path, settings)
        return Configuration(drive.name, image_of(drive), drive)
    except ConfigurationError as error:
        raise HubsimError(str(error)) from error


def _changed(drive: Drive, path: Path, settings: Mapping[str, Any]) -> Drive:
    data = tomllib.loads(files.read_text(path))
    for key, value in settings.items():
        section, dot, name = key.partition(".")
        keys = data.setdefault(section, {})
        if not dot or not isinstance(keys, dict):
            raise HubsimError(f"{key!r}: accepted: section.key, as in {path}")
        if value is None:
            keys.pop(name, None)
        else:
            keys[name] = value
    return schema.parse(data, name=drive.name, source=f"{path} with settings", beside=path.parent)


_KEPT = 16
_known: dict[str, bytes] = {}
_lock = threading.Lock()


def image_of(drive: Drive) -> bytes:
    """Return the image of a drive; drives that differ in strategy or [fields] only share the work.

    Raises
    ------
    ConfigurationError
        As ``regen_table.image.build``.
    """
    data = drive.model_dump()
    strategy = data["brake"].pop("strategy")
    given = data.pop("fields")
    table = data["motor"].pop("flux_map")
    content = b"" if table is None else flux_constants.content_of(Path(table))
    key = f"{drive.name} {data!r} {hashlib.sha256(content).hexdigest()}"
    with _lock:  # runs begin in several threads: the second one waits for the work of the first
        if key not in _known:
            if len(_known) >= _KEPT:
                _known.pop(next(iter(_known)))
            plain = drive.model_copy(update={"fields": Fields()}) if given else drive
            of = (*program(), key.encode())
            _known[key] = stored.by_content("image", of, partial(_computed, plain))
        found = _known[key]
    own: dict[tuple[str, str], int | list[int]]
    own = {("brake", "strategy"): STRATEGIES.index(strategy)}
    return changed_image(found, own | drive.fields.values())


def _computed(drive: Drive) -> bytes:
    from regen_table import image  # noqa: PLC0415, with all that it needs as slow as one image

    return image.build(drive)


@cache
def program() -> tuple[bytes, ...]:
    """Return what an image depends on besides its drive: header, programs, cycles."""
    programs = Path(schema.__file__).parent.glob("*.py")
    cycles = (installation.ROOT / "host_sim" / "cycles").glob("*.csv")
    read = (path.read_bytes() for path in sorted([*programs, *cycles]))
    return (np.__version__.encode(), layout.header_text().encode(), *read)


def changed_image(raw: bytes, values: Mapping[tuple[str, str], int | list[int]]) -> bytes:
    """Return an image with other values in some of its fields, sealed anew."""
    header = layout.load()
    config = header.ffi.from_buffer("config_t *", bytearray(raw))
    for (section, name), value in values.items():
        setattr(getattr(config, section), name, value)
    out = bytes(header.ffi.buffer(config))
    body = out[: header.ffi.offsetof("config_t", "crc32")]
    return body + zlib.crc32(body).to_bytes(4, "little") + out[len(body) + 4 :]
