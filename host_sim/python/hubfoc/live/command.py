# SPDX-License-Identifier: Apache-2.0
"""``hubfoc live``: put a virtual vehicle on a bus and keep it running."""

import argparse
import contextlib
import json
import os
import sys
import tempfile
import webbrowser
from collections.abc import Callable, Iterator
from pathlib import Path

from hubsim.errors import HubsimError
from regen_table import service_key

from hubfoc.bus import Bus, Frame, join, reserve
from hubfoc.errors import HubfocError
from hubfoc.live import page
from hubfoc.live.board import Board
from hubfoc.live.clock import Clock
from hubfoc.live.desk import Desk
from hubfoc.live.orders import Orders
from hubfoc.live.service import Answers, Service
from hubfoc.live.stream import serve
from hubfoc.live.terminals import Terminals
from hubfoc.live.vehicle import POSITIONS, STEP_S
from hubfoc.live.viewers import Foxglove, PlotJuggler, Viewer, Viewers
from hubfoc.live.world import LiveWorld, World
from hubfoc.live.xcp import Gateways

SHELL_STEPS = 10  # of STEP_S between two looks at the serial lines
SWITCH_S = 5e-4  # between two threads of Python: the vehicle shall not wait for a page
PAUSED_S = 0.02  # between two looks at what is wanted while the time stands


def _xcp(gateways: Gateways, wheel: int) -> dict[str, object] | None:
    if not gateways.wheels:
        return None
    gateway = gateways.wheels[wheel]
    return {"udp": gateway.address, "command": gateway.command, "answer": gateway.answer}


def _ready(
    service: Service, bus: Bus, terminals: Terminals, gateways: Gateways, key: Path | None
) -> dict[str, object]:
    names = [POSITIONS[k] if k < len(POSITIONS) else str(k) for k in range(len(terminals.names))]
    return {
        "ready": True,
        "url": service.url,
        "can": bus.name,
        "key": None if key is None else str(key),
        "wheels": [
            {"position": position, "xcp": _xcp(gateways, k), "serial": serial}
            for k, (position, serial) in enumerate(zip(names, terminals.names, strict=True))
        ],
        "pid": os.getpid(),
    }


def _shown(ready: dict[str, object]) -> str:
    wheels = ready["wheels"]
    assert isinstance(wheels, list)
    what = "vehicle" if wheels else "wheels"
    lines = [f"{what} on {ready['can']}, {ready['url']}"]
    for wheel in wheels:
        xcp = wheel["xcp"] and f", XCP on {wheel['xcp']['udp']}"
        lines.append(f"  {wheel['position']}: shell on {wheel['serial']}{xcp or ''}")
    if ready["key"] is not None:
        lines.append(f"key of XCP in {ready['key']}")
    return "\n".join([*lines, "Ctrl-C ends it."])


def keep_running(
    world: LiveWorld, bus: Bus, terminals: Terminals, gateways: Gateways, clock: Clock,
    orders: Orders,
    ends: Callable[[], bool], desk: Desk | None = None, viewers: Viewers | None = None,
) -> None:  # fmt: skip
    """Step the vehicle in time until this shall end, or a world that ends with its scenario."""
    clock.begin()
    steps, number = 0, world.number
    while not ends():
        orders.serve()
        if world.paused or world.number != number:
            _stand(world, bus, orders, ends)
            number = world.number
            clock.begin(world.time_s)
        if world.vehicle.ended:
            if world.ends:
                break
            world.stop("the scenario is over")
            continue
        received: list[Frame] = []
        while (wait_s := clock.wait_s()) > 0.0:
            received += bus.receive(wait_s)
        received += bus.receive(0.0)
        own = [] if desk is None else desk.before(received)
        try:
            gateways.receive(world.vehicle)
            sent = world.vehicle.step([*received, *own])
        except HubsimError as error:
            if world.ends:
                raise
            world.stop(str(error))
            continue
        gateways.send(world.vehicle)
        for identifier, data in (*own, *sent):
            bus.send(identifier, data)
        if desk is not None:
            desk.after()
            if viewers is not None:
                viewers.show(desk.history, world.time_s)
        if steps % SHELL_STEPS == 0:
            terminals.exchange(world.vehicle, None if desk is None else desk.inquiry)
        steps += 1
        complaint = clock.stepped(world.time_s, STEP_S)
        if complaint is not None:
            print(f"hubfoc live: {complaint}", file=sys.stderr, flush=True)


