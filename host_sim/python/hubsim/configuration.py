# SPDX-License-Identifier: Apache-2.0
"""What a controller believes and what a plant is made of.

A drive's TOML file, or the image a controller is flashed with.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from regen_table import installation, schema
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

from hubsim import files, images
from hubsim.errors import HubsimError

MAX_IMAGE_BYTES = 1 << 16


@dataclass(frozen=True)
class Configuration:
    """The configuration of one controller and, where it came from a TOML file, everything known about its drive.

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
        return Configuration(drive.name, images.build(drive), drive)
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
    return schema.parse(data, name=drive.name, source=f"{path} with settings")
