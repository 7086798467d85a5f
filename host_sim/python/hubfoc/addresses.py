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
SCOPE = 0xC0000000
RECORD = 0xD0000000
SIGNAL_BYTES = 4
CHANNELS = 8  # of the scope
SETTINGS = {
    **{f"signal_{k}": f"signal {k}: its place in the table, -1: none" for k in range(CHANNELS)},
    "trigger": "0 none, 1 above, 2 below, 3 rises, 4 falls, 5 a finding appears",
    "trigger_signal": "its place in the table",
    "level": "raw; of a finding its reason, 0: any",
    "before_rows": "rows before the trigger's",
    "rows": "of the record, 0: as many as fit",
    "periods": "PWM periods a row",
    "run": "1 begins, 0 ends",
}
STATES = {
    "phase": "0 off, 1 armed, 2 triggered, 3 complete, 4 the memory is that of a DAQ list",
    "record_rows": "rows of the record",
    "row_bytes": "bytes of a row",
    "row_layout": "bytes of signal k in bits 4k to 4k + 3",
    "first_row": "number of the oldest row",
    "memory_bytes": "0: there is no scope",
}
_FAST = (variables.FAST_OUTPUT, variables.FAST_INPUT, variables.FAST_VIEW)


@dataclass(frozen=True)
class Signal:
    """One row of the table, a signed word.

    ``name`` begins with ``output.`` or ``input.`` of the slow step, and with ``fast_output.``,
    ``fast_input.`` or ``fast_view.`` of the PWM period, whose values are raw.
    """

    name: str
    address: int
    variable: variables.Variable
    is_fast: bool
    list: int
    """Its list of variables, and the number in it."""
    number: int

    @property
    def place(self) -> int:
        """Return its number in the table."""
        return (self.address - SIGNALS) // SIGNAL_BYTES

    @property
    def least_bytes(self) -> int:
        """Return how many bytes hold every value."""
        low, high = self.variable.lowest_raw, self.variable.highest_raw
        return next((n for n in (1, 2) if low >= 0 and high < 1 << 8 * n), SIGNAL_BYTES)


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
    ports = (
        (variables.SLOW_OUTPUT, "output"), (variables.SLOW_INPUT, "input"),
        (variables.FAST_OUTPUT, "fast_output"), (variables.FAST_INPUT, "fast_input"),
        (variables.FAST_VIEW, "fast_view"),
    )  # fmt: skip
    rows = [
        (f"{side}.{row.raw_name if port in _FAST else row.name}", row, port, number)
        for port, side in ports
        for number, row in enumerate(variables.of_port(port))
    ]
    return tuple(
        Signal(name, SIGNALS + SIGNAL_BYTES * place, row, port in _FAST, port, number)
        for place, (name, row, port, number) in enumerate(rows)
    )


def scope_words() -> dict[str, int]:
    """Return the address of each word of the scope's page, settings first."""
    return {name: SCOPE + 4 * k for k, name in enumerate((*SETTINGS, *STATES))}


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
