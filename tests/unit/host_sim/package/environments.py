# SPDX-License-Identifier: Apache-2.0
"""The distribution installed as a user does it: a wheel in an environment outside the repository.

No network is needed: the required packages are linked from the environment of the tests, and only
those that the metadata of the wheel require.
"""

import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterable
from email.parser import Parser
from importlib.metadata import distribution
from pathlib import Path

from packaging.markers import default_environment
from packaging.requirements import Requirement

REPOSITORY = Path(__file__).resolve().parents[4]
PROJECT = REPOSITORY / "host_sim" / "python"
EXTRAS = frozenset({"report", "formats", "sweep"})


class Installed:
    """An environment with the distribution in it, outside the repository.

    Commands run in ``place``, with no compiler on the path.
    """

    def __init__(self, root: Path) -> None:
        self.python = root / "environment" / "bin" / "python"
        self.site = next((root / "environment" / "lib").glob("python*")) / "site-packages"
        self.place = root / "place"
        self.place.mkdir()

    def call(self, *command: str | Path) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment, whatever its exit status."""
        environment = {
            "PATH": str(self.python.parent),
            "HOME": str(self.place),
            "MPLCONFIGDIR": str(self.place / ".matplotlib"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        program = self.python.parent / command[0]
        return subprocess.run(
            [program, *command[1:]],
            cwd=self.place, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip

    def run(self, *command: str | Path) -> str:
        """Run a program that has to succeed, and return its standard output."""
        done = self.call(*command)
        assert done.returncode == 0, f"{command}: {done.stdout}\n{done.stderr}"
        return done.stdout


def metadata_of(wheel: Path) -> dict[str, list[str]]:
    """Return the fields of a wheel's METADATA, each with all its lines."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        message = Parser().parsestr(archive.read(name).decode("utf-8"))
    return {key: [str(v) for v in message.get_all(key) or []] for key in message}


def requirements_of(lines: Iterable[str], extras: frozenset[str]) -> list[Requirement]:
    """Return the requirements that hold on this machine with these extras."""
    found = []
    for line in lines:
        requirement = Requirement(line)
        for extra in extras | {""}:
            where = default_environment() | {"extra": extra}
            if requirement.marker is None or requirement.marker.evaluate(
                {k: str(v) for k, v in where.items()}
            ):
                found.append(requirement)
                break
    return found


def _lend(site: Path, wanted: list[Requirement]) -> None:
    """Link the wanted distributions and all they need into an environment."""
    done: set[str] = set()
    while wanted:
        requirement = wanted.pop()
        name = requirement.name.lower().replace("_", "-")
        own = distribution(requirement.name)
        assert requirement.specifier.contains(own.version), f"{requirement}: {own.version} is here"
        wanted += requirements_of(own.requires or (), frozenset(requirement.extras))
        if name in done:
            continue
        done.add(name)
        for top in {Path(str(file)).parts[0] for file in own.files or ()}:
            source = Path(str(own.locate_file(top)))
            if top not in {"..", "__pycache__"} and not (site / top).exists():
                (site / top).symlink_to(source)


def install(wheel: Path, root: Path, extras: frozenset[str]) -> Installed:
    """Make an environment below ``root`` with the wheel, and what its metadata asks for, in it."""
    venv.create(root / "environment", symlinks=True, with_pip=False)
    made = Installed(root)
    arguments = ["--no-index", "--no-deps", "--disable-pip-version-check", "--quiet"]
    pip = [sys.executable, "-m", "pip", "--python", str(made.python), "install"]
    subprocess.run([*pip, *arguments, str(wheel)], check=True)
    _lend(made.site, requirements_of(metadata_of(wheel)["Requires-Dist"], extras))
    return made
