# SPDX-License-Identifier: Apache-2.0
"""``hubfoc record``: a recording of a virtual vehicle that runs, from its boot on."""

import argparse
import time
from contextlib import suppress
from pathlib import Path

from hubfoc.errors import HubfocError
from hubfoc.recording import check_file
from hubfoc.simulation import Simulation

LOOK_S = 0.1


def _until(world: Simulation, duration_s: float | None) -> None:
    """Wait for a time of the simulation, the end of its scenario, or Ctrl-C."""
    while True:
        state = world.state()
        recorded_s = state["recording_s"]
        if recorded_s is None:
            raise HubfocError("the vehicle has begun again, without this recording")
        if state["ended"] or (duration_s is not None and recorded_s >= duration_s):
            return
        time.sleep(LOOK_S)


def _record(world: Simulation, options: argparse.Namespace, file: Path) -> None:
    if options.scenario is not None:
        world.scenario(options.scenario)
    world.record(file)
    with suppress(KeyboardInterrupt):  # as good an end as any
        _until(world, options.duration)
    print(f"{world.stop_recording()['recorded']}: recorded")


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc record``."""
    file = check_file(options.file)
    _record(Simulation(options.url), options, file)
    return 0
