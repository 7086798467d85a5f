# SPDX-License-Identifier: Apache-2.0
"""``--set section.key=value``: other values on top of a drive's file, and the name they make."""

import re
import tomllib
from collections.abc import Sequence
from typing import Any

from regen_table.errors import ConfigurationError

_NOT_IN_A_NAME = re.compile(r"[^A-Za-z0-9_-]+")


def value_of(text: str) -> Any:  # noqa: ANN401, whatever TOML can say
    """Read a value as TOML does; any other text is a string without its quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, KeyError):
        return text


def parse(settings: Sequence[str]) -> dict[tuple[str, str], Any]:
    """Return the values by section and key; the last one of a key counts."""
    out: dict[tuple[str, str], Any] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        section, dot, key = name.strip().partition(".")
        if not equals or not dot or not key:
            raise ConfigurationError(f"--set {setting!r}: accepted: section.key=value")
        out[section, key] = value_of(text.strip())
    return out


def name_of(drive: str, settings: Sequence[str]) -> str:
    """Return the name of a drive with these settings: ``mine`` at ``rear_left`` is mine_rear_left.

    It keeps apart what is made of one file with different values.
    """
    words = [_NOT_IN_A_NAME.sub("_", str(value)) for value in parse(settings).values()]
    return "_".join([drive, *words])
