# SPDX-License-Identifier: Apache-2.0
"""The keyed MAC of XCP's lock, independent of the firmware's and the client's."""

import struct

MASK = 2**64 - 1


def _rotated(x: int, bits: int) -> int:
    return (x << bits | x >> (64 - bits)) & MASK


def siphash(key: bytes, message: bytes) -> bytes:
    """Return SipHash-2-4 as its paper writes it; any length, for its example of 15 bytes."""
    k0, k1 = struct.unpack("<QQ", key)
    v = [k0 ^ 0x736F6D6570736575, k1 ^ 0x646F72616E646F6D,
         k0 ^ 0x6C7967656E657261, k1 ^ 0x7465646279746573]  # fmt: skip

    def mix(rounds: int) -> None:
        for _ in range(rounds):
            for a, b, s, t in ((0, 1, 13, 32), (2, 3, 16, 0), (2, 1, 17, 32), (0, 3, 21, 0)):
                v[a] = (v[a] + v[b]) & MASK
                v[b] = _rotated(v[b], s) ^ v[a]
                v[a] = _rotated(v[a], t) if t else v[a]

    padded = message + bytes(7 - len(message) % 8) + bytes([len(message) % 256])
    for (block,) in struct.iter_unpack("<Q", padded):
        v[3] ^= block
        mix(2)
        v[0] ^= block
    v[2] ^= 0xFF
    mix(4)
    return struct.pack("<Q", v[0] ^ v[1] ^ v[2] ^ v[3])


def key_of(key: bytes, seed: bytes) -> bytes:
    """Return the answer to a seed."""
    return siphash(key, seed + bytes(2))[:6]
