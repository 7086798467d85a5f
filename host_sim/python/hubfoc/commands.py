# SPDX-License-Identifier: Apache-2.0
"""``hubfoc watch`` and ``hubfoc demand``: the client on a terminal."""

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict

from rich.console import Console
from rich.live import Live
from rich.table import Table

from hubfoc.client import WHEELS, Vehicle
from hubfoc.errors import HubfocError

REFRESH_S = 0.1
LINE_S = 1.0  # between two tables where there is no terminal
SETTLE_S = 0.5  # within which a wheel that is there has spoken
SWITCH_ON_S = 2.0
RUNNING = ("RUN", "LIMP")
UNITS = {"rad_s": "rad/s", "nm": "N m", "v": "V", "a": "A", "c": "degC", "wh": "Wh", "percent": "%"}


def _label(key: str) -> str:
    for suffix, unit in UNITS.items():
        if key.endswith(f"_{suffix}"):
            return f"{key.removesuffix(f'_{suffix}').replace('_', ' ')}, {unit}"
    return key.replace("_", " ")


def _cell(value: object) -> str:
    if isinstance(value, tuple):
        return " ".join(value)
    return f"{value:.1f}" if isinstance(value, float) else "" if value is None else str(value)


def table_of(car: Vehicle) -> Table:
    """Return what all wheels say, a column each."""
    out = Table(box=None)
    out.add_column("", no_wrap=True)
    for position in WHEELS:
        out.add_column(position.replace("_", " "), justify="right")
    statuses = [asdict(wheel.status()) for wheel in car.wheels]
    for key in statuses[0]:
        out.add_row(_label(key), *(_cell(status[key]) for status in statuses))
    return out


def _ticks(duration_s: float | None) -> Iterator[None]:
    """Yield in steps of ``REFRESH_S``, for some seconds or until Ctrl-C."""
    begun_s = time.monotonic()
    while duration_s is None or time.monotonic() - begun_s < duration_s:
        yield
        time.sleep(REFRESH_S)


def _follow(car: Vehicle, duration_s: float | None) -> None:
    """Show what the wheels say as it changes; without a terminal once a second."""
    console = Console()
    if console.is_terminal:
        with Live(table_of(car), console=console, auto_refresh=False) as shown:
            for _ in _ticks(duration_s):
                shown.update(table_of(car), refresh=True)
        return
    due_s = time.monotonic()
    for _ in _ticks(duration_s):
        if time.monotonic() >= due_s:
            due_s += LINE_S
            console.print(table_of(car))
            sys.stdout.flush()


def _meet(car: Vehicle, name: str) -> None:
    end_s = time.monotonic() + SETTLE_S
    while all(wheel.status().mode is None for wheel in car.wheels):
        if time.monotonic() > end_s:
            raise HubfocError(f"{name}: no wheel on this bus, accepted: one on which a vehicle is, "
                              "such as './tools/dev live' prints")  # fmt: skip
        time.sleep(REFRESH_S / 10)


def watch(options: argparse.Namespace) -> int:
    """Do ``hubfoc watch``."""
    with Vehicle(options.can, options.base) as car:
        _meet(car, options.can)
        _follow(car, options.duration)
    return 0


def _switch_on(car: Vehicle) -> None:
    """Demand nothing until the wheels run: switched on they wait for the pedals' release."""
    car.demand()
    end_s = time.monotonic() + SWITCH_ON_S
    present = [wheel for wheel in car.wheels if wheel.status().mode is not None]
    while any(wheel.status().mode not in RUNNING for wheel in present):
        if time.monotonic() > end_s:
            return  # the table tells what each waits for
        time.sleep(REFRESH_S / 10)


def demand(options: argparse.Namespace) -> int:
    """Do ``hubfoc demand``."""
    with Vehicle(options.can, options.base) as car:
        _meet(car, options.can)
        _switch_on(car)
        car.demand(
            options.drive, options.brake, direction=options.direction,
            acknowledge=options.acknowledge,
        )  # fmt: skip
        _follow(car, options.duration)
    return 0


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc watch`` or ``hubfoc demand``."""
    return {"watch": watch, "demand": demand}[options.command](options)
