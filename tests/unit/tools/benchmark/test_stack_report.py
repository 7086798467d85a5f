# SPDX-License-Identifier: Apache-2.0
"""Stack depth of call chains with known frames."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import elf, stack_report

# Frames by the instructions themselves: top 8 (two registers), middle 8 + 104, leaf 4, other 24,
# handler 24.
CHAIN = """
#define ASM __attribute__((naked, noinline))
ASM void leaf(void) { __asm volatile("str r4, [sp, #-4]!\\n pop {r4}\\n bx lr"); }
ASM void middle(void) {
    __asm volatile("push {r4, lr}\\n sub sp, #104\\n bl leaf\\n add sp, #104\\n pop {r4, pc}");
}
ASM void other(void) {
    __asm volatile("stmdb sp!, {r4-r8, lr}\\n bl leaf\\n ldmia sp!, {r4-r8, pc}");
}
ASM void top(void) { __asm volatile("push {r4, lr}\\n bl middle\\n bl other\\n pop {r4, pc}"); }
ASM void handler(void) {
    __asm volatile("push {r0-r3, r5, lr}\\n bl other\\n pop {r0-r3, r5, pc}");
}
int main(void) { top(); handler(); return 0; }
"""


def test_stack_use_is_the_sum_of_frames_of_the_deepest_call_chain(
    program: Callable[..., Path],
) -> None:
    functions = elf.functions(program(CHAIN))
    path = stack_report.worst_path("top", functions, {})
    assert path.functions == ("top", "middle", "leaf")
    assert path.bytes == 8 + (8 + 104) + 4
    assert stack_report.worst_path("other", functions, {}).bytes == 24 + 4


def test_an_interrupt_adds_the_exception_frame(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    rows = stack_report.report(program(CHAIN), [tmp_path], "top", ["handler"])
    assert rows[1][1].bytes == 24 + (24 + 4) + 36


def test_a_handler_with_a_stack_of_its_own_adds_the_exception_frame_alone(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    cases = stack_report.Cases(own_stack=("handler",))
    rows = stack_report.report(program(CHAIN), [tmp_path], "top", ["handler"], cases)
    assert rows[1][1].bytes == 36


def test_the_result_is_written_beside_the_program(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(CHAIN)
    arguments = ["--elf", str(image), "--objects", str(tmp_path), "--root", "top"]
    assert stack_report.main([*arguments, "--interrupt", "handler", "--limit", "500"]) == 0
    found = json.loads(stack_report.result_of(image).read_text())
    assert (found["bytes"], found["reserved"]) == (124 + 24 + 28 + 36, 500)
    assert found["paths"][0] == {"from": "top", "bytes": 124, "through": ["middle", "leaf"]}


def test_calls_before_interrupts_are_a_case_without_them(
    program: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image = program(CHAIN)
    arguments = ["--elf", str(image), "--objects", str(tmp_path), "--root", "top"]
    early = [*arguments, "--before-interrupts", "top:middle", "--limit", "500"]
    assert stack_report.main(early) == 0
    assert "124 of 500" in capsys.readouterr().out
    assert stack_report.main([*early, "--interrupt", "handler"]) == 0
    assert "124 of 500" in capsys.readouterr().out, "8 + 24 + 28 + 36 are less"
    assert stack_report.main([*early, "--own-stack", "handler"]) == 0
    assert "160 of 500" in capsys.readouterr().out


def test_the_compilers_figure_applies_if_larger_than_that_of_the_instructions(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(
        "__attribute__((noinline)) int f(int n) { volatile char b[300]; b[n] = 1; return b[0]; }"
        " int main(void) { return f(3); }"
    )
    frames = stack_report.compiled_frames(image, [tmp_path])
    assert frames["f"] >= 300
    assert stack_report.worst_path("f", elf.functions(image), frames).bytes == frames["f"]


def test_stack_of_a_recursion_is_unbounded(program: Callable[..., Path]) -> None:
    image = program(
        "__attribute__((noinline)) int f(int n) { return n ? f(n - 1) * f(n / 3) + 1 : 1; } int"
        " main(void) { return f(9); }"
    )
    with pytest.raises(stack_report.StackError, match="recursion: f -> f"):
        stack_report.worst_path("main", elf.functions(image), {})


def test_stack_of_a_call_through_a_pointer_is_unbounded(program: Callable[..., Path]) -> None:
    image = program("int (*volatile f)(void); int main(void) { return 1 + f(); }")
    with pytest.raises(stack_report.StackError, match="through a pointer"):
        stack_report.worst_path("main", elf.functions(image), {})


def test_stack_of_a_variable_size_frame_is_unbounded(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(
        "__attribute__((noinline)) int f(int n) { volatile char b[n]; b[0] = 1; return b[0]; } int"
        " main(void) { return f(3); }"
    )
    with pytest.raises(stack_report.StackError, match="variable size"):
        stack_report.compiled_frames(image, [tmp_path])


def test_stack_of_the_size_in_a_register_is_unbounded_without_the_compilers_figure(
    program: Callable[..., Path],
) -> None:
    image = program(
        "__attribute__((naked, noinline)) void f(void) {"
        ' __asm volatile("sub sp, sp, r0\\n add sp, sp, r0\\n bx lr"); }'
        " int main(void) { f(); return 0; }"
    )
    with pytest.raises(stack_report.StackError, match="f: stack of variable size"):
        stack_report.worst_path("main", elf.functions(image), {})


def test_a_called_name_that_the_program_does_not_have_is_an_error() -> None:
    functions = {"main": elf.Function("main", 0x8000, calls={"removed"})}
    with pytest.raises(stack_report.StackError, match="removed: no such function"):
        stack_report.worst_path("main", functions, {})


def test_a_call_that_is_left_out_must_be_in_the_program(
    program: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--elf", str(program(CHAIN)), "--objects", str(tmp_path), "--limit", "500"]
    for call in ("top:leaf", "removed:middle"):
        assert stack_report.main([*arguments, "--root", "top", "--before-interrupts", call]) == 1
        caller, _, called = call.partition(":")
        assert f"no call of {called} by {caller}" in capsys.readouterr().err


def test_a_program_optimised_whole_has_the_frames_of_its_link(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    image = program(
        "__attribute__((noipa)) int f(int n) { volatile char b[300]; b[n] = 1; return b[0]; }"
        " int main(void) { return f(3); }",
        "-flto",
        "-ffat-lto-objects",
        link=("-flto", "-flto-partition=one"),
    )
    frames = stack_report.compiled_frames(image, [tmp_path])
    assert 300 <= frames["f"] < 400
    apart = tmp_path / "apart" / "program.ci"
    apart.parent.mkdir()
    apart.write_text(
        'node: { title: "program.o:f" label: "f\\nprogram.c:1:1\\n9000 bytes (static)" }\n'
        'node: { title: "program.o:g" label: "g\\nprogram.c:2:1\\n16 bytes (static)" }\n'
    )
    both = stack_report.compiled_frames(image, [apart.parent])
    assert (both["f"], both["g"]) == (frames["f"], 16)


def test_too_little_stack_fails_the_link_step_with_the_missing_size(
    program: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image = program(CHAIN)
    arguments = [
        "--elf",
        str(image),
        "--objects",
        str(tmp_path),
        "--root",
        "top",
        "--interrupt",
        "handler",
    ]
    assert stack_report.main([*arguments, "--limit", "500"]) == 0
    assert stack_report.main([*arguments, "--limit", "100"]) == 1
    assert "212 bytes may be needed, 100 are there" in capsys.readouterr().err
