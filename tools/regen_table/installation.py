# SPDX-License-Identifier: Apache-2.0
"""Where the packages find what is not Python, and which version and commit they are.

In the repository that is the repository itself. An installed distribution carries a copy of the few
files needed, at the same places below ``regen_table/data``, and a record of the build.
"""

import json
import os
import re
from functools import cache
from pathlib import Path

_DATA = Path(__file__).resolve().parent / "data"
INSTALLED = (_DATA / "build.json").is_file()
ROOT = _DATA if INSTALLED else Path(__file__).resolve().parents[2]

UNKNOWN = "unknown"


# Packages that only some commands need, and the extra of the distribution that brings them.
EXTRAS = {
    "matplotlib": "report",
    "asammdf": "formats",
    "pyarrow": "formats",
    "dask": "sweep",
    "distributed": "sweep",
}
# The repository's set of packages (tools/setup/requirements), where it has another name.
SETS = {"report": "figures"}


def missing(error: ModuleNotFoundError) -> str:
    """Return in one line what is not installed and which command installs it.

    Raises
    ------
    ModuleNotFoundError
        The same again, where no extra has the module: then the fault is the program's.
    """
    package = (error.name or "").partition(".")[0]
    if package not in EXTRAS:
        raise error
    extra = EXTRAS[package]
    if INSTALLED:
        return f"{package} is not installed, accepted: after pip install 'hubfoc[{extra}]'"
    return (
        f"{package} is not installed, accepted: after './tools/dev setup {SETS.get(extra, extra)}'"
    )


def drive_file(named: str | Path) -> Path:
    """Return the file of a drive that may be named as a file or as one of those that come along.

    "lu2013" is tools/motors/lu2013.toml, unless a file of that very name is here.
    """
    path = Path(named)
    known = ROOT / "tools" / "motors" / f"{path.name}.toml"
    return known if path.name == str(named) and not path.exists() and known.is_file() else path


@cache
def version() -> str:
    """Return the project's version, "MAJOR.MINOR.PATCH": that of the top CMake project."""
    if INSTALLED:
        return _record()["version"]
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.search(r"^project\(hubfoc VERSION (\d+\.\d+\.\d+)", text, flags=re.MULTILINE)
    assert found is not None, "the top CMakeLists.txt has no project(hubfoc VERSION ...)"
    return found[1]


@cache
def commit() -> str:
    """Return the commit, with "+" behind it where tracked files were changed.

    An installed distribution names the one it was built from. Else HUBFOC_COMMIT in the environment
    comes first, then what git says, then what ``git archive`` wrote into an archive of the sources;
    where there is none of them: "unknown". tools/cmake/commit.cmake gives the firmware the same.
    """
    if INSTALLED:
        return _record()["commit"]
    if named := os.environ.get("HUBFOC_COMMIT"):
        return named
    if not (ROOT / ".git").exists():  # the project may lie in the checkout of something else
        return _archived()
    import subprocess  # noqa: PLC0415, few callers want a commit

    question = ("describe", "--always", "--dirty=+", "--exclude=*", "--abbrev=40")
    command = ["git", "-C", str(ROOT), "--no-optional-locks", *question]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    except (OSError, subprocess.SubprocessError):
        return UNKNOWN
    return done.stdout.strip() if done.returncode == 0 and done.stdout.strip() else UNKNOWN


def short(commit: str) -> str:
    """Return a commit as the firmware has it: twelve digits, and "+" behind changed files."""
    found = re.fullmatch(r"([0-9a-f]{1,12})[0-9a-f]*(\+?)", commit)
    return "".join(found.groups()) if found else UNKNOWN


def identity(program: str) -> str:
    """Return program, version and commit in the words of the firmware's banner."""
    return f"{program} {version()} ({short(commit())})"


def _archived() -> str:
    """Return the commit that ``git archive`` put in place of the file's format string."""
    try:
        text = (ROOT / "tools" / "cmake" / "archived_commit").read_text(encoding="ascii").strip()
    except OSError:
        return UNKNOWN
    return text if re.fullmatch(r"[0-9a-f]{40}", text) else UNKNOWN


def _record() -> dict[str, str]:
    """Return what the build of the distribution wrote down."""
    found: dict[str, str] = json.loads((_DATA / "build.json").read_text(encoding="utf-8"))
    return found
