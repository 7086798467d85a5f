# SPDX-License-Identifier: Apache-2.0
"""Formatting and static checks, each as a test; the same tools and settings as tools/dev lint."""

import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from modules import PURE, ROOT, sources_of
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


def test_the_pure_modules_have_no_known_defects(tmp_path: Path) -> None:
    """clang-tidy with the options the build compiles them with."""
    clang_tidy = shutil.which("clang-tidy")
    if clang_tidy is None:
        pytest.fail("no clang-tidy here; tools/dev setup checks installs it")
    build = Path(os.environ["HUBFOC_BUILD_DIR"])
    sources = [str(path) for module in PURE for path in sources_of(module)]
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    wanted = different([portable(entry) for entry in commands if entry["file"] in sources])
    assert {entry["file"] for entry in wanted} == set(sources)
    (tmp_path / "compile_commands.json").write_text(json.dumps(wanted), encoding="utf-8")
    jobs = [
        subprocess.Popen(
            [clang_tidy, "--quiet", "-p", tmp_path, *part],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        for part in halves(sources)
    ]
    outputs = [job.communicate()[0] for job in jobs]
    assert not any(job.returncode for job in jobs), "\n".join(outputs)


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


def different(commands: list[dict[str, str]]) -> list[dict[str, str]]:
    """Return the commands without those that compile the same text with the same options.

    A file that is part of several libraries is listed once for each, and clang-tidy would repeat
    the analysis for every one of them. Kept apart are texts that differ after the preprocessor (by
    a macro or an include), and options of the language and of warnings that differ.
    """
    kept: dict[tuple[object, ...], dict[str, str]] = {}
    for entry in commands:
        words = shlex.split(entry["command"])
        options = tuple(sorted(word for word in words if word.startswith(("-std=", "-W"))))
        text = preprocessed(words, Path(entry["directory"]))
        kept.setdefault((entry["file"], text, options), entry)
    return list(kept.values())


def preprocessed(words: list[str], directory: Path) -> str:
    output = words.index("-o")
    command = [*words[:output], *words[output + 2 :], "-E", "-P"]
    result = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=True)
    return result.stdout


def halves(items: list[str]) -> list[list[str]]:
    return [items[0::2], items[1::2]]
