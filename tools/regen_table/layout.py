# SPDX-License-Identifier: Apache-2.0
"""The memory layout and the accepted ranges of config_t.

Read from firmware/config/include/config/config.h.

That header is the only place that knows them. ``config_header`` expands it, through a C
preprocessor or, in an installed distribution, once and for all when that was built; cffi computes
the layout from the result, so a field added there appears here without a change.
"""

import re
import sys
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import cffi

from regen_table import config_header
from regen_table.config_header import HEADER
from regen_table.errors import ConfigurationError


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
    """Everything the header says.

    Attributes
    ----------
    ffi : cffi.FFI
        Knows ``config_t``.
    sections : dict
        Section name to its fields, in order.
    constants : dict
        Value of every object-like integer macro CONFIG_*.
    """

    ffi: cffi.FFI
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
    return parse(config_header.expanded(header), header)


def parse(text: str, header: Path = HEADER) -> Layout:
    """Compute the layout from the expanded header; ``header`` names it in messages."""
    declarations, _, expanded = text.partition(config_header.LISTS_BEGIN)
    ffi = cffi.FFI()
    try:
        ffi.cdef(re.sub(r"_Static_assert\s*\(.*?\)\s*;", "", declarations, flags=re.DOTALL))
        sections = _sections(ffi, expanded)
    except (cffi.CDefError, cffi.FFIError, KeyError) as error:
        raise ConfigurationError(
            f"{header}: not understood: {' '.join(str(error).split())}"
        ) from error
    pairs = re.findall(r'regen_constant\("(\w+)",\s*(0[xX][0-9a-fA-F]+|\d+)[uUlL]*\);', expanded)
    return Layout(ffi, sections, {name: int(value, 0) for name, value in pairs})


def _sections(ffi: cffi.FFI, expanded: str) -> dict[str, dict[str, FieldInfo]]:
    """Order the expanded field lists into the sections of config_t."""
    members = {
        name: _struct_fields(info.type)
        for name, info in _struct_fields(ffi.typeof("config_t")).items()
    }
    sections: dict[str, dict[str, FieldInfo]] = {
        name: {} for name, fields in members.items() if fields
    }
    for part in expanded.split("regen_list(")[1:]:
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
