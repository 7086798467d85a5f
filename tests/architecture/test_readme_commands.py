# SPDX-License-Identifier: Apache-2.0
"""Every command of the README runs, in the README's order, in a clone that holds nothing else.

What tools/dev installs and compiles with is pretended (dev_fixture.py); the programs that its
commands start, hubsim, regen_table and the studies, are the clone's own and run. A command that
needs hardware, a network or minutes has another form here, with the reason.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import unittest
from dataclasses import dataclass
from pathlib import Path

from dev_fixture import ROOT, DevFixture, write_program

BUILT = Path(os.environ.get("HUBFOC_BUILD_DIR", ROOT / "build" / "host"))
PROGRAMS = ("./tools/dev", "pip", "qemu-system-arm", "gdb-multiarch", "openocd")
LONGEST_S = 300.0


@dataclass(frozen=True)
class Form:
    """What is run of a command that begins so instead of it; ``run`` empty: nothing.

    ``reason``: why, and which test runs what is left out.
    """

    run: str
    reason: str


FORMS = {
    "./tools/dev sim": Form(
        "./tools/dev sim --help", "two cycles take a minute; cli/test_readme.py runs hubsim sim"
    ),
    "./tools/dev test": Form("./tools/dev test --help", "this is one of its tests"),
    "./tools/dev hubsim run udds": Form(
        "./tools/dev hubsim run udds --config tools/motors/lu2013.toml --csv udds.csv"
        " --set max_duration_s=130",
        "1 370 s are the test scenario_udds",
    ),
    "./tools/dev hubsim sweep": Form(
        './tools/dev hubsim sweep stop --vary "demand_nm=range(40,120,2)" --output grid.parquet',
        "24 runs show no more than two",
    ),
    "./tools/dev hubsim swarm": Form(
        "./tools/dev hubsim swarm --seeds 0:1 --output swarm", "cli/test_readme.py has four seeds"
    ),
    "pip install": Form("", "a wheel is built and installed by package/test_wheel.py"),
    "./tools/dev python host_sim/python/examples/": Form("", "api/test_examples.py runs them all"),
    "./tools/dev flash stm32f405": Form(
        "./tools/dev flash stm32f405 --dry-run", "writes through a probe"
    ),
    "./tools/dev flash --config mine --only-config": Form(
        "./tools/dev flash --config mine --only-config --dry-run", "writes through a probe"
    ),
    "qemu-system-arm": Form("", "waits for a debugger; target/test_debug_recipe.py runs it"),
    "gdb-multiarch": Form("", "its protocol is spoken in target/test_debug_recipe.py"),
    "openocd": Form("", "needs a probe and a board"),
    "./tools/dev setup test": Form("./tools/dev setup --help", "needs a network"),
    "./tools/dev release": Form(
        "./tools/dev release --help", "builds everything; architecture/test_release.py"
    ),
}
WRITTEN = (
    *("stop.json", "udds.csv", "grid.parquet"),
    "tools/motors/mine.toml",
    *("firmware/config/generated/mine.c", "firmware/config/generated/mine.bin"),
    "firmware/config/generated/mine_front_right.c",
    "build/STM32F41x.svd",
)

# Makes what a build leaves: the files of a port with its ELF, the units of the simulator.
LINKS = """
case "$*" in
    *" --target hubfoc_"*) for suffix in elf bin hex; do touch "build/$3/$5.$suffix"; done ;;
    *" --target fmu"*) mkdir -p "build/$3/host_sim/fmu" && touch "build/$3/host_sim/fmu/a.fmu" ;;
esac
"""


def commands() -> list[str]:
    """Return the commands of the README's indented blocks, comments taken off, lines joined."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").replace("\\\n", "\n")
    found: list[str] = []
    for line in text.splitlines():
        if not line.startswith("    "):
            continue
        word = line.split()[0] if line.split() else ""
        if word in PROGRAMS:
            found.append(line.strip())
        elif (
            line.startswith("        ")
            and found
            and found[-1].count("'") % 2 + found[-1].count('"') % 2 + found[-1].endswith("-S")
        ):
            found[-1] += f" {line.strip()}"
    return [re.sub(r"\s{2,}#.*", "", command) for command in found]


