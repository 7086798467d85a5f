# SPDX-License-Identifier: Apache-2.0
"""``hubfoc live``: put a virtual vehicle on a bus and keep it running."""

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from hubsim import scenario as scenarios
from hubsim.scenario import overrides
from regen_table import schema, service_key

from hubfoc.bus import Bus, Frame, reserve
from hubfoc.live.clock import Clock
from hubfoc.live.service import Service
from hubfoc.live.terminals import Terminals
from hubfoc.live.vehicle import POSITIONS, STEP_S, SimulatedVehicle
from hubfoc.live.xcp import Gateways

SHELL_STEPS = 10  # of STEP_S between two looks at the serial lines


def _vehicle(options: argparse.Namespace) -> SimulatedVehicle:
    if options.scenario is None:
        return SimulatedVehicle(schema.load(options.config))
    _, chosen, beside = scenarios.load(options.scenario, {})
    drive = overrides.load_drive(options.config, overrides.parse([]), chosen)
    return SimulatedVehicle(drive, chosen, beside)


def _xcp(gateways: Gateways, wheel: int) -> dict[str, object] | None:
    if not gateways.wheels:
        return None
    gateway = gateways.wheels[wheel]
    return {"udp": gateway.address, "command": gateway.command, "answer": gateway.answer}


def _ready(
    service: Service, bus: Bus, terminals: Terminals, gateways: Gateways, key: Path
) -> dict[str, object]:
    names = [POSITIONS[k] if k < len(POSITIONS) else str(k) for k in range(len(terminals.names))]
    return {
        "ready": True,
        "url": service.url,
        "can": bus.name,
        "key": str(key),
        "wheels": [
            {"position": position, "xcp": _xcp(gateways, k), "serial": serial}
            for k, (position, serial) in enumerate(zip(names, terminals.names, strict=True))
        ],
        "pid": os.getpid(),
    }


def _shown(ready: dict[str, object]) -> str:
    wheels = ready["wheels"]
    assert isinstance(wheels, list)
    lines = [f"vehicle on {ready['can']}, {ready['url']}health"]
    for wheel in wheels:
        xcp = wheel["xcp"] and f", XCP on {wheel['xcp']['udp']}"
        lines.append(f"  {wheel['position']}: shell on {wheel['serial']}{xcp or ''}")
    return "\n".join([*lines, f"key of XCP in {ready['key']}", "Ctrl-C ends it."])


def keep_running(
    vehicle: SimulatedVehicle, bus: Bus, terminals: Terminals, gateways: Gateways, clock: Clock,
    ends: Callable[[], bool],
) -> None:  # fmt: skip
    """Step the vehicle in time until it ends or it shall."""
    clock.begin()
    steps = 0
    while not vehicle.ended and not ends():
        received: list[Frame] = []
        while (wait_s := clock.wait_s()) > 0.0:
            received += bus.receive(wait_s)
        received += bus.receive(0.0)
        sent = vehicle.step(received + gateways.receive())
        gateways.send(sent)
        for identifier, data in sent:
            bus.send(identifier, data)
        if steps % SHELL_STEPS == 0:
            terminals.exchange(vehicle)
        steps += 1
        complaint = clock.stepped(vehicle.time_s, STEP_S)
        if complaint is not None:
            print(f"hubfoc live: {complaint}", file=sys.stderr, flush=True)


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc live``."""
    clock = Clock(paced=not options.fast)
    with (
        _vehicle(options) as vehicle,
        Terminals(vehicle.wheels) as terminals,
        Gateways(vehicle.service_base, vehicle.wheels) as gateways,
        tempfile.TemporaryDirectory(prefix="hubfoc-") as folder,
    ):
        key = Path(folder) / "xcp.key"
        service_key.write(key, vehicle.key)
        bus = reserve(options.can)
        try:
            with Service(
                options.port, lambda: {"time_s": vehicle.time_s, **clock.health()}
            ) as service:
                ready = _ready(service, bus, terminals, gateways, key)
                print(json.dumps(ready) if options.ready_json else _shown(ready), flush=True)
                keep_running(vehicle, bus, terminals, gateways, clock, lambda: False)
        finally:
            bus.close()
    return 0
