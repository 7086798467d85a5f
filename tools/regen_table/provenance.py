# SPDX-License-Identifier: Apache-2.0
"""Where an output comes from: version, commit, configuration with its CRC, scenario, seed and date.

Every JSON, Parquet, MDF and HTML file holds these. The generated C source and its image do not: they
depend on the TOML file alone. Standard library only.
"""

import os
import subprocess
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from regen_table import __version__
from regen_table.errors import ConfigurationError

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"
UNKNOWN = "unknown"
_ROOT = Path(__file__).resolve().parents[2]


def provenance(
    configuration: str | None = None,
    image: bytes | None = None,
    *,
    scenario: str | None = None,
    seed: int | None = None,
    date: str | None = None,
) -> dict[str, Any]:
    """Return the origin of an output as an object for JSON; None becomes null.

    Parameters
    ----------
    configuration : str, optional
        Name of the configuration.
    image : bytes, optional
        Its binary image, as the firmware holds it; its CRC-32 is the field ``crc32``.
    scenario, seed : optional
        Of a simulated run.
    date : str, optional
        ISO 8601. Absent: SOURCE_DATE_EPOCH, or else the clock.
    """
    return {
        "program": "hubfoc",
        "version": __version__,
        "commit": commit(),
        "configuration": configuration,
        "configuration_crc32": None if image is None else crc32(image),
        "scenario": scenario,
        "seed": seed,
        "date": timestamp(date),
    }


def crc32(image: bytes) -> str:
    """Return the CRC-32 that an image ends with, as the generated C file writes it."""
    return f"0x{int.from_bytes(image[-4:], 'little'):08X}"


@cache
def commit() -> str:
    """Return the repository's commit, "+" behind it where files differ; "unknown" outside of one.

    A package that was built from the repository holds the commit in ``regen_table/COMMIT``.
    """
    baked = Path(__file__).with_name("COMMIT")
    try:
        if baked.is_file():
            return baked.read_text(encoding="ascii").strip() or UNKNOWN
        if not (_ROOT / ".git").exists():
            return UNKNOWN
        command = ["git", "-C", str(_ROOT), "describe", "--always", "--exclude=*", "--abbrev=40"]
        command.append("--dirty=+")
        done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    except (OSError, ValueError, subprocess.SubprocessError):
        return UNKNOWN
    return done.stdout.strip() if done.returncode == 0 and done.stdout.strip() else UNKNOWN


def timestamp(given: str | None = None) -> str:
    """Return a date as ISO 8601 in UTC, to the second.

    The one given (ISO 8601, UTC where it names no zone), else SOURCE_DATE_EPOCH, else the clock.
    """
    if given is not None:
        try:
            moment = datetime.fromisoformat(given)
        except ValueError:
            raise ConfigurationError(
                f"date: {given!r}, accepted: ISO 8601, as in 2026-01-31T12:00:00Z"
            ) from None
        moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    elif epoch := os.environ.get(EPOCH_VARIABLE):
        try:
            moment = datetime.fromtimestamp(int(epoch), UTC)
        except (ValueError, OverflowError, OSError):
            raise ConfigurationError(
                f"{EPOCH_VARIABLE}: {epoch!r}, accepted: seconds since 1970 as a whole number"
            ) from None
    else:
        moment = datetime.now(UTC)
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
