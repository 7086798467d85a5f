# SPDX-License-Identifier: Apache-2.0
"""The package of a unit: its C table, model description, binary, sources and documentation.

Model descriptions are those of FMI 2.0 and 3.0, the build description that of FMI 3.0.
"""

import platform
import re
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from regen_table import installation

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.fmu.description import (
    CODE,
    FIXED,
    FLAG,
    INPUT,
    OUTPUT,
    REAL,
    Description,
    Variable,
    base_powers,
    enumerations,
)

_STAMP = (1980, 1, 1, 0, 0, 0)  # the same content is the same package
_MACHINE = {"x86_64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_FMI2_FOLDER = {"x86_64": "linux64", "aarch64": "aarch64-linux"}
STOP_S = 10.0
_HAL_HEADER = re.compile(r'#include "(hal/[^"]+)"')
_TYPE = {
    2: {REAL: "Real", FLAG: "Boolean", CODE: "Integer"},
    3: {REAL: "Float64", FLAG: "Boolean", CODE: "Int32"},
}


def platform_folder(fmi: int) -> str:
    """Return the folder below binaries/ of this platform."""
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
        folder = module.name if module.name != "generated" else f"{module.parent.name}/generated"
        found[f"{folder}/{path.name}"] = path
        for header in sorted((module / "include").rglob("*.h")):
            found[header.relative_to(module / "include").as_posix()] = header
        for header in sorted(module.glob("*.h")):
            found[f"{folder}/{header.name}"] = header
    interface = installation.ROOT / "hal" / "include"  # of which the bench needs a pure header
    texts = [path.read_text(encoding="utf-8") for path in found.values()]
    return found | {name: interface / name for text in texts for name in _HAL_HEADER.findall(text)}


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
        "modelDescription.xml": model_description(unit, fmi, compiled).encode()
    }
    entries[f"binaries/{platform_folder(fmi)}/{unit.identifier}.so"] = binary.read_bytes()
    entries |= {f"sources/{name}": path.read_bytes() for name, path in sources.items()}
    if fmi == 3:
        entries["sources/buildDescription.xml"] = build_description(unit, compiled).encode()
    where = "documentation/licenses" if fmi == 3 else "documentation"
    entries[f"{where}/license.txt"] = licence.read_bytes()
    entries["documentation/index.html"] = _page(unit).encode()
    files.write_by_name(out, lambda temporary: write_zip(entries, temporary))


def model_description(unit: Description, fmi: int, sources: Sequence[str]) -> str:
    """Return modelDescription.xml; ``sources`` are file names below sources/."""
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{fmi}.0",
            "modelName": unit.identifier,
            "guid" if fmi == 2 else "instantiationToken": unit.token,
            "description": unit.text,
            "version": installation.version(),
            "license": "Apache-2.0",
            "generationTool": installation.identity("hubfoc"),
            "variableNamingConvention": "structured",
        },
    )
    _co_simulation(root, unit, fmi, sources)
    _units(root, unit, fmi)
    _types(root, unit, fmi)
    ET.SubElement(
        root,
        "DefaultExperiment",
        {"startTime": "0", "stopTime": _number(STOP_S), "stepSize": _number(unit.step_s)},
    )
    listed = ET.SubElement(root, "ModelVariables")
    if fmi == 3:
        time = {
            "name": "time",
            "valueReference": "0",
            "causality": "independent",
            "variability": "continuous",
        }
        ET.SubElement(listed, "Float64", time | {"description": "since the run began", "unit": "s"})
    for reference, variable in enumerate(unit.variables, start=1):
        _variable(listed, variable, reference, fmi)
    _structure(root, unit, fmi)
    return _text(root)


def build_description(unit: Description, sources: Sequence[str]) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": unit.identifier})
    files = ET.SubElement(configuration, "SourceFileSet", {"language": "C11"})
    for name in sources:
        ET.SubElement(files, "SourceFile", {"name": name})
    ET.SubElement(files, "IncludeDirectory", {"name": "."})
    return _text(root)


