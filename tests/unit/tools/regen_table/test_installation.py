# SPDX-License-Identifier: Apache-2.0
"""Search paths and identity of the packages."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from regen_table import installation, schema
from regen_table.errors import ConfigurationError

REPOSITORY = Path(__file__).resolve().parents[4]


def test_version_equals_that_of_the_top_cmake_project() -> None:
    text = (REPOSITORY / "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.search(r"project\(\s*hubfoc\s+VERSION\s+([\d.]+)", text)
    assert found is not None
    assert installation.version() == found[1]


def test_commit_equals_that_of_the_checkout(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HUBFOC_COMMIT", raising=False)
    done = subprocess.run(
        ["git", "-C", str(REPOSITORY), "rev-parse", "HEAD"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    installation.commit.cache_clear()
    commit = installation.commit()
    if done.returncode == 0:
        assert commit.removesuffix("+") == done.stdout.strip()
    else:  # sources without their history
        assert re.fullmatch(r"unknown|[0-9a-f]{40}", commit)


def test_the_commit_of_an_archive_can_be_given_by_the_caller(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HUBFOC_COMMIT", "0123456789ab")
    assert installation.commit.__wrapped__() == "0123456789ab"


@pytest.mark.parametrize(
    ("commit", "shown"),
    [
        ("0123456789abcdef0123456789abcdef01234567", "0123456789ab"),
        ("0123456789abcdef0123456789abcdef01234567+", "0123456789ab+"),
        ("unknown", "unknown"),
    ],
)
def test_identity_has_the_format_of_the_firmwares_banner(
    monkeypatch: pytest.MonkeyPatch, commit: str, shown: str
) -> None:
    monkeypatch.setattr(installation, "commit", lambda: commit)
    assert installation.identity("hubsim") == f"hubsim {installation.version()} ({shown})"


def test_a_source_archive_reports_its_commit_everywhere(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """In a minimal checkout: the files that contain the commit, and one more."""
    monkeypatch.delenv("HUBFOC_COMMIT", raising=False)
    names = (".gitattributes", "tools/cmake/archived_commit", "tools/cmake/commit.cmake")
    checkout, archive = tmp_path / "checkout", tmp_path / "archive"
    for name in names:
        (checkout / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(REPOSITORY / name, checkout / name)
    git = ("git", "-C", str(checkout), "-c", "user.name=a", "-c", "user.email=a@b")
    subprocess.run(["git", "init", "-q", str(checkout)], check=True)
    subprocess.run([*git, "add", "."], check=True)
    subprocess.run([*git, "commit", "-q", "-m", "x"], check=True)
    head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True, check=True)
    archive.mkdir()
    packed = subprocess.run([*git, "archive", "HEAD"], capture_output=True, check=True).stdout
    subprocess.run(["tar", "-x", "-C", str(archive)], input=packed, check=True)

    commit = head.stdout.strip()
    for root, expected in ((archive, commit), (checkout, commit)):
        monkeypatch.setattr(installation, "ROOT", root)
        assert installation.commit.__wrapped__() == expected
        header = tmp_path / "commit.h"
        command = ["cmake", f"-DSOURCE={root}", f"-DOUTPUT={header}"]
        subprocess.run([*command, "-P", str(root / "tools/cmake/commit.cmake")], check=True)
        assert f'"{commit[:12]}"' in header.read_text(encoding="utf-8")


def test_a_directory_inside_another_checkout_has_no_commit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("HUBFOC_COMMIT", raising=False)
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    inner = tmp_path / "inner"
    inner.mkdir()
    monkeypatch.setattr(installation, "ROOT", inner)
    assert installation.commit.__wrapped__() == "unknown"


def test_a_name_without_a_suffix_is_a_shipped_drive(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert installation.drive_file("lu2013") == REPOSITORY / "tools" / "motors" / "lu2013.toml"
    assert schema.load("lu2013").name == "lu2013"
    assert installation.drive_file("wheel24v").name == "wheel24v.toml"  # in a folder of its own
    assert installation.drive_file("none.toml") == Path("none.toml")
    with pytest.raises(ConfigurationError, match=r"no drive 'lu2014', did you mean lu2013\?"):
        schema.load("lu2014")
    with pytest.raises(ConfigurationError, match=r"no drive 'xyzzy', accepted: .*lu2013"):
        schema.load("xyzzy")


def test_a_local_file_has_priority_over_a_shipped_drive(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lu2013").write_text("mine", encoding="utf-8")
    assert installation.drive_file("lu2013") == Path("lu2013")
    assert installation.drive_file("./ebike36v") == Path("./ebike36v")
