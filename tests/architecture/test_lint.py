# SPDX-License-Identifier: Apache-2.0
"""Formatting and static checks, each as a test; the same tools and settings as tools/dev lint."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest
from modules import PURE, ROOT, sources_of
from run_tests import known
from test_repository import git_files, name_of

VENV = Path(sys.executable).parent


def run(*command: str | Path) -> None:
    result = subprocess.run(
        [str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, f"{result.stdout}\n{result.stderr}"


def tracked(*suffixes: str) -> list[str]:
    return [
        name
        for name in map(name_of, git_files())
        if name.endswith(suffixes) and "/generated/" not in name
    ]


def test_c_is_formatted() -> None:
    run(VENV / "clang-format", "--dry-run", "-Werror", *tracked(".c", ".h", ".cpp", ".hpp"))


def test_python_is_formatted() -> None:
    run(VENV / "ruff", "format", "--check", "--config", "tools/setup/ruff.toml", *tracked(".py"))


def test_python_has_no_known_defects() -> None:
    run(VENV / "ruff", "check", "--config", "tools/setup/ruff.toml", *tracked(".py"))


def test_python_types_agree() -> None:
    run(VENV / "mypy", "--config-file", "tools/setup/mypy.ini", *tracked(".py"))


ANALYSIS = "clang-analyzer-*"
"""What follows every path through a function: 98 % of the time of all checks."""

LARGE = ROOT / "firmware" / "config" / "fields.c"
"""Its lists of ranges are a million nodes of a syntax tree: nine tenths of the time of the rest."""


def test_the_pure_modules_have_no_known_defects(tmp_path: Path) -> None:
    """clang-tidy with the options the build compiles them with; all but one large table."""
    assert_no_defects(tmp_path, f"-{ANALYSIS}", LARGE)


def test_no_path_through_the_pure_modules_has_a_known_defect(tmp_path: Path) -> None:
    """With the analysis of paths as well, in a full run, and that table."""
    assert_no_defects(tmp_path, "")


def built_here(path: Path) -> bool:
    """Return whether the host's build has a source: not what a small port has in its place."""
    return not path.stem.endswith("_absent")


def assert_no_defects(tmp_path: Path, but: str, *left_out: Path) -> None:
    clang_tidy = shutil.which("clang-tidy")
    if clang_tidy is None:
        pytest.fail("no clang-tidy here; tools/dev setup checks installs it")
    build = Path(os.environ["HUBFOC_BUILD_DIR"])
    every = [path for module in PURE for path in sources_of(module) if built_here(path)]
    assert set(left_out) < set(every)
    sources = [str(path) for path in every if path not in left_out]
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    wanted = different([portable(entry) for entry in commands if entry["file"] in sources])
    assert {one.file for one in wanted} == set(sources)
    entries = [one.entry for one in wanted]
    (tmp_path / "compile_commands.json").write_text(json.dumps(entries), encoding="utf-8")
    settings = [clang_tidy, "--quiet", "-p", str(tmp_path), f"--checks={but}"]
    version = subprocess.run([clang_tidy, "--version"], capture_output=True, check=True).stdout
    checks = (ROOT / ".clang-tidy").read_bytes() + but.encode()

    def defects(file: str) -> str:
        key = known.key_of([version, checks, *(part for one in wanted if one.file == file
                                               for part in one.content())])  # fmt: skip
        if known.is_good("clang_tidy", key):
            return ""
        done = subprocess.run([*settings, file], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            known.keep("clang_tidy", key)
            return ""
        return done.stdout or done.stderr or f"{file}: clang-tidy ended with {done.returncode}"

    with ThreadPoolExecutor(2) as pool:
        found = "\n".join(filter(None, pool.map(defects, sources)))
    assert not found, found


@dataclass(frozen=True)
class Unit:
    """A compile command and the preprocessed text of its source, with the line markers."""

    entry: dict[str, str]
    text: str

    @property
    def file(self) -> str:
        """Return the path of the source."""
        return self.entry["file"]

    def content(self) -> list[str | bytes]:
        """Return all that decides what clang-tidy finds: command and files, comments included."""
        names = dict.fromkeys(re.findall(r'(?m)^# \d+ "([^"<]+)"', self.text))
        contents = [contents_of(Path(self.entry["directory"]) / name) for name in names]
        return [self.entry["command"].replace(f"{ROOT}/", ""), *contents]


@cache
def contents_of(path: Path) -> bytes:
    return path.read_bytes() if path.is_file() else b""


def portable(entry: dict[str, str]) -> dict[str, str]:
    """Return a command without the engine's header of its own and without optimisation.

    The header gives the engine other bodies of a few functions of core, tested as equal; how gcc
    optimises it is unknown to clang and changes no analysis.
    """
    words = shlex.split(entry["command"])
    if "native.h" in words:
        at = words.index("native.h")
        assert words[at - 1] == "-include"
        del words[at - 1 : at + 1]
    words = [word for word in words if not word.startswith(("-fno-", "--param"))]
    return {**entry, "command": shlex.join(words)}


def different(commands: list[dict[str, str]]) -> list[Unit]:
    """Return the commands without those that compile the same text with the same options.

    A file that is part of several libraries is listed once for each, and clang-tidy would repeat
    the analysis for every one of them. Kept apart are texts that differ after the preprocessor (by
    a macro or an include), and options of the language and of warnings that differ.
    """
    kept: dict[tuple[object, ...], Unit] = {}
    for entry in commands:
        words = shlex.split(entry["command"])
        options = tuple(sorted(word for word in words if word.startswith(("-std=", "-W"))))
        text = preprocessed(words, Path(entry["directory"]))
        plain = re.sub(r"(?m)^# .*\n", "", text)
        kept.setdefault((entry["file"], plain, options), Unit(entry, text))
    return list(kept.values())


def preprocessed(words: list[str], directory: Path) -> str:
    output = words.index("-o")
    command = [*words[:output], *words[output + 2 :], "-E"]
    result = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=True)
    return result.stdout
