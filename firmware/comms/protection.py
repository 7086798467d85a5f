# SPDX-License-Identifier: Apache-2.0
"""The end-to-end protection's numbers, as a C header and as the Python module of the protocol.

A message with a checksum of 16 bits has AUTOSAR's profile 5, one with 8 bits profile 2.
"""

import re
from collections.abc import Iterable
from pathlib import Path

from cantools.database.can import Database, Message

# Of the protocol, 1 .. 7: part of every data id, so that frames of another version are refused.
VERSION = 2
BASE = 0x100
WHEEL_MASK = 3
P5_DATA_ID = VERSION << 11  # above the identifier's eleven bits
P2_DATA_ID = VERSION << 5  # above the bits in which the identifiers with profile 2 differ
P5 = {"POLYNOMIAL": 0x1021, "INITIAL": 0xFFFF, "COUNTER_MASK": 0xFF}
P2 = {"POLYNOMIAL": 0x2F, "INITIAL": 0xFF, "FINAL": 0xFF, "COUNTER_MASK": 0x0F}
# Profile 2's list of data ids by the counter's bits: entry [a ^ b] = entry [a] ^ entry [b], and
# every entry has an even number of bits, so the code stays a linear one in which, as in the CRC
# alone, words differ in an even number of places. The four were found by search to leave no two
# equal syndromes (distance 4) and no burst of eight or fewer undetected.
P2_BASIS = {1: 0x90, 2: 0xAA, 4: 0xC0, 8: 0x60}


def data_ids() -> list[int]:
    """Return profile 2's data ids, one for each counter, but for the identifier's low byte."""
    found = [P2_DATA_ID]
    for entry in P2_BASIS.values():
        found += [entry ^ before for before in found]
    return found


def profile(message: Message) -> int:
    """Return the profile that protects a message."""
    return 5 if message.get_signal_by_name("crc").length == 16 else 2


def header() -> str:
    """Return generated/protection.h."""
    names = [(f"PROTECTION_P5_{name}", value) for name, value in P5.items()]
    names += [(f"PROTECTION_P2_{name}", value) for name, value in P2.items()]
    names += [("PROTECTION_P5_DATA_ID", P5_DATA_ID)]
    lines = "".join(f"    {name} = {value:#x},\n" for name, value in names)
    listed = ", ".join(f"{entry:#04x}" for entry in data_ids())
    return (
        "/* SPDX-License-Identifier: Apache-2.0 */\n"
        "/* By generate.py: the numbers of the end-to-end protection (comms/e2e.h). */\n"
        "/* clang-format off */\n"
        "#ifndef COMMS_GENERATED_PROTECTION_H\n#define COMMS_GENERATED_PROTECTION_H\n\n"
        f"enum {{\n{lines}}};\n\n#define PROTECTION_P2_DATA_IDS {{{listed}}}\n\n#endif\n"
    )


def attributes(messages: Iterable[Message], module: Path) -> str:
    """Return the DBC's attributes of the protection, by AUTOSAR's names of its parameters."""
    text, step = "", enumerator(module, "E2E_STEP_MAX")
    for message in messages:
        of = f"BO_ {message.frame_id}"
        text += f'BA_ "E2EProfile" {of} {profile(message)};\n'
        text += f'BA_ "E2EMaxDeltaCounter" {of} {step};\n'
        if profile(message) == 5:
            text += f'BA_ "E2EDataID" {of} {P5_DATA_ID ^ message.frame_id};\n'
        else:
            ids = " ".join(str(entry ^ message.frame_id & 0xFF) for entry in data_ids())
            text += f'BA_ "E2EDataIDList" {of} "{ids}";\n'
    return text


def enumerator(module: Path, name: str) -> int:
    """Return the value of an enumerator of the module's headers."""
    for path in sorted((module / "include/comms").glob("*.h")):
        found = re.search(rf"\b{name} = (\d+)", path.read_text(encoding="utf-8"))
        if found:
            return int(found.group(1))
    raise ValueError(f"no header defines {name}")


def _message(message: Message) -> str:
    each = "False" if message.senders == ["battery"] else "True"
    text = (
        f'    "{message.name}": Message(\n        0x{message.frame_id:03X},\n        {each},\n'
        f"        {message.cycle_time},\n        {profile(message)},\n        {{\n"
    )
    for signal in sorted(message.signals, key=lambda signal: signal.start):
        step = float(signal.conversion.scale)
        least, most = float(signal.minimum or 0), float(signal.maximum or 0)
        named = {str(meaning): raw for raw, meaning in (signal.choices or {}).items()}
        last = f", {named['NOT_AVAILABLE']}" if "NOT_AVAILABLE" in named else ""
        if signal.multiplexer_ids:
            only = f'("{signal.multiplexer_signal}", {signal.multiplexer_ids[0]})'
            last = f"{last or ', None'}, {only}"
        values = f"{signal.start}, {signal.length}, {signal.is_signed}, {step}, {least}, {most}"
        text += f'            "{signal.name}": Signal({values}{last}),\n'
    return f"{text}        }},\n    ),\n"


def python_module(database: Database, module: Path) -> str:
    """Return hubsim/can_protocol.py."""
    text = (module / "can_protocol.py.in").read_text(encoding="utf-8")
    text = text.replace("@MESSAGES@", "".join(map(_message, database.messages)))
    numbers = {
        "VERSION": str(VERSION),
        "P5_DATA_ID": f"0x{P5_DATA_ID:X}",
        "BASE": f"0x{BASE:03X}",
        "WHEEL_MASK": str(WHEEL_MASK),
        "STEP_MAX": str(enumerator(module, "E2E_STEP_MAX")),
        "QUALIFYING_FRAMES": str(enumerator(module, "E2E_QUALIFYING_FRAMES")),
        "TIMEOUT_CYCLES": str(enumerator(module, "NODE_TIMEOUT_CYCLES")),
        "P2_DATA_IDS": " ".join(f"{entry:02x}" for entry in data_ids()),
    }
    numbers |= {f"P5_{name}": f"0x{value:X}" for name, value in P5.items()}
    numbers |= {f"P2_{name}": f"0x{value:X}" for name, value in P2.items()}
    for name, value in numbers.items():
        text = text.replace(f"@{name}@", value)
    return text
