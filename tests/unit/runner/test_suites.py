# SPDX-License-Identifier: Apache-2.0
"""Files of one program keep their names, functions and mocks apart, and a failure says where."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import suites

FIRST = """
#include "unity.h"
static int calls = 0;
/* void test_in_a_comment(void) {} */
void setUp(void) { calls = 1; }
void tearDown(void) {}
void test_same_name(void) { TEST_ASSERT_EQUAL_INT(1, calls); }
void test_with_a_long_name(
    void) { TEST_ASSERT_EQUAL_INT(2, calls); }
static void helper(void) { TEST_ASSERT_EQUAL_INT(1, calls); }
void test_last(void) { helper(); }
"""
SECOND = """
#include "unity.h"
#include "mock_line.h"
void setUp(void) {}
void tearDown(void) {}
void test_same_name(void) { mock_wrong_at = __LINE__; }
void test_after_it(void) { TEST_ASSERT_EQUAL_INT(1, mock_begun); }
"""
MOCK = """
#include "unity.h"
static int mock_begun, mock_wrong_at;
static void mock_line_Init(void) { mock_begun++; mock_wrong_at = 0; }
static void mock_line_Verify(void)
{
    UNITY_TEST_ASSERT_EQUAL_INT(0, mock_wrong_at, mock_wrong_at, "mock");
}
static void mock_line_Destroy(void) { mock_begun = 0; }
"""
UNITY = Path(os.environ["HUBFOC_UNITY_DIR"]) / "src"
HERE = Path(__file__).resolve().parent


class Program:
    """A program of two test files."""

    def __init__(self, place: Path) -> None:
        compiler = shutil.which("cc") or shutil.which("gcc")
        assert compiler is not None
        files = {"test_first.c": FIRST, "test_second.c": SECOND, "mock_line.h": MOCK}
        for name, text in files.items():
            (place / name).write_text(text, encoding="utf-8")
        self.tests = [place / "test_first.c", place / "test_second.c"]
        self.written = place / "written"
        suites.main(self.written, self.tests)
        self.path = place / "program"
        sources = [*sorted(self.written.glob("*.c")), HERE / "run_suites.c", UNITY / "unity.c"]
        command = [compiler, "-Wall", "-Wextra", "-Werror", f"-I{UNITY}", f"-I{HERE}",
                   *map(str, sources), "-o", str(self.path)]  # fmt: skip
        subprocess.run(command, check=True)

    def run(self, *arguments: str) -> tuple[int, list[str]]:
        done = subprocess.run([self.path, *arguments], check=False, capture_output=True, text=True)
        return done.returncode, (done.stdout + done.stderr).splitlines()


@pytest.fixture(name="program", scope="module")
def make_program(tmp_path_factory: pytest.TempPathFactory) -> Program:
    return Program(tmp_path_factory.mktemp("suites"))


def test_failures_name_file_line_and_test_and_are_counted_together(program: Program) -> None:
    status, lines = program.run()
    first, second = program.tests
    assert [line for line in lines if line.startswith("/")] == [
        f"{first}:7:test_same_name:PASS",
        f"{first}:9:test_with_a_long_name:FAIL: Expected 2 Was 1",
        f"{first}:11:test_last:PASS",
        f"{second}:6:test_same_name:FAIL: Expected 0 Was 6. mock",
        f"{second}:7:test_after_it:PASS",
    ]
    assert "5 Tests 2 Failures 0 Ignored " in lines
    assert status == 2


def test_only_the_suites_that_are_named_run(program: Program) -> None:
    assert program.run("--list") == (0, ["first", "second"])
    status, lines = program.run("second")
    assert "2 Tests 1 Failures 0 Ignored " in lines
    assert status == 1
    assert not [line for line in lines if "test_first" in line]


def test_an_unknown_suite_is_an_error(program: Program) -> None:
    assert program.run("first", "third") == (2, ["no suite third; --list shows them"])


def test_what_has_not_changed_is_not_written(program: Program) -> None:
    before = {path: path.stat().st_mtime_ns for path in program.written.iterdir()}
    text = program.tests[0].read_text(encoding="utf-8")
    program.tests[0].write_text(text + "void test_new(void) {}\n", encoding="utf-8")
    suites.main(program.written, program.tests)
    program.tests[0].write_text(text, encoding="utf-8")
    changed = {path.name for path, time in before.items() if path.stat().st_mtime_ns != time}
    assert changed == {"suite_first.c"}


def test_a_file_without_a_test_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "test_none.c").write_text("void setUp(void) {}\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="no test"):
        suites.main(tmp_path, [tmp_path / "test_none.c"])
