# SPDX-License-Identifier: Apache-2.0
"""Units with binaries for other platforms: what is compiled, and where it goes.

The compiler is pretended, for the real one is 411 MB and takes minutes; where it is installed, its
binary for this machine gives the same bits.
"""

import importlib.util
import itertools
import platform
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
from hubsim.errors import HubsimError
from hubsim.fmu import platforms
from importer import VERSIONS, path_of

PRETENDED = """
import pathlib, sys
args = sys.argv[1:]
if "x86_64-macos" in args and pathlib.Path({broken!r}).exists():
    print("a.c:1: error: pretended", file=sys.stderr)
    sys.exit(1)
sources = [a for a in args if a.endswith(".c")]
assert all(pathlib.Path(s).is_file() for s in sources)
pathlib.Path(args[args.index("-o") + 1]).write_text(" ".join(args))
"""


@pytest.fixture
def pretended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let the compiler be a program that writes its arguments; return what breaks it."""
    program, broken = tmp_path / "cc.py", tmp_path / "broken"
    program.write_text(PRETENDED.format(broken=str(broken)), encoding="utf-8")
    monkeypatch.setattr(platforms, "compiler", lambda: [sys.executable, str(program)])
    return broken


@pytest.mark.parametrize(
    ("kind", "fmi"), list(itertools.product(("controller", "vehicle"), VERSIONS))
)
def test_every_platform_has_a_library_of_all_sources_in_its_folder(
    kind: str, fmi: int, tmp_path: Path, pretended: Path
) -> None:
    assert not pretended.exists()
    before = path_of(kind, fmi)
    (made,) = platforms.add([before], tmp_path / "out")
    with zipfile.ZipFile(before) as old, zipfile.ZipFile(made) as new:
        ours = {name: old.read(name) for name in old.namelist()}
        theirs = {name: new.read(name) for name in new.namelist()}
    binaries = {name: text.decode() for name, text in theirs.items() if "binaries/" in name}
    name = f"hubfoc_{kind}"
    expected = {
        2: ["linux64/%s.so", "aarch64-linux/%s.so", "win64/%s.dll", "darwin64/%s.dylib",
            "aarch64-darwin/%s.dylib"],
        3: ["x86_64-linux/%s.so", "aarch64-linux/%s.so", "x86_64-windows/%s.dll",
            "x86_64-darwin/%s.dylib", "aarch64-darwin/%s.dylib"],
    }[fmi]  # fmt: skip
    assert set(binaries) == {f"binaries/{place % name}" for place in expected}
    # Everything else is as it was: the sources, and the description with its token.
    assert {n: t for n, t in ours.items() if "binaries/" not in n} == {
        n: t for n, t in theirs.items() if "binaries/" not in n
    }
    compiled = {n.removeprefix("sources/") for n in ours if re.match(r"sources/.*\.c$", n)}
    for arguments in binaries.values():
        words = arguments.split()
        assert {word for word in words if word.endswith(".c")} == compiled
        assert {"-shared", "-ffp-contract=off", "-fvisibility=hidden"} <= set(words)
    linux = binaries[f"binaries/{expected[0] % name}"]
    assert "-target x86_64-linux-gnu.2.17 " in linux


def test_a_compiler_s_error_is_one_line_and_leaves_no_unit(tmp_path: Path, pretended: Path) -> None:
    pretended.touch()
    with pytest.raises(HubsimError) as caught:
        platforms.add([path_of("controller", 2)], tmp_path / "out")
    assert str(caught.value) == "hubfoc_controller for x86_64-macos: a.c:1: error: pretended"
    assert list((tmp_path / "out").iterdir()) == []


def test_without_the_compiler_the_set_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(HubsimError, match=r"ziglang is not installed.*setup zig"):
        platforms.compiler()


@pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None or platform.machine() != "x86_64",
    reason="needs ./tools/dev setup zig, and its machine",
)
def test_the_library_for_an_old_linux_gives_the_same_outputs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platforms, "PLATFORMS", platforms.PLATFORMS[:1])
    before = path_of("vehicle", 3)
    (made,) = platforms.add([before], tmp_path / "out")
    assert validate_fmu(str(made)) == []
    wanted = ["vehicle.speed_m_per_s", "wheel0.motor_torque_nm", "energy.chemical_j", "wheel3.mode"]

    def run(unit: Path) -> bytes:
        starts = {"run.initial_speed_m_per_s": 5.0, "driver.brake_demand_nm": 20.0}
        found = simulate_fmu(str(unit), start_values=starts, stop_time=0.3, output_interval=0.05,
                             step_size=0.05, output=wanted)  # fmt: skip
        return bytes(found.tobytes())

    assert run(made) == run(before)
    with zipfile.ZipFile(made) as package:
        library = Path(package.extract("binaries/x86_64-linux/hubfoc_vehicle.so", tmp_path))
    symbols = subprocess.run(
        ["objdump", "-T", str(library)], capture_output=True, text=True, check=True
    ).stdout
    needed = {tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", symbols)}
    assert max(needed) <= (2, 17)
