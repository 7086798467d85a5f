# SPDX-License-Identifier: Apache-2.0
"""Reading programs back: sizes, calls, the tables that code refers to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from benchmark import elf
from benchmark.elf import size_of

TABLES = """
#include <stdint.h>
__attribute__((noinline)) static int double_it(int x) { __asm volatile(""); return 2 * x; }
static const int16_t sine[50] = {1, 2, 3, 4};
static const int16_t unused_by_step[400] = {5};
static int32_t state[20];
__attribute__((noinline)) int step(int i) { state[i] = double_it(sine[i]); return state[0]; }
int main(int argc, char **argv) { (void)argv; return step(argc) + unused_by_step[argc]; }
"""


def test_size_of_a_function_includes_its_callees_and_constants(
    program: Callable[..., Path],
) -> None:
    image = program(TABLES, "-fno-ipa-cp", "-fno-ipa-sra")
    functions, symbols = elf.functions(image), elf.symbols(image)
    assert elf.reachable("step", functions) == {"step", "double_it"}
    size = size_of("step", functions, symbols)
    assert size["code"] == symbols["step"].size + symbols["double_it"].size
    assert size["tables"] == 50 * 2


def test_every_call_has_its_return_address(program: Callable[..., Path]) -> None:
    image = program(TABLES, "-fno-ipa-cp", "-fno-ipa-sra")
    functions = elf.functions(image)
    sites = functions["step"].return_sites["double_it"]
    assert len(sites) == 1
    assert (
        functions["step"].address
        < sites[0]
        < functions["step"].address + elf.symbols(image)["step"].size
    )
