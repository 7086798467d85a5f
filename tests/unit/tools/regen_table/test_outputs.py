# SPDX-License-Identifier: Apache-2.0
"""Output files are complete or absent, links stay links, streams are never replaced."""

import os
import re
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from regen_table import installation, outputs
from regen_table.errors import ConfigurationError, OutputError

TOOLS = Path(outputs.__file__).resolve().parents[1]
Writer = Callable[[Path, bytes], object]


def by_name(path: Path, content: bytes) -> None:
    outputs.write_with(path, lambda temporary: temporary.write_bytes(content), suffix=".tmp")


WRITERS = {"from memory": outputs.write_bytes, "by a library": by_name}


@pytest.fixture(params=WRITERS)
def write(request: pytest.FixtureRequest) -> Writer:
    return WRITERS[str(request.param)]


def test_a_regular_file_is_replaced_atomically_and_keeps_its_permissions(
    tmp_path: Path, write: Writer
) -> None:
    path = tmp_path / "out.csv"
    path.write_bytes(b"before")
    path.chmod(0o640)
    with path.open("rb") as reader:  # of the file that was there
        write(path, b"after")
        assert reader.read() == b"before"
    assert path.read_bytes() == b"after"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_a_new_file_has_default_permissions(tmp_path: Path, write: Writer) -> None:
    mask = os.umask(0o027)
    try:
        write(tmp_path / "new", b"x")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


@pytest.mark.parametrize("exists", [True, False])
def test_a_link_is_kept_and_its_target_replaced(
    tmp_path: Path, write: Writer, exists: bool
) -> None:
    place = tmp_path / "elsewhere"
    place.mkdir()
    target, link, second = place / "target", tmp_path / "link", tmp_path / "second"
    if exists:
        target.write_bytes(b"before")
    link.symlink_to("elsewhere/target")
    second.symlink_to(link)
    write(second, b"after")
    assert link.is_symlink()
    assert second.is_symlink()
    assert not target.is_symlink()
    assert target.read_bytes() == b"after"
    assert list(place.iterdir()) == [target]


def test_a_fifo_is_written_and_not_replaced(tmp_path: Path, write: Writer) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    found: list[bytes] = []
    reader = threading.Thread(target=lambda: found.append(fifo.read_bytes()), daemon=True)
    reader.start()
    content = bytes(range(256)) * 1024  # more than a pipe holds
    write(fifo, content)
    reader.join(timeout=30.0)
    assert found == [content]
    assert stat.S_ISFIFO(fifo.lstat().st_mode)
    assert list(tmp_path.iterdir()) == [fifo]


def test_a_device_is_written_and_not_replaced(tmp_path: Path, write: Writer) -> None:
    """Through a link in the test's directory: a writer that replaces the target would damage only
    this copy.
    """
    link = tmp_path / "null"
    link.symlink_to("/dev/null")
    before = Path("/dev/null").stat()
    write(link, b"gone")
    assert link.is_symlink()
    after = Path("/dev/null").stat()
    assert stat.S_ISCHR(after.st_mode)
    assert (before.st_ino, before.st_rdev) == (after.st_ino, after.st_rdev)
    assert list(tmp_path.iterdir()) == [link]


def test_a_full_device_is_an_error_in_one_line(tmp_path: Path, write: Writer) -> None:
    link = tmp_path / "full"
    link.symlink_to("/dev/full")
    with pytest.raises(OutputError) as refused:
        write(link, b"too much")
    assert str(refused.value) == f"{link}: cannot be written: No space left on device"
    assert link.is_symlink()


def test_standard_output_keeps_text_written_before_and_after() -> None:
    code = (
        "from pathlib import Path\nfrom regen_table import outputs\nprint('before')\n"
        "outputs.write_text(Path('/dev/stdout'), 'between\\n')\nprint('after')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=TOOLS
    )
    assert done.stdout == "before\nbetween\nafter\n"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (".", "is a directory, accepted: the name of a file to write"),
        ("nowhere/out", "no directory .*nowhere to write to"),
        ("loop", "cannot be written: (too many|Too many) levels of symbolic links"),
        ("file/out", "cannot be written: Not a directory"),
        ("x" * 300, "cannot be written: File name too long"),
    ],
)
def test_an_unwritable_path_is_an_error_in_one_line_before_the_computation(
    tmp_path: Path, name: str, expected: str
) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "file").write_text("here")
    path = tmp_path / name
    for attempt in (outputs.check_writable, lambda p: outputs.write_bytes(p, b"x")):
        with pytest.raises(OutputError) as refused:
            attempt(path)
        assert re.fullmatch(re.escape(str(path)) + ": " + expected, str(refused.value))


