# SPDX-License-Identifier: Apache-2.0
"""The package of a unit: its C table, description, binary, sources and documentation."""

import platform
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from regen_table import installation, provenance

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.fmu import xml
from hubsim.fmu.description import Description

_STAMP = (1980, 1, 1, 0, 0, 0)  # the same content is the same package
_MACHINE = {"x86_64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_FMI2_FOLDER = {"x86_64": "linux64", "aarch64": "aarch64-linux"}


def platform_folder(fmi: int) -> str:
    """Return the folder below binaries/ that this machine's importers look into."""
    machine = _MACHINE.get(platform.machine())
    if machine is None or platform.system() != "Linux":
        raise HubsimError(
            f"{platform.system()} on {platform.machine()}: units are built on Linux, x86_64 or "
            "aarch64"
        )
    return _FMI2_FOLDER[machine] if fmi == 2 else f"{machine}-linux"


def source_files(listed: Iterable[Path], table: Path) -> dict[str, Path]:
    """Return files by their names below sources/.

    C files in modules (``.../MODULE/FILE.c``), their headers and the table.

    Headers keep the names they are included by, so that sources/ is the only include directory.
    """
    found: dict[str, Path] = {"table.c": table}
    for path in listed:
        module = path.parent
        found[f"{module.name}/{path.name}"] = path
        for header in sorted((module / "include").rglob("*.h")):
            found[header.relative_to(module / "include").as_posix()] = header
        for header in sorted(module.glob("*.h")):
            found[f"{module.name}/{header.name}"] = header
    return found


def write(
    unit: Description,
    fmi: int,
    binary: Path,
    listed: Iterable[Path],
    table: Path,
    licence: Path,
    out: Path,
) -> None:
    """Write a unit; an old one is replaced only by a complete new one."""
    sources = source_files(listed, table)
    compiled = sorted(name for name in sources if name.endswith(".c"))
    entries: dict[str, bytes] = {
        "modelDescription.xml": xml.model_description(unit, fmi, compiled).encode()
    }
    entries[f"binaries/{platform_folder(fmi)}/{unit.identifier}.so"] = binary.read_bytes()
    entries |= {f"sources/{name}": path.read_bytes() for name, path in sources.items()}
    if fmi == 3:
        entries["sources/buildDescription.xml"] = xml.build_description(unit, compiled).encode()
    where = "documentation/licenses" if fmi == 3 else "documentation"
    entries[f"{where}/license.txt"] = licence.read_bytes()
    entries["documentation/index.html"] = _page(unit).encode()
    files.write_by_name(out, lambda temporary: _zip(entries, temporary))


def _zip(entries: Mapping[str, bytes], path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        for name, content in sorted(entries.items()):
            entry = zipfile.ZipInfo(name, _STAMP)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            package.writestr(entry, content)


def _page(unit: Description) -> str:
    """Return the documentation.

    Its origin is version, commit, configuration and CRC; a date would make other bytes of the same
    sources.
    """
    origin = {
        "version": installation.version(),
        "commit": installation.short(installation.commit()),
        "configuration": unit.config.name,
        "configuration_crc32": provenance.crc32(unit.config.image),
    }
    meta = "".join(f'<meta name="hubfoc-{key}" content="{text}">' for key, text in origin.items())
    origin_text = ", ".join(f"{key.replace('_', ' ')} {text}" for key, text in origin.items())
    rows = "\n".join(
        f"<tr><td>{v.name}<td>{v.role.lower()}<td>{v.unit}<td>{v.text}" for v in unit.variables
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><meta charset="utf-8">{meta}'
        f"<title>{unit.identifier}</title>\n<h1>{unit.identifier}</h1>\n"
        f"<p>{unit.text}\n<p>hubfoc, {origin_text}\n"
        f"<table><tr><th>variable<th>role<th>unit<th>meaning\n{rows}\n</table></html>\n"
    )


def c_table(unit: Description) -> str:
    """Return the text of the C file: variables, settings, configuration and voltage curve."""
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0 */",
        f"/* {unit.identifier} of {unit.config.name}: written by hubsim.fmu. */",
        '#include "fmu/model.h"',
        "",
    ]
    lines += [f'const char MODEL_TOKEN[] = "{unit.token}";', ""]
    rows = [
        f'    {{"{v.name}", MODEL_{v.kind}, MODEL_{v.role}, {v.start!r}}},' for v in unit.variables
    ]
    lines += [
        f"const int MODEL_VARIABLE_COUNT = {len(rows)};",
        "const model_variable_t MODEL_VARIABLES[] = {",
        *rows,
        "};",
        "",
    ]
    settings = [f'    {{"{name}", {value!r}}},' for name, value in unit.settings.items()]
    lines += [f"const int MODEL_SETTING_COUNT = {len(settings)};"]
    lines += [
        "const model_setting_t MODEL_SETTINGS[] = {",
        *(settings or ['    {"", 0.0},']),
        "};",
        "",
    ]
    soc, voltage_v = unit.curve
    lines += [f"const int MODEL_CURVE_POINTS = {len(soc)};"]
    lines += [
        f"const double MODEL_CURVE_SOC[] = {{{_listed(soc)}}};",
        f"const double MODEL_CURVE_V[] = {{{_listed(voltage_v)}}};",
        "",
    ]
    image = unit.config.image
    lines += [
        f"const uint32_t MODEL_CONFIG_BYTES = {len(image)};",
        "const unsigned char MODEL_CONFIG[] = {",
    ]
    lines += [
        "    " + ", ".join(map(str, image[at : at + 24])) + "," for at in range(0, len(image), 24)
    ]
    return "\n".join([*lines, "};", ""])


def _listed(values: object) -> str:
    numbers = [float(value) for value in values] if isinstance(values, list | tuple) else []
    return ", ".join(map(repr, numbers)) if numbers else "0.0"