def _stand(world: LiveWorld, bus: Bus, orders: Orders, ends: Callable[[], bool]) -> None:
    """Do what is wanted while the time stands."""
    while world.paused and not ends():
        bus.receive(0.0)
        orders.serve(PAUSED_S)


def answers(world: LiveWorld, clock: Clock, orders: Orders, desk: Desk | None = None) -> Answers:
    """Return what the local service answers; with a page if it has a desk."""
    simulated = {
        "simulation": lambda: orders.call(world.state),
        "faults": lambda: orders.call(world.fault_list),
        "scenarios": world.scenarios,
    }
    return Answers(
        get={
            "health": lambda: {"time_s": world.time_s, **clock.health()},
            **({} if world.real else simulated),
        },
        change=lambda wanted: orders.call(lambda: world.change(wanted)),
        page=None if desk is None else page.document,
        recording=lambda: world.recorded if isinstance(world, World) else None,
        stream=None if desk is None else lambda handler: serve(desk, orders, handler),
    )


@contextlib.contextmanager
def _viewers(options: argparse.Namespace) -> Iterator[Viewers | None]:
    """Yield the viewers that are wanted; None: nobody wants any."""
    with contextlib.ExitStack() as stack:
        wanted: list[Viewer] = []
        if options.foxglove is not None:
            foxglove = Foxglove(options.foxglove)
            print(f"Foxglove: {foxglove.url}", file=sys.stderr, flush=True)
            wanted.append(foxglove)
            stack.callback(foxglove.close)
        if options.plotjuggler is not None:
            plotjuggler = PlotJuggler(options.plotjuggler)
            wanted.append(plotjuggler)
            stack.callback(plotjuggler.close)
        yield Viewers(wanted) if wanted else None


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc live``."""
    sys.setswitchinterval(SWITCH_S)
    if options.board:
        return _run_board(options)
    if options.allow_demand:
        raise HubfocError("--allow-demand: accepted: with --board")
    clock, orders = Clock(paced=not options.fast), Orders()
    ends = options.no_page and options.scenario is not None
    with (
        World(options.config, options.scenario, ends=ends, rear=options.rear) as world,
        Terminals(world.vehicle.wheels) as terminals,
        Gateways(world.vehicle.service_base, world.vehicle.wheels) as gateways,
        _viewers(options) as viewers,
        tempfile.TemporaryDirectory(prefix="hubfoc-") as folder,
    ):
        key = Path(folder) / "xcp.key"
        service_key.write(key, world.vehicle.key)
        page_desk = None if options.no_page else Desk(world, clock, gateways)
        desk = Desk(world, clock) if page_desk is None and viewers is not None else page_desk
        bus = reserve(options.can)
        try:
            with Service(options.port, answers(world, clock, orders, page_desk)) as service:
                ready = _ready(service, bus, terminals, gateways, key)
                print(json.dumps(ready) if options.ready_json else _shown(ready), flush=True)
                if page_desk is not None and _may_open(options):
                    webbrowser.open(service.url)
                keep_running(
                    world, bus, terminals, gateways, clock, orders, lambda: False, desk, viewers
                )
        finally:
            bus.close()
    return 0


def _run_board(options: argparse.Namespace) -> int:
    """Do ``hubfoc live --board``: listen to real wheels, and show them."""
    for given, name in ((options.scenario, "--scenario"), (options.fast, "--fast")):
        if given:
            raise HubfocError(f"{name}: accepted: of a virtual vehicle, not with --board")
    clock, orders = Clock(paced=True), Orders()
    world = Board(options.config, demands=options.allow_demand, rear=options.rear)
    with Terminals(0) as terminals, Gateways(0, 0) as gateways, _viewers(options) as viewers:
        desk = Desk(world, clock, channel=options.can)
        bus = join(options.can)
        try:
            shown = None if options.no_page else desk
            with Service(options.port, answers(world, clock, orders, shown)) as service:
                ready = _ready(service, bus, terminals, gateways, None)
                print(json.dumps(ready) if options.ready_json else _shown(ready), flush=True)
                if shown is not None and _may_open(options):
                    webbrowser.open(service.url)
                keep_running(
                    world, bus, terminals, gateways, clock, orders, lambda: False, desk, viewers
                )
        finally:
            bus.close()
    return 0


def _may_open(options: argparse.Namespace) -> bool:
    """Return whether a browser with a window may be opened."""
    has_screen = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    return has_screen and not options.no_open and not options.ready_json
