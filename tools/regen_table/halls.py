# SPDX-License-Identifier: Apache-2.0
"""How three hall sensors are wired, as the controller reads them. Standard library only.

Turning forward, sensors a, b, c rise one after the other, 120 or 60 electrical degrees apart, each
for half a turn; sector 0 begins where a rises. They may be inverted, and come to the board's inputs
A, B, C in any order. What the controller's table expects follows by inverting inputs and exchanging
B and C: all else is the number of the sector from which it counts.
"""

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from regen_table.rotor_section import Rotor

# Of sectors 0 to 5 turning forward, bits c b a; that of 120 degrees is firmware/foc/hall.c's.
STATES = {120: (5, 1, 3, 2, 6, 4), 60: (1, 3, 7, 6, 4, 0)}
EXCHANGED = 8  # bit of rotor.hall_lines


class Wiring(NamedTuple):
    """What the controller knows of it.

    Attributes
    ----------
    lines : int
        Bits 0 to 2: inputs A, B, C that are inverted; bit 3: B and C are exchanged.
    edges_deg : tuple of float
        Where its own sectors begin.
    """

    lines: int
    edges_deg: tuple[float, ...]


def states(spacing_deg: int, inverted: str, order: str) -> tuple[int, ...]:
    """Return what the inputs (bits C B A) show in sectors 0 to 5."""
    flipped = sum(1 << i for i, sensor in enumerate(order) if sensor in inverted)
    return tuple(_at_inputs(state, order) ^ flipped for state in STATES[spacing_deg])


def wiring(rotor: "Rotor") -> Wiring:
    """Return the lines with which the controller's sectors follow each other, and its edges."""
    shown = states(rotor.hall_spacing_deg, rotor.hall_inverted, rotor.hall_order)
    lines, first = next(
        (lines, own[0])
        for lines in range(2 * EXCHANGED)
        if (own := [_sector(state, lines) for state in shown])
        and all((own[0] + k) % 6 == sector for k, sector in enumerate(own))
    )
    edges = rotor.hall_edges_deg
    return Wiring(lines, tuple(edges[(sector - first) % 6] for sector in range(6)))


def _at_inputs(state: int, order: str) -> int:
    return sum((state >> "abc".index(sensor) & 1) << i for i, sensor in enumerate(order))


def _sector(shown: int, lines: int) -> int:
    """Return the controller's sector; -1: impossible."""
    state = shown ^ lines & 7
    state = _at_inputs(state, "acb") if lines & EXCHANGED else state
    return STATES[120].index(state) if state in STATES[120] else -1
