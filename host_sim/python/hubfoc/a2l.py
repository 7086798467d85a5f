# SPDX-License-Identifier: Apache-2.0
"""The description of a wheel for measuring and calibration tools: an A2L (ASAM MCD-2 MC 1.7).

Made from the table of signals and the configuration's list of fields alone; names, units, texts and
ranges stand here and not in flash. The addresses are the protocol's, the same in every image of
this version (``hubfoc.addresses``).
"""

import argparse
import re
from collections.abc import Iterable

from hubsim import variables
from regen_table import installation, outputs

from hubfoc import addresses
from hubfoc.addresses import Field, Signal
from hubfoc.cli import SERVICE_BASE

SIGNED = {2: ("SWORD", "word"), 4: ("SLONG", "long")}
_SCALES = {1: "plain", 100: "hundredths", 1000: "thousandths"}


def _text(text: str) -> str:
    """Return a quoted string as the standard wants it: ASCII, quotes doubled."""
    return '"' + re.sub(r"[^ -~]", "?", text).replace('"', '""') + '"'


def _per_unit(signal: Signal) -> int:
    """Return how many of the raw value are one of the unit."""
    raw = signal.variable.raw_name
    if signal.is_fast:
        return 1
    if signal.variable.kind != variables.REAL:
        return 1
    if raw.endswith("_cC"):
        return 100
    return 1000


def _method(name: str, unit: str, per_unit: int) -> list[str]:
    return [
        f'    /begin COMPU_METHOD {name} ""',
        f'      RAT_FUNC "%12.3f" {_text(unit)}',
        f"      COEFFS 0 {per_unit} 0 0 0 1",
        "    /end COMPU_METHOD",
    ]


def _name_of(unit: str, per_unit: int) -> str:
    return "CM_" + re.sub(r"\W+", "_", f"{unit or 'number'}_{_SCALES[per_unit]}")


def _measurement(signal: Signal) -> list[str]:
    row, per_unit, unit = signal.variable, _per_unit(signal), _unit_of(signal)
    low, high = (max(-(2**31), row.lowest_raw), min(2**31 - 1, row.highest_raw))
    return [
        f"    /begin MEASUREMENT {signal.name} {_text(row.text)}",
        f"      SLONG {_name_of(unit, per_unit)} 0 0 {low / per_unit:.12g} {high / per_unit:.12g}",
        f"      ECU_ADDRESS 0x{signal.address:08X}",
        f'      SYMBOL_LINK "measurement_page.{signal.name}" 0',
        "    /end MEASUREMENT",
    ]


def _unit_of(signal: Signal) -> str:
    """Return the unit; a signal of the PWM period is raw."""
    return "" if signal.is_fast else signal.variable.unit


def _scope() -> list[str]:
    """Return settings and state of the scope (firmware/comms/include/comms/scope.h)."""
    method = _name_of("", 1)
    lines = []
    for name, address in addresses.scope_words().items():
        link = f'      SYMBOL_LINK "scope_page.{name}" 0'
        if name in addresses.SETTINGS:
            lines += [
                f"    /begin CHARACTERISTIC scope.{name} {_text(addresses.SETTINGS[name])}",
                f"      VALUE 0x{address:08X} RL_long 0 {method} {-(2**31)} {2**31 - 1}",
                link,
                "    /end CHARACTERISTIC",
            ]
        else:
            lines += [
                f"    /begin MEASUREMENT scope.{name} {_text(addresses.STATES[name])}",
                f"      SLONG {method} 0 0 {-(2**31)} {2**31 - 1}",
                f"      ECU_ADDRESS 0x{address:08X}",
                link,
                "    /end MEASUREMENT",
            ]
    return lines


