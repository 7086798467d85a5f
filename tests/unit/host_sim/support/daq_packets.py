# SPDX-License-Identifier: Apache-2.0
"""What pyxcp does with the packets of DAQ lists: it keeps them."""

from pyxcp.transport.transport_ext import (  # type: ignore[import-not-found]
    FrameAcquisitionPolicy,
    FrameCategory,
)


class Kept(FrameAcquisitionPolicy):  # type: ignore[misc] # pyxcp has no types
    """The packets of DAQ lists."""

    def __init__(self) -> None:
        super().__init__(set())
        self.packets: list[bytes] = []

    def feed(self, category: FrameCategory, _counter: int, _time: int, payload: bytes) -> None:
        """Keep one."""
        if category == FrameCategory.DAQ:
            self.packets.append(bytes(payload))

    def finalize(self) -> None:
        """Do what a policy does at the end: nothing."""
