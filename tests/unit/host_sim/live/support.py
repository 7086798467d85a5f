# SPDX-License-Identifier: Apache-2.0
"""A virtual vehicle with its local service in this process."""

import itertools
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from hubfoc.bus import join
from hubfoc.live import clock, command, desk, orders, service, terminals, world, xcp
from hubsim import cli

TIMEOUT_S = 60.0  # of a busy machine
NUMBERS = itertools.count()


@dataclass(frozen=True)
class Running:
    """What runs, and where it is reached; ``do`` calls in the thread that steps the vehicle."""

    world: world.World
    desk: desk.Desk
    gateways: xcp.Gateways
    channel: str
    url: str
    do: Callable[[Callable[[], object]], object]
    serial: list[str]

    def value(self, signal: str) -> float:
        """Return a signal of the simulation."""
        found = self.do(lambda: self.world.vehicle.value(signal))
        assert isinstance(found, float)
        return found


def until(condition: Callable[[], bool]) -> None:
    """Wait for something that will happen."""
    end_s = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s
        time.sleep(0.01)


@contextmanager
def running(*, paced: bool = True, config: Path = cli.DEFAULT_CONFIG) -> Iterator[Running]:
    """Run the paper's vehicle, or another one, on a bus of its own."""
    channel = f"virtual:{next(NUMBERS)}"
    ends = threading.Event()
    bus, pace, calls = join(channel), clock.Clock(paced=paced), orders.Orders()
    with (
        world.World(config) as own,
        terminals.Terminals(own.vehicle.wheels) as lines,
        xcp.Gateways(own.vehicle.service_base, own.vehicle.wheels) as gateways,
    ):
        pages = desk.Desk(own, pace, gateways)
        with service.Service(0, command.answers(own, pace, calls, pages)) as server:
            thread = threading.Thread(
                target=command.keep_running,
                args=(own, bus, lines, gateways, pace, calls, ends.is_set, pages),
            )
            thread.start()
            try:
                yield Running(own, pages, gateways, channel, server.url, calls.call, lines.names)
            finally:
                ends.set()
                thread.join()
    bus.close()
