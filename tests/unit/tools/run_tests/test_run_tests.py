# SPDX-License-Identifier: Apache-2.0
"""tools/run_tests on a small project: two C tests, a Python test and a slow one."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from run_tests import cases, choose
from run_tests.choose import BuildGraph
from run_tests.ctest import Result
from run_tests.ctest import Test as CTest
from run_tests.suite import steady_s

ROOT = Path(__file__).resolve().parents[4]

LISTS = """
cmake_minimum_required(VERSION 3.25)
project(small C)
enable_testing()
add_subdirectory(tests/unit)
"""
TESTS = """
foreach(name IN ITEMS first second)
  add_executable(${name} ${name}.c)
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/include")
  add_test(NAME ${name} COMMAND ${name})
endforeach()
set_tests_properties(second PROPERTIES ENVIRONMENT "ANSWER=a b")
add_test(NAME reader COMMAND "$ENV{SMALL_PYTHON}" "${CMAKE_CURRENT_SOURCE_DIR}/reader.py")
set_tests_properties(reader PROPERTIES LABELS python)
add_test(NAME whole_cycle COMMAND "${CMAKE_COMMAND}" -E true)
set_tests_properties(whole_cycle PROPERTIES LABELS full
  ENVIRONMENT "HUBFOC_WHEN_CHANGED=${PROJECT_SOURCE_DIR}/none.c,${PROJECT_SOURCE_DIR}/proved")
"""
PRESETS = """
{"version": 6,
 "configurePresets": [{"name": "host", "generator": "Ninja",
  "binaryDir": "${sourceDir}/build/host"}],
 "buildPresets": [{"name": "host", "configurePreset": "host"}],
 "testPresets": [{"name": "host", "configurePreset": "host"}]}
