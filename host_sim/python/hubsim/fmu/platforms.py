# SPDX-License-Identifier: Apache-2.0
"""Binaries of a unit for other platforms, compiled from the sources in its own package.

The compiler is zig's (the Python package ziglang, the set ``zig``), which has the C libraries of
all platforms with it. Sources and options are those of every build: without fused multiply-add, so
that results are the same bits where the C library's functions are.
"""

import importlib.util
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from xml.etree import ElementTree as ET

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.fmu import pack

OPTIONS = ("-std=c11", "-O2", "-g0", "-ffp-contract=off", "-fvisibility=hidden", "-shared")


@dataclass(frozen=True)
class Platform:
    """One platform: zig's name of it, folders below binaries/, and how its libraries end.

    ``fmi2`` and ``fmi3`` are the folders of the two versions of the standard.
    """

    target: str
    fmi2: str
    fmi3: str
    suffix: str
    options: tuple[str, ...] = ()

    def folder(self, fmi: int) -> str:
        """Return the folder below binaries/."""
        return self.fmi2 if fmi == 2 else self.fmi3


# Linux with the C library of CentOS 7 (2014) or any newer one; macOS from zig's oldest on.
_LINUX = ("-fPIC", "-s", "-lm")
PLATFORMS = (
    Platform("x86_64-linux-gnu.2.17", "linux64", "x86_64-linux", ".so", _LINUX),
    Platform("aarch64-linux-gnu.2.17", "aarch64-linux", "aarch64-linux", ".so", _LINUX),
    Platform("x86_64-windows-gnu", "win64", "x86_64-windows", ".dll", ("-s",)),
    Platform("x86_64-macos", "darwin64", "x86_64-darwin", ".dylib", ("-fPIC",)),
    Platform("aarch64-macos", "aarch64-darwin", "aarch64-darwin", ".dylib", ("-fPIC",)),
)


def compiler() -> list[str]:
    """Return the command of the compiler; refused without its package."""
    if importlib.util.find_spec("ziglang") is None:
        raise HubsimError("ziglang is not installed, accepted: after './tools/dev setup zig'")
    return [sys.executable, "-m", "ziglang", "cc"]


def headers() -> Path:
    """Return the folder of the standard's headers, which come with FMPy."""
    found = importlib.util.find_spec("fmpy")
    if found is None or found.origin is None:
        raise HubsimError("fmpy is not installed, accepted: after './tools/dev setup fmi'")
    return Path(found.origin).parent / "c-code"


def add(units: Sequence[Path], output: Path) -> list[Path]:
    """Write units with binaries for all platforms into a folder, and return their paths."""
    cc, include = compiler(), headers()
    output.mkdir(parents=True, exist_ok=True)
    made = []
    for unit in units:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            with zipfile.ZipFile(unit) as package:
                package.extractall(folder)
                entries = {name: package.read(name) for name in package.namelist()}
            description = ET.fromstring(entries["modelDescription.xml"])
            fmi = int(str(description.get("fmiVersion"))[0])
            simulation = description.find("CoSimulation")
            assert simulation is not None
            identifier = str(simulation.get("modelIdentifier"))
            with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
                waiting = [
                    (platform, pool.submit(_binary, cc, include, platform, folder, identifier))
                    for platform in PLATFORMS
                ]
                for platform, binary in waiting:
                    name = f"binaries/{platform.folder(fmi)}/{identifier}{platform.suffix}"
                    entries[name] = binary.result()
        path = output / unit.name
        files.write_by_name(path, partial(pack.write_zip, entries))
        made.append(path)
    return made


def _binary(
    cc: Sequence[str], include: Path, platform: Platform, folder: Path, identifier: str
) -> bytes:
    """Compile one library from all sources of a unit."""
    sources = folder / "sources"
    listed = sorted(path.relative_to(sources).as_posix() for path in sources.rglob("*.c"))
    place = folder / platform.target
    place.mkdir()
    library = place / f"{identifier}{platform.suffix}"
    command = [
        *(*cc, "-target", platform.target, *OPTIONS, "-I.", f"-I{include}", *listed),
        *(*platform.options, "-o", str(library)),
    ]
    done = subprocess.run(command, cwd=sources, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        errors = done.stderr.strip().splitlines()
        raise HubsimError(
            f"{identifier} for {platform.target}: {errors[0] if errors else 'failed'}"
        )
    return library.read_bytes()
