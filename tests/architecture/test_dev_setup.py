# SPDX-License-Identifier: Apache-2.0
"""Packages installed by tools/dev per command, and the messages of CMake for missing ones."""

import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from dev_fixture import ROOT, DevFixture, needs_headers, write_program
from regen_table import installation


class SetupTest(DevFixture):
    """Commands in any order, each with its requirements."""

    @needs_headers
    def test_sim_and_test_pass_in_any_order_as_a_missing_tool_triggers_a_new_configure(
        self,
    ) -> None:
        path, environment = self.pretend_everything_is_installed()
        cmock = self.home / ".dev/cmock"
        hidden = self.base / "cmock"
        cmock.rename(hidden)

        def configured(command: str) -> list[str]:
            before = len(self.calls("cmake")) if (self.base / "calls").exists() else 0
            result = self.run_dev(command, path=path, environment=environment)
            self.assertEqual(result.returncode, 0, result.stderr)
            calls = self.calls("cmake")[before:]
            return [call for call in calls if call.startswith("--preset host ")]

        if not Path("/usr/share/cmock").exists():
            self.assertEqual(configured("sim"), ["--preset host -DHUBFOC_TESTS=OFF"])
            self.assertEqual(configured("sim"), [])
        hidden.rename(cmock)
        self.assertEqual(configured("test"), ["--preset host -DHUBFOC_TESTS=ON"])
        self.assertEqual(configured("sim"), [])
        self.assertEqual(configured("test"), [])
        # A tool searched by CMake is installed.
        checker = self.home / ".dev/cbmc/cbmc"
        checker.parent.mkdir()
        checker.touch()
        self.assertEqual(configured("test"), ["--preset host -DHUBFOC_TESTS=ON"])
        self.assertEqual(configured("test"), [])

    @needs_headers
    def test_each_command_installs_only_the_python_packages_that_it_uses(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        (self.base / "mine.toml").touch()
        every = {file.stem for file in (ROOT / "tools/setup/requirements").glob("*.txt")} - {"zig"}
        for arguments, sets in (
            (["sim"], {"sim"}),
            (["hubsim", "run", "stop", "--csv", "x.csv"], {"sim"}),
            (["hubsim", "run", "stop", "--mdf", "x.mf4"], {"sim", "formats"}),
            (["hubsim", "sweep", "stop"], {"sim", "sweep", "formats"}),
            (["hubsim", "stops", "--count", "4"], {"sim", "figures"}),
            (["hubsim", "blackbox", "log.txt"], {"sim", "figures"}),
            (["hubsim", "report", "a.json", "--blackbox", "log.txt"], {"sim", "figures"}),
            (["hubsim", "faults", "--list"], {"sim"}),
            (["hubsim", "faults", "--reduced"], {"sim", "figures"}),
            (["study", "coast"], {"sim", "figures"}),
            (["table", "mine.toml"], {"sim"}),
            (["table", "mine.toml", "--plots"], {"sim", "figures"}),
            (
                ["python", "host_sim/python/examples/a.py"],
                {"sim", "examples", "figures", "formats"},
            ),
            (["fmu", "--config", "mine.toml"], {"sim", "fmi"}),
            (["fmu", "--config", "mine.toml", "--platforms"], {"sim", "fmi", "zig"}),
            (["format"], {"dev"}),
            (["test"], every),
        ):
            (self.base / "calls").unlink(missing_ok=True)
            self.run_dev(*arguments, path=path, environment=environment)
            checks = [call for call in self.calls("python") if "check_venv" in call]
            asked = next(call for call in checks if "--place" not in call)
            asked_sets = set(re.findall(r"/requirements/(\w+)\.txt", asked))
            self.assertEqual(asked_sets, sets, arguments)

    @needs_headers
    def test_every_command_that_builds_tests_installs_the_packages_they_are_configured_with(
        self,
    ) -> None:
        """After another command had installed its own ones and no more."""
        cmake = (ROOT / "tools/cmake/HubfocTools.cmake").read_text(encoding="utf-8")
        found = re.search(r"foreach\(package IN ITEMS ([\w ]+)\)", cmake)
        assert found is not None
        path, environment = self.pretend_everything_is_installed()
        for command in ("bench", "mutants", "oracle", "coverage", "test"):
            (self.base / "calls").unlink(missing_ok=True)
            self.run_dev(command, path=path, environment=environment)
            configured = [call for call in self.calls("cmake") if "HUBFOC_TESTS=ON" in call]
            self.assertTrue(configured or command != "bench", command)
            asked = next(
                call
                for call in self.calls("python")
                if "check_venv" in call and "-place" not in call
            )
            locks = [Path(name) for name in asked.split() if name.endswith(".txt")]
            pinned = "".join(lock.read_text(encoding="utf-8") for lock in locks)
            for package in found[1].split():
                self.assertRegex(pinned, rf"(?m)^{package}==", command)

    def test_continuous_integration_runs_the_readme_s_two_commands_in_its_order(self) -> None:
        shutil.copytree(ROOT / ".ci", self.home / ".ci")
        write_program(self.home / "tools/dev", '#!/bin/sh\necho "dev $*" >> "$CALLS"\n')
        calls = self.base / "calls"
        subprocess.run([str(self.home / ".ci/run")],
            env={"CALLS": str(calls), "PATH": os.environ["PATH"]},
                       timeout=60, check=True)  # fmt: skip
        self.assertEqual(calls.read_text().splitlines(), ["dev sim", "dev test"])
        shown = re.findall(
            r"^ +\./tools/dev (sim|test)\b", (ROOT / "README.md").read_text(), re.MULTILINE
        )
        self.assertEqual(shown[:2], ["sim", "test"])


class RequirementsTest(unittest.TestCase):
    """The lists of Python packages and their lock files."""

    def test_every_package_is_pinned_with_hashes_and_without_a_registry_address(self) -> None:
        folder = ROOT / "tools/setup/requirements"
        versions: dict[str, str] = {}
        for file in sorted(folder.glob("*.txt")):
            text = file.read_text(encoding="utf-8")
            self.assertNotIn("://", text)
            pins = re.findall(
                r"^([a-z0-9-]+)==(\S+)((?: \\\n    --hash=sha256:[0-9a-f]{64})+)$",
                text,
                re.MULTILINE,
            )
            self.assertEqual(len(pins), len(re.findall(r"^[^#\s]", text, re.MULTILINE)), file.name)
            for name, version, _ in pins:
                self.assertEqual(versions.setdefault(name, version), version, name)
            listed = re.findall(r"^([^#\s]+)$", file.with_suffix(".in").read_text(), re.MULTILINE)
            self.assertLessEqual(set(listed), {f"{name}=={version}" for name, version, _ in pins})
        self.assertEqual(
            {file.stem for file in folder.glob("*.in")},
            {file.stem for file in folder.glob("*.txt")},
        )

    def test_the_error_for_a_missing_package_names_a_set_that_contains_it(self) -> None:
        for package, extra in installation.EXTRAS.items():
            answer = installation.missing(ModuleNotFoundError(name=f"{package}.part"))
            command = re.search(r"'\./tools/dev setup (\w+)'", answer)
            assert command is not None, answer
            listed = (ROOT / f"tools/setup/requirements/{command[1]}.in").read_text()
            self.assertRegex(listed, rf"(?m)^{package}==", extra)


class PlainCMakeTest(unittest.TestCase):
    """CMake without tools/dev, in a copy of the repository on which nothing has been installed."""

    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.home = Path(temporary.name) / "clone"
        listed = subprocess.run(
            ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
            cwd=ROOT, capture_output=True, text=True, check=True,
        )  # fmt: skip
        for name in filter(None, listed.stdout.split("\0")):
            if (ROOT / name).is_file() and not name.endswith((".py", ".md", ".csv")):
                (self.home / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, self.home / name)

    def configure(self, *options: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["cmake", "--preset", "host", *options],
            cwd=self.home, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip

    def test_missing_test_tools_are_listed_in_one_line_with_the_command_that_installs_them(
        self,
    ) -> None:
        result = self.configure()
        self.assertNotEqual(result.returncode, 0)
        lines = [line for line in result.stderr.splitlines() if "The tests need" in line]
        self.assertEqual(len(lines), 1, result.stderr)
        for words in (".dev/venv", "'./tools/dev setup'", "HUBFOC_TESTS=OFF"):
            self.assertIn(words, lines[0])

    def test_without_the_test_tools_the_simulator_is_configured_and_ctest_fails(
        self,
    ) -> None:
        result = self.configure("-D", "HUBFOC_TESTS=OFF")
        self.assertEqual(result.returncode, 0, result.stderr)
        tests = subprocess.run(
            ["ctest", "--preset", "host"],
            cwd=self.home, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        self.assertNotEqual(tests.returncode, 0)
        self.assertIn("./tools/dev test", tests.stdout)
        plan = subprocess.run(
            ["ninja", "-C", "build/host", "-t", "commands", "hubsim_engine"],
            cwd=self.home, capture_output=True, text=True, timeout=60, check=True,
        ).stdout  # fmt: skip
        self.assertIn("libhubsim_engine.so", plan)
        for word in ("ruby", "cmock", "unity", "eigen", "venv"):
            self.assertNotIn(word, plan.lower())


if __name__ == "__main__":
    unittest.main()
