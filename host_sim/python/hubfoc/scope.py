# SPDX-License-Identifier: Apache-2.0
"""``hubfoc scope`` and ``hubfoc watch --signals``: any signals of one wheel, by XCP."""

import argparse
import time
from contextlib import closing
from pathlib import Path

from hubfoc import bus
from hubfoc.live.vehicle import POSITIONS
from hubfoc.measuring import Trigger
from hubfoc.service import Can, Service, Udp

LINE_S = 0.1  # between two lines


def _session(options: argparse.Namespace) -> Service:
    if options.udp is not None:
        return Service(Udp(options.udp))
    wheel = POSITIONS.index(options.wheel)
    return Service(Can(bus.join(options.can), options.xcp_base, wheel))


def _watch(options: argparse.Namespace) -> int:
    """Print the values of a sample every ``LINE_S`` of the wheel's time."""
    begun_s = time.monotonic()
    due_s = 0.0
    print("time_s", *options.signals)
    with _session(options) as wheel, closing(wheel.daq(options.signals)) as samples:
        for sample in samples:
            if sample.time_s >= due_s:
                due_s = sample.time_s + LINE_S
                values = (sample.values[name] for name in options.signals)
                print(f"{sample.time_s:.3f}", *values, flush=True)
            if options.duration is not None and time.monotonic() - begun_s > options.duration:
                return 0
    return 0


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc scope``, or ``hubfoc watch`` of signals."""
    if options.command == "watch":
        return _watch(options)
    trigger = Trigger.of(options.trigger)
    with _session(options) as wheel:
        found = wheel.scope(
            options.signals, trigger=trigger, before=options.before, rows=options.rows,
            every=options.every, wait_s=options.wait,
        )  # fmt: skip
    found.write(Path(options.output))
    return 0
