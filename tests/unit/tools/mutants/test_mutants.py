# SPDX-License-Identifier: Apache-2.0
"""tools/mutants: which changes are found in a C file, that each acts alone, and the report."""

import json
import subprocess
import sys
from math import comb
from pathlib import Path

import pytest
from mutants import __main__ as command
from mutants import measure, schema
from mutants.operators import Change, changes, parse
from mutants.report import Result, Survivor
from unit_programs import programs_of, suites_of

RUNTIME = "int hubfoc_mutant; unsigned char hubfoc_reached[99];\n"


def found_in(body: str, before: str = "int f(int a, int b)") -> list[Change]:
    """Return the changes of a function with this body."""
    return changes(parse(f"{before}\n{{\n{body}\n}}\n".encode()))


def texts(body: str) -> list[str]:
    """Return the changes of a body as text."""
    return [f"{change.original} -> {change.replacement}" for change in found_in(body)]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("return a < b;", ["a < b -> (a) <= (b)", "a < b -> (a) >= (b)"]),
        ("return a == b;", ["a == b -> (a) != (b)"]),
        ("return a && b;", ["a && b -> (a) || (b)", "a && b -> a", "a && b -> b"]),
        ("return a + b;", ["a + b -> (a) - (b)"]),
        ("return 7;", ["7 -> 7 + 1", "7 -> 7 - 1", "7 -> 0"]),
        ("return 1;", ["1 -> 1 + 1", "1 -> 0"]),
        ("return LIMIT;", ["LIMIT -> LIMIT + 1", "LIMIT -> LIMIT - 1", "LIMIT -> 0"]),
        ("return !a;", ["!a -> a"]),
        ("return q_min(a, b);", ["q_min(a, b) -> a", "q_min(a, b) -> b"]),
        ("if (a) { b = a; }", ["a -> !(a)", "b = a; -> "]),
        ("return a ? a : b;", ["a -> !(a)"]),
        ("a += b;", ["a += b; -> ", "a += b -> (a) -= (b)"]),
        ("for (; a; a++) { break; }", ["a -> !(a)", "a++ -> a--", "break; -> "]),
    ],
)
def test_each_operator_of_c_has_its_changes(body: str, expected: list[str]) -> None:
    assert texts(body) == expected


@pytest.mark.parametrize(
    "body",
    [
        "static const int table[2] = {1, 2};",
        "switch (a) { case LIMIT: return b; }",
        "(void)a;",
        "return (int)sizeof(int[4]);",
        "return MACRO(7, a);",
    ],
)
def test_what_must_be_constant_or_has_no_effect_stays(body: str) -> None:
    assert texts(body) == []


def test_code_outside_functions_stays() -> None:
    assert changes(parse(b"enum { A = 1 }; static const int x = 3; int y[4];")) == []


def test_an_object_with_the_name_of_a_constant_stays() -> None:
    text = b"static const pair_t ZERO = {0};\nint f(void)\n{\n    return g(ZERO);\n}\n"
    assert changes(parse(text)) == []


def test_a_function_that_is_not_understood_is_refused() -> None:
    with pytest.raises(ValueError, match="line 3"):
        found_in("return a +* ;;) b;")


