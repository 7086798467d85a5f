# SPDX-License-Identifier: Apache-2.0
"""What the motors move, and where on CAN each is."""

from typing import Annotated, Literal

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, number


class Vehicle(Section):
    """What the motors move."""

    mass_kg: Annotated[float, number(1.0, 1e5, "kg", "with load")]
    wheel_radius_m: Annotated[
        float,
        number(0.01, 2.0, "m", "rolling radius, divided by the gear ratio where there is a gear"),
    ]
    frontal_area_m2: Annotated[
        float,
        number(0.0, 20.0, "m2", ""),
        Assumed(defaults.frontal_area, "simulated vehicles and ideal stops alone"),
    ]
    drag_coefficient: Annotated[
        float,
        number(0.0, 2.0, "1", ""),
        Assumed(defaults.drag, "simulated vehicles and ideal stops alone"),
    ]
    rolling_resistance: Annotated[
        float,
        number(0.0, 0.2, "1", ""),
        Assumed(defaults.rolling, "simulated vehicles and ideal stops alone"),
    ]
    driven_wheels: Annotated[
        int,
        number(1, 16, "1", "motors on one battery"),
        Assumed(defaults.one_wheel, "pack limits are shared by this number"),
    ]
    pack_share: Annotated[
        float | None,
        number(
            0.01, 1.0, "1",
            "of the pack's limits that this motor may use; all motors on a pack make 1 together;"
            " absent: motors alike, 1/driven_wheels"),
    ] = None  # fmt: skip
    wheel_position: Annotated[
        Literal["front_left", "front_right", "rear_left", "rear_right"],
        Field(description="this controller's address on CAN"),
    ] = "front_left"
    can_base: Annotated[
        int,
        number(0, 0x740, "1", "lowest identifier on CAN, a multiple of 32"),
    ] = 0x100