def _co_simulation(root: ET.Element, unit: Description, fmi: int, sources: Sequence[str]) -> None:
    flags = {
        "modelIdentifier": unit.identifier,
        "needsExecutionTool": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "canBeInstantiatedOnlyOncePerProcess": "false",
    }
    state = "FMUstate" if fmi == 2 else "FMUState"
    flags |= {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    if fmi == 3:
        flags["fixedInternalStepSize"] = _number(unit.period_s)
    element = ET.SubElement(root, "CoSimulation", flags)
    if fmi == 2:
        files = ET.SubElement(element, "SourceFiles")
        for name in sources:
            ET.SubElement(files, "File", {"name": name})


def _units(root: ET.Element, unit: Description, fmi: int) -> None:
    definitions = ET.SubElement(root, "UnitDefinitions")
    used = {v.unit for v in unit.variables if v.unit} | ({"s"} if fmi == 3 else set())
    for name in sorted(used):
        powers = {key: _number(value) for key, value in base_powers(name).items()}
        ET.SubElement(ET.SubElement(definitions, "Unit", {"name": name}), "BaseUnit", powers)


def _types(root: ET.Element, unit: Description, fmi: int) -> None:
    """Name the values of modes and reasons, where the unit has some."""
    used = {v.enumeration for v in unit.variables}
    definitions = ET.SubElement(root, "TypeDefinitions")
    for name, items in enumerations().items():
        if name not in used:
            continue
        if fmi == 2:
            kind = ET.SubElement(definitions, "SimpleType", {"name": name})
            listed = ET.SubElement(kind, "Enumeration")
        else:
            listed = ET.SubElement(definitions, "EnumerationType", {"name": name})
        for item in items:
            described = {"description": item.text} if item.text else {}
            ET.SubElement(listed, "Item", {"name": item.name, "value": str(item.value)} | described)


def _variable(listed: ET.Element, v: Variable, reference: int, fmi: int) -> None:
    common = {"name": v.name, "valueReference": str(reference), "description": v.text}
    common["causality"] = {INPUT: "input", OUTPUT: "output"}.get(v.role, "parameter")
    if v.role in {INPUT, OUTPUT}:
        common["variability"] = "continuous" if v.kind == REAL else "discrete"
    else:
        common["variability"] = "fixed" if v.role == FIXED else "tunable"
    common["initial"] = "calculated" if v.role == OUTPUT else "exact"
    if v.role == INPUT:
        del common["initial"]  # an input's start value is what it is
    own = {}
    if v.unit:
        own["unit"] = v.unit
    if v.enumeration:
        own["declaredType"] = v.enumeration
    elif v.kind != FLAG and v.lowest is not None and v.highest is not None:
        whole = v.kind == CODE
        own |= {"min": _value(v.lowest, whole), "max": _value(v.highest, whole)}
    if v.role != OUTPUT:
        own["start"] = (
            ("true" if v.start else "false") if v.kind == FLAG else _value(v.start, v.kind == CODE)
        )
    kind = "Enumeration" if v.enumeration else _TYPE[fmi][v.kind]
    if fmi == 2:
        ET.SubElement(ET.SubElement(listed, "ScalarVariable", common), kind, own)
    else:
        ET.SubElement(listed, kind, common | own)


def _structure(root: ET.Element, unit: Description, fmi: int) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [reference for reference, v in enumerate(unit.variables, start=1) if v.role == OUTPUT]
    if fmi == 3:
        for tag in ("Output", "InitialUnknown"):
            for reference in outputs:
                ET.SubElement(structure, tag, {"valueReference": str(reference)})
        return
    for tag in ("Outputs", "InitialUnknowns"):
        group = ET.SubElement(structure, tag)
        for index in outputs:
            ET.SubElement(group, "Unknown", {"index": str(index)})


def _value(value: float, whole: bool) -> str:
    return str(int(value)) if whole else _number(value)


def _number(value: float) -> str:
    """Return the shortest text that is this very number."""
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def write_zip(entries: Mapping[str, bytes], path: Path) -> None:
    """Write a package: the same content is the same bytes."""
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
        "configuration_crc32": installation.crc32(unit.config.image),
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