@pytest.mark.parametrize("forbidden", ["the file", "the directory"])
def test_a_path_without_write_permission_is_an_error_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forbidden: str
) -> None:
    path = tmp_path / "kept"
    path.write_bytes(b"kept")
    closed = {"the file": path, "the directory": tmp_path}[forbidden]
    # Root may write anywhere, so the error of the operating system is simulated.
    monkeypatch.setattr(os, "access", lambda asked, _: Path(asked) != closed)
    for attempt in (outputs.check_writable, lambda p: outputs.write_bytes(p, b"x")):
        with pytest.raises(OutputError, match=r"^\S+/kept: (cannot be written|the directory)"):
            attempt(path)
    assert path.read_bytes() == b"kept"


def test_a_failed_writer_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "out"
    path.write_bytes(b"before")

    def fail(temporary: Path) -> None:
        temporary.write_bytes(b"half of")
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        outputs.write_with(path, fail)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_several_files_are_replaced_together_or_not_at_all(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "nowhere" / "second"
    first.write_bytes(b"before")
    with pytest.raises(OutputError):
        outputs.write_files({first: b"after", second: b"after"})
    assert first.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [first]
    outputs.write_files({first: b"after", second: b"after"}, make_directories=True)
    assert (first.read_bytes(), second.read_bytes()) == (b"after", b"after")


def test_a_failed_stream_leaves_the_regular_files_unchanged(tmp_path: Path) -> None:
    kept, full = tmp_path / "kept", tmp_path / "full"
    kept.write_bytes(b"before")
    full.symlink_to("/dev/full")
    with pytest.raises(OutputError, match="full: cannot be written: No space left"):
        outputs.write_files({kept: b"after", full: b"after"})
    assert kept.read_bytes() == b"before"
    assert sorted(tmp_path.iterdir()) == [full, kept]


def test_after_a_failed_rename_the_earlier_renames_are_reverted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, new, last = (tmp_path / name for name in ("kept", "new", "last"))
    kept.write_bytes(b"before")
    replace = Path.replace

    def refuse_last(self: Path, target: Path) -> Path:
        if Path(target).name == "last":
            raise PermissionError(13, "Permission denied", str(target))
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", refuse_last)
    with pytest.raises(OutputError, match="last: cannot be written: Permission denied"):
        outputs.write_files({kept: b"after", new: b"after", last: b"after"})
    assert kept.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [kept]


def test_an_up_to_date_file_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "same"
    path.write_bytes(b"same")
    before = path.stat()
    outputs.write_bytes(path, b"same")
    assert (before.st_ino, before.st_mtime_ns) == (path.stat().st_ino, path.stat().st_mtime_ns)


def test_provenance_uses_given_date_then_environment_then_clock(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    image = bytes(8) + (0x573C2186).to_bytes(4, "little") + bytes(installation.KEY_BYTES)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    found = installation.provenance("lu2013", image, scenario="stop", seed=3)
    assert found["date"] == "1970-01-02T00:00:00Z"
    assert found["configuration_crc32"] == "0x573C2186"
    assert (found["configuration"], found["scenario"], found["seed"]) == ("lu2013", "stop", 3)
    assert re.fullmatch(r"[0-9a-f]{40}\+?|unknown", found["commit"])
    assert installation.timestamp("2026-01-31T13:00:00+01:00") == "2026-01-31T12:00:00Z"
    assert installation.timestamp("2026-01-31") == "2026-01-31T00:00:00Z"
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    assert installation.timestamp() > "2026"


def test_an_invalid_date_is_an_error_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ConfigurationError, match="accepted: ISO 8601"):
        installation.timestamp("yesterday")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(ConfigurationError, match="accepted: seconds since 1970"):
        installation.timestamp()
