# SPDX-License-Identifier: Apache-2.0
"""How the controller learns the rotor's angle."""

from typing import Annotated, Literal

from pydantic import Field

from regen_table.section import Section, number

Degrees = Annotated[float, number(0.0, 360.0, "deg", "an electrical angle")]


class Rotor(Section):
    """How the controller learns the rotor's angle."""

    sensor: Annotated[
        Literal["hall", "encoder", "angle"],
        Field(
            description=(
                "three hall sensors, an incremental encoder with index, or an absolute electrical"
                " angle"
            )
        ),
    ] = "angle"
    hall_edges_deg: Annotated[
        tuple[Degrees, Degrees, Degrees, Degrees, Degrees, Degrees],
        Field(
            strict=False,
            description=(
                "electrical angle at which sector k begins when turning forward; the first where"
                " sensor a rises"
            ),
        ),
    ] = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0)
    hall_spacing_deg: Annotated[
        Literal[120, 60],
        Field(description="electrical, from a to b and from b to c, which rise in this order"),
    ] = 120
    hall_inverted: Annotated[
        Literal["", "a", "b", "c", "ab", "ac", "bc", "abc"],
        Field(description="sensors whose level is inverted"),
    ] = ""
    hall_order: Annotated[
        Literal["abc", "acb", "bac", "bca", "cab", "cba"],
        Field(description="sensors at the board's inputs A, B, C"),
    ] = "abc"
    pll_bandwidth_hz: Annotated[float, number(1.0, 1000.0, "Hz", "tracking of the angle")] = 50.0
    encoder_counts: Annotated[
        int | None,
        number(32, 65536, "1", "in a mechanical turn, four to a line; absent: no encoder"),
    ] = None
    encoder_index_deg: Annotated[
        float | None, number(0.0, 360.0, "deg", "electrical angle at the index pulse")
    ] = None
    encoder_index_tolerance_counts: Annotated[
        int,
        number(
            0,
            1024,
            "1",
            "how far beside its place an index pulse is still the expected one: its width",
        ),
    ] = 4
    encoder_reversed: Annotated[bool, Field(description="the count falls when turning forward")] = (
        False
    )
    observer_speed_rpm: Annotated[
        float | None,
        number(
            0.1,
            4e4,
            "r/min",
            "from which the EMF observer's angle counts; absent: EMF equal to the resistive drop"
            " at rated torque and the dead times' voltage",
        ),
    ] = None
    observer_takeover: Annotated[
        bool,
        Field(
            description=(
                "the EMF observer watches the sensor and takes over from it; else it only reports"
            )
        ),
    ] = True
