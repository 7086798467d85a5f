# SPDX-License-Identifier: Apache-2.0
"""The list of accessors reads every field of what the firmware gives."""

import re
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
FIRMWARE = HERE.parents[1] / "firmware"
ACCESSORS = (HERE / "accessors.h").read_text(encoding="utf-8")
TABLE = FIRMWARE / "torque/include/torque/torque_limits.h"
MODULES = ("core", "foc", "controller", "torque")
NUMBERS = {
    *("bool", "int8_t", "int16_t", "int32_t", "int64_t", "uint8_t", "uint16_t", "uint32_t"),
    *("reason_t", "bridge_mode_t", "operating_mode_t", "waits_for_t", "drive_direction_t"),
}
PAIRS = {"q_pair_t": ("x", "y")}
SIZES = {"SENSE_PHASES": 3}
LISTS = {
    "ORACLE_FAST_OUTPUT": ("output", "fast_output_t"),
    "ORACLE_FAST_REPORT": ("report", "fast_report_t"),
    "ORACLE_SETPOINT": ("setpoint", "fast_setpoint_t"),
    "ORACLE_SLOW_OUTPUT": ("output", "slow_output_t"),
    "ORACLE_LIMITS": ("limits", "torque_limits_t"),
}

Structures = dict[str, list[tuple[str, str]]]


def without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)


def structures_of(text: str) -> Structures:
    """Return the fields of every structure of a header: type and name, arrays with their size."""
    found: Structures = {}
    for body, name in re.findall(
        r"typedef struct \{(.*?)\} (\w+);", without_comments(text), re.DOTALL
    ):
        fields = []
        for declaration in body.split(";"):
            words = declaration.split()
            if words:
                names = " ".join(words[1:]).split(",")
                fields += [(words[0], one.strip()) for one in names]
        found[name] = fields
    return found


def torque_lines(text: str) -> list[str]:
    listed = re.search(r"#define TORQUE_LINES\(X\)(.*?)\n\n", text, re.DOTALL)
    assert listed is not None
    return re.findall(r"X\((\w+),", listed[1])


def leaves(structures: Structures, kind: str, lines: list[str], path: str = "") -> list[str]:
    """Return the paths of all numbers in a type, "tuning.advance.v.x"."""
    if kind in NUMBERS:
        return [path]
    if kind in PAIRS:
        return [f"{path}.{part}" for part in PAIRS[kind]]
    out = []
    for inner, name in structures[kind]:
        field, _, size = name.partition("[")
        size = size.rstrip("]")
        places = [f"TORQUE_LINE_{line}" for line in lines] if size == "TORQUE_LINE_COUNT" else None
        if size and places is None:
            places = [str(k) for k in range(SIZES.get(size) or int(size))]
        for index in places or [""]:
            own = f"{field}[{index}]" if index else field
            out += leaves(structures, inner, lines, f"{path}.{own}".lstrip("."))
    return out


def definition(name: str, text: str = ACCESSORS) -> str:
    found = re.search(rf"#define {name}\([^)]*\)((?:[^\n]*\\\n)+[^\n]*)", text)
    assert found is not None, name
    return found[1]


def accessors(name: str, text: str = ACCESSORS) -> list[tuple[str, str]]:
    """Return identifier and expression of every line of a list."""
    if name == "ORACLE_LIMITS":
        one = re.findall(r"X\((.*), (limits->.*)\)", definition("ORACLE_LIMIT_LINE", text))
        uses = re.findall(r"ORACLE_LIMIT_LINE\(X, (\w+), (\w+)\)", definition(name, text))
        return [
            (identifier.replace("##identifier##", short), expression.replace("[line]", f"[{line}]"))
            for short, line in uses
            for identifier, expression in one
        ]
    return re.findall(r"X\((\w+), (.*)\)", definition(name, text))


def path_read(expression: str, variable: str) -> str:
    """Return the field that an expression reads, as ``leaves`` writes it."""
    pair = re.fullmatch(r"q_pair_([xy])\((.*)\)", expression)
    if pair:
        return f"{path_read(pair[2], variable)}.{pair[1]}"
    packed = re.fullmatch(r"dq_of\((.*)\)\.([dq])", expression)
    if packed:
        return f"{path_read(packed[1], variable)}.v.{'xy'['dq'.index(packed[2])]}"
    plain = re.fullmatch(rf"{variable}->([\w.\[\]]+)", expression)
    assert plain is not None, f"{expression}: what field does it read?"
    return plain[1]


@pytest.fixture(scope="module")
def structures() -> Structures:
    found: Structures = {}
    for module in MODULES:
        for header in sorted((FIRMWARE / module).rglob("*.h")):
            found |= structures_of(header.read_text(encoding="utf-8"))
    return found


@pytest.fixture(scope="module")
def lines() -> list[str]:
    return torque_lines(TABLE.read_text(encoding="utf-8"))


def not_hashed(kind: str) -> set[str]:
    given = re.findall(r'X\((\w+), (\w+), "[^"]+"\)', definition("ORACLE_NOT_HASHED"))
    return {field for structure, field in given if structure == kind}


@pytest.mark.parametrize("name", LISTS)
def test_every_field_has_an_accessor(name: str, structures: Structures, lines: list[str]) -> None:
    variable, kind = LISTS[name]
    left_out = not_hashed(kind)
    fields = [field for field in structures[kind] if field[1] not in left_out]
    wanted = leaves({**structures, kind: fields}, kind, lines)
    read = [path_read(expression, variable) for _, expression in accessors(name)]
    assert sorted(set(wanted) - set(read)) == [], (
        f"{kind} has fields that {name} does not read: add them to tests/oracle/accessors.h, "
        "in ORACLE_NOT_HASHED until a baseline has them"
    )
    assert sorted(set(read) - set(wanted)) == []


@pytest.mark.parametrize("name", [*LISTS, "ORACLE_EVENTS"])
def test_every_identifier_is_given_once(name: str) -> None:
    identifiers = [identifier for identifier, _ in accessors(name)]
    assert len(identifiers) == len(set(identifiers)) > 3


def test_the_fields_that_are_not_hashed_exist(structures: Structures) -> None:
    given = re.findall(r'X\((\w+), (\w+), "[^"]+"\)', definition("ORACLE_NOT_HASHED"))
    assert given
    assert [one for one in given if one[1] not in [name for _, name in structures[one[0]]]] == []


def test_a_field_without_an_accessor_is_found() -> None:
    header = "typedef struct { int32_t a_mA, b_mA[2]; /* c_mA */ bool d; q_pair_t e; } some_t;"
    listed = "#define LIST(X) \\\n    X(one, some->a_mA) \\\n    X(two, q_pair_y(some->e))\n"
    read = {path_read(expression, "some") for _, expression in accessors("LIST", listed)}
    wanted = leaves(structures_of(header), "some_t", [])
    assert [path for path in wanted if path not in read] == ["b_mA[0]", "b_mA[1]", "d", "e.x"]
