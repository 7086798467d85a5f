# SPDX-License-Identifier: Apache-2.0
"""Bytes of a program that is optimised whole, by the module whose sources they come from."""

from __future__ import annotations

from pathlib import Path

import pytest
from benchmark import build, memory

CORE = build.CORES[0]

# Bytes: 100 of a table and 40 of variables; 34 of instructions; what is inlined; 5 of a text.
SOURCES = {
    "firmware/motor/tables.c": """
        const int SQUARES[25] = {1, 4, 9};
        int counts[10];
        """,
    "firmware/core/include/core/twice.h": """
        static inline int twice(const volatile int *x)
        {
            return *x + *x;
        }
        """,
    "firmware/foc/foc.c": """
        #include "../core/include/core/twice.h"
        extern const int SQUARES[25];
        extern int counts[10];
        __attribute__((naked, noipa)) void wait(void)
        {
            __asm volatile(".rept 16\\n nop\\n .endr\\n bx lr");
        }
        int main(int argc, char **argv)
        {
            (void)argv;
            wait();
            counts[argc % 10] = twice((const volatile int *)&SQUARES[argc % 25]);
            return counts[3] + "text"[argc];
        }
        """,
}


@pytest.fixture
def image(tmp_path: Path) -> Path:
    """Compile the sources, and link them and the emulated board's start-up whole."""
    options = [*CORE.flags, "-O2", "-g", "-flto", "-ffunction-sections", "-fdata-sections"]
    port = build.ROOT / "hal" / "qemu_mps2"
    for name, text in SOURCES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    sources = [tmp_path / name for name in SOURCES if name.endswith(".c")]
    elf = tmp_path / "program.elf"
    build.run(
        [build.PREFIX + "gcc", *options, "-std=gnu11", f"-I{port}", *map(str, sources),
         str(port / "startup.c"), str(port / "semihost.c"), "-nostartfiles", "--specs=nano.specs",
         f"-T{port / 'link.ld'}", "-Wl,--defsym=link_stack_size=0x4000", "-Wl,--gc-sections",
         "-o", str(elf)],
        "compiling",
    )  # fmt: skip
    return elf


def test_every_byte_of_flash_has_one_owner(image: Path) -> None:
    flash, _, _ = memory.sections(image)
    assert sum(size for size, _ in memory.modules(image).values()) == flash


def test_tables_and_variables_count_for_the_module_that_defines_them(image: Path) -> None:
    assert memory.modules(image)["motor"] == (25 * 4, 10 * 4)


def test_an_inlined_function_counts_for_the_module_that_has_written_it(image: Path) -> None:
    flash, ram = memory.modules(image)["core"]
    assert 3 * 2 <= flash <= 5 * 4, "two loads and an addition"
    assert ram == 0


def test_code_counts_by_its_lines_and_texts_have_no_owner(image: Path) -> None:
    found = memory.modules(image)
    assert found["foc"][0] >= 16 * 2 + 2
    assert found["port"][0] > 0
    assert found[memory.NAMELESS][0] >= len("text") + 1