"""
FILES = {
    "CMakeLists.txt": LISTS,
    "CMakePresets.json": PRESETS,
    ".gitignore": "/build/\n__pycache__/\n",
    "include/limit.h": "#define LIMIT 3\n",
    "data/table.csv": "1,2\n",
    "data/unread.csv": "1,2\n",
    "tests/unit/CMakeLists.txt": TESTS,
    "tests/unit/first.c": (
        '#include <stdio.h>\n#include "limit.h"\n'
        'int main(void) { puts("2 Tests 0 Failures 0 Ignored"); return LIMIT != 3; }\n'
    ),
    "tests/unit/second.c": (
        "#include <stdlib.h>\n#include <string.h>\n"
        'int main(void) { return strcmp(getenv("ANSWER"), "a b"); }\n'
    ),
    "tests/unit/reader.py": (
        "import helper\nassert helper.rows() == 1\nprint('5 passed, 1 skipped in 0.01s')\n"
    ),
    "tests/unit/helper.py": (
        "import pathlib\ndef rows(): return"
        " len(pathlib.Path(__file__).parents[2].joinpath('data/table.csv').read_text().split())\n"
    ),
}


class Project:
    """A repository with run_tests in it."""

    def __init__(self, place: Path) -> None:
        self.root = place
        for name, text in FILES.items():
            self.write(name, text)
        shutil.copytree(ROOT / "tools/run_tests", place / "tools/run_tests",
                        ignore=shutil.ignore_patterns("__pycache__"))  # fmt: skip
        self.write("tools/run_tests/costs.json", '{"host:first": 1, "host:second": 5}\n')
        # An interpreter as the project's environment starts it, with the hook of its .pth file.
        self.write(
            "build/python",
            f"#!/bin/sh\nPYTHONPATH={place}/tools exec {sys.executable} -c 'import os, runpy, sys;"
            ' "HUBFOC_OPENED" in os.environ and __import__("run_tests.opened"); sys.argv.pop(0);'
            " sys.path.insert(0, os.path.dirname(sys.argv[0])); runpy.run_path(sys.argv[0])'"
            ' "$@"\n',
        )
        (place / "build/python").chmod(0o755)
        self.git("init", "-q")
        self.git("add", "-A")
        self.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "-m", "all")
        self.command("cmake", "--preset", "host")
        self.command("cmake", "--build", "--preset", "host")

    def write(self, name: str, text: str) -> None:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def git(self, *arguments: str) -> None:
        self.command("git", *arguments)

    def command(self, *words: str, status: int | None = 0) -> str:
        environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("HUBFOC", "GIT"))
        }
        environment["SMALL_PYTHON"] = str(self.root / "build/python")
        answer = subprocess.run(
            words, cwd=self.root, env=environment, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
        assert status is None or answer.returncode == status, answer.stdout
        return answer.stdout

    def run(self, *arguments: str, status: int = 0) -> str:
        words = (sys.executable, str(self.root / "tools/run_tests/__main__.py"), *arguments)
        return self.command("env", f"PYTHONPATH={self.root / 'tools'}", *words, status=status)


@pytest.fixture(name="project")
def make_project(tmp_path: Path) -> Project:
    return Project(tmp_path)


def started(output: str) -> list[str]:
    return [line.split()[-1] for line in output.splitlines() if line.lstrip().startswith("Start ")]


def test_tests_run_longest_first_by_the_times_of_the_previous_run(
    project: Project,
) -> None:
    output = project.run("--presets", "host", "--setup-s", "1", "--build-s", "2")
    # That of an unknown time first, so that the others cannot be through before it.
    assert started(output) == ["host:reader", "host:second", "host:first"]
    assert "1 tests labelled full were left out" in output
    assert "Set-up took 1 s, building 2 s, testing" in output
    lines = output.splitlines()[-4:]
    assert lines[:2] == ["host:", "100% tests passed, 0 tests failed out of 3"]
    assert lines[3] == ("Cases: 3 tests ran; 2 Unity functions (2 host); 6 pytest cases (6 host).")
    # The Python test took longest, unlike the stored estimate.
    assert started(project.run("--presets", "host"))[0] == "host:reader"
    full = project.run("--presets", "host", "--full")
    assert "100% tests passed, 0 tests failed out of 4" in full


def test_a_full_test_runs_where_a_file_that_it_names_has_changed(project: Project) -> None:
    (project.root / "data/table.csv").write_text("3,4\n", encoding="utf-8")
    assert "host:whole_cycle" not in started(project.run("--presets", "host"))
    project.write("proved/source.c", "")
    output = project.run("--presets", "host")
    assert "host:whole_cycle" in started(output)
    assert "were left out" not in output
    assert "host:whole_cycle" in started(project.run("--quick"))
    shutil.rmtree(project.root / ".git")  # nothing is known to have changed
    assert "host:whole_cycle" not in started(project.run("--presets", "host"))


def test_programs_not_built_yet_are_targets(project: Project) -> None:
    project.run("--presets", "host")
    built = project.root / "build/host/tests/unit"
    for name in ("first", "second"):
        (built / name).unlink()
    needed = project.run("--presets", "host", "--list-targets", "unit").split()
    assert needed == ["tests/unit/first", "tests/unit/second"]
    project.write("include/limit.h", "#define LIMIT 3 /* again */\n")
    assert started(project.run("--quick")) == ["host:first"]


def test_a_failing_test_is_listed_under_its_preset_and_fails_the_run(project: Project) -> None:
    project.write("data/table.csv", "1,2\n3,4\n")
    output = project.run("--presets", "host", status=1)
    assert output.splitlines()[-1] == "tools/dev: failed: host"
    assert "67% tests passed, 1 tests failed out of 3" in output
    assert "The following tests FAILED:\n\treader (Failed)" in output


def test_the_tests_of_a_folder_are_those_of_its_cmake_lists(project: Project) -> None:
    # The input files of the Python test are unknown so far.
    needed = project.run("--presets", "host", "--list-targets", "unit").split()
    assert needed == ["all"]
    assert len(started(project.run("--presets", "host", "tests/unit"))) == 3
    assert len(started(project.run("--presets", "host", "unit"))) == 3
    empty_run = project.run("--presets", "host", "include", status=1)
    assert started(empty_run) == []
    needed = project.run("--presets", "host", "--list-targets", "unit").split()
    assert needed == ["tests/unit/first", "tests/unit/second"]
    assert project.run("--presets", "host", "--list-targets", "tools") == ""
    # A test that needs no build.
    needed = project.run("--presets", "host", "--list-targets", "tests/unit/reader.py").split()
    assert needed == ["build.ninja"]
    project.command("cmake", "--build", "--preset", "host", "--target", *needed)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("include/limit.h", ["host:first"]),
        ("tests/unit/second.c", ["host:second"]),
        ("data/table.csv", ["host:reader"]),
        ("tests/unit/helper.py", ["host:reader"]),
        ("data/unread.csv", []),
    ],
)
def test_quick_builds_and_runs_the_tests_that_read_a_changed_file(
    project: Project, changed: str, expected: list[str]
) -> None:
    project.run("--presets", "host")
    path = project.root / changed
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    output = project.run("--quick")
    assert started(output) == expected
    assert f"1 files changed since HEAD; {len(expected)} tests belong to them." in output
    assert (f"No test is known to read: {changed}." in output) == (not expected)


def test_quick_builds_first_and_selects_tests_of_unknown_inputs(project: Project) -> None:
    project.write("include/limit.h", "#define LIMIT 4\n")
    output = project.run("--quick", status=1)
    assert "first (Failed)" in output
    assert "1 Python tests" in output  # none has run yet, so the input files are unknown
    project.write("include/limit.h", "#define LIMIT three\n")
    assert "the build failed" in project.run("--quick", status=1)


def test_quick_includes_a_test_added_since_the_last_configure(project: Project) -> None:
    project.run("--presets", "host")
    project.write("tests/unit/third.c", FILES["tests/unit/first.c"])
    project.write("tests/unit/CMakeLists.txt", TESTS.replace("first second", "first second third"))
    output = project.run("--quick")
    assert "host:third" in started(output)


def test_quick_lists_the_tests_omitted_for_time(project: Project) -> None:
    project.run("--presets", "host")
    (project.root / "build/test/costs.json").write_text('{"host:first": 100.0}', encoding="utf-8")
    project.write("include/limit.h", "#define LIMIT 3 /* again */\n")
    output = project.run("--quick")
    assert started(output) == []
    assert "Left out to save time: 1 tests: host:first." in output


def test_json_says_what_was_done_and_what_it_took(project: Project) -> None:
    project.write("build/times", "host configure 1.25\nhost build 20.5\nqemu build 3\n")
    begin = str(time.time() - 100.0)
    options = ["--presets", "host", "--not-built", "qemu", "--json", "build/run.json",
               "--times", "build/times", "--begin", begin]  # fmt: skip
    project.run(*options, status=1)
    content = json.loads((project.root / "build/run.json").read_text(encoding="utf-8"))
    assert 100.0 < content["wall_s"] < 150.0
    assert 0.0 < content["cpu_s"] < 100.0
    assert content["cores"] == len(os.sched_getaffinity(0))
    tests_s = content["presets"]["host"].pop("test_s")
    assert 0.0 <= tests_s < 50.0
    assert content["presets"] == {
        "host": {"configure_s": 1.2, "build_s": 20.5},
        "qemu": {"configure_s": 0.0, "build_s": 3.0, "test_s": 0},
    }
    assert content["cases"] == {"Unity functions": {"host": 2}, "pytest cases": {"host": 6}}
    assert content["left_out"] == ["host:whole_cycle"]
    assert content["failed"] == ["qemu:build"]
    assert content["proofs"] == {"run": 0, "cached": 0}


def test_json_is_written_when_tests_fail_and_of_a_quick_run(project: Project) -> None:
    project.run("--presets", "host")
    project.write("include/limit.h", "#define LIMIT 4\n")
    project.run("--quick", "--json", "build/quick.json", status=1)
    content = json.loads((project.root / "build/quick.json").read_text(encoding="utf-8"))
    assert content["failed"] == ["host:first"]
    assert content["presets"]["host"]["build_s"] >= 0.0
    assert content["left_out"] == []


def test_graph_ignores_order_only_dependencies(project: Project) -> None:
    directory = project.root / "build/host"
    graph = BuildGraph(directory)
    affected = graph.affected({project.root / "include/limit.h"})
    assert directory / "tests/unit/first" in affected
    assert directory / "tests/unit/second" not in affected


def test_input_files_of_a_test_are_found_in_arguments_and_environment() -> None:
    test = CTest(
        "host",
        "boots",
        (
            "/bin/cmake",
            "-DLIMIT=/build/limit.so,instructions=1",
            "test_a.py::test_b",
            "-P",
            "run.cmake",
        ),
        {"ENVIRONMENT": ["LIBRARY=/build/library.so"], "WORKING_DIRECTORY": "/tests"},
        (),
    )
    expected = {"/build/limit.so", "/tests/test_a.py", "/tests/run.cmake", "/build/library.so"}
    assert set(map(Path, expected)) <= test.files()


def test_the_unit_tests_of_a_changed_folder_are_the_nearest() -> None:
    root = Path("/repository")
    lists = {
        "unit_torque": "tests/unit/firmware/torque",
        "unit_controller": "tests/unit/firmware/controller",
        "proofs": "tests/proofs",
    }
    tests = [
        CTest("host", name, (), {}, (root / folder / "CMakeLists.txt", root / "CMakeLists.txt"))
        for name, folder in lists.items()
    ]

    def nearest(*names: str) -> list[str]:
        return [test.name for test in choose.nearest(tests, [root / name for name in names], root)]

    assert nearest("firmware/torque/torque_limits.c") == ["unit_torque"]
    assert nearest("firmware/controller/include/controller/controller.h") == ["unit_controller"]
    assert nearest("tests/unit/firmware/torque/test_limit.c", "tests/proofs/proof.h") == [
        "unit_torque",
        "proofs",
    ]
    assert nearest("README.md", "firmware/CMakeLists.txt") == []


def test_kept_times_are_whole_seconds_and_change_only_by_much() -> None:
    assert [steady_s(None, 2.6), steady_s(None, 0.2)] == [3, 0]
    assert [steady_s(1, 2.0), steady_s(100, 125.0), steady_s(10, 14.0)] == [1, 100, 14]


def test_the_time_of_a_proof_that_was_known_is_no_cost() -> None:
    known = "3 contracts proved before (cached): a, b, c"
    assert cases.only_known([known])
    assert not cases.only_known([known, "1 contract proved: d"])
    assert not cases.only_known(["2 Tests 0 Failures 0 Ignored"])


LOG = """Start testing: Nov 22 15:04 UTC
1/8 Testing: host:circle
1/8 Test: host:circle
Command: "test_circle"
Output:
----------------------------------------------------------
test_circle.c:7:test_a:PASS
Output:
9 Tests 9 Failures 0 Ignored
-----------------------
3 Tests 1 Failures 1 Ignored
FAIL
<end of output>
Test time =   0.01 sec
7 Tests 0 Failures 0 Ignored
----------------------------------------------------------
"""
ENTRY = """{number}/8 Test: {name}
Command: "99 Tests 0 Failures 0 Ignored"
Output:
----------------------------------------------------------
{text}
<end of output>
"""


def test_cases_are_counted_by_kind_and_preset_from_what_ran(tmp_path: Path) -> None:
    """Programs without a summary have no cases; a proof that was known is one as well."""
    programs = [
        ("host", "circle", ["unit"], None),
        ("qemu", "target_circle", ["target", "unit"], "4 Tests 0 Failures 0 Ignored\r\nOK"),
        ("host", "property_twin", ["property"], "5 Tests 0 Failures 0 Ignored"),
        ("host", "table", ["python"], "2 failed, 70 passed, 1 skipped, 3 warnings in 8.21s"),
        ("host", "cli", ["python"], "== 1 passed in 61.00s (0:01:01) =="),
        ("host", "proof_circle", ["proof"], "1 proof proved: circle"),
        ("host", "proof_grid", ["proof"], "no input meets the assumptions"),
        (
            "host",
            "contracts_limit",
            ["proof"],
            "3 contracts proved: a, b, c\n2 contracts proved before (cached): d, e",
        ),
        ("host", "boots", ["target"], "result: READY"),
    ]
    log = tmp_path / "LastTest.log"
    log.write_text(
        LOG + "".join(
            ENTRY.format(number=number, name=f"{preset}:{name}", text=text)
            for number, (preset, name, _, text) in enumerate(programs) if text
        ),
        encoding="utf-8",
    )  # fmt: skip
    tests = [
        CTest(preset, name, (), {"LABELS": labels}, ()) for preset, name, labels, _ in programs
    ]
    results = {test.full_name: Result("Passed", 1.0) for test in tests}
    line = cases.closing_line(tests, results, cases.outputs(log))
    assert line == (
        "Cases: 9 tests ran; 7 Unity functions (3 host, 4 qemu); 5 property cases (5 host);"
        " 74 pytest cases (74 host); 6 proofs (6 host); 2 of the proofs had been proved before."
    )
    # What was skipped or never started counts nowhere.
    results["host:circle"] = Result("Skipped", 0.0)
    del results["host:table"], results["host:proof_circle"], results["host:contracts_limit"]
    line = cases.closing_line(tests, results, cases.outputs(log))
    assert line == (
        "Cases: 5 tests ran; 4 Unity functions (4 qemu); 5 property cases (5 host);"
        " 1 pytest cases (1 host)."
    )
