# SPDX-License-Identifier: Apache-2.0
"""A copy of tools/dev in an empty directory, with a simulated set of installed tools.

Packages are installed by a fake apt-get that records its calls, so nothing outside the temporary
directory changes.
"""

import os
import shutil
import stat
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
USAGE = 2

# Headers are searched in the system directories and cannot be simulated.
needs_headers = unittest.skipUnless(
    any(Path(p, "include", "eigen3").exists() for p in ("/usr", "/usr/local")),
    "needs Eigen",
)

# Tools searched by the set-up, hidden from the command so that every machine starts without them.
HIDDEN = (
    "apt-get", "apt-cache", "sudo", "arm-none-eabi-gcc", "qemu-system-arm", "clang-tidy",
    "shellcheck", "ninja", "openocd",
    "chromium", "chromium-headless-shell", "google-chrome",
)  # fmt: skip

# Records its arguments and, for an installation, adds the programs of known packages to the PATH.
PRETENDED_APT_GET = """#!/bin/sh
echo "$*" >> "$APT_CALLS"
[ -z "$APT_OFFLINE" ] || echo "W: Failed to fetch x  Temporary failure resolving 'deb.example'" >&2
case "$*" in *" install "*) ;; *) exit 0 ;; esac
[ -z "$APT_BROKEN" ] || { echo "E: pretended failure" >&2; exit 100; }
for package in "$@"; do
    case $package in
        gcc-arm-none-eabi)
            printf '#!/bin/sh\\necho /pretended/nano.specs\\n' > "$APT_BIN/arm-none-eabi-gcc" ;;
        chromium-headless-shell) printf '#!/bin/sh\\n' > "$APT_BIN/chromium-headless-shell" ;;
        qemu-system-arm) printf '#!/bin/sh\\n' > "$APT_BIN/qemu-system-arm" ;;
        *) continue ;;
    esac
done
chmod +x "$APT_BIN"/*
"""

# Configures by creating the files of a configured directory; records its arguments.
PRETENDED_CMAKE = """#!/bin/sh
echo "cmake $*" >> "$CALLS"
case "$*" in
    --version) echo "cmake version 3.25.1" ;;
    "--preset "*)
        mkdir -p "build/$2"
        printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\\n' "$PWD" > "build/$2/CMakeCache.txt"
        for option in "$@"; do
            case $option in
                -D*) echo "${option#-D}" | sed 's/=/:STRING=/' >> "build/$2/CMakeCache.txt" ;;
            esac
        done
        touch "build/$2/build.ninja" ;;
    *" --target hubfoc_"*) touch "build/$3/$5.elf"
        printf 'Linking\\nMemory region: pretended\\n' ;;
    *"$BROKEN_BUILD"*) [ -z "$BROKEN_BUILD" ] || { echo "main.c:1: error: pretended"; exit 1; } ;;
esac
"""

# Lists two tests per preset; runs those of the combined list and fails one of a selected preset.
PRETENDED_CTEST = """#!/bin/sh
echo "ctest $*" >> "$CALLS"
case "$*" in
    "--preset "*) cat <<JSON
{"backtraceGraph": {"files": ["$PWD/tests/unit/CMakeLists.txt"], "nodes": [{"file": 0}]}, "tests": [
 {"name": "physics", "command": ["physics"], "backtrace": 0, "properties": []},
 {"name": "whole_cycle", "command": ["cycle"],
   "properties": [{"name": "LABELS", "value": ["full"]}]}]}
JSON
    exit 0 ;;
esac
tests=$(sed -n 's/^add_test(.==.\\([^]]*\\)\\].*/\\1/p' CTestTestfile.cmake)
total=$(echo "$tests" | wc -l) number=0
for name in $tests; do
    number=$((number + 1)) outcome=Passed
    [ "$name" != "$BROKEN_TEST:physics" ] || outcome='***Failed'
    echo "$name" >> "$CALLS.tests"
    echo "$number/$total Test #$number: $name ......   $outcome    0.01 sec"
done
"""


def write_program(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)