def form_of(command: str) -> Form | None:
    """Return the form of the longest beginning that a command has; None of a dry run."""
    if "--dry-run" in command:
        return None
    beginnings = [begin for begin in FORMS if command == begin or command.startswith(begin)]
    return FORMS[max(beginnings, key=len)] if beginnings else None


class ReadmeCommandsTest(DevFixture):
    """The README from its first line to its last, in one clone."""

    def setUp(self) -> None:
        """Make the clone: all files that git knows or would, none that was built."""
        compiler = shutil.which("arm-none-eabi-gcc")
        if compiler is None:
            self.skipTest("needs the cross compiler, which reads a board's full scales")
        super().setUp()
        shutil.rmtree(self.home)
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT, capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip
        for name in filter(None, listed.split("\0")):
            if (source := ROOT / name).is_file():
                target = self.home / name
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, target)
        self.path, self.environment = self.pretend_everything_is_installed()
        (self.bin / "arm-none-eabi-gcc").unlink()
        (self.bin / "arm-none-eabi-gcc").symlink_to(compiler)
        cmake = self.bin / "cmake"
        write_program(cmake, cmake.read_text(encoding="utf-8") + LINKS)
        # What tools/dev asks of the packages is pretended, what it starts with them runs.
        packages = ":".join(str(self.home / f) for f in ("tools", "host_sim/python", "host_sim"))
        write_program(
            self.home / ".dev/venv/bin/python",
            '#!/bin/sh\necho "python $*" >> "$CALLS"\n'
            'case "$*" in "-m hubsim"* | "-m regen_table"* | "-m studies"* | -c*)\n'
            f'    PYTHONPATH={packages} HUBFOC_BUILD_DIR={BUILT} exec {sys.executable} "$@" ;;\n'
            "esac\n",
        )
        fetched = ROOT / ".dev" / "svd"
        if fetched.is_dir():
            (self.home / ".dev/svd").symlink_to(fetched)

    def run_command(self, command: str) -> subprocess.CompletedProcess[str]:
        """Run a command in the clone, as a reader types it."""
        return subprocess.run(
            ["bash", "-c", command],
            env={"PATH": self.path, "HOME": str(self.base), **self.environment},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=LONGEST_S,
            check=False,
            cwd=self.home,
        )

    def test_every_command_of_the_readme_runs_in_its_order(self) -> None:
        for command in commands():
            self.files_exist(command)
            form = form_of(command)
            if form is not None and not form.run:
                continue
            if (
                command.startswith("./tools/dev python -c")
                and not (self.home / ".dev/svd").exists()
            ):
                self.skipTest("needs what ./tools/dev setup test fetches")
            done = self.run_command(form.run if form is not None else command)
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}\n{done.stderr}")
            self.assertNotIn("Traceback", done.stderr)
            if "vehicle.wheel_position=front_right" in command:
                self.assertIn("Configuration: mine_front_right,", done.stderr)
        for name in WRITTEN:
            self.assertTrue((self.home / name).is_file(), name)

    def files_exist(self, command: str) -> None:
        """A file that a command reads is the repository's, or an earlier command made it."""
        for name in re.findall(r"(?:(?:tools|host_sim|build)/[\w./-]+\.(?:toml|py|elf))", command):
            self.assertTrue((self.home / name).is_file(), f"{command}: {name}")


class ReadmeTest(unittest.TestCase):
    """What is said of its commands, without a clone."""

    def test_the_package_that_is_installed_has_its_extra(self) -> None:
        (command,) = [command for command in commands() if command.startswith("pip ")]
        found = re.fullmatch(r"pip install '\./([\w/]+)\[(\w+)\]'", command)
        assert found is not None, command
        project = tomllib.loads((ROOT / found[1] / "pyproject.toml").read_text(encoding="utf-8"))
        self.assertIn(found[2], project["project"]["optional-dependencies"])

    def test_every_other_form_is_of_a_command_and_has_a_reason(self) -> None:
        found = commands()
        self.assertGreater(len(found), 25)
        for begin, form in FORMS.items():
            self.assertTrue(any(command.startswith(begin) for command in found), begin)
            self.assertTrue(form.reason)

    def test_tests_that_are_named_as_a_reason_exist(self) -> None:
        for form in FORMS.values():
            for name in re.findall(r"[\w/]*test_\w+\.py", form.reason):
                self.assertTrue(list((ROOT / "tests").rglob(name.rpartition("/")[2])), name)
