# SPDX-License-Identifier: Apache-2.0
"""Every public function has a contract that is proved, or is listed as one without."""

import re
from pathlib import Path

import contracts

HEADER = """
/* A speed.
 *
 * @pre speed >= 0 && speed <= LIMIT
 *
 * @post result >= old(speed + 1) &&
 * result < 9
 */
int32_t faster(const thing_t *thing, int32_t speed);

void plain(void);
"""


def registered() -> set[str]:
    """Return the functions whose contracts CMakeLists.txt has proved."""
    text = (contracts.PROOFS / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"headers\.\nforeach\(name IN ITEMS ([^)]*)\)", text)
    assert match is not None
    return set(match[1].split())


def without() -> list[str]:
    """Return the functions that are listed as having no contract."""
    lines = contracts.WITHOUT.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def test_every_public_function_has_a_contract_or_is_listed() -> None:
    assert without() == contracts.bare(), "python contracts.py without > without_contract.txt"


def test_every_contract_is_proved() -> None:
    assert registered() == {name for name, one in contracts.public().items() if one.post}


def test_a_precondition_alone_is_no_contract() -> None:
    assert [name for name, one in contracts.public().items() if one.pre and not one.post] == []


def test_functions_are_found_in_every_module_and_none_is_missed() -> None:
    """Count the declarations in another way: lines that begin with a type and end a parameter."""
    for module in contracts.MODULES:
        found = [one for one in contracts.public().values() if module in one.header.parts]
        names = set()
        for header in (contracts.FIRMWARE / module / "include").rglob("*.h"):
            text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
            names |= set(re.findall(r"(?m)^(?:static inline )?[a-z]\w* \*?([a-z]\w+)\(", text))
        assert {one.name for one in found} == names


def test_a_contract_is_read_from_the_comment_before_its_function(tmp_path: Path) -> None:
    header = contracts.FIRMWARE / "x" / "include" / "x" / "x.h"
    file = tmp_path / "x.h"
    file.write_text(HEADER, encoding="utf-8")
    faster, plain = contracts.read(file)
    assert faster.pre == ("speed >= 0 && speed <= LIMIT",)
    assert faster.post == ("result >= old(speed + 1) && result < 9",)
    assert (plain.pre, plain.post, plain.parameters) == ((), (), ())
    harness = contracts.Contract(
        header, faster.name, faster.result, faster.parameters, faster.pre, faster.post
    ).harness()
    order = [
        "thing_t thing_object;",
        "thing_t *const thing = &thing_object;",
        "int32_t speed;",
        "ASSUME(speed >= 0 && speed <= LIMIT);",
        "const __typeof__(speed + 1) old_1 = speed + 1;",
        "const int32_t result = faster(thing, speed);",
        "PROVE(result >= old_1 && result < 9);",
        "PROOF_END();",
    ]
    lines = [line.strip() for line in harness.splitlines()]
    assert [line for line in lines if line in order] == order
