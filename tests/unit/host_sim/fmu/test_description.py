# SPDX-License-Identifier: Apache-2.0
"""The model description of an FMU.

Causality, units and start values come from the lists of the simulation.
"""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import hubsim
import pytest
from hubsim import reasons
from hubsim.engine import ROOT
from hubsim.fmu.description import (
    CODE,
    FIXED,
    INPUT,
    OUTPUT,
    VEHICLE_FIXED,
    VEHICLE_INPUTS,
    VEHICLE_SETTINGS,
    Description,
    base_powers,
    describe,
    standard_unit,
)
from hubsim.fmu.pack import c_table, model_description
from regen_table import installation

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


@pytest.fixture(scope="module")
def vehicle() -> Description:
    return describe("vehicle", LU2013)


@pytest.fixture(scope="module")
def controller() -> Description:
    return describe("controller", LU2013)


def test_the_vehicle_fmu_contains_every_parameter_and_signal(vehicle: Description) -> None:
    names = [v.name for v in vehicle.variables]
    assert len(names) == len(set(names))
    assert set(hubsim.parameters()) == {
        v.name for v in vehicle.variables if v.role != OUTPUT
    } | set(vehicle.settings)
    with hubsim.Bench(LU2013, record=()) as bench:
        assert set(bench.signals()) == {v.name for v in vehicle.variables if v.role == OUTPUT}


def test_every_variable_with_a_causality_exists(vehicle: Description) -> None:
    assert set(hubsim.parameters()) >= VEHICLE_INPUTS | VEHICLE_FIXED | VEHICLE_SETTINGS
    roles = {v.name: v.role for v in vehicle.variables}
    assert roles["driver.brake_demand_nm"] == INPUT
    assert roles["run.seed"] == FIXED
    assert "wheel7.current_offset_a" in vehicle.settings


def test_the_controller_fmu_contains_inputs_and_outputs_of_both_steps(
    controller: Description,
) -> None:
    ports = hubsim.Controller.variables()
    expected = [
        f"{port}.{v.name}"
        for port in ("fast_input", "slow_input", "fast_output", "slow_output")
        for v in ports[port]
    ]
    assert [v.name for v in controller.variables] == expected
    assert controller.step_s == hubsim.Controller(LU2013).period_s


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_contains_version_and_commit(fmi: int, controller: Description) -> None:
    root = ET.fromstring(model_description(controller, fmi, ["table.c"]))
    assert root.get("version") == installation.version()
    assert root.get("generationTool") == installation.identity("hubfoc")


@pytest.mark.parametrize("fmi", [2, 3])
def test_every_variable_has_a_description_and_a_unit(
    fmi: int, vehicle: Description, controller: Description
) -> None:
    for unit in (vehicle, controller):
        root = ET.fromstring(model_description(unit, fmi, ["table.c"]))
        defined = {element.get("name") for element in root.iter("Unit")}
        listed = root.find("ModelVariables")
        assert listed is not None
        assert all(element.get("description") for element in listed)
        used = {element.get("unit") for element in listed.iter() if element.get("unit")}
        assert used == defined


@pytest.mark.parametrize(
    ("unit", "powers"),
    [
        ("N.m", {"kg": 1, "m": 2, "s": -2}),
        ("m/s2", {"m": 1, "s": -2}),
        ("1/m", {"m": -1}),
        ("K/W", {"K": 1, "kg": -1, "m": -2, "s": 3}),
        ("V.s/rad", {"kg": 1, "m": 2, "s": -2, "A": -1, "rad": -1}),
        ("A.h", {"A": 1, "s": 1, "factor": 3600.0}),
        ("degC", {"K": 1, "offset": 273.15}),
        ("turn/min", {"rad": 1, "s": -1, "factor": pytest.approx(2.0 * 3.141592653589793 / 60.0)}),
        ("m/m", {}),
    ],
)
def test_units_are_powers_of_base_units(unit: str, powers: dict[str, float]) -> None:
    assert base_powers(unit) == powers


def test_an_invalid_physical_unit_is_an_error_that_names_it() -> None:
    assert standard_unit("N m s") == "N.m.s"
    assert standard_unit("1") == standard_unit("") == ""
    with pytest.raises(hubsim.HubsimError, match="furlong"):
        standard_unit("furlong/s")


def test_the_token_depends_on_the_configuration(vehicle: Description, tmp_path: Path) -> None:
    other = tmp_path / "heavy.toml"
    other.write_text(
        LU2013.read_text(encoding="utf-8").replace("mass_kg = 660.0", "mass_kg = 700.0"),
        encoding="utf-8",
    )
    heavy = describe("vehicle", other)
    assert heavy.token != vehicle.token
    assert heavy.token in c_table(heavy)
    assert {v.name: v.start for v in heavy.variables}["vehicle.mass_kg"] == 700.0
    with pytest.raises(hubsim.HubsimError, match="no such kind"):
        describe("wheel", LU2013)


def modes_of_the_firmware() -> dict[str, int]:
    """Return the modes by name, as the header lists them."""
    path = ROOT / "firmware" / "core" / "include" / "core" / "operating_mode.h"
    found = re.findall(r"MODE_(\w+) = (\d+)", path.read_text(encoding="utf-8"))
    return {name: int(value) for name, value in found}


@pytest.mark.parametrize("fmi", [2, 3])
def test_modes_and_reasons_are_enumerations_with_their_names(
    fmi: int, vehicle: Description, controller: Description
) -> None:
    for unit, some in (
        (vehicle, {"wheel0.mode", "wheel3.first_fault_reason", "wheel0.waits_for"}),
        (controller, {"slow_output.mode", "slow_output.torque_reason", "slow_input.demand_reason"}),
    ):
        root = ET.fromstring(model_description(unit, fmi, ["table.c"]))
        tag = "SimpleType" if fmi == 2 else "EnumerationType"
        named = {
            kind.get("name"): {
                str(item.get("name")): int(str(item.get("value"))) for item in kind.iter("Item")
            }
            for kind in root.iter(tag)
        }
        assert named["mode"] == modes_of_the_firmware()
        assert named["reason"]["NONE"] == 0
        assert named["reason"] == reasons.codes()
        for items in named.values():
            assert len(set(items.values())) == len(items)
        listed = root.find("ModelVariables")
        assert listed is not None
        typed = {
            (one.get("name") or variable.get("name")): one.get("declaredType")
            for variable in listed
            for one in ([variable] if fmi == 3 else list(variable))
            if one.tag == "Enumeration"
        }
        assert set(typed) >= some
        assert set(typed.values()) == {"mode", "reason"}
        assert all((kind == "mode") == str(name).endswith(".mode") for name, kind in typed.items())
        # Every code that is called a reason or a mode is one, and nothing else.
        codes = {v.name for v in unit.variables if v.kind == CODE}
        assert {n for n in codes if n.endswith(("reason", ".mode"))} <= set(typed) <= codes