def test_every_mutant_acts_alone_and_number_zero_is_the_unchanged_code(tmp_path: Path) -> None:
    """Each numbered mutant of the file with all of them gives what its own plain file gives."""
    text = (
        b"int f(int a, int b)\n{\n    int c = 0;\n    if (a < b && a + 1 != b) {\n        c = b;\n"
    )
    text += b"    }\n    c += a * 2;\n    return c > 3 ? c - 1 : -c;\n}\n"
    numbered = dict(enumerate(changes(parse(text)), 1))
    main = (
        "#include <stdio.h>\n#include <stdlib.h>\nint f(int a, int b);\nextern int hubfoc_mutant;\n"
        "int main(int n, char **v) { hubfoc_mutant = n > 1 ? atoi(v[1]) : 0;\n"
        'for (int a = 1; a < 5; a++) for (int b = 1; b < 6; b++) printf("%d ", f(a, b)); }\n'
    )
    runtime = Path(schema.__file__).with_name("runtime.h")

    def program(name: str, code: bytes) -> Path:
        file = tmp_path / f"{name}.c"
        file.write_text(RUNTIME + main + code.decode(), encoding="utf-8")
        out = tmp_path / name
        subprocess.run(["cc", "-w", "-fwrapv", "-include", runtime, file, "-o", out], check=True)
        return out

    def output(*words: str | Path) -> str:
        return subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True).stdout

    everything = program("all", schema.with_all(text, numbered))
    unchanged = output(program("plain", text))
    assert output(everything, "0") == unchanged
    differing = 0
    for number, change in list(numbered.items())[::3]:
        alone = output(program(f"one{number}", schema.with_one(text, change)))
        assert output(everything, str(number)) == alone
        differing += alone != unchanged
    assert differing >= 7


def test_a_place_is_reached_by_a_value_that_the_mutant_changes(tmp_path: Path) -> None:
    """What has effects, or guards a division, is reached wherever it is evaluated."""
    text = (
        b"int f(int a, int b)\n{\n    const int c = a < b;\n    const int d = q_min(a, 9);\n"
        b"    const int e = b != 0 && 8 / b > 3;\n    return c + d + e + (g(a) < 2);\n}\n"
    )
    before = (
        "#include <stdio.h>\nstatic int calls;\nint g(int a) { calls++; return a; }\n"
        "int q_min(int a, int b) { return a < b ? a : b; }\n"
    )
    main = (
        "int main(void) { f(1, 2); f(1, 0); printf(calls == 2 ? "
        '"" : "effect"); for (int n = 0; n < 99; n++) if (hubfoc_reached[n]) printf("%d ", n); }\n'
    )
    numbered = dict(enumerate(changes(parse(text)), 1))
    file, out = tmp_path / "reached.c", tmp_path / "reached"
    code = schema.with_all(text, numbered).decode()
    file.write_text(RUNTIME + before + code + main, encoding="utf-8")
    runtime = Path(schema.__file__).with_name("runtime.h")
    subprocess.run(["cc", "-w", "-fwrapv", "-include", runtime, file, "-o", out], check=True)
    done = subprocess.run([out], stdout=subprocess.PIPE, text=True, check=True)
    reached = {int(number) for number in done.stdout.split()}
    seen = {
        f"{change.original} -> {change.replacement}": number in reached
        for number, change in numbered.items()
    }
    # f(1, 2) and f(1, 0): 1 < 2 and 1 < 0 are as 1 <= 2 and 1 <= 0; 8 / 2 > 3 is as 8 / 2 >= 3.
    expected = {
        "a < b -> (a) <= (b)": False,
        "a < b -> (a) >= (b)": True,
        "q_min(a, 9) -> a": False,
        "q_min(a, 9) -> 9": True,
        "8 / b > 3 -> (8 / b) >= (3)": False,
        "8 / b > 3 -> (8 / b) <= (3)": True,
        "b != 0 && 8 / b > 3 -> 8 / b > 3": True,
        "b != 0 && 8 / b > 3 -> b != 0": False,
        "g(a) < 2 -> (g(a)) <= (2)": True,
    }
    assert {text: seen[text] for text in expected} == expected


def result(killed: int, tested: int, mutants: int = 0, same_code: int = 0) -> Result:
    """Return a module's result: of so many mutants so many met the tests."""
    survivors = [
        Survivor.of(Path("firmware/x/x.c"), change)
        for change in found_in("return 7;")[:1] * (tested - killed)
    ]
    compiled = tested + same_code
    return Result("x", mutants or compiled, compiled, same_code, killed, survivors)


