# SPDX-License-Identifier: Apache-2.0
"""Hall sensors of every kind, order and inversion, as the controller sees them."""

import itertools

import pytest
from regen_table import halls
from regen_table.rotor_section import Rotor

EDGES_DEG = (11.0, 64.5, 133.0, 186.0, 255.0, 304.0)
LINES = ["".join(some) for count in range(4) for some in itertools.combinations("abc", count)]


def levels(spacing_deg: int, sector: int) -> dict[str, int]:
    """Return what three sensors show in the middle of a sixth of a turn.

    Each is on for half a turn from its place on.
    """
    middle_deg = 60.0 * sector + 30.0
    return {
        sensor: int((middle_deg - k * spacing_deg) % 360.0 < 180.0)
        for k, sensor in enumerate("abc")
    }


@pytest.mark.parametrize("spacing_deg", [120, 60])
@pytest.mark.parametrize("inverted", LINES)
@pytest.mark.parametrize("order", ["abc", "acb", "bac", "bca", "cab", "cba"])
def test_the_controller_finds_every_sector_begin_where_the_key_says(
    spacing_deg: int, inverted: str, order: str
) -> None:
    """Read as firmware/foc/hall.h and config.h say: invert, exchange B and C, six states."""
    rotor = Rotor(
        hall_edges_deg=EDGES_DEG,
        hall_spacing_deg=spacing_deg,  # type: ignore[arg-type]
        hall_inverted=inverted,  # type: ignore[arg-type]
        hall_order=order,  # type: ignore[arg-type]
    )
    lines, edges_deg = halls.wiring(rotor)
    for sector in range(6):
        sensor = levels(spacing_deg, sector)
        at = [sensor[name] ^ (name in inverted) ^ lines >> k & 1 for k, name in enumerate(order)]
        a, b, c = (at[0], at[2], at[1]) if lines & 8 else at
        own = [(1, 0, 1), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)].index((a, b, c))
        assert edges_deg[own] == EDGES_DEG[sector]


def test_sensors_as_the_defaults_have_them_change_nothing() -> None:
    assert halls.wiring(Rotor(hall_edges_deg=EDGES_DEG)) == (0, EDGES_DEG)
