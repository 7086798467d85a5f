# SPDX-License-Identifier: Apache-2.0
"""The protocol as its users see it.

The DBC through cantools, and the firmware's C through its own headers.
"""

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any, TypeAlias

import cantools
import cffi
from cantools.database.can import Database, Message, Signal

ROOT = Path(__file__).resolve().parents[4]
FIRMWARE = ROOT / "firmware"
MODULE = FIRMWARE / "comms"
DBC = MODULE / "hubfoc.dbc"

WHEELS = {"FRONT_LEFT": 0, "FRONT_RIGHT": 1, "REAR_LEFT": 2, "REAR_RIGHT": 3}
BASE = 0x100  # of the identifiers in the DBC
WHEEL_MASK = 0x7FC  # bits of an identifier that select the message

# A structure, an enumerator's or a function's value of the C, which has the types that the headers
# give it.
CValue: TypeAlias = Any


FOUR_WHEELS_DBC = MODULE / "hubfoc_four_wheels.dbc"


def attribute(owner: Message | Signal, name: str) -> int | str:
    """Return an attribute's value; of a message or signal that does not name it, the default."""
    assert owner.dbc is not None
    found = owner.dbc.attributes.get(name)
    assert found is not None, name
    value = found.value
    assert isinstance(value, int | str)
    return value


def load(frame_id_mask: int | None = None) -> Database:
    """Load the DBC strictly."""
    loaded = cantools.database.load_file(str(DBC), strict=True, frame_id_mask=frame_id_mask)
    assert isinstance(loaded, Database)
    return loaded


class Comms:
    """The module's C: ``ffi`` for its types, ``lib`` for its functions."""

    def __init__(self, library: Path, bare: Path) -> None:
        """Read the declarations from the headers."""
        for name in ("stdint.h", "stdbool.h"):  # cffi knows these types by itself
            (bare / name).write_text("", encoding="utf-8")
        compiler = shutil.which("cc") or shutil.which("gcc")
        assert compiler is not None
        includes = [
            f"-I{directory}"
            for directory in (bare, MODULE / "include", FIRMWARE / "core" / "include")
        ]
        command = [compiler, "-E", "-P", "-nostdinc", *includes, "-"]
        text = '#include "comms/messages.h"\n'
        declarations = subprocess.run(
            command, input=text, capture_output=True, text=True, check=True
        ).stdout
        self.ffi = cffi.FFI()
        self.ffi.cdef(declarations)
        self.lib: CValue = self.ffi.dlopen(str(library))

    def struct(self, name: str, **values: CValue) -> CValue:
        """Return a structure with the given members, the others zero."""
        made = self.ffi.new(f"{name} *")
        for member, value in values.items():
            setattr(made, member, value)
        return made

    def address(self, wheel: int, base: int = BASE) -> CValue:
        """Return a wheel's place on the bus."""
        return self.struct("messages_address_t", base=base, wheel=wheel)[0]

    def number(self, name: str) -> int:
        """Return the value of an enumerator."""
        return int(getattr(self.lib, name))


def listed_in(header: str) -> dict[int, str]:
    """Return number and name of every line of a header's list."""
    text = (FIRMWARE / header).read_text(encoding="utf-8")
    return {
        int(number): name
        for number, name in re.findall(r"^\s*X\((\d+), (\w+), \"", text, re.MULTILINE)
    }


def reasons() -> dict[int, str]:
    """Return number and name of every reason of core/reason.h."""
    found = listed_in("core/include/core/reason.h")
    assert found[0] == "NONE"
    assert len(found) > 20
    return found


def enumerators(header: str, prefix: str) -> dict[int, str]:
    """Return number and name, without the prefix, of the enumerators of a firmware header that
    begin so.
    """
    text = (FIRMWARE / header).read_text(encoding="utf-8")
    return {int(number): name for name, number in re.findall(rf"\b{prefix}_(\w+) = (\d+)", text)}
