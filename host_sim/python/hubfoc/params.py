# SPDX-License-Identifier: Apache-2.0
"""``hubfoc params``: what a wheel is configured with, against a TOML, and other values for it."""

import argparse
import re
import time
from collections.abc import Mapping
from pathlib import Path

from hubsim import configuration, files
from regen_table import layout, schema, service_key
from regen_table.fields_section import Value

from hubfoc import addresses, bus
from hubfoc.errors import HubfocError
from hubfoc.live.vehicle import POSITIONS
from hubfoc.service import Can, Service, Udp, values_of

FAILED = 1
SHOWN_VALUES = 8
RESTART_S = 10.0
WAIT_S = 0.2
_FIELDS = re.compile(r"^\[fields\][^\n]*\n(?:(?!\[)[^\n]*\n?)*", re.MULTILINE)
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


def exported(body: bytes, base: Path) -> str:
    """Return a TOML file that makes an image: a drive's, and [fields] with what differs from it.

    Parameters
    ----------
    body : bytes
        The image up to its checksum, as a wheel shows it.
    base : path
        The drive's file; what is in its own [fields] may be replaced.
    """
    drive = schema.load(base)
    image = configuration.image_of(drive)
    given: dict[str, Value] = {
        f"{section}.{name}": value for (section, name), value in drive.fields.values().items()
    }
    for field in addresses.fields():
        found = values_of(body, field)
        if found != values_of(image, field):
            given[field.name] = found if field.info.count else found[0]
    return _with_fields(files.read_text(base), given)


def _with_fields(text: str, given: Mapping[str, Value]) -> str:
    """Return the text of a TOML file with another section [fields], at its end."""
    rest = _FIELDS.sub("", text).rstrip("\n")
    lines = [f'"{name}" = {value}' for name, value in given.items()]
    return "\n".join([rest, "", "[fields]", *lines] if lines else [rest]) + "\n"


def _image_name(body: bytes) -> str:
    begin = layout.load().ffi.offsetof("config_t", "name")
    return body[begin:].partition(b"\0")[0].decode("ascii", "replace")


def _export(options: argparse.Namespace) -> int:
    files.check_writable(options.file)
    with _session(options) as wheel:
        body = wheel.read(addresses.PAGE, addresses.page_bytes())
    name = _image_name(body)
    if options.file.name != f"{name}.toml":
        raise HubfocError(f"{options.file}: the wheel's image has the name of its file, accepted:"
                          f" a file {name}.toml")  # fmt: skip
    files.write_text(options.file, exported(body, options.config))
    made = configuration.image_of(schema.load(options.file))
    if made[: len(body)] != body:
        raise HubfocError(
            f"{options.file}: another version's image, accepted: a wheel with one of this version"
        )
    return 0


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc params get``, ``diff``, ``set`` or ``export``."""
    actions = {"get": _get, "diff": _diff, "set": _set, "export": _export}
    return actions[options.action](options)
