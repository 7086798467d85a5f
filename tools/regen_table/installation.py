# SPDX-License-Identifier: Apache-2.0
"""Where the packages find what is not Python, and which version and commit they are.

Also the provenance of every output: version, commit, configuration with its CRC, scenario,
seed and date stand in every JSON, Parquet, MDF and HTML file. The generated C source and its image
have none of it: they depend on the TOML file alone. Standard library only.

In the repository that is the repository itself. An installed distribution carries a copy of the few
files needed, at the same places below ``regen_table/data``, and a record of the build.
"""

import json
import os
import re
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from regen_table.errors import ConfigurationError
from regen_table.suggest import suggestion

_DATA = Path(__file__).resolve().parent / "data"
INSTALLED = (_DATA / "build.json").is_file()
ROOT = _DATA if INSTALLED else Path(__file__).resolve().parents[2]

UNKNOWN = "unknown"
EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"


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
KEY_BYTES = 16  # of [service] key, the end of an image


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

    Raises
    ------
    ConfigurationError
        For a name, so without folder and suffix, that no drive has.
    """
    path = Path(named)
    if path.exists() or path.suffix or path.name != str(named):
        return path
    motors = ROOT / "tools" / "motors"
    known = {file.stem: file for file in (*motors.glob("*.toml"), *motors.glob("*/*.toml"))}
    if path.name not in known:
        raise ConfigurationError(f"no drive {path.name!r}, {suggestion(path.name, known)}")
    return known[path.name]


def new_drive_file(name: str) -> Path:
    """Return where a new drive's file goes: beside the others, or here where they are installed."""
    return Path(f"{name}.toml") if INSTALLED else ROOT / "tools" / "motors" / f"{name}.toml"


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
    """Return the commit, followed by "+" if tracked files were changed.

    An installed distribution names the one it was built from. Else HUBFOC_COMMIT in the environment
    comes first, then that of git, then what ``git archive`` wrote into an archive of the sources;
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
    """Return a commit as the firmware has it: twelve digits, and "+" for changed files."""
    found = re.fullmatch(r"([0-9a-f]{1,12})[0-9a-f]*(\+?)", commit)
    return "".join(found.groups()) if found else UNKNOWN


def identity(program: str) -> str:
    """Return program, version and commit in the words of the firmware's banner."""
    return f"{program} {version()} ({short(commit())})"


def provenance(
    configuration: str | None = None,
    image: bytes | None = None,
    *,
    scenario: str | None = None,
    seed: int | None = None,
    date: str | None = None,
) -> dict[str, Any]:
    """Return the origin of an output as an object for JSON; None becomes null.

    Parameters
    ----------
    configuration : str, optional
        Name of the configuration.
    image : bytes, optional
        Its binary image, as the firmware holds it; its CRC-32 is the field ``crc32``.
    scenario, seed : optional
        Of a simulated run.
    date : str, optional
        ISO 8601. Absent: SOURCE_DATE_EPOCH, or else the clock.
    """
    return {
        "program": "hubfoc",
        "version": version(),
        "commit": commit(),
        "configuration": configuration,
        "configuration_crc32": None if image is None else crc32(image),
        "scenario": scenario,
        "seed": seed,
        "date": timestamp(date),
    }


def crc32(image: bytes) -> str:
    """Return an image's CRC-32, as the generated C file writes it; behind it is the service key."""
    return f"0x{int.from_bytes(image[-KEY_BYTES - 4 : -KEY_BYTES], 'little'):08X}"


def timestamp(given: str | None = None) -> str:
    """Return a date as ISO 8601 in UTC, to the second.

    The one given (ISO 8601, UTC where it names no zone), else SOURCE_DATE_EPOCH, else the clock.
    """
    if given is not None:
        try:
            moment = datetime.fromisoformat(given)
        except ValueError:
            raise ConfigurationError(
                f"date: {given!r}, accepted: ISO 8601, as in 2026-01-31T12:00:00Z"
            ) from None
        moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    elif epoch := os.environ.get(EPOCH_VARIABLE):
        try:
            moment = datetime.fromtimestamp(int(epoch), UTC)
        except (ValueError, OverflowError, OSError):
            raise ConfigurationError(
                f"{EPOCH_VARIABLE}: {epoch!r}, accepted: seconds since 1970 as a whole number"
            ) from None
    else:
        moment = datetime.now(UTC)
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


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
