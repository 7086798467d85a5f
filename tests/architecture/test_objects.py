# SPDX-License-Identifier: Apache-2.0
"""Object code of the pure modules: no static state, no recursion, no division in the fast loop.

The source can hide a division in a macro, recursion behind three functions and a global behind a
static; object files cannot. The modules are compiled here, each file by itself, with the host's
compiler and for three Cortex-M cores.
"""

import functools
import itertools
import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from modules import PURE, STRICT_C, include_options, sources_of

# Calls inserted by the compiler: every C implementation, also a freestanding one, provides these
# four for copying and clearing structures (GCC manual, "Standards"). They have no
# state and cannot fail. Modules cannot call them by name, because no module may include <string.h>.
COMPILER_SUPPORT = {"memcpy", "memset", "memmove", "memcmp"}

# Supplied by app/ or a test: the end of a failed assertion (core/check.h).
CHECK_HANDLER = {"check_failed"}

# 64-bit integer arithmetic of the slow loop (ARM IHI 0043, "Run-time ABI"), and the table jumps of
# Cortex-M0+. No __aeabi_d* or __aeabi_f*: there is no floating point to emulate.
ARM_INTEGER_HELPERS = {
    *(
        "__aeabi_idiv",
        "__aeabi_idivmod",
        "__aeabi_uidiv",
        "__aeabi_uidivmod",
        "__aeabi_ldivmod",
        "__aeabi_uldivmod",
    ),
    *(
        "__aeabi_lmul",
        "__aeabi_llsl",
        "__aeabi_llsr",
        "__aeabi_lasr",
        "__aeabi_lcmp",
        "__aeabi_ulcmp",
    ),
    *(
        "__gnu_thumb1_case_sqi",
        "__gnu_thumb1_case_uqi",
        "__gnu_thumb1_case_shi",
        "__gnu_thumb1_case_uhi",
        "__gnu_thumb1_case_si",
    ),
}
# Those permitted in a fast step: no division.
FAST_HELPERS = {name for name in ARM_INTEGER_HELPERS if "div" not in name} | COMPILER_SUPPORT

CORES = {
    "cortex-m4": ["-mcpu=cortex-m4", "-mthumb", "-O2"],
    "cortex-m3": ["-mcpu=cortex-m3", "-mthumb", "-O2"],
    "cortex-m0plus": ["-mcpu=cortex-m0plus", "-mthumb", "-Os"],
}
if "HUBFOC_FOR_LONG" not in os.environ:  # it lacks less than Cortex-M0+ and is no image's core
    del CORES["cortex-m3"]
FAST_ROOT = "controller_fast_step"

Calls = dict[str, set[str]]


def run(*command: str | Path) -> str:
    result = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


def compile_modules(compiler: str, options: list[str], directory: Path) -> list[Path]:
    objects = []
    for module in PURE:
        for source in sources_of(module):
            objects.append(directory / f"{module}_{source.stem}.o")
            run(
                compiler,
                *STRICT_C,
                *options,
                *include_options(module),
                "-c",
                source,
                "-o",
                objects[-1],
            )
    return objects


def symbols_of(nm: str, objects: Iterable[Path]) -> list[tuple[Path, str, str]]:
    """Return (object, nm's letter, name) of every symbol."""
    by_name = {str(path): path for path in objects}
    found = []
    for line in run(nm, "--format=posix", "--print-file-name", *by_name).splitlines():
        path, _, symbol = line.partition(": ")
        name, letter = symbol.split()[:2]
        found.append((by_name[path], letter, name))
    return found


