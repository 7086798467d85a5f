# SPDX-License-Identifier: Apache-2.0
"""``hubfoc params``: what a wheel is configured with, against a TOML, and other values for it."""

import argparse
import time

from hubsim import configuration
from regen_table import schema, service_key

from hubfoc import addresses, bus
from hubfoc.errors import HubfocError
from hubfoc.live.vehicle import POSITIONS
from hubfoc.service import Can, Service, Udp, values_of

FAILED = 1
SHOWN_VALUES = 8
RESTART_S = 10.0
WAIT_S = 0.2
# Each wheel's own, whatever the TOML says.
_OF_THE_WHEEL = "vehicle.wheel_position"


def _session(options: argparse.Namespace) -> Service:
    if options.udp is not None:
        return Service(Udp(options.udp))
    wheel = POSITIONS.index(options.wheel)
    return Service(Can(bus.join(options.can), options.base, wheel))


def _shown(values: list[int]) -> str:
    rest = f" ... ({len(values)} values)" if len(values) > SHOWN_VALUES else ""
    return " ".join(map(str, values[:SHOWN_VALUES])) + rest


def _get(options: argparse.Namespace) -> int:
    with _session(options) as wheel:
        values = wheel.values()
    for field in addresses.fields():
        if field.name.startswith(options.prefix):
            unit = "" if field.info.unit in {"", "1"} else f" {field.info.unit}"
            print(f"{field.name} {_shown(values[field.name])}{unit}")
    return 0


def _diff(options: argparse.Namespace) -> int:
    image = configuration.image_of(schema.load(options.config))
    with _session(options) as wheel:
        found = wheel.values()
    differing = 0
    for field in addresses.fields():
        wanted = values_of(image, field)
        if found[field.name] != wanted and field.name != _OF_THE_WHEEL:
            differing += 1
            print(f"{field.name}: wheel {_shown(found[field.name])}, file {_shown(wanted)}")
    return FAILED if differing else 0


def _assignments(texts: list[str]) -> dict[str, list[int]]:
    out = {}
    for text in texts:
        name, equals, values = text.partition("=")
        try:
            out[name] = [int(value) for value in values.split(",")]
        except ValueError:
            equals = ""
        if not equals:
            raise HubfocError(f"{text!r}: accepted: SECTION.FIELD=VALUE, whole numbers in the"
                              " field's unit, with commas between several")  # fmt: skip
    return out


def _set(options: argparse.Namespace) -> int:
    wanted = _assignments(options.assignments)
    with _session(options) as wheel:
        wheel.unlock(service_key.read(options.key))
        for name, values in wanted.items():
            wheel.write(name, values)
        wheel.store()
    end_s = time.monotonic() + RESTART_S
    while True:
        time.sleep(WAIT_S)
        try:
            with _session(options) as wheel:
                found = wheel.values()
        except HubfocError:  # it restarts
            found = {}
        if all(found.get(name) == values for name, values in wanted.items()):
            return 0
        if time.monotonic() > end_s:
            raise HubfocError("stored, but the wheel has not come back with it: its shell says why")


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc params get``, ``diff`` or ``set``."""
    return {"get": _get, "diff": _diff, "set": _set}[options.action](options)
