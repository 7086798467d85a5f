# SPDX-License-Identifier: Apache-2.0
"""The counter against functions whose instructions can be counted by hand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import build, count, elf

# straight: 10 and the return. loop(n): 1, then 2 for each pass, and the return. skipped: compare,
# IT, two that are not taken but are fetched, the return. outer: push, call, pop: 3 around
# straight's 11.
PROGRAM = """
#define NAKED __attribute__((naked, noinline))
NAKED void straight(void) { __asm volatile(".rept 10\\n nop\\n .endr\\n bx lr"); }
NAKED void loop(int n) { __asm volatile("nop\\n 1: subs r0, #1\\n bne 1b\\n bx lr" ::: "r0"); }
NAKED void skipped(void) {
    __asm volatile("cmp sp, #0\\n itt eq\\n moveq r0, #1\\n moveq r1, #2\\n bx lr");
}
NAKED void outer(void) { __asm volatile("push {r4, lr}\\n bl straight\\n pop {r4, pc}"); }
__attribute__((noinline)) void begin(void) { __asm volatile(""); }
int main(void) {
    for (int i = 0; i < 100; i++) { straight(); loop(7); skipped(); outer(); } /* not counted */
    begin();
    for (int i = 1; i <= 1001; i++) { straight(); loop(i); skipped(); outer(); }
    return 0;
}
"""
NAMES = ["straight", "loop", "skipped", "outer"]


@pytest.fixture
def counts(program: Callable[..., Path], tmp_path: Path) -> dict[str, count.Count]:
    image = program(PROGRAM)
    functions = elf.functions(image)
    plugin = count.loadable_plugin(tmp_path)
    return count.count(build.CORES[0], image, plugin, functions, NAMES, "begin")


def test_counts_equal_those_made_by_hand(counts: dict[str, count.Count]) -> None:
    assert counts["loop"] == count.Count(
        1001, 1 + 2 * 1 + 1, 1 + 2 * 501 + 1, 1 + 2 * 991 + 1, 1 + 2 * 1001 + 1
    )
    assert counts["skipped"] == count.Count(1001, 5, 5, 5, 5)
    assert counts["outer"] == count.Count(1001, 14, 14, 14, 14)
    # straight is called from two places, each of which ends a window of its own.
    assert counts["straight"] == count.Count(2002, 11, 11, 11, 11)


def test_the_99th_percentile_is_the_smallest_count_that_99_percent_do_not_exceed() -> None:
    """One of a hundred may lie beyond it, not two."""
    assert count.summary([9] + [5] * 99) == count.Count(100, 5, 5, 5, 9)
    assert count.summary([9, 8] + [5] * 98) == count.Count(100, 5, 5, 8, 9)


def test_a_missing_function_is_an_error_that_names_it(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(PROGRAM)
    with pytest.raises(build.BenchError, match="vanished: not a function of its own"):
        count.count(
            build.CORES[0], image, tmp_path / "none.so", elf.functions(image), ["vanished"], "begin"
        )


# around: push, 2, two calls, pop; its call of by_jump goes on in straight.
NESTED = """
#define NAKED __attribute__((naked, noinline))
NAKED void straight(void) { __asm volatile(".rept 10\\n nop\\n .endr\\n bx lr"); }
NAKED void by_jump(void) { __asm volatile("nop\\n nop\\n b straight"); }
NAKED void around(void) {
    __asm volatile("push {r4, lr}\\n nop\\n bl straight\\n bl by_jump\\n pop {r4, pc}");
}
__attribute__((noinline)) void begin(void) { __asm volatile(""); }
int main(void) {
    begin();
    for (int i = 0; i < 3; i++) { around(); }
    return 0;
}
"""


def test_a_call_counts_what_is_its_own_without_the_named_functions_it_calls(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    """Also where a function is left by a jump into another: both end where the first returns."""
    image = program(NESTED)
    functions = elf.functions(image)
    plugin = count.loadable_plugin(tmp_path)

    def traced(*names: str) -> list[tuple[str, int, int]]:
        found, _ = count.trace(build.CORES[0], image, plugin, functions, list(names), "begin")
        return [(call.name, call.instructions, call.own) for call in found]

    assert traced("around", "by_jump", "straight") == 3 * [
        ("straight", 11, 11),
        ("straight", 11, 11),
        ("by_jump", 3 + 11, 3),
        ("around", 5 + 11 + 14, 5),
    ]
    assert traced("straight", "around") == 3 * [
        ("straight", 11, 11),
        ("straight", 11, 11),
        ("around", 30, 5 + 3),
    ]


def test_a_function_without_a_caller_is_an_error_that_names_it(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(PROGRAM)
    with pytest.raises(build.BenchError, match="alone: nothing calls it"):
        functions = elf.functions(image) | {"alone": elf.Function("alone", 0)}
        count.count(build.CORES[0], image, tmp_path / "none.so", functions, ["alone"], "begin")
