# SPDX-License-Identifier: Apache-2.0
"""tools/mutants: which changes are found in a C file, and that each acts alone."""

import subprocess
from pathlib import Path

import pytest
from mutants import explained, schema
from mutants.operators import Change, changes, parse

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


def test_a_name_stays_when_lines_are_moved_and_tells_equal_changes_apart() -> None:
    def names_of(body: str) -> list[str]:
        numbered = dict(enumerate(((Path("x.c"), one) for one in found_in(body)), 1))
        return list(explained.names(numbered).values())

    names = names_of("a = 2;\na = 2;")
    assert names == names_of("\n\n a = 2;\n\n  a = 2;")
    assert len(set(names)) == len(names)
    assert names[0] == "x.c: f: a = 2; -> (removed)"
    assert names[1] == "x.c: f: 2 -> 2 + 1 in: a = 2;"


def test_an_entry_without_a_reason_or_of_an_unknown_kind_is_wrong(tmp_path: Path) -> None:
    entry = '[[explained]]\nfile = "x.c"\nfunction = "f"\nchanges = ["a -> b"]\n'
    file = tmp_path / "explained_x.toml"
    for more, wrong in (
        ('kind = "equivalent"\nreason = "because"', 0),
        ('kind = "equivalent"\nreason = " "', 1),
        ('kind = "boring"\nreason = "because"', 1),
    ):
        file.write_text(entry + more, encoding="utf-8")
        tables = explained.Tables(tmp_path, "x")
        assert len(tables.wrong) == wrong
        assert list(tables.explained) == ["x.c: f: a -> b"]


def test_open_mutants_are_written_and_read_back(tmp_path: Path) -> None:
    explained.Tables(tmp_path, "x").write_open(["x.c: f: a -> b"])
    assert explained.Tables(tmp_path, "x").open == {"x.c: f: a -> b"}
    explained.Tables(tmp_path, "x").write_open([])
    assert not (tmp_path / "open_x.txt").exists()
