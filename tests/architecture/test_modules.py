# SPDX-License-Identifier: Apache-2.0
"""The modules keep to their order of dependency.

Includes run one way, the pure modules stay pure, every header compiles on its own.
"""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from modules import (
    FIRMWARE,
    MAY_INCLUDE,
    PURE,
    ROOT,
    STRICT_C,
    code_only,
    files_of,
    include_options,
    includes_in,
)

PURE_LIBRARY_HEADERS = {"stdint.h", "stdbool.h", "stddef.h"}

# Identifiers refused in a pure module, with the reason of each.
FORBIDDEN = {
    "floating point": r"\b(?:float|double|_Complex|_Imaginary|_Float\w+)\b|\b\d+\.\d*[fFlL]?\b",
    "heap": r"\b(?:malloc|calloc|realloc|free|alloca)\b",
    "jumps out of a function": r"\b(?:setjmp|longjmp|_setjmp|goto)\b",
    "input and output": r"\b(?:s?n?printf|puts|putchar|scanf|fopen)\b",
    "memory that changes by itself": r"\bvolatile\b",
    "threads": r"\b(?:_Thread_local|_Atomic)\b",
    "compiler extensions": r"\b(?:asm|typeof|__\w+)\b",
    "variable arguments": r"\bva_(?:list|start|arg|end)\b",
    "compiler-dependent code": r"#\s*pragma\b",
}

MODULES_HERE = [module for module in MAY_INCLUDE if (FIRMWARE / module).is_dir()]
# Public headers by their name in the module's include folder, private ones by their file name.
HEADERS = [
    (
        module,
        (
            path.name
            if path.parent == FIRMWARE / module
            else path.relative_to(FIRMWARE / module / "include").as_posix()
        ),
    )
    for module in MODULES_HERE
    for path in files_of(module)
    if path.suffix == ".h"
]
HAL_HEADERS = sorted(
    path.relative_to(ROOT / "hal/include").as_posix()
    for path in (ROOT / "hal/include").rglob("*.h")
)


