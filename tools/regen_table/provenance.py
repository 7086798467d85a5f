# SPDX-License-Identifier: Apache-2.0
"""Where an output comes from: version, commit, configuration with its CRC, scenario, seed and date.

Every JSON, Parquet, MDF and HTML file holds these. The generated C source and its image do not:
they depend on the TOML file alone. Standard library only.
"""

import os
from datetime import UTC, datetime
from typing import Any

from regen_table import installation
from regen_table.errors import ConfigurationError

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"


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
        "version": installation.version(),
        "commit": installation.commit(),
        "configuration": configuration,
        "configuration_crc32": None if image is None else crc32(image),
        "scenario": scenario,
        "seed": seed,
        "date": timestamp(date),
    }


def crc32(image: bytes) -> str:
    """Return the CRC-32 that an image ends with, as the generated C file writes it."""
    return f"0x{int.from_bytes(image[-4:], 'little'):08X}"


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
