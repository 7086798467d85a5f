# SPDX-License-Identifier: Apache-2.0
"""A release: parts of one version in one folder with checksums, and the list of licences."""

import hashlib
import importlib.util
import json
import re
import subprocess
import sys
import zipfile
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import pytest
from modules import ROOT
from test_repository import git_files, name_of

VERSION = "1.2.3"
COMMIT = "0123456789abcdef0123456789abcdef01234567"
LICENCES = ROOT / "tools" / "release" / "LICENSES.md"
SETUP = ROOT / "tools" / "setup"


def loaded() -> Any:  # noqa: ANN401, a module
    spec = importlib.util.spec_from_file_location("collect", ROOT / "tools/release/collect.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["collect"] = module
    spec.loader.exec_module(module)
    return module


collect = loaded()


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Make a repository with minimal outputs of a build."""
    root = tmp_path / "tree"
    configuration = b"the configuration"
    banner = f"hubfoc {VERSION} ({COMMIT[:12]}) on stm32f405".encode()
    unit = f'<fmiModelDescription generationTool="hubfoc {VERSION} ({COMMIT[:12]})"/>'
    files = {
        "firmware/config/generated/lu2013.bin": configuration,
        "firmware/config/generated/other.bin": b"another one",
        "firmware/comms/hubfoc.dbc": b'VERSION ""',
        "firmware/comms/hubfoc_four_wheels.dbc": b'VERSION ""',
        "LICENSE": b"Apache",
        "tools/release/LICENSES.md": b"# Licences",
        "build/stm32f405/hubfoc_stm32f405.bin": configuration + b"\xff" * 9 + banner + b"\0",
        "build/stm32f405/hubfoc_stm32f405.hex": b":00000001FF\n",
        "build/stm32f405/hubfoc_stm32f405.elf": b"\x7fELF",
    }
    for name, content in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes(content)
    (root / "build/host/host_sim/fmu").mkdir(parents=True)
    for name in collect.UNITS:
        with zipfile.ZipFile(root / "build/host/host_sim/fmu" / name, "w") as archive:
            archive.writestr("modelDescription.xml", unit)
    with zipfile.ZipFile(root / wheel_name(), "w") as archive:
        record = {"version": VERSION, "commit": COMMIT}
        archive.writestr("regen_table/data/build.json", json.dumps(record))
    return root


def wheel_name() -> str:
    return f"hubfoc-{VERSION}-py3-none-linux_x86_64.whl"


def parts_of(tree: Path) -> dict[str, Path]:
    found: dict[str, Path] = collect.parts(tree, tree / "build", tree / wheel_name(), VERSION)
    return found


def test_a_release_contains_every_part_with_version_and_checksum(
    tree: Path, tmp_path: Path
) -> None:
    found = parts_of(tree)
    collect.check(found, VERSION, COMMIT, "lu2013")
    folder = collect.collect(found, f"hubfoc-{VERSION}", tmp_path / "out")
    assert folder.name == f"hubfoc-{VERSION}"
    files = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    ends = {f"hubfoc-{VERSION}-stm32f405{end}" for end in (".bin", ".hex", ".elf")}
    assert files == ends | {
        *(
            "configurations/lu2013.bin",
            "configurations/other.bin",
            "hubfoc.dbc",
            "hubfoc_four_wheels.dbc",
            wheel_name(),
        ),
        *(f"fmu/{name}" for name in collect.UNITS),
        *("LICENSE", "LICENSES.md", "SHA256SUMS"),
    }
    listed = dict(
        line.split("  ")[::-1] for line in (folder / "SHA256SUMS").read_text().splitlines()
    )
    assert listed.keys() == files - {"SHA256SUMS"}
    for name, digest in listed.items():
        assert digest == hashlib.sha256((folder / name).read_bytes()).hexdigest()
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=folder, check=True)


def test_a_release_replaces_the_previous_one(tree: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out" / f"hubfoc-{VERSION}"
    folder.mkdir(parents=True)
    (folder / "old").touch()
    assert collect.collect(parts_of(tree), folder.name, folder.parent) == folder
    assert not (folder / "old").exists()
    assert [path.name for path in folder.parent.iterdir()] == [folder.name]


def replace(path: Path, before: bytes, after: bytes) -> None:
    content = path.read_bytes()
    assert before in content
    path.write_bytes(content.replace(before, after))


@pytest.mark.parametrize("commit", ["f" * 40, f"{COMMIT}+"])
def test_firmware_of_another_commit_is_refused(tree: Path, commit: str) -> None:
    with pytest.raises(collect.ReleaseError, match="build it again"):
        collect.check(parts_of(tree), VERSION, commit, "lu2013")


def test_firmware_with_another_configuration_is_refused(tree: Path) -> None:
    with pytest.raises(collect.ReleaseError, match="has not the configuration other"):
        collect.check(parts_of(tree), VERSION, COMMIT, "other")


@pytest.mark.parametrize("origin", [f"0.0.9 ({COMMIT[:12]})", f"{VERSION} (ffffffffffff)"])
def test_an_fmu_of_another_version_or_commit_is_refused(tree: Path, origin: str) -> None:
    name = collect.UNITS[-1]
    description = f'<fmiModelDescription generationTool="hubfoc {origin}"/>'
    with zipfile.ZipFile(tree / "build/host/host_sim/fmu" / name, "w") as archive:
        archive.writestr("modelDescription.xml", description)
    with pytest.raises(collect.ReleaseError, match=re.escape(f"fmu/{name}: is of hubfoc {origin}")):
        collect.check(parts_of(tree), VERSION, COMMIT, "lu2013")


def test_a_wheel_of_another_commit_is_refused(tree: Path) -> None:
    with zipfile.ZipFile(tree / wheel_name(), "w") as archive:
        record = {"version": VERSION, "commit": "unknown"}
        archive.writestr("regen_table/data/build.json", json.dumps(record))
    with pytest.raises(collect.ReleaseError, match=r"is of 1\.2\.3 \(unknown\)"):
        collect.check(parts_of(tree), VERSION, COMMIT, "lu2013")


def test_a_missing_part_is_an_error_that_names_it(tree: Path) -> None:
    (tree / "build/stm32f405/hubfoc_stm32f405.hex").unlink()
    with pytest.raises(collect.ReleaseError, match=r"stm32f405\.hex: .* is missing"):
        parts_of(tree)


def table(heading: str) -> list[list[str]]:
    """Return the rows of the table below a heading of LICENSES.md."""
    text = LICENCES.read_text(encoding="utf-8").partition(f"## {heading}\n")[2]
    rows = [line for line in text.partition("\n## ")[0].splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]


def pinned() -> dict[str, set[str]]:
    """Return every pinned Python package and the sets that it is in."""
    found: dict[str, set[str]] = {}
    for path in sorted((SETUP / "requirements").glob("*.txt")):
        for name in re.findall(r"^([\w.-]+)==", path.read_text(encoding="utf-8"), re.MULTILINE):
            found.setdefault(re.sub(r"[-_.]+", "-", name).lower(), set()).add(path.stem)
    return found


def test_every_python_package_has_its_licence_and_use() -> None:
    listed = {name: set(sets.split()) for name, _, sets in table("Python packages")}
    assert listed == pinned()
    assert len(listed) > 50


def test_licences_are_those_that_the_packages_state() -> None:
    """Where a package states an expression; older ones state words, which were translated."""
    compared = 0
    for name, licence, sets in table("Python packages"):
        assert licence, name
        if sets == "zig":
            continue  # installed only when it is asked for
        stated = distribution(name).metadata.json.get("license_expression")
        if stated is not None:
            assert licence == stated, name
            compared += 1
    assert compared > 20


def system_packages() -> set[str]:
    """Return what the set-up may install or unpack."""
    text = (SETUP / "packages.sh").read_text(encoding="utf-8")
    bodies = re.findall(
        r"^missing_(?!packages)\w+\(\) (?:\{\n(.*?)\n\}|(\{[^\n]*\}))",
        text,
        re.MULTILINE | re.DOTALL,
    )
    found: set[str] = set()
    for body in bodies:
        for words in re.findall(r"\|\| echo ([\w+. -]+?)(?=[;\n}]|$)", "".join(body)):
            found |= set(words.split())
    for script in ("cmock.sh", "cbmc.sh"):
        for words in re.findall(
            r'unpack_privately "\$\w+" ([\w+. -]+)', (SETUP / script).read_text(encoding="utf-8")
        ):
            found |= set(words.split())
    browser = (SETUP / "browser.sh").read_text(encoding="utf-8")
    found |= set(re.findall(r"^readonly BROWSER_PACKAGE=(\S+)", browser, re.MULTILINE))
    return found


def test_every_system_package_has_its_licence_and_use() -> None:
    rows = table("System packages")
    assert all(licence and use for _, licence, use in rows)
    assert {name for name, _, _ in rows} == system_packages()
    assert {"gcc", "ninja-build", "cmock", "cbmc", "libnewlib-arm-none-eabi"} <= system_packages()


SOURCE = re.compile(
    r"\.(?:c|h|cpp|py|sh|cmake|toml|ld|in|yml)$|(?:^|/)CMakeLists\.txt$|^tools/dev$"
)


def test_every_source_file_has_an_spdx_licence_generated_files_included() -> None:
    names = [name for name in map(name_of, git_files()) if SOURCE.search(name)]
    assert len(names) > 300
    assert any("/generated/" in name for name in names)
    silent = [
        name
        for name in names
        if "SPDX-License-Identifier: " not in (ROOT / name).read_text(encoding="utf-8")[:200]
    ]
    assert silent == []
