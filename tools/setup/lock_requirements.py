# SPDX-License-Identifier: Apache-2.0
"""Resolve the package sets of tools/setup/requirements and pin every package with its hashes.

Usage: ``./tools/dev python tools/setup/lock_requirements.py [--upgrade]``

Each ``NAME.in`` lists what the project itself uses. ``NAME.txt`` is written beside it: these
packages and all that they need, one version for every supported Python, with the SHA-256 of each
wheel that may be installed. Versions already in a ``.txt`` stay as they are unless an ``.in`` asks
for another one; with ``--upgrade`` all packages that no ``.in`` pins take their newest version.

pip resolves, from the index that this machine's pip is set up for. Nothing is installed.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pip._vendor.packaging.requirements import Requirement

SETS = Path(__file__).resolve().parent / "requirements"
PYTHONS = ("3.11", "3.12", "3.13")
# Wheels that run with the C library of Debian 12 (2.36) or an older one.
TAGS = (
    *(f"manylinux_2_{minor}" for minor in range(36, 3, -1)),
    *("manylinux2014", "manylinux2010", "manylinux1"),
)
Package = dict[str, Any]


def normalised(name: str) -> str:
    """Return a package name as Python packaging compares names."""
    return re.sub(r"[-_.]+", "-", name).lower()


def lines(path: Path) -> Iterator[str]:
    """Yield the requirements of a file, without comments, hashes and continuations."""
    for line in path.read_text(encoding="utf-8").splitlines():
        requirement = line.partition("#")[0].partition("\\")[0].strip()
        if requirement and not requirement.startswith("--"):
            yield requirement


def pinned_now() -> dict[str, str]:
    """Return the version of every package that is pinned today."""
    pins = {}
    for path in SETS.glob("*.txt"):
        for line in lines(path):
            name, _, version = line.partition("==")
            pins[normalised(name)] = version
    return pins


def resolve(python: str, sources: list[Path], constraints: Path) -> dict[str, Package]:
    """Return pip's resolution for one Python version: every package of all sets, by name."""
    command = [
        *(sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--quiet"),
        *("--report", "-", "--only-binary=:all:", "--implementation", "cp"),
        *("--python-version", python, "--constraint", str(constraints)),
        *("--target", str(constraints.parent)),
        *(f"--platform={tag}_x86_64" for tag in TAGS),
        *(word for source in sources for word in ("-r", str(source))),
    ]
    answer = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if answer.returncode != 0:
        sys.exit(f"lock_requirements: pip found no set of wheels for CPython {python}")
    report = json.loads(answer.stdout)
    return {normalised(item["metadata"]["name"]): item for item in report["install"]}


def closure(roots: list[str], packages: dict[str, Package], python: str) -> set[str]:
    """Return the names of the roots and of everything they need with one Python version."""
    environment = {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "sys_platform": "linux",
        "platform_system": "Linux",
        "platform_machine": "x86_64",
        "os_name": "posix",
        "implementation_name": "cpython",
        "platform_python_implementation": "CPython",
    }
    found: set[str] = set()
    waiting = [Requirement(root) for root in roots]
    seen: set[tuple[str, str]] = set()
    while waiting:
        requirement = waiting.pop()
        name = normalised(requirement.name)
        found.add(name)
        for extra in {"", *requirement.extras}:
            if (name, extra) in seen:
                continue
            seen.add((name, extra))
            for text in packages[name]["metadata"].get("requires_dist", []):
                needed = Requirement(text)
                if needed.marker is None or needed.marker.evaluate(environment | {"extra": extra}):
                    waiting.append(needed)
    return found


def lock_text(source: Path, answers: dict[str, dict[str, Package]]) -> str:
    """Return the text of one set's lock file."""
    names = set()
    for python, packages in answers.items():
        names |= closure(list(lines(source)), packages, python)
    text = [
        "# SPDX-License-Identifier: Apache-2.0",
        (
            f"# Generated from {source.name} by tools/setup/lock_requirements.py: all that it"
            " needs, with"
        ),
        f"# the hashes of the wheels for CPython {PYTHONS[0]} to {PYTHONS[-1]} on x86-64 Linux.",
    ]
    for name in sorted(names):
        items = [packages[name] for packages in answers.values() if name in packages]
        versions = {item["metadata"]["version"] for item in items}
        if len(versions) != 1:
            sys.exit(
                f"lock_requirements: {name}: {' and '.join(sorted(versions))}; pin it in an .in"
            )
        hashes = {item["download_info"]["archive_info"]["hashes"]["sha256"] for item in items}
        pin = f"{name}=={versions.pop()}"
        text.append(
            " \\\n    ".join([pin, *(f"--hash=sha256:{digest}" for digest in sorted(hashes))])
        )
    return "\n".join(text) + "\n"


def main() -> None:
    """Write every lock file anew."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--upgrade", action="store_true", help="take the newest versions")
    upgrade = parser.parse_args().upgrade
    sources = sorted(SETS.glob("*.in"))
    asked_for = {normalised(Requirement(line).name) for source in sources for line in lines(source)}
    pins = {} if upgrade else pinned_now()
    with tempfile.TemporaryDirectory() as directory:
        constraints = Path(directory) / "constraints.txt"
        constraints.write_text(
            "".join(f"{name}=={pins[name]}\n" for name in sorted(set(pins) - asked_for))
        )
        answers = {python: resolve(python, sources, constraints) for python in PYTHONS}
    texts = {source: lock_text(source, answers) for source in sources}
    for source, text in texts.items():
        source.with_suffix(".txt").write_text(text, encoding="utf-8")
        print(f"{source.with_suffix('.txt').name}: {text.count('==')} packages")


if __name__ == "__main__":
    main()