def test_the_score_is_the_share_of_killed_mutants_without_those_of_the_same_code() -> None:
    assert result(killed=6, tested=8, same_code=2).score == pytest.approx(6 / 8)
    assert result(killed=92, tested=100, same_code=7).meets(0.92)
    assert not result(killed=91, tested=100, same_code=7).meets(0.92)


@pytest.mark.parametrize(("mutants", "sample"), [(500, 150), (500, 400), (6000, 150)])
def test_one_in_a_hundred_samples_fails_that_are_drawn_from_a_module_with_the_least_score(
    mutants: int, sample: int
) -> None:
    """Hypergeometric distribution: sample of mutants of which 92 % are killed by the tests."""
    killable = round(0.92 * mutants)
    fails = sum(
        comb(killable, k) * comb(mutants - killable, sample - k) / comb(mutants, sample)
        for k in range(max(0, sample - (mutants - killable)), min(sample, killable) + 1)
        if not result(k, sample, mutants).meets(0.92)
    )
    assert 0.003 < fails < 0.025


def test_the_report_names_survivors_by_place_and_change_and_a_low_score_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "report.json"
    one = result(killed=11, tested=12, same_code=3)
    monkeypatch.setattr(command, "test_module", lambda *_: one)
    call = ["mutants", "modes", "--json", str(file)]
    for least, status in (("0.92", 1), ("0.91", 0)):
        monkeypatch.setattr(sys, "argv", [*call, "--least", least])
        assert command.main() == status
    assert "firmware/x/x.c:3: constant: 7 -> 7 + 1\n" in capsys.readouterr().out
    found = json.loads(file.read_text(encoding="utf-8"))["x"]
    assert found.pop("score") == pytest.approx(11 / 12)
    survivor = {"file": "firmware/x/x.c", "line": 3, "operator": "constant", "before": "7"}
    survivors = [{**survivor, "after": "7 + 1"}]
    assert found == {"compiled": 15, "same_code": 3, "killed": 11, "survivors": survivors}


def test_the_programs_of_a_module_are_its_own_unit_tests() -> None:
    listed = """\
tests/unit/firmware/foc/unit_foc: C_EXECUTABLE_LINKER__unit_foc_
tests/unit/firmware/foc/all: phony
tests/unit/firmware/foc_other/unit_foc_other: C_EXECUTABLE_LINKER__unit_other_
tests/unit/firmware/foc/unit_foc_private: C_EXECUTABLE_LINKER__unit_foc_private_
tests/unit/firmware/modes/unit_modes: C_EXECUTABLE_LINKER__unit_modes_
firmware/foc/libhubfoc_foc.a: C_STATIC_LIBRARY_LINKER__hubfoc_foc_
"""
    folder = "tests/unit/firmware"
    assert programs_of(["foc"], listed) == [
        f"{folder}/foc/unit_foc",
        f"{folder}/foc/unit_foc_private",
    ]
    assert programs_of(["modes", "core"], listed) == [f"{folder}/modes/unit_modes"]


def test_a_suite_is_run_by_itself_and_reaches_its_own_mutants(tmp_path: Path) -> None:
    program = tmp_path / "unit_modes"
    program.write_text(
        '#!/bin/sh\nif [ "$*" = --list ]; then echo first; echo second; exit; fi\n'
        '[ "$*" != first ] || printf \'\\0\\1\\0\' >"$HUBFOC_MUTANTS_REACHED"\n'
        '[ "$*" != second ] || printf \'\\0\\0\\1\' >"$HUBFOC_MUTANTS_REACHED"\n'
        '[ "$*/$HUBFOC_MUTANT" != second/2 ]\n',
        encoding="utf-8",
    )
    program.chmod(0o755)
    names = suites_of(program)
    assert names == ["first", "second"]
    first, second = (measure.profile(program, name) for name in names)
    assert first.reached == {1}
    assert second.reached == {2}
    assert measure.is_killed(second, 2)
    assert not measure.is_killed(first, 2)
