# SPDX-License-Identifier: Apache-2.0
"""The service protocol, XCP: where it is on CAN, and the key of its lock."""

from typing import Annotated

from pydantic import Field

from regen_table.section import Section, number


class Service(Section):
    """Measurement and parameters by XCP; without a key measurement alone."""

    can_base: Annotated[
        int,
        number(
            0, 0x7F8, "1",
            "identifier of the commands to the front left wheel, a multiple of 8 and at least 160"
            " above vehicle.can_base; those of the other wheels follow, then the four of the"
            " answers; 0: no XCP on CAN",
        ),
    ] = 0x7F0  # fmt: skip
    key: Annotated[
        str | None,
        Field(
            min_length=1, max_length=255,
            description="file of the lock's key, beside this one; absent: nothing can be changed",
        ),
    ] = None  # fmt: skip
