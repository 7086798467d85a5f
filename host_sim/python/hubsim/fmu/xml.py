# SPDX-License-Identifier: Apache-2.0
"""Model descriptions of a unit in both versions of the standard.

And the build description of FMI 3.0.
"""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from regen_table import installation

from hubsim.fmu.description import CODE, FIXED, FLAG, INPUT, OUTPUT, REAL, Description, Variable
from hubsim.fmu.units import base_powers

STOP_S = 10.0
_TYPE = {
    2: {REAL: "Real", FLAG: "Boolean", CODE: "Integer"},
    3: {REAL: "Float64", FLAG: "Boolean", CODE: "Int32"},
}


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
    if v.kind != FLAG and v.lowest is not None and v.highest is not None:
        whole = v.kind == CODE
        own |= {"min": _value(v.lowest, whole), "max": _value(v.highest, whole)}
    if v.role != OUTPUT:
        own["start"] = (
            ("true" if v.start else "false") if v.kind == FLAG else _value(v.start, v.kind == CODE)
        )
    if fmi == 2:
        ET.SubElement(ET.SubElement(listed, "ScalarVariable", common), _TYPE[2][v.kind], own)
    else:
        ET.SubElement(listed, _TYPE[3][v.kind], common | own)


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
