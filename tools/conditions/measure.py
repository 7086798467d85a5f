# SPDX-License-Identifier: Apache-2.0
"""Builds the preset host-mcdc, runs the unit tests of the modules, returns what they reached."""

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from unit_programs import programs_of

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "host-mcdc"
MODULES = ("core", "config", "foc", "motor", "torque", "monitor", "modes", "pedals", "controller")
VERSION = 19
_WRONG = re.compile("error:|FAILED|:FAIL:")  # in what tools and programs print
_TOOLS = tuple(f"{name}-{VERSION}" for name in ("clang", "llvm-profdata", "llvm-cov"))


class ConditionsError(Exception):
    """Something that keeps the conditions from being measured, in one line."""


def _run(words: Iterable[str], folder: Path = ROOT) -> str:
    done = subprocess.run(list(words), cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = (done.stdout + done.stderr).splitlines()
        wrong = [line for line in lines if _WRONG.search(line)] or lines or ["?"]
        raise ConditionsError(wrong[0].replace(f"{ROOT}/", ""))
    return done.stdout


def _programs(jobs: int) -> list[Path]:
    """Return the unit test programs of the modules, built."""
    _run(("cmake", "--preset", "host-mcdc"))
    targets = programs_of(MODULES, _run(("ninja", "-t", "targets", "all"), BUILD))
    if not targets:
        raise ConditionsError("no unit tests in build/host-mcdc")
    _run(("ninja", "-j", str(jobs), *targets), BUILD)
    return [BUILD / target for target in targets]


def _profile(program: Path) -> Path:
    """Run a test program and return the file with its counts."""
    counts = program.with_suffix(".profraw")
    counts.unlink(missing_ok=True)
    done = subprocess.run(
        [str(program)],
        env={**os.environ, "LLVM_PROFILE_FILE": str(counts)},
        stdout=subprocess.DEVNULL,
        check=False,
    )
    if done.returncode != 0:
        raise ConditionsError(f"{program.name} fails")
    return counts


def run(jobs: int) -> dict[str, Any]:
    """Return the export of llvm-cov over all test programs.

    Parameters
    ----------
    jobs : int
        So many compilers and test programs at the same time.
    """
    for tool in _TOOLS:
        if shutil.which(tool) is None:
            raise ConditionsError(f"{tool} is missing; ./tools/dev setup mcdc installs it")
    programs = _programs(jobs)
    with ThreadPoolExecutor(jobs) as pool:
        counts = list(pool.map(_profile, programs))
    merged = BUILD / "unit_tests.profdata"
    _run((_TOOLS[1], "merge", "-sparse", *map(str, counts), "-o", str(merged)))
    objects = [word for program in programs[1:] for word in ("-object", str(program))]
    exported: dict[str, Any] = json.loads(
        _run((_TOOLS[2], "export", str(programs[0]), *objects, f"-instr-profile={merged}"))
    )
    return exported