class DevFixture(unittest.TestCase):
    """Each test has its own copy of the command in a directory that holds nothing else."""

    ordinary: Path

    @classmethod
    def setUpClass(cls) -> None:
        """Make a directory with the ordinary programs of this machine without the hidden ones."""
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.ordinary = Path(temporary.name)
        cls.ordinary.chmod(0o755)
        for directory in {Path("/bin").resolve(), Path("/usr/bin").resolve()}:
            for program in directory.iterdir():
                if program.name not in HIDDEN:
                    (cls.ordinary / program.name).symlink_to(program)

    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.base = Path(temporary.name)
        self.base.chmod(0o755)
        self.home = self.base / "clone"
        self.bin = self.base / "bin"
        self.bin.mkdir()
        (self.home / "tools").mkdir(parents=True)
        shutil.copy2(ROOT / "tools/dev", self.home / "tools/dev")
        for folder in ("setup", "run_tests"):
            shutil.copytree(ROOT / "tools" / folder, self.home / "tools" / folder)
        for folder in ("host_sim", "tools/regen_table"):  # whose programs explain themselves
            (self.home / folder).symlink_to(ROOT / folder)
        self.before = self.contents()

    def contents(self) -> set[Path]:
        return set(self.home.rglob("*"))

    def run_dev(
        self,
        *arguments: str,
        path: str | None = None,
        user: int | None = None,
        environment: dict[str, str] | None = None,
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(self.home / "tools/dev"), *arguments],
            env={"PATH": path or os.environ["PATH"], "HOME": str(self.base), **(environment or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
            user=user,
            cwd=self.base,
        )

    def assert_refused(self, result: subprocess.CompletedProcess[str], *words: str) -> None:
        """Expect one line on stderr with these words, the usage exit status and an unchanged
        directory."""
        self.assertEqual(result.returncode, USAGE, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertEqual(self.contents(), self.before)

    def bare_path(self) -> str:
        return f"{self.bin}:{self.ordinary}"

    def pretend_apt(self) -> dict[str, str]:
        write_program(self.bin / "apt-get", PRETENDED_APT_GET)
        write_program(self.bin / "apt-cache", "#!/bin/sh\n")
        write_program(self.bin / "sudo", '#!/bin/sh\n[ "$1" != -n ] || shift\nexec "$@"\n')
        return {"APT_CALLS": str(self.base / "calls"), "APT_BIN": str(self.bin)}

    def pretend_everything_is_installed(self) -> tuple[str, dict[str, str]]:
        """Return a PATH and an environment with fakes of all tools that record their calls."""
        path = self.bare_path()
        for name in (
            "arm-none-eabi-gcc",
            "arm-none-eabi-size",
            "qemu-system-arm",
            "clang-tidy",
            "shellcheck",
            "ruby",
            "clang",
            "clang-19",
            "llvm-cov-19",
            "cbmc",
            "chromium",
            "gcc",
            "g++",
            "ninja",
        ):
            write_program(
                self.bin / name,
                f'#!/bin/sh\necho "{name} $*" >> "$CALLS"\necho /pretended/nano.specs\n',
            )
        write_program(self.bin / "cmake", PRETENDED_CMAKE)
        write_program(self.bin / "ctest", PRETENDED_CTEST)
        write_program(self.bin / "apt-get", "#!/bin/sh\necho apt-get $* >> $CALLS\nexit 1\n")
        python = self.home / ".dev/venv/bin/python"
        python.parent.mkdir(parents=True)
        write_program(
            python,
            '#!/bin/sh\necho "python $*" >> "$CALLS"\n'
            f'case "$*" in *run_tests*) PYTHONPATH={self.home}/tools exec python3 "$@" ;; esac\n',
        )
        cmock = self.home / ".dev/cmock/usr/share/cmock"
        for file in (
            cmock / "lib/cmock.rb",
            cmock / "vendor/unity/src/unity.c",
            self.home / "CMakePresets.json",
        ):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.touch()
        return path, {"CALLS": str(self.base / "calls")}

    def calls(self, program: str) -> list[str]:
        """Return the arguments of every call of a program, but for questions about its version and
        paths.
        """
        lines = (self.base / "calls").read_text().splitlines()
        calls = [line.partition(" ")[2] for line in lines if line.startswith(program + " ")]
        return [call for call in calls if "version" not in call and "print-file-name" not in call]

    def names_run(self) -> list[str]:
        """Return the names of the tests that ctest was given, in its order."""
        return (self.base / "calls.tests").read_text().splitlines()

    def apt_installs(self) -> list[str]:
        calls = self.base / "calls"
        return (
            [line for line in calls.read_text().splitlines() if " install " in line]
            if calls.exists()
            else []
        )