@pytest.fixture(scope="module")
def host_objects(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return unoptimised objects, in which every call of the source is still a call."""
    directory = tmp_path_factory.mktemp("host")
    return compile_modules("gcc", ["-O0", "-fno-pic", "-fcallgraph-info"], directory)


@pytest.fixture(scope="module", params=CORES)
def arm_objects(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> list[Path]:
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.fail("no arm-none-eabi-gcc here; tools/dev setup arm installs it")
    directory = tmp_path_factory.mktemp(request.param)
    return compile_modules(
        "arm-none-eabi-gcc", [*CORES[request.param], "-ffunction-sections"], directory
    )


def writable(symbols: list[tuple[Path, str, str]]) -> list[str]:
    """Return the symbols in memory that can be written.

    Initialised, zeroed, common or small data.
    """
    return [f"{path.name}: {name}" for path, letter, name in symbols if letter in "bBdDcCgGsS"]


def undefined(symbols: list[tuple[Path, str, str]]) -> set[str]:
    defined = {name for _, letter, name in symbols if letter not in "Uwv" and letter.isupper()}
    return {name for _, letter, name in symbols if letter == "U"} - defined


def test_pure_modules_have_no_static_data(host_objects: list[Path]) -> None:
    assert writable(symbols_of("nm", host_objects)) == []


def test_pure_modules_have_no_static_data_on_the_target(
    arm_objects: list[Path],
) -> None:
    assert writable(symbols_of("arm-none-eabi-nm", arm_objects)) == []


def test_pure_modules_call_only_each_other(host_objects: list[Path]) -> None:
    assert undefined(symbols_of("nm", host_objects)) <= COMPILER_SUPPORT | CHECK_HANDLER


def test_pure_modules_call_only_each_other_and_integer_arithmetic_on_the_target(
    arm_objects: list[Path],
) -> None:
    outside = undefined(symbols_of("arm-none-eabi-nm", arm_objects))
    assert outside <= COMPILER_SUPPORT | CHECK_HANDLER | ARM_INTEGER_HELPERS


# ---- recursion ----


def calls_in(callgraph: str) -> Calls:
    """Return who calls whom according to -fcallgraph-info (VCG text)."""
    calls: Calls = {}
    for source, target in re.findall(
        r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', callgraph
    ):
        calls.setdefault(source, set()).add(target)
    return calls


def cycle_in(calls: Calls) -> list[str]:
    """Return a cycle of calls, or an empty list."""
    finished: set[str] = set()

    def search(function: str, path: list[str]) -> list[str]:
        if function in path:
            return [*path[path.index(function) :], function]
        if function in finished:
            return []
        for callee in sorted(calls.get(function, ())):
            cycle = search(callee, [*path, function])
            if cycle:
                return cycle
        finished.add(function)
        return []

    return next(
        (cycle for cycle in (search(function, []) for function in sorted(calls)) if cycle), []
    )


def test_no_direct_or_indirect_recursion(host_objects: list[Path]) -> None:
    calls: Calls = {}
    for path in host_objects:
        for source, targets in calls_in(
            path.with_suffix(".ci").read_text(encoding="utf-8")
        ).items():
            calls.setdefault(source, set()).update(targets)
    assert "controller_fast_step" in calls
    assert cycle_in(calls) == []


def test_no_function_is_called_through_a_pointer(host_objects: list[Path]) -> None:
    """The search above cannot follow calls through a pointer."""
    assert not [
        path.name
        for path in host_objects
        if "__indirect_call" in path.with_suffix(".ci").read_text(encoding="utf-8")
    ]


def test_the_search_finds_recursion(tmp_path: Path) -> None:
    source = tmp_path / "loop.c"
    source.write_text(
        "int a(int x);\n"
        "static int c(int x) { return a(x); }\n"
        "static int b(int x) { return x ? c(x - 1) : 0; }\n"
        "int a(int x) { return b(x); }\n"
    )
    run("gcc", "-O0", "-fcallgraph-info", "-c", source, "-o", tmp_path / "loop.o")
    names = [
        name.rpartition(":")[2]
        for name in cycle_in(calls_in((tmp_path / "loop.ci").read_text(encoding="utf-8")))
    ]
    assert sorted(set(names)) == ["a", "b", "c"]
    assert names[0] == names[-1]
    assert cycle_in({"a": {"b", "c"}, "b": {"c"}}) == []


# ---- the fast loop ----


@dataclass
class Function:
    """One function of an object file."""

    instructions: list[str] = field(default_factory=list)
    callees: set[str] = field(default_factory=set)


def disassemble(path: Path) -> dict[str, Function]:
    functions: dict[str, Function] = {}
    current = Function()
    for line in run("arm-none-eabi-objdump", "-dr", "--no-show-raw-insn", path).splitlines():
        start = re.match(r"[0-9a-f]+ <([^>]+)>:$", line)
        call = re.search(r"R_ARM_THM_(?:CALL|JUMP\d+|XPC22)\s+(?:\.text\.)?(\S+)", line)
        instruction = re.match(r"\s+[0-9a-f]+:\t([a-z][\w.]*)\s*(.*)", line)
        if start:
            current = functions.setdefault(start.group(1), Function())
        elif call:
            current.callees.add(call.group(1))
        elif instruction:
            current.instructions.append(" ".join(instruction.groups()))
    return functions


def call_tree(objects: list[Path], root: str) -> tuple[dict[str, Function], set[str]]:
    """Return every function that `root` can reach, and the names that are in no object."""
    disassembled = functools.cache(disassemble)  # the slow steps have most of the code
    exported = {
        name: path
        for path, letter, name in symbols_of("arm-none-eabi-nm", objects)
        if letter == "T"
    }
    reached: dict[str, Function] = {}
    outside: set[str] = set()
    waiting = [(exported[root], root)]
    while waiting:
        path, name = waiting.pop()
        key = name if name in exported else f"{path.name}:{name}"
        if key in reached:
            continue
        reached[key] = disassembled(path)[name]
        for callee in reached[key].callees:
            home = path if callee in disassembled(path) else exported.get(callee)
            if home is None:
                outside.add(callee)
            else:
                waiting.append((home, callee))
    return reached, outside


def costly(function: Function) -> list[str]:
    """Return the instructions refused in a fast step.

    Hardware division, floating point, calls through a pointer; a `bx` behind the `pop` of its
    register is a return, also where the stack pointer moves between the two.
    """
    moved = [text for text in function.instructions if not re.match(r"add\s+sp\b", text)]
    return [
        text
        for before, text in itertools.pairwise(("", *moved))
        if re.match(r"(?:[su]div|v[a-z]\w*|blx r\d+|bx r\d+)\b", text)
        and not re.match(rf"pop\b.*\b{text.split()[-1]}\b", before)
    ]


def test_fast_loop_has_no_division_and_no_unknown_call(
    arm_objects: list[Path],
) -> None:
    reached, outside = call_tree(arm_objects, FAST_ROOT)
    assert {"foc_current_step", "foc_step", "hall_process_event"} <= set(
        reached
    )  # the expected functions were searched
    assert not {name: costly(function) for name, function in reached.items() if costly(function)}
    assert outside <= FAST_HELPERS


def test_the_search_finds_a_division_three_calls_deep(tmp_path: Path) -> None:
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.fail("no arm-none-eabi-gcc here; tools/dev setup arm installs it")
    source = tmp_path / "deep.c"
    source.write_text(
        "#define FAR __attribute__((noinline)) static\n"
        "FAR int c(int x, int y) { return x / y; }\n"
        "FAR int b(int x, int y) { return c(x, y) + 1; }\n"
        "int controller_fast_step(int x, int y) { return b(x, y) + 1; }\n"
    )
    for core, options in CORES.items():
        path = tmp_path / f"{core}.o"
        run("arm-none-eabi-gcc", *options, "-ffunction-sections", "-c", source, "-o", path)
        reached, outside = call_tree([path], FAST_ROOT)
        assert len(reached) == 3
        assert (
            outside & {"__aeabi_idiv", "__aeabi_idivmod"}
            if core == "cortex-m0plus"
            else costly(reached[f"{path.name}:c"])
        )
