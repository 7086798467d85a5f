# SPDX-License-Identifier: Apache-2.0
"""Judge whether the running environment is complete and made for this directory.

Usage: ``check_venv.py [--place] ROOT [LOCK_FILE...]``; exit status 0 if so, else one line on stderr
and 1. With ``--place`` only the place is judged, not the packages. It runs before every command, so
it imports little.
"""

import re
import sys
import sysconfig
from pathlib import Path

SITE_PACKAGES = Path(sysconfig.get_path("purelib"))


def misplaced(root: str) -> str | None:
    """Return why this environment does not belong to the directory, or None."""
    pth = SITE_PACKAGES / "hubfoc.pth"
    if not pth.is_file():
        return "hubfoc.pth is missing"
    if str(Path(root) / "tools") not in pth.read_text(encoding="utf-8").split("\n"):
        return "the environment was made for another directory"
    return None


def normalised(name: str) -> str:
    """Return a package name as Python packaging compares names.

    Case and the kind of separator do not count.
    """
    return re.sub(r"[-_.]+", "-", name).lower()


def missing(lock_files: list[str]) -> str | None:
    """Return the first pinned package that is absent or of another version, or None."""
    installed = set()
    for entry in SITE_PACKAGES.glob("*.dist-info"):
        name, _, version = entry.stem.rpartition("-")
        installed.add((normalised(name), version))
    for file in lock_files:
        for line in Path(file).read_text(encoding="utf-8").splitlines():
            pin = line.partition("#")[0].partition("\\")[0].strip()
            if not pin or pin.startswith("--"):
                continue
            name, _, version = pin.partition("==")
            if (normalised(name), version) not in installed:
                return f"{pin} is not installed"
    return None


def main(arguments: list[str]) -> int:
    """Judge the environment."""
    place_only = arguments[0] == "--place"
    if place_only:
        arguments = arguments[1:]
    problem = misplaced(arguments[0])
    if problem is None and not place_only:
        problem = missing(arguments[1:])
    if problem is not None:
        print(problem, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
