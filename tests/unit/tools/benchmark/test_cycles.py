# SPDX-License-Identifier: Apache-2.0
"""Cycles by the manual's table added up by hand; both counters of instructions on one function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import blocks, build, count, cycles, elf

# Cycles, with P for a refill and without the last return's: straight 11; loop 1 + 7 * 2 + 6 P + 1;
# outer push 3, call 1 + P, 10, return 1 + P, pop 3; memory 1, load 2, store behind it 1, store 1,
# load 2, load behind a load 1, return 1; divided 2 to 12 and 1; skipped 5; products 3 and 1, on a
# Cortex-M3 3 to 5, 2, 4 to 7 and 1.
PROGRAM = """
#define ASM __attribute__((naked, noinline, used))
ASM void straight(void) { __asm volatile(".rept 10\\n nop\\n .endr\\n bx lr"); }
ASM void loop(void) { __asm volatile("movs r0, #7\\n 1: subs r0, #1\\n bne 1b\\n bx lr"); }
ASM void outer(void) { __asm volatile("push {r4, lr}\\n bl straight\\n pop {r4, pc}"); }
ASM void memory(void) {
    __asm volatile("mov r0, sp\\n ldr r1, [r0]\\n str r1, [r0]\\n str r1, [r0]\\n"
                   "ldr r2, [r0]\\n ldr r3, [r0, #4]\\n bx lr");
}
ASM void divided(void) { __asm volatile("udiv r0, r1, r2\\n bx lr"); }
ASM void skipped(void) {
    __asm volatile("cmp sp, #0\\n itt eq\\n moveq r0, #1\\n moveq r1, #2\\n bx lr");
}
ASM void products(void) {
    __asm volatile("smull r0, r1, r2, r3\\n mla r0, r1, r2, r3\\n umlal r0, r1, r2, r3\\n bx lr");
}
static const unsigned short table[8] = {3, 1, 4, 1, 5, 9, 2, 6};
__attribute__((noinline)) unsigned mixed(unsigned x) {
    unsigned sum = 0;
    for (unsigned i = 0; i < (x & 15u); i++) {
        sum += x % (i + 3u) > 1u ? table[i & 7u] : 0u;
        switch ((x >> i) & 7u) {
        case 0: sum ^= x; break;
        case 1: sum *= 3u; break;
        case 2: sum -= i; break;
        case 3: sum |= 5u; break;
        case 4: sum += (unsigned)((unsigned long long)x * sum >> 32); break;
        default: sum = sum > 1000u ? sum / 7u : sum + 1u; break;
        }
    }
    return sum;
}
__attribute__((noinline)) void begin(void) { __asm volatile(""); }
static volatile unsigned result;
int main(void) {
    straight(); /* not counted */
    begin();
    loop(); outer(); memory(); divided(); skipped(); products(); straight();
    for (unsigned i = 0; i < 1001; i++) { result = mixed(i * 2654435761u); }
    return 0;
}
"""


@pytest.fixture
def image(program: Callable[..., Path]) -> Path:
    return program(PROGRAM)


NAMES = ["loop", "outer", "memory", "divided", "skipped", "products"]


def called(image: Path, tmp_path: Path, *names: str) -> dict[str, blocks.Executed]:
    """Return the last call of each function in the model's core."""
    found = blocks.calls(
        image, tmp_path / "calls", elf.functions(image), list(names), "begin", 5000
    )
    return {call.name: call for call in found}


@pytest.mark.parametrize(
    ("name", "instructions"),
    [("straight", 11), ("loop", 16), ("outer", 14), ("memory", 7), ("skipped", 5)],
)
def test_counts_equal_those_made_by_hand(
    image: Path, tmp_path: Path, name: str, instructions: int
) -> None:
    """Two of skipped() are not taken; outer() has straight() within."""
    found = called(image, tmp_path, name)[name]
    assert found.instructions == instructions
    assert sum(len(cycles.Table(image).instructions(b)) for b in found.path) == instructions


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("straight", 11, 11),
        ("loop", 16 + 6 * 1, 16 + 6 * 3),
        ("outer", 18 + 2 * 1, 18 + 2 * 3),
        ("memory", 9, 9),
        ("divided", 3, 13),
        ("skipped", 5, 5),
        ("products", 4, 4),
    ],
)
def test_cycles_equal_those_added_up_by_hand(
    image: Path, tmp_path: Path, name: str, least: int, most: int
) -> None:
    cost = cycles.Table(image).cost(called(image, tmp_path, name)[name].path)
    assert (cost.least, cost.most) == (24 + least, 24 + most)
    assert cost.cold > cost.most


def test_a_cortex_m3_takes_longer_for_long_products_and_waits_for_a_flash_without_cache(
    image: Path, tmp_path: Path
) -> None:
    """Code in line waits for its first eight bytes, and one cycle if it begins at their end."""
    found = called(image, tmp_path, "products", "straight")
    table = cycles.Table(image, cycles.STM32F103)
    cost = table.cost(found["products"].path)
    assert (cost.least, cost.most) == (24 + 10, 24 + 15)
    cost = table.cost(found["straight"].path)
    assert cost.most == 24 + 11
    assert cost.cold - cost.most in {2, 3}


def test_the_model_of_the_chip_counts_what_the_plugin_counts(image: Path, tmp_path: Path) -> None:
    """The same calls, by basic block and by instruction, with IT blocks and tables of jumps."""
    plugin = count.loadable_plugin(tmp_path)
    functions = elf.functions(image)
    found, _ = count.calls(build.CORES[0], image, plugin, functions, ["mixed"], "begin")
    assert len(set(found["mixed"])) > 100
    blocks.check_equal(image, functions, found, "begin", 1001)
    one_more = [*found["mixed"][:700], found["mixed"][700] + 1, *found["mixed"][701:]]
    with pytest.raises(build.BenchError, match="count call 700 of 1001 differently"):
        blocks.check_equal(image, functions, {"mixed": one_more}, "begin", 1001)


def test_a_missing_program_is_an_error_that_names_its_target() -> None:
    with pytest.raises(build.BenchError, match="--target no_such_program makes it"):
        blocks.program("no_such_program")
