# SPDX-License-Identifier: Apache-2.0
"""Images of ``config_t`` for runs side by side.

Computed once for a drive, whatever its braking strategy, however often asked.
"""

import threading
import zlib
from collections.abc import Mapping

from regen_table import image, layout
from regen_table.schema import Drive

_KEPT = 16
_known: dict[str, bytes] = {}
_lock = threading.Lock()


def build(drive: Drive) -> bytes:
    """Return the image of a drive; drives that differ in their strategy only share the work.

    Raises
    ------
    ConfigurationError
        As ``regen_table.image.build``.
    """
    data = drive.model_dump()
    strategy = data["brake"].pop("strategy")
    key = f"{drive.name} {data!r}"
    with _lock:  # runs begin in several threads: the second one waits for the work of the first
        if key not in _known:
            if len(_known) >= _KEPT:
                _known.pop(next(iter(_known)))
            _known[key] = image.build(drive)
        found = _known[key]
    return changed(found, {("brake", "strategy"): image.STRATEGIES[strategy]})


def changed(raw: bytes, values: Mapping[tuple[str, str], int | list[int]]) -> bytes:
    """Return an image with other values in some of its fields, sealed anew."""
    header = layout.load()
    config = header.ffi.from_buffer("config_t *", bytearray(raw))
    for (section, name), value in values.items():
        setattr(getattr(config, section), name, value)
    out = bytes(header.ffi.buffer(config))
    body = out[: header.ffi.offsetof("config_t", "crc32")]
    return body + zlib.crc32(body).to_bytes(4, "little") + out[len(body) + 4 :]
