# SPDX-License-Identifier: Apache-2.0
"""Writing a configuration: <name>.c and <name>.bin together, or neither.

The C source is one constant with designated initialisers, the same bytes as the binary image.
"""

import re
import textwrap
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from regen_table import __version__, image, installation, layout, outputs
from regen_table.errors import CheckFailedError
from regen_table.schema import Drive

# In the repository, where its build looks for them; elsewhere, where the caller is.
GENERATED = (
    Path() if installation.INSTALLED else installation.ROOT / "firmware" / "config" / "generated"
)
FIGURES = Path("figures") if installation.INSTALLED else installation.ROOT / "build/report/figures"
_COLUMNS = 100
_HEAD = """\
/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "{name}": {motor}.
 *
 * Written by tools/regen_table {version} from {name}.toml; the same bytes as {name}.bin. Do not
 * edit: change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t {symbol};

CONFIG_SECTION const config_t {symbol} = {{
    .magic = CONFIG_MAGIC,
    .format_version = {format_version},
    .size_bytes = sizeof(config_t),
    .generator_version = 0x{generator_version:08X},
    .name = "{name}",
"""


@dataclass(frozen=True)
class Artefacts:
    """The files of one configuration, by their names below the output directory, and the image."""

    files: dict[str, bytes]
    image: bytes


def artefacts(drive: Drive) -> Artefacts:
    """Compute both files of a drive."""
    raw = image.build(drive)
    return Artefacts(
        {f"{drive.name}.c": c_source(drive, raw).encode("ascii"), f"{drive.name}.bin": raw}, raw
    )


def write(drive: Drive, directory: Path) -> list[Path]:
    """Write both files of a drive and return their paths."""
    return write_all(artefacts(drive).files, directory)


def write_all(files: dict[str, bytes], directory: Path) -> list[Path]:
    """Put files into a directory all together or not at all."""
    found = {directory / name: content for name, content in files.items()}
    return outputs.write_files(found, make_directories=True)


def check(drive: Drive, directory: Path) -> None:
    """Compare both files of a drive with what a directory holds.

    Raises CheckFailedError with one line.
    """
    for name, content in artefacts(drive).files.items():
        path = directory / name
        try:
            same = path.read_bytes() == content
        except FileNotFoundError:
            raise CheckFailedError(f"{path}: missing; write it with ./tools/dev table") from None
        except OSError as error:
            raise CheckFailedError(f"{path}: cannot be read: {error.strerror}") from error
        if not same:
            raise CheckFailedError(
                f"{path}: differs from what its TOML file generates; renew it with ./tools/dev"
                " table"
            )


def symbol(drive: Drive) -> str:
    """Return the name of the C constant."""
    return "CONFIG_" + re.sub(r"\W", "_", drive.name).upper()


def c_source(drive: Drive, raw: bytes) -> str:
    """Return the C file of a drive whose image is ``raw``.

    Depends on nothing else, so its bytes repeat.
    """
    header = layout.load()
    lines = [
        _HEAD.format(
            name=drive.name,
            motor=re.sub(r"[^ -~]|[\\*/]", "?", drive.motor.name),
            version=__version__,
            symbol=symbol(drive),
            format_version=header.constants["CONFIG_FORMAT_VERSION"],
            generator_version=image.generator_version(),
        )
    ]
    packed = header.ffi.from_buffer("config_t *", raw)
    for section, fields in header.sections.items():
        lines.append(f"    .{section} = {{\n")
        width = max(len(name) for name, info in fields.items() if not info.count)
        for name, info in fields.items():
            value = getattr(getattr(packed, section), name)
            if info.count:
                lines += _array(name, [int(item) for item in value], packed)
            else:
                lines += _scalar(f".{name:<{width}} = {int(value)},", info)
        lines.append("    },\n")
    body = raw[: header.ffi.offsetof("config_t", "crc32")]
    lines.append(f"    .crc32 = 0x{zlib.crc32(body):08X},\n}};\n")
    return "".join(lines)


def _scalar(assignment: str, info: layout.FieldInfo) -> list[str]:
    """Write a field with its unit and meaning, beside it or above it as the width allows."""
    unit = f"[{info.unit}]" if info.unit not in {"", "1"} else ""
    meaning = " ".join(part for part in (unit, info.text) if part)
    line = f"        {assignment}" + (f" /* {meaning} */" if meaning else "")
    if len(line) <= _COLUMNS:
        return [line + "\n"]
    comment = textwrap.wrap(meaning, _COLUMNS - 17)
    above = "\n         * ".join(comment)
    return [f"        /* {above} */\n", f"        {assignment}\n"]


def _array(name: str, values: list[int], packed: Any) -> list[str]:  # noqa: ANN401, a cffi pointer
    """Write an array: a map row by row with what each row stands for, anything else in one line.

    Trailing zeros are implied.
    """
    if name == "torque_mNm":
        grid = packed.regen_map
        temperatures = [
            (grid.temperature_origin_cC + (row << grid.temperature_step_log2)) / 100
            for row in range(grid.temperature_points)
        ]
        step = (1 << grid.speed_step_log2) / 1000
        return _rows(
            name,
            values,
            grid.speed_points,
            f"a column every {step:g} rad/s, mechanical",
            [f"{t:g} degC" for t in temperatures],
        )
    if name == "current_d_mA":
        grid = packed.current_map
        speeds = [(row << grid.speed_step_log2) / 1000 for row in range(grid.speed_points)]
        layers = [
            (grid.temperature_origin_cC + (row << grid.temperature_step_log2)) / 100
            for row in range(grid.temperature_points)
        ]
        first, step = (
            -(grid.torque_points // 2 << grid.torque_step_log2) / 1000,
            (1 << grid.torque_step_log2) / 1000,
        )
        head = f"a column every {step:g} N m from {first:g} N m on"
        return _rows(
            name,
            values,
            grid.torque_points,
            head,
            [f"{w:g} rad/s, {t:g} degC" for t in layers for w in speeds],
        )
    return [f"        .{name} = {{{', '.join(str(value) for value in values)}}},\n"]


def _rows(name: str, values: list[int], columns: int, head: str, labels: list[str]) -> list[str]:
    """Write a map, one labelled row after the other."""
    lines = [f"        .{name} = {{\n", f"            /* {head} */\n"]
    for row, label in enumerate(labels):
        entries = ", ".join(str(value) for value in values[row * columns : (row + 1) * columns])
        lines.append(f"            /* {label} */\n")
        lines += [f"            {part}\n" for part in textwrap.wrap(f"{entries},", _COLUMNS - 12)]
    return [*lines, "        },\n"]
