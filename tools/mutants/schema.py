# SPDX-License-Identifier: Apache-2.0
"""A file with all its mutants in it: each is chosen at run time by its number.

`a < b` becomes ``(HUBFOC_VALUE(7, ((a) <= (b)) != (a < b)) ? ((a) <= (b)) : (a < b))``. Only one
mutant acts at a time, so alternatives are plain text, and only the unchanged expression holds
further mutants. What has effects, or may not be computed beside, is not compared: HUBFOC_MUTANT(7).
"""

from collections import defaultdict
from collections.abc import Mapping

from mutants.operators import Change


def with_all(text: bytes, numbered: Mapping[int, Change]) -> bytes:
    """Return the file with every numbered change in it."""
    places: dict[tuple[int, int], list[tuple[int, Change]]] = defaultdict(list)
    for number, change in numbered.items():
        places[(change.start, change.end)].append((number, change))
    # An outer place comes before the inner ones.
    order = sorted(places, key=lambda place: (place[0], -place[1]))
    out, position = _render(text, 0, len(text), order, places)
    assert position == len(order)
    return out


def _render(
    text: bytes,
    begin: int,
    end: int,
    order: list[tuple[int, int]],
    places: Mapping[tuple[int, int], list[tuple[int, Change]]],
    position: int = 0,
) -> tuple[bytes, int]:
    out = bytearray()
    while position < len(order) and order[position][0] < end:
        place = order[position]
        out += text[begin : place[0]]
        inner, position = _render(text, *place, order, places, position + 1)
        out += _choice(inner, places[place])
        begin = place[1]
    out += text[begin:end]
    return bytes(out), position


def _choice(unchanged: bytes, alternatives: list[tuple[int, Change]]) -> bytes:
    number, change = alternatives[0]
    if change.removed:
        return b"{ if (!HUBFOC_MUTANT(%d)) { %s } }" % (number, unchanged)
    chain = b"".join(_alternative(number, change) for number, change in alternatives)
    return b"(%s(%s))" % (chain, unchanged)


def _alternative(number: int, change: Change) -> bytes:
    new, old = change.replacement.encode(), change.original.encode()
    if change.comparable:
        return b"HUBFOC_VALUE(%d, (%s) != (%s)) ? (%s) : " % (number, new, old, new)
    return b"HUBFOC_MUTANT(%d) ? (%s) : " % (number, new)


def with_one(text: bytes, change: Change) -> bytes:
    """Return the file with one change, as a programmer would have written it."""
    new = b"{ }" if change.removed else b"(%s)" % change.replacement.encode()
    return text[: change.start] + new + text[change.end :]
