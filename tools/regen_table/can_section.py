# SPDX-License-Identifier: Apache-2.0
"""What a wheel sends on CAN beside its own protocol."""

from typing import Annotated

from regen_table.section import Section, number


class Can(Section):
    """Frames of other protocols; none unless a key says so."""

    vesc_status: Annotated[
        int,
        number(
            0, 250, "1",
            "VESC controller id of the front left wheel; those of the other wheels follow. Under"
            " them the wheels send VESC status frames for displays and loggers, and receive none;"
            " 0: none are sent",
        ),
    ] = 0  # fmt: skip
