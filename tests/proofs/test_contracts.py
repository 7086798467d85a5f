# SPDX-License-Identifier: Apache-2.0
"""Every public function has a contract that is proved, or is listed as one without."""

import dataclasses
import re
import shutil
import subprocess
from pathlib import Path

import contract_harness
import contracts
import prove_contracts
import pytest
from planted_errors import PLANTED, PLANTED_IN_PROOFS

HEADER = """
/* A speed. */
int32_t faster(const thing_t *thing, int32_t speed);

void plain(void);
"""
CLAUSES = """
PRE(faster, speed >= 0 && speed <= LIMIT)
POST(faster, result >= old(speed + 1) &&
     result < 9)
"""


def registered(variable: str) -> list[str]:
    """Return the names in one of the lists of CMakeLists.txt."""
    text = (contracts.PROOFS / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(rf"^set\({variable}([^)]*)\)", text, re.MULTILINE)
    assert match is not None
    return match[1].split()


def when_changed() -> dict[str, list[str]]:
    """Return the groups of CMakeLists.txt that run when a source has changed, and the sources."""
    text = (contracts.PROOFS / "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.findall(r"^hubfoc_prove_when_changed\(contracts_(\w+) ([^)]*)\)", text, re.MULTILINE)
    return {name: sources.split() for name, sources in found}


def without() -> list[str]:
    """Return the functions that are listed as having no contract."""
    lines = contracts.WITHOUT.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def test_every_public_function_has_a_contract_or_is_listed() -> None:
    assert without() == contracts.bare(), "python contracts.py without > without_contract.txt"


def test_every_contract_is_proved_once_or_tested() -> None:
    full = contract_harness.FULL
    groups = [*contract_harness.GROUPS, *contract_harness.VALUES]
    assert registered("groups") == [name for name in groups if name not in full]
    assert registered("heavy") == [*full, *contract_harness.HEAVY]
    grouped = [name for group in groups for name in contract_harness.functions_of(group)]
    everywhere = [*grouped, *contract_harness.HEAVY, *contract_harness.TESTED]
    assert sorted(everywhere) == sorted(contracts.known())


def test_a_group_is_proved_when_any_source_of_it_has_changed() -> None:
    found = when_changed()
    assert set(found) <= set(registered("groups"))
    assert "torque_step" in found
    for group, sources in found.items():
        functions = contract_harness.functions_of(group)
        parts = {contracts.known()[name].part for name in functions}
        paths = {path for part in parts for path in contract_harness.sources_of(part)}
        assert sources == sorted(str(path.relative_to(contracts.FIRMWARE)) for path in paths)


def test_a_function_of_the_modules_is_never_only_tested() -> None:
    for name in contract_harness.TESTED:
        assert contracts.known()[name].part.startswith("core/")


def test_every_planted_error_has_its_place_in_the_source() -> None:
    planted = (*PLANTED, *PLANTED_IN_PROOFS)
    assert [
        error.function
        for error in planted
        if (contracts.FIRMWARE / error.source).read_text(encoding="utf-8").count(error.right) != 1
    ] == []


def test_a_precondition_alone_is_no_contract() -> None:
    assert [name for name, one in contracts.public().items() if one.pre and not one.post] == []


def test_functions_are_found_in_every_module_and_none_is_missed() -> None:
    """Count the declarations in another way: lines that begin with a type and end a parameter."""
    for module in contracts.MODULES:
        found = [one for one in contracts.public().values() if module in one.header.parts]
        names = set()
        for header in (contracts.FIRMWARE / module / "include").rglob("*.h"):
            text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
            names |= set(
                re.findall(r"(?m)^(?:static inline |const )?[a-z]\w* \*?([a-z]\w+)\(", text)
            )
        assert {one.name for one in found} == names


def test_every_clause_is_of_a_function_of_its_module() -> None:
    for file in (contracts.PROOFS / "contracts").glob("*.h"):
        text = file.read_text(encoding="utf-8")
        stated = contracts.parse(text)
        assert sum(len(one) for kinds in stated.values() for one in kinds.values()) == len(
            re.findall(r"(?m)^\s*(?:PRE|POST)\b", text)
        )
        for name in stated:
            assert file.stem in contracts.known()[name].header.parts, name


def test_a_contract_is_the_clauses_of_the_name_of_a_function(tmp_path: Path) -> None:
    header = contracts.FIRMWARE / "x" / "include" / "x" / "x.h"
    file = tmp_path / "x.h"
    file.write_text(HEADER, encoding="utf-8")
    faster, plain = contracts.read(file, contracts.parse(CLAUSES))
    assert faster.pre == ("speed >= 0 && speed <= LIMIT",)
    assert faster.post == ("result >= old(speed + 1) && result < 9",)
    assert (plain.pre, plain.post, plain.parameters) == ((), (), ())
    assert [given.name for given in faster.parameters] == ["thing", "speed"]
    one = dataclasses.replace(faster, header=header)
    order = [
        "thing_t thing_object;",
        "thing_t *const thing = &thing_object;",
        "int32_t speed;",
        "ASSUME(speed >= 0 && speed <= LIMIT);",
        "const __typeof__(speed + 1) old_1 = speed + 1;",
        "int32_t const result = faster(thing, speed);",
        "PROVE(result >= old_1 && result < 9);",
        'CONTRACT_END("the end of faster is reached");',
    ]
    lines = [line.strip() for line in contract_harness.harness(one).splitlines()]
    assert [line for line in lines if line in order] == order
    order = [
        "int32_t faster_by_contract(const thing_t *thing, int32_t speed)",
        "PROVE(speed >= 0 && speed <= LIMIT);",
        "const __typeof__(speed + 1) old_1 = speed + 1;",
        "int32_t result;",
        "ASSUME(result >= old_1 && result < 9);",
        "return result;",
    ]
    lines = [line.strip() for line in contract_harness.substitute(one).splitlines()]
    assert [line for line in lines if line in order] == order


def test_what_a_function_may_write_is_any_content_for_its_callers(tmp_path: Path) -> None:
    file = tmp_path / "x.h"
    file.write_text("void fill(int32_t *a, limit_t b[3]);\n", encoding="utf-8")
    (one,) = contracts.read(file, contracts.parse("POST(fill, *a == 0)"))
    lines = [line.strip() for line in contract_harness.substitute(one).splitlines()]
    assert {"b[at_b] = any;", "void fill_by_contract(int32_t *to_a, limit_t b[3])"} <= set(lines)
    order = [
        "int32_t copy_a = *to_a;",
        "int32_t *const a = &copy_a;",
        "*a = any_a;",
        "ASSUME(*a == 0);",
        "*to_a = copy_a;",
    ]
    assert [line for line in lines if line in order] == order


def test_without_a_promise_anything_may_follow_a_call(tmp_path: Path) -> None:
    file = tmp_path / "x.h"
    file.write_text("/* Nothing is promised. */\nint32_t filled(int32_t *a);\n", encoding="utf-8")
    (one,) = contracts.read(file)
    lines = [line.strip() for line in contract_harness.substitute(one).splitlines()]
    assert {"*a = any_a;", "int32_t result;", "return result;"} <= set(lines)
    assert not [line for line in lines if line.startswith("ASSUME")]


def test_pointers_that_a_result_shares_with_a_parameter_are_assigned(tmp_path: Path) -> None:
    file = tmp_path / "x.h"
    declared = "feasible_set_t set(const motor_model_t *model);\n"
    file.write_text(declared, encoding="utf-8")
    (one,) = contracts.read(file, contracts.parse("POST(set, result.model == model && true)"))
    lines = [line.strip() for line in contract_harness.substitute(one).splitlines()]
    assert lines.index("result.model = model;") < lines.index(
        "ASSUME(result.model == model && true);"
    )


def test_a_parameter_points_to_another_one_where_a_precondition_says_so(tmp_path: Path) -> None:
    header = contracts.FIRMWARE / "x" / "include" / "x" / "x.h"
    file = tmp_path / "x.h"
    declared = "void move(feasible_set_t *set, motor_model_t *model, int32_t *by);\n"
    file.write_text(declared, encoding="utf-8")
    clauses = "PRE(move, set->model == model && *by > 0)\nPOST(move, *by == 0)\n"
    (one,) = contracts.read(file, contracts.parse(clauses))
    proof = contract_harness.harness(dataclasses.replace(one, header=header)).splitlines()
    assert proof.index("    set_object.model = model;") < proof.index(
        "    ASSUME(set->model == model && *by > 0);"
    )
    lines = [line.strip() for line in contract_harness.substitute(one).splitlines()]
    head = "void move_by_contract(feasible_set_t *to_set, motor_model_t *model, int32_t *to_by)"
    assert {head, "*model = any_model;", "*to_set = copy_set;", "*to_by = copy_by;"} <= set(lines)
    assert not [line for line in lines if "copy_model" in line]


def test_calls_are_renamed_and_definitions_are_not() -> None:
    source = "int f(int x)\n{\n    return g(f(x)) + 2 * f(x);\n}\n"
    renamed = contract_harness.with_calls_by_contract(source, ["f"])
    assert renamed.count("f_by_contract(") == 2
    assert renamed.startswith("int f(int x)\n")


@pytest.mark.parametrize(
    ("printed", "wrong"),
    [
        ("[p.assertion.1] line 3 assertion x: SUCCESS\n{end}", 0),
        ("[p.assertion.1] line 3 assertion x: FAILURE\n{end}", 1),
        ("[p.assertion.1] line 3 assertion x: UNKNOWN\n{end}", 1),
        ("[p.no-body.g] line 3 no body for callee g: FAILURE\n{end}", 1),
        ("[p.assertion.1] line 3 assertion x: SUCCESS\n", 1),
        ("[p.assertion.2] line 4 the end of f is reached: SUCCESS", 1),
        ("CONVERSION ERROR", 2),
    ],
)
def test_a_run_is_good_if_all_holds_and_every_end_is_reached(printed: str, wrong: int) -> None:
    end = "[p.assertion.2] line 4 the end of f is reached: FAILURE"
    assert len(prove_contracts.judge(printed.format(end=end), ["f"])) == wrong


def test_contracts_of_core_hold_for_random_and_extreme_inputs(tmp_path: Path) -> None:
    """What the solvers do not finish on; as many inputs for each function as take a second."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler is not None
    source = tmp_path / "tested.c"
    source.write_text(program_that_tests(contract_harness.TESTED), encoding="utf-8")
    core = contracts.FIRMWARE / "core"
    program = tmp_path / "tested"
    command = [compiler, "-O1", "-w", f"-I{contracts.PROOFS}", f"-I{core / 'include'}",
               f"-I{contracts.FIRMWARE / 'config' / 'include'}", str(source),
               str(core / "scaled.c"), str(core / "divide.c"), "-o", str(program)]  # fmt: skip
    subprocess.run(command, check=True)
    run = subprocess.run([str(program)], check=False, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
    counts = dict(line.split() for line in run.stdout.splitlines())
    assert set(counts) == set(contract_harness.TESTED)
    assert all(int(count) > 30_000 for count in counts.values()), counts


def program_that_tests(names: tuple[str, ...]) -> str:
    """Return a C program that calls functions with numbers of any length, edges among them."""
    lines = [TESTED_HEAD]
    for name in names:
        one = contracts.known()[name]
        lines += [f"static long test_{name}(void)", "{", "    long counted = 0;",
                  "    for (long i = 0; i < 400000; i++) {"]  # fmt: skip
        lines += [f"        const {given.type} {given.name} = ({given.type})any();"
                  for given in one.parameters]  # fmt: skip
        lines += [f"        if (!({line})) continue;" for line in one.pre]
        given = ", ".join(parameter.name for parameter in one.parameters)
        lines += [f"        const {one.result} result = {name}({given});"]
        lines += [f'        if (!({line})) {{ puts("{name}"); exit(1); }}' for line in one.post]
        lines += ["        counted++;", "    }", "    return counted;", "}"]
    lines += ["int main(void)", "{"]
    lines += [f'    printf("{name} %ld\\n", test_{name}());' for name in names]
    return "\n".join([*lines, "    return 0;", "}", ""])


TESTED_HEAD = """
#include <stdio.h>
#include <stdlib.h>
#include "core/divide.h"
#include "core/q15.h"
#include "core/scaled.h"
#define __CPROVER_assume(condition) ((void)(condition))
#include "contract.h"
static uint64_t bits(void)
{
    static uint64_t x = 88172645463325252u;
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    return x;
}
/* Of any length up to 64 digits, of either sign; a third at or beside a power of two, a third near
 * the number before. */
static int64_t any(void)
{
    static uint64_t before;
    const unsigned digits = (unsigned)(bits() % 65u);
    const uint64_t random = digits == 0 ? 0 : bits() >> (64u - digits);
    const uint64_t near = (UINT64_C(1) << (digits & 63u)) + bits() % 5u - 2u;
    const uint64_t which = bits() % 3u;
    const uint64_t x = which == 0 ? random : which == 1 ? near : before + bits() % 5u - 2u;
    before = x;
    return (int64_t)(bits() & 1u ? x : 0u - x);
}
"""


def test_a_condition_that_is_some_is_assumed_of_a_chosen_index() -> None:
    chosen = contract_harness.with_a_chosen_index
    assert chosen("some(i, 3, f(i) < x)") == "chosen_some(i, 3, f(i) < x)"
    for other in ("some(i, 3, f(i)) == x", "some(i, 3, x) != some(i, 4, x)", "!some(i, 3, x)"):
        assert chosen(other) == other