def compile_text(text: str, options: list[str]) -> subprocess.CompletedProcess[str]:
    compiler = shutil.which("gcc")
    assert compiler is not None, "the architecture tests compile with gcc"
    command = [compiler, *STRICT_C, "-fsyntax-only", *options, "-x", "c", "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=False)


def test_every_firmware_directory_is_a_known_module() -> None:
    assert {path.name for path in FIRMWARE.iterdir() if path.is_dir()} <= set(MAY_INCLUDE)
    assert set(PURE) <= set(MODULES_HERE)


@pytest.mark.parametrize("module", MODULES_HERE)
def test_module_includes_only_modules_of_lower_layers(module: str) -> None:
    allowed = {module, *MAY_INCLUDE[module]}
    wrong = []
    for path in files_of(module):
        for kind, name in includes_in(path.read_text(encoding="utf-8")):
            # A private header beside its source has no module in its name; it must then really be
            # there.
            of_module = (
                name.split("/")[0]
                if "/" in name
                else module
                if (path.parent / name).exists()
                else name
            )
            if kind == '"' and of_module not in allowed:
                wrong.append(f"{path.relative_to(ROOT)}: {name}")
    assert not wrong


def test_only_app_includes_the_hardware_interface_and_no_port_includes_firmware() -> None:
    assert [module for module in MAY_INCLUDE if "hal" in MAY_INCLUDE[module]] == ["app"]
    for path in sorted((ROOT / "hal").rglob("*.[ch]")):
        names = {
            name.split("/")[0]
            for kind, name in includes_in(path.read_text(encoding="utf-8"))
            if kind == '"' and "/" in name
        }
        assert not names & set(MAY_INCLUDE), path.relative_to(ROOT)


def test_a_header_of_the_hardware_interface_has_at_most_12_functions() -> None:
    """At most twelve functions a header keep a port small."""
    assert HAL_HEADERS
    for header in HAL_HEADERS:
        text = code_only((ROOT / "hal/include" / header).read_text(encoding="utf-8"))
        functions = re.findall(r"^[a-z][\w \t*]*?\b(\w+)\([^;{]*\)\s*[;{]", text, re.MULTILINE)
        assert 1 <= len(functions) <= 12, (header, functions)


@pytest.mark.parametrize("module", PURE)
def test_a_pure_module_includes_only_the_library_headers_of_integer_types(module: str) -> None:
    wrong = [
        f"{path.relative_to(ROOT)}: <{name}>"
        for path in files_of(module)
        for kind, name in includes_in(path.read_text(encoding="utf-8"))
        if kind == "<" and name not in PURE_LIBRARY_HEADERS
    ]
    assert not wrong


@pytest.mark.parametrize("reason", FORBIDDEN)
def test_a_pure_module_contains_no(reason: str) -> None:
    wrong = []
    for module in PURE:
        for path in files_of(module):
            for number, line in enumerate(
                code_only(path.read_text(encoding="utf-8")).splitlines(), start=1
            ):
                found = re.search(FORBIDDEN[reason], line)
                if found:
                    wrong.append(f"{path.relative_to(ROOT)}:{number}: {found.group()}")
    assert not wrong


@pytest.mark.parametrize(
    ("reason", "line"),
    [
        ("floating point", "x = 0.5f;"),
        ("floating point", "double y;"),
        ("heap", "p = malloc(4);"),
        ("jumps out of a function", "goto end;"),
        ("input and output", "snprintf(text, 8, x);"),
        ("compiler extensions", "int x __attribute__((used));"),
        ("compiler extensions", "y = __builtin_clz(x);"),
        ("memory that changes by itself", "volatile int x;"),
        ("compiler-dependent code", "#pragma GCC optimize"),
    ],
)
def test_the_search_finds_every_forbidden_pattern(reason: str, line: str) -> None:
    assert re.search(FORBIDDEN[reason], code_only(line))


def test_the_search_ignores_comments_and_strings() -> None:
    text = 'int x; /* a double\n malloc */ // goto\nconst char *y = "float \\" 0.5";'
    assert not any(re.search(pattern, code_only(text)) for pattern in FORBIDDEN.values())
    assert len(code_only(text)) == len(text)


@pytest.mark.parametrize(("module", "header"), HEADERS)
def test_a_header_compiles_on_its_own_and_when_included_twice(module: str, header: str) -> None:
    options = [*include_options(module), f"-I{FIRMWARE / module}"]
    result = compile_text(f'#include "{header}"\n#include "{header}"\n', options)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("header", HAL_HEADERS)
def test_a_header_of_the_hardware_interface_compiles_on_its_own(header: str) -> None:
    result = compile_text(
        f'#include "{header}"\n#include "{header}"\n', [f"-I{ROOT / 'hal/include'}"]
    )
    assert result.returncode == 0, result.stderr


def test_a_vector_of_one_frame_is_rejected_where_another_is_expected() -> None:
    options = [*include_options("foc"), f"-I{FIRMWARE / 'foc'}"]
    text = (
        '#include "transforms.h"\ndq16_t f({0} x, rotation_t a);\ndq16_t f({0} x, rotation_t a) {{'
        " return transforms_park(x, a); }}\n"
    )
    assert compile_text(text.format("ab16_t"), options).returncode == 0
    for wrong in ("dq16_t", "dq_t", "abc_t"):
        assert "incompatible type" in compile_text(text.format(wrong), options).stderr


def test_kernels_of_the_fast_loop_do_not_know_the_loop() -> None:
    """Within foc only what foc.h declares includes it."""
    knowing = {
        path.name
        for path in files_of("foc")
        if '#include "foc/foc.h"' in path.read_text(encoding="utf-8")
    }
    assert knowing == {"foc.c", "report.c"}


def test_a_forbidden_include_fails_to_compile() -> None:
    """The same rule enforced by the build.

    Each target has only the include paths of lower modules.
    """
    for target, forbidden in (
        ("torque", "foc/foc.h"),
        ("core", "config/config.h"),
        ("monitor", "modes/modes.h"),
    ):
        assert compile_text(f'#include "{forbidden}"\n', include_options(target)).returncode != 0
    for module in MODULES_HERE:
        text = (FIRMWARE / module / "CMakeLists.txt").read_text(encoding="utf-8")
        named = set(re.findall(r"\bhubfoc_(\w+)\b", re.sub(r"#.*", "", text))) & {
            *MAY_INCLUDE,
            "hal",
        }
        assert named <= {module, *MAY_INCLUDE[module]}, module


def test_every_module_has_a_readme_with_its_purpose() -> None:
    missing = [module for module in MODULES_HERE if not (FIRMWARE / module / "README.md").is_file()]
    assert not missing


def code_files_of(module: str) -> set[str]:
    """Return the names of a module's sources and of headers with inline functions.

    Not of what takes the place of a source on a port without space for it: the images are compared
    with that port's list.
    """
    headers = {
        path.stem
        for path in files_of(module)
        if path.suffix == ".h" and "static inline" in code_only(path.read_text(encoding="utf-8"))
    }
    sources = {path.stem for path in files_of(module) if path.suffix == ".c"}
    return headers | {name for name in sources if not name.endswith("_absent")}


@pytest.mark.parametrize("module", PURE)
def test_every_source_file_has_a_test_of_its_own(module: str) -> None:
    here = ROOT / "tests/unit/firmware" / module
    missing = [
        name for name in sorted(code_files_of(module)) if not (here / f"test_{name}.c").is_file()
    ]
    assert not missing, f"{here.relative_to(ROOT)} has no test of these files"


def test_the_files_of_a_module_are_found() -> None:
    """Guards the tests above against an empty file list."""
    assert {"limit", "brake_blending"} <= code_files_of("torque")
    assert Path("foc/foc.h") in {Path(header) for _, header in HEADERS}
