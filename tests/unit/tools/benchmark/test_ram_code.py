# SPDX-License-Identifier: Apache-2.0
"""Code in RAM that needs the flash is found."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import elf, ram_code

PROGRAM = """
#define IN_RAM __attribute__((section(".ram_code"), noipa))
static volatile int busy;
__attribute__((noipa)) int in_flash(int x) { return 3 * x; }
IN_RAM int wait_for(int polls) { while (busy && polls > 0) { polls--; } return polls; }
IN_RAM int operate(int x) { return wait_for(x) + OTHER(x); }
int main(int argc, char **argv) { (void)argv; return operate(argc); }
"""
SWITCH = """
static const int TABLE[5] = {3, 1, 4, 1, 5};
__attribute__((section(".ram_code"), noipa)) int operate(int x) { return TABLE[x]; }
int main(int argc, char **argv) { (void)argv; return operate(argc); }
"""


IN_RAM = ("-Wl,--section-start=.ram_code=0x20100000",)


def test_a_call_of_a_function_in_flash_is_found(program: Callable[..., Path]) -> None:
    found = ram_code.needs(elf.functions(program(PROGRAM, "-DOTHER=in_flash", link=IN_RAM)))
    assert [text for text in found if "in_flash" in text]


def test_calls_within_ram_are_none(program: Callable[..., Path]) -> None:
    assert not ram_code.needs(elf.functions(program(PROGRAM, "-DOTHER=wait_for", link=IN_RAM)))


def test_a_table_in_flash_is_found(
    program: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ram_code, "FLASH", range(1, 0x400000))
    assert (
        "operate has the address" in ram_code.needs(elf.functions(program(SWITCH, link=IN_RAM)))[0]
    )


def test_an_image_without_code_in_ram_is_no_proof(program: Callable[..., Path]) -> None:
    image = program("int main(void) { return 0; }")
    assert ram_code.main([str(image)]) == 1
