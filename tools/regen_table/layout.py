# SPDX-License-Identifier: Apache-2.0
"""The memory layout and the accepted ranges of config_t.

Read from firmware/config/include/config/config.h.

That header alone defines them. It is run through the C preprocessor of whatever
compiler is at hand (``$CC``, cc, gcc, clang or arm-none-eabi-gcc), and cffi computes the layout
from the result, so a field added there appears here without a change. An installed distribution has
the expanded text instead of the header (host_sim/python/bake.py) and needs no compiler; where that
is written there is no cffi, so that it is imported only where a layout is computed. What was
computed from a header is kept (stored.py).
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from regen_table import declarations, installation, stored
from regen_table.declarations import DeclarationError
from regen_table.errors import ConfigurationError

if TYPE_CHECKING:
    import cffi

HEADER = installation.ROOT / "firmware" / "config" / "include" / "config" / "config.h"
# What an installed distribution has in the place of the header.
EXPANDED = installation.ROOT / "config_header.i"
LISTS_BEGIN = "regen_lists_begin"
_COMPILERS = ("cc", "gcc", "clang", "arm-none-eabi-gcc")


@dataclass(frozen=True)
class FieldInfo:
    """One line of a field list in config.h."""

    name: str
    count: int
    lowest: int
    highest: int
    unit: str
    text: str


@dataclass(frozen=True)
class Layout:
    """Contents of the header.

    Attributes
    ----------
    ffi : cffi.FFI
        Knows ``config_t``.
    sections : dict
        Section name to its fields, in order.
    constants : dict
        Value of every object-like integer macro CONFIG_*.
    """

    ffi: "cffi.FFI"
    sections: dict[str, dict[str, FieldInfo]]
    constants: dict[str, int] = field(default_factory=dict)

    @property
    def size_bytes(self) -> int:
        """Size of config_t."""
        return int(self.ffi.sizeof("config_t"))


@cache
def load(header: Path = HEADER) -> Layout:
    """Read the header, once in the life of the process."""
    if sys.byteorder != "little":
        raise ConfigurationError(
            "configuration images are little endian, as the microcontroller is; so must this"
            " machine be"
        )
    content = (header_text(header).encode(),)
    text = stored.by_content("header", content, lambda: expanded(header).encode())
    return parse(text.decode(), header)


def header_text(header: Path = HEADER) -> str:
    """Return everything that a layout depends on."""
    if installation.INSTALLED and header == HEADER:
        return EXPANDED.read_text(encoding="utf-8")
    return _whole(header)


def parse(text: str, header: Path = HEADER) -> Layout:
    """Compute the layout from the expanded header; ``header`` names it in messages."""
    declared, _, lists = text.partition(LISTS_BEGIN)
    try:
        ffi = declarations.known(
            re.sub(r"_Static_assert\s*\(.*?\)\s*;", "", declared, flags=re.DOTALL)
        )
        sections = _sections(ffi, lists)
    except (DeclarationError, KeyError) as error:
        raise ConfigurationError(
            f"{header}: not understood: {' '.join(str(error).split())}"
        ) from error
    pairs = re.findall(r'regen_constant\("(\w+)",\s*(0[xX][0-9a-fA-F]+|\d+)[uUlL]*\);', lists)
    return Layout(ffi, sections, {name: int(value, 0) for name, value in pairs})


def _sections(ffi: "cffi.FFI", lists: str) -> dict[str, dict[str, FieldInfo]]:
    """Order the expanded field lists into the sections of config_t."""
    members = {
        name: _struct_fields(info.type)
        for name, info in _struct_fields(ffi.typeof("config_t")).items()
    }
    sections: dict[str, dict[str, FieldInfo]] = {
        name: {} for name, fields in members.items() if fields
    }
    for part in lists.split("regen_list(")[1:]:
        macro = part[1 : part.index('"', 1)]
        for field_text in re.findall(r"regen_field\((.*?)\) regen_end", part, flags=re.DOTALL):
            name, count, lowest, highest, unit, text = _split(field_text)
            own = macro.removeprefix("CONFIG_").removesuffix("_FIELDS").lower()
            section = (
                own
                if own in sections
                else next(s for s, fields in members.items() if name in fields)
            )
            sections[section][name] = FieldInfo(
                name,
                _integer(count),
                _integer(lowest),
                _integer(highest),
                unit.strip('"'),
                text.strip('"'),
            )
    for section, fields in sections.items():
        missing = set(members[section]) - set(fields)
        if missing:
            raise KeyError(f"{section}.{sorted(missing)[0]} has no line in a field list")
        sections[section] = {name: fields[name] for name in members[section]}
    return sections


def _struct_fields(ctype: Any) -> dict[str, Any]:  # noqa: ANN401, cffi's types have no public names
    return dict(ctype.fields) if ctype.kind == "struct" else {}


_QUOTED = r'"((?:[^"\\]|\\.)*)"'


def _joined(text: str) -> str:
    """Join adjacent string literals, as a C compiler does."""
    return re.sub(
        rf"{_QUOTED}(?:\s+{_QUOTED})+",
        lambda literals: '"' + "".join(re.findall(_QUOTED, literals[0])) + '"',
        text,
    )


def _split(text: str) -> list[str]:
    """Split the six arguments of a field line at the commas outside its quoted texts."""
    return [part.strip() for part in re.findall(r'"(?:[^"\\]|\\.)*"|[^,"\s][^,"]*', _joined(text))]


def _integer(text: str) -> int:
    if not re.fullmatch(r"[-+]?\s*(0[xX][0-9a-fA-F]+|\d+)", text):
        raise KeyError(f"{text} is not a whole number")
    return int(text.replace(" ", ""), 0)


def _whole(header: Path) -> str:
    """Return a header's text with the project's own headers in place of their include lines."""
    try:
        text = header.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{header}: cannot be read: {error.strerror}") from error
    return re.sub(
        r'^#include "([\w/]+\.h)"$',
        lambda line: _whole(header.parents[1] / line[1]),
        text,
        flags=re.MULTILINE,
    )


def expanded(header: Path = HEADER) -> str:
    """Return the declarations, then what stands in the field lists and constants."""
    text = header_text(header)
    if installation.INSTALLED and header == HEADER:
        return text
    lists = re.findall(
        r"^#define\s+(CONFIG_\w+_(?:FIELDS|ARRAY))\((\w)\)", text, flags=re.MULTILINE
    )
    constants = [
        name
        for name in re.findall(r"^#define\s+(CONFIG_\w+)[ \t]+\S", text, flags=re.MULTILINE)
        if not name.endswith(("_MEMBER", "_FIELDS", "_ARRAY"))
    ]
    # Standard headers say nothing about the layout, and cffi knows the fixed-width types by itself.
    bare = re.sub(r"^\s*#\s*include\s*<[^>]*>", "", text, flags=re.MULTILINE)
    source = [bare, LISTS_BEGIN]
    source.append(
        "#define REGEN_SCALAR(name, lowest, highest, unit, text) "
        "regen_field(name, 0, lowest, highest, unit, text) regen_end"
    )
    source.append(
        "#define REGEN_ARRAY(name, count, lowest, highest, unit, text) "
        "regen_field(name, count, lowest, highest, unit, text) regen_end"
    )
    source += [
        f'regen_list("{name}"); {name}({"REGEN_SCALAR" if letter == "X" else "REGEN_ARRAY"})'
        for name, letter in lists
    ]
    source += [f'regen_constant("{name}", {name});' for name in constants]
    return _preprocess("\n".join(source) + "\n", header)


def _preprocess(source: str, header: Path) -> str:
    """Run the first C preprocessor found over a text."""
    named = os.environ.get("CC")
    candidates = [shlex.split(named)] if named else []
    candidates += [[name] for name in _COMPILERS]
    command = next((c for c in candidates if shutil.which(c[0])), None)
    if command is None:
        raise ConfigurationError(
            f"no C preprocessor found to read {header.name}: "
            f"install one of {', '.join(_COMPILERS)} or set CC"
        )
    arguments = [*command, "-E", "-P", "-x", "c", "-I", str(header.parents[1]), "-"]
    done = subprocess.run(arguments, input=source, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = next(iter(done.stderr.strip().splitlines()), "no message")
        raise ConfigurationError(f"{header}: {command[0]} refused it: {reason}")
    return done.stdout
