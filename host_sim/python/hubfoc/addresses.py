# SPDX-License-Identifier: Apache-2.0
"""What XCP shows of a wheel, and at which address: the table of signals and the configuration.

The same in every image of a version of the firmware (``firmware/comms/include/comms/xcp.h``).
"""

from dataclasses import dataclass
from functools import cache

from hubsim import variables
from regen_table import layout

SIGNALS = 0xA0000000
PAGE = 0xB0000000
SIGNAL_BYTES = 4


@dataclass(frozen=True)
class Signal:
    """One row of the table, a signed word; ``name`` begins with ``output.`` or ``input.``."""

    name: str
    address: int
    variable: variables.Variable


@dataclass(frozen=True)
class Field:
    """One field of the configuration: values of ``value_bytes`` each, signed."""

    name: str
    address: int
    value_bytes: int
    info: layout.FieldInfo


@cache
def signals() -> tuple[Signal, ...]:
    """Return the table in the order of the addresses."""
    ports = ((variables.SLOW_OUTPUT, "output"), (variables.SLOW_INPUT, "input"))
    rows = [(f"{side}.{row.name}", row) for port, side in ports for row in variables.of_port(port)]
    return tuple(
        Signal(name, SIGNALS + SIGNAL_BYTES * place, row) for place, (name, row) in enumerate(rows)
    )


@cache
def fields() -> tuple[Field, ...]:
    """Return every field in the order of config_t."""
    header = layout.load()
    out = []
    for section, infos in header.sections.items():
        members = dict(header.ffi.typeof(f"config_{section}_t").fields)
        begin = header.ffi.offsetof("config_t", section)
        for name, info in infos.items():
            kind = members[name].type
            value = kind.item if info.count else kind
            out.append(
                Field(
                    f"{section}.{name}", PAGE + begin + members[name].offset,
                    header.ffi.sizeof(value), info,
                )
            )  # fmt: skip
    return tuple(out)


def page_bytes() -> int:
    """Return how much of a page is shown: all before the checksum."""
    return int(layout.load().ffi.offsetof("config_t", "crc32"))