def _interface() -> list[str]:
    """Return what a tool has to know of the slave: packets, DAQ lists, events, identifiers."""
    base = SERVICE_BASE
    events = (("slow step", 1, 6), ("PWM period", 0, 3))  # cycle, unit; 0: GET_DAQ_EVENT_INFO
    lists = [
        f"          /begin DAQ_LIST 0x{k:04X} DAQ_LIST_TYPE DAQ MAX_ODT {odts} MAX_ODT_ENTRIES 8"
        f" EVENT_FIXED 0x{k:04X} /end DAQ_LIST"
        for k, odts in enumerate((8, 1))
    ]
    described = [
        f'          /begin EVENT "{name}" "{name[:8]}" 0x{k:04X} DAQ 1 {cycle} {unit} 0 /end EVENT'
        for k, (name, cycle, unit) in enumerate(events)
    ]
    return [
        "    /begin IF_DATA XCP",
        "      /begin PROTOCOL_LAYER",
        "        0x0100 1000 1000 0 0 0 0 0 8 8",
        "        BYTE_ORDER_MSB_LAST ADDRESS_GRANULARITY_BYTE",
        "      /end PROTOCOL_LAYER",
        "      /begin DAQ",
        "        STATIC 2 2 0 OPTIMISATION_TYPE_DEFAULT ADDRESS_EXTENSION_FREE",
        "        IDENTIFICATION_FIELD_TYPE_ABSOLUTE GRANULARITY_ODT_ENTRY_SIZE_DAQ_BYTE 4",
        "        OVERLOAD_INDICATION_PID PRESCALER_SUPPORTED",
        "        /begin TIMESTAMP_SUPPORTED 1 SIZE_WORD UNIT_10US TIMESTAMP_FIXED"
        " /end TIMESTAMP_SUPPORTED",
        *lists,
        *described,
        "      /end DAQ",
        f"      /begin XCP_ON_CAN 0x0100 CAN_ID_MASTER 0x{base:X} CAN_ID_SLAVE 0x{base + 4:X}"
        " BAUDRATE 500000 /end XCP_ON_CAN",
        "    /end IF_DATA",
    ]


def _characteristic(field: Field) -> list[str]:
    info = field.info
    kind = "VAL_BLK" if info.count else "VALUE"
    lines = [
        f"    /begin CHARACTERISTIC {field.name} {_text(info.text)}",
        f"      {kind} 0x{field.address:08X} RL_{SIGNED[field.value_bytes][1]} 0"
        f" {_name_of(_unit(field), 1)} {info.lowest} {info.highest}",
    ]
    if info.count:
        lines.append(f"      MATRIX_DIM {info.count}")
    return [
        *lines,
        f'      SYMBOL_LINK "calibration_page.{field.name}" 0',
        "    /end CHARACTERISTIC",
    ]


def _unit(field: Field) -> str:
    return "" if field.info.unit == "1" else field.info.unit


def _methods(signals: Iterable[Signal], fields: Iterable[Field]) -> list[str]:
    wanted = {(_unit_of(row), _per_unit(row)) for row in signals}
    wanted |= {(_unit(row), 1) for row in fields}
    return [
        line
        for unit, per_unit in sorted(wanted)
        for line in _method(_name_of(unit, per_unit), unit, per_unit)
    ]


def _segment() -> list[str]:
    size = addresses.page_bytes()
    return [
        '    /begin MOD_PAR "addresses of the protocol"',
        '      /begin MEMORY_SEGMENT calibration_page "the configuration, config_t"',
        f"        DATA FLASH INTERN 0x{addresses.PAGE:08X} 0x{size:X} -1 -1 -1 -1 -1",
        "      /end MEMORY_SEGMENT",
        "    /end MOD_PAR",
    ]


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc a2l``."""
    outputs.write_files({options.file: text().encode("ascii")}, make_directories=False)
    return 0


def text() -> str:
    """Return the whole file."""
    signals, fields = addresses.signals(), addresses.fields()
    layouts = [
        f"    /begin RECORD_LAYOUT RL_{name} FNC_VALUES 1 {kind} ROW_DIR DIRECT /end RECORD_LAYOUT"
        for kind, name in SIGNED.values()
    ]
    lines = [
        "ASAP2_VERSION 1 71",
        f'/begin PROJECT hubfoc "hubfoc {installation.version()}"',
        f'  /begin MODULE hubfoc "{len(signals)} signals, {len(fields)} parameters"',
        '    /begin MOD_COMMON "little endian"',
        "      BYTE_ORDER MSB_LAST",
        "    /end MOD_COMMON",
        *_segment(),
        *_interface(),
        *_methods(signals, fields),
        *layouts,
        *(line for row in signals for line in _measurement(row)),
        *(line for row in fields for line in _characteristic(row)),
        *_scope(),
        "  /end MODULE",
        "/end PROJECT",
    ]
    return "\n".join(lines) + "\n"
