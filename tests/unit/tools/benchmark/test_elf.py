# SPDX-License-Identifier: Apache-2.0
"""Reading programs back: sizes, calls, the tables that code refers to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
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


DISASSEMBLY = """
08000000 <first>:
 8000000:\tpush\t{r4, lr}
 8000002:\tbl\t8000010 <put>
 8000006:\tb.n\t8000008 <link_stack_size>
 8000008:\tpop\t{r4, pc}

08000010 <put>:
 8000010:\tpush\t{r4, r5, r6, lr}
 8000012:\tpop\t{r4, r5, r6, pc}

08000014 <second>:
 8000014:\tpush\t{r4, lr}
 8000016:\tbl\t8000020 <put>
 800001a:\tbl\t8000030 <__erase_veneer>
 800001e:\tpop\t{r4, pc}

08000020 <put>:
 8000020:\tsub\tsp, #64\t@ 0x40
 8000022:\tbx\tlr

08000030 <__erase_veneer>:
 8000030:\tldr.w\tpc, [pc]\t@ 8000034 <__erase_veneer+0x4>
 8000034:\t.word\t0x20000101
 8000038:\t.word\t0x08000011

08000040 <with_arguments>:
 8000040:\tpush\t{r0, r1, lr}
 8000042:\tpop\t{r3}
 8000044:\tadd\tsp, #8
 8000046:\tbx\tr3

08000048 <through_a_pointer>:
 8000048:\tbx\tr2

20000100 <erase>:
20000100:\tpush\t{r4, lr}
20000102:\tpop\t{r4, pc}
"""


def test_two_static_functions_of_one_name_are_two_functions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(elf, "_run", lambda *_: DISASSEMBLY)
    functions = elf.functions(Path("program.elf"))
    assert functions["first"].calls == {"put"}
    assert functions["put"].pushed_bytes == 16
    assert functions["put@8000020"].pushed_bytes == 64
    assert "put@8000020" in functions["second"].calls


def test_a_jump_within_a_function_is_none_whatever_else_its_address_is_called(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(elf, "_run", lambda *_: DISASSEMBLY)
    assert elf.functions(Path("program.elf"))["first"].jumps == set()


def test_a_jump_to_what_was_popped_is_a_return_and_to_another_register_a_call(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(elf, "_run", lambda *_: DISASSEMBLY)
    functions = elf.functions(Path("program.elf"))
    assert not functions["with_arguments"].indirect
    assert functions["through_a_pointer"].indirect


def test_the_linkers_jump_to_a_far_function_is_a_call_of_that(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(elf, "_run", lambda *_: DISASSEMBLY)
    functions = elf.functions(Path("program.elf"))
    assert functions["__erase_veneer"].calls == {"erase"}
    assert elf.reachable("second", functions) == {
        "second",
        "put@8000020",
        "__erase_veneer",
        "erase",
    }
