# SPDX-License-Identifier: Apache-2.0
"""Put what was built for a release into one folder, checked and with SHA-256 sums.

    python tools/release/collect.py --build build --wheel FILE.whl --output DIRECTORY

``tools/dev release`` builds everything and calls this. Every part must name the same version, and
the image of the default configuration must be the one inside the firmware; the folder appears as a
whole or not at all. Equal parts give equal bytes: no date, no name of a machine.
"""

import argparse
import hashlib
import json
import os
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from regen_table import installation

ROOT = Path(__file__).resolve().parents[2]
GENERATED = Path("firmware/config/generated")
SUMS = "SHA256SUMS"
PORT = "stm32f405"
UNITS = tuple(f"hubfoc_{kind}_fmi{fmi}.fmu" for kind in ("controller", "vehicle") for fmi in (2, 3))


class ReleaseError(ValueError):
    """A part of the release is missing or does not belong to the others; one line."""


def parts(
    root: Path, build: Path, wheel: Path, version: str, units: Path | None = None
) -> dict[str, Path]:
    """Return every file of a release by its name in the folder.

    Parameters
    ----------
    root, build : Path
        The repository and its build directory, with ``stm32f405`` and ``host`` below it.
    wheel : Path
        The Python distribution.
    version : str
        Of the project.
    units : Path, optional
        Where the co-simulation units are; absent: where the host preset makes them.
    """
    firmware = build / PORT / f"hubfoc_{PORT}"
    endings = (".bin", ".hex", ".elf")
    found = {f"hubfoc-{version}-{PORT}{end}": firmware.with_suffix(end) for end in endings}
    found |= {
        f"configurations/{path.name}": path for path in sorted((root / GENERATED).glob("*.bin"))
    }
    for dbc in ("hubfoc.dbc", "hubfoc_four_wheels.dbc"):
        found[dbc] = root / "firmware" / "comms" / dbc
    units = units or build / "host" / "host_sim" / "fmu"
    found |= {f"fmu/{name}": units / name for name in UNITS}
    found[wheel.name] = wheel
    found["LICENSE"] = root / "LICENSE"
    found["LICENSES.md"] = root / "tools" / "release" / "LICENSES.md"
    for name, path in found.items():
        if not path.is_file():
            raise ReleaseError(f"{name}: {path} is missing")
    return found


def check(found: dict[str, Path], version: str, commit: str, config: str) -> None:
    """Refuse parts that do not belong together."""
    image = found[f"hubfoc-{version}-{PORT}.bin"].read_bytes()
    identity = f"hubfoc {version} ({installation.short(commit)})"
    banner = f"{identity} on {PORT}".encode()
    if banner not in image:
        raise ReleaseError(
            f"hubfoc-{version}-{PORT}.bin: is not {banner.decode()!r}; build it again"
        )
    default = found.get(f"configurations/{config}.bin")
    if default is None or default.read_bytes() not in image:
        raise ReleaseError(f"hubfoc-{version}-{PORT}.bin: has not the configuration {config}")
    for name in UNITS:
        with zipfile.ZipFile(found[f"fmu/{name}"]) as unit:
            described = ElementTree.fromstring(unit.read("modelDescription.xml"))
        if described.get("generationTool") != identity:
            raise ReleaseError(f"fmu/{name}: is of {described.get('generationTool')}")
    (wheel,) = (name for name in found if name.endswith(".whl"))
    with zipfile.ZipFile(found[wheel]) as archive:
        record = json.loads(archive.read("regen_table/data/build.json"))
    if record != {"version": version, "commit": commit}:
        raise ReleaseError(f"{wheel}: is of {record['version']} ({record['commit']})")


def sums(directory: Path) -> Iterator[str]:
    """Yield the lines of SHA256SUMS, as ``sha256sum --check`` reads them."""
    for path in sorted(directory.rglob("*")):
        if path.is_file() and path.name != SUMS:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
            yield f"{digest}  {path.relative_to(directory).as_posix()}\n"


def collect(found: dict[str, Path], release: str, output: Path) -> Path:
    """Copy the parts into a folder below ``output`` and return it; one of that name is replaced."""
    output.mkdir(parents=True, exist_ok=True)
    folder = output / release
    with tempfile.TemporaryDirectory(dir=output) as temporary:
        made = Path(temporary) / release
        for name, path in found.items():
            (made / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, made / name)
        (made / SUMS).write_text("".join(sums(made)), encoding="ascii")
        if folder.is_dir():
            folder.rename(Path(temporary) / "before")
        made.rename(folder)
    return folder


def main() -> int:
    """Collect, and print the sums."""
    parser = argparse.ArgumentParser(description="put a release into one folder")
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    parser.add_argument("--wheel", type=Path, required=True)
    parser.add_argument("--config", default="lu2013", help="the configuration in the firmware")
    parser.add_argument("--units", type=Path, help="folder of the co-simulation units")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "release")
    options = parser.parse_args()
    version, commit = installation.version(), installation.commit()
    try:
        found = parts(ROOT, options.build, options.wheel, version, options.units)
        check(found, version, commit, options.config)
        folder = collect(found, f"hubfoc-{version}", options.output)
    except (ReleaseError, OSError, zipfile.BadZipFile, KeyError) as error:
        print(f"release: {error}", file=sys.stderr)
        return 1
    print((folder / SUMS).read_text(encoding="ascii"), end="")
    print(f"{os.path.relpath(folder)}: version {version}, commit {commit}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
