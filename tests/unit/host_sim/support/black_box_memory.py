# SPDX-License-Identifier: Apache-2.0
"""A record of a first fault as a controller holds it in memory, and as its shell prints it."""

import struct
import zlib

FAST_NEXT, SLOW_NEXT = 7, 11


def memory(
    phase: int = 4, after_reset: int = 0, filled: int = 400, starts: tuple[int, int] = (0, 0)
) -> bytes:
    """Return a record as recorder.h lays it out: entry n, from the oldest, shows n."""
    fast = [struct.pack("<6H", 2048 + n, 2048, 2048 - n, 2048 | 1 << 14, n, 99) for n in range(400)]
    fast[: 400 - filled] = [bytes(12)] * (400 - filled)
    slow = [struct.pack("<6h2b2B", 100, n, -20, 30, 530, -15, 25, 30, 4, 1) for n in range(200)]
    rings = b"".join(fast[-FAST_NEXT:] + fast[:-FAST_NEXT] + slow[-SLOW_NEXT:] + slow[:-SLOW_NEXT])
    counts = [0] * 64
    counts[67 - 64] = 3
    checked = (
        struct.pack("<3I2H", 20000, 0x1234, 1500, FAST_NEXT, SLOW_NEXT)
        + bytes((67, after_reset, *starts))
        + rings
    )
    front = struct.pack("<I2HB3xI64H", 0x42464F46, 1, 8168, phase, 0xFFFFFFFC, *counts)
    return front + struct.pack("<I", zlib.crc32(checked)) + checked


def printed(content: bytes) -> str:
    lines = [
        f"{at:04X}: {content[at : at + 32].hex().upper()}\r" for at in range(0, len(content), 32)
    ]
    return "> blackbox\r\nblack box: record of 67\r\n" + "\n".join(lines) + "\n> \r\n"
