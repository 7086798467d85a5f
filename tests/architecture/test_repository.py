# SPDX-License-Identifier: Apache-2.0
"""The repository itself.

Top-level entries, length of lines, and text that no tracked file may contain.
"""

import re
import subprocess
import tempfile
from pathlib import Path

import pytest
from modules import ROOT

TOP_LEVEL = {
    *("CMakeLists.txt", "CMakePresets.json", "README.md", "LICENSE"),
    *(".ci", ".clang-format", ".clang-tidy", ".editorconfig", ".gitattributes", ".gitignore"),
    *("firmware", "hal", "host_sim", "tests", "tools"),
}

LONGEST_LINE = 100  # characters, as in .editorconfig, .clang-format and ruff.toml

# Files that are generated or taken over from others; not checked.
FOREIGN = re.compile(
    r"(?:^|/)(?:LICENSE|generated/.*|foreign/.*|cycles/.*\.csv)$|\.(?:bin|png|svg|csv|npz)$"
)
CODE = re.compile(r"\.(?:c|h|cpp|hpp|py|sh|cmake|toml|ld)$|(?:^|/)CMakeLists\.txt$|^tools/dev$")

# Documents cited by address. Any other host name would be that of a machine.
KNOWN_HOSTS = re.compile(r"(?:^|\.)(?:apache|doi|fmi-standard|w3)\.org$")

# Split so that this file does not contain the refused text.
MACHINE_PATH = re.compile(
    r"(?<![\w.~$}/<-])/(?:home|root|work|Users|mnt|media)(?:/|\b(?![\w-]))|(?<![\w$}/.-])/tmp/\w"
)
HOST = re.compile(r"(?<=://)[\w-]+(?:\.[\w-]+)+|\b(?:[a-z0-9-]+\.)+(?:com|org)\b(?!\()")
UNFINISHED = re.compile(
    rf"\b(?:{'TO' + 'DO'}|{'FIX' + 'ME'}|{'XX' + 'X'}|"
    rf"(?i:{'ha' + 'ck'}|{'place' + 'holder'}|{'dum' + 'my'}|{'st' + 'ubs?'}))\b"
)


def git_files() -> list[Path]:
    """Return the files that are tracked or would be with the next commit.

    Of an unpacked archive, all that is not ignored.
    """
    listing = ["ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    result = subprocess.run(
        ["git", "-C", str(ROOT), *listing], capture_output=True, text=True, check=False
    )
    if result.returncode != 0:
        with tempfile.TemporaryDirectory() as empty:
            subprocess.run(["git", "init", "--quiet", "--bare", empty], check=True)
            places = [f"--git-dir={empty}", f"--work-tree={ROOT}"]
            result = subprocess.run(
                ["git", *places, *listing], cwd=ROOT, capture_output=True, text=True, check=True
            )
    return [ROOT / name for name in result.stdout.split("\0") if name and (ROOT / name).is_file()]


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def own_text() -> dict[str, str]:
    """Return name and text of every file that people of this project wrote."""
    return {
        name_of(path): path.read_bytes().decode("utf-8")
        for path in git_files()
        if not FOREIGN.search(name_of(path))
    }


def found(pattern: re.Pattern[str], texts: dict[str, str]) -> list[str]:
    return [
        f"{name}:{number}: {match.group()}"
        for name, text in texts.items()
        for number, line in enumerate(text.splitlines(), start=1)
        for match in pattern.finditer(line)
    ]


def test_the_top_level_contains_exactly_the_entries_of_the_design() -> None:
    top = {name_of(path).split("/", maxsplit=1)[0] for path in git_files()}
    assert top <= TOP_LEVEL
    assert {"CMakeLists.txt", "README.md", "LICENSE", "firmware", "hal", "tests", "tools"} <= top


def test_no_line_of_code_is_longer_than_a_hundred_columns() -> None:
    """Comments and strings as well, which no formatter wraps."""
    texts = {name: text for name, text in own_text().items() if CODE.search(name)}
    assert found(re.compile(rf"^.{{{LONGEST_LINE + 1},}}$"), texts) == []


def prose(text: str) -> str:
    """Return a Markdown text with the lines blanked that cannot be wrapped.

    Rows of tables, code (fenced or indented), pictures and lines that are one link or one word.
    """
    kept, fenced = [], False
    for line in text.splitlines():
        fenced ^= line.lstrip().startswith("```")
        whole = re.match(r"(?: {4}|\s*\||\s*!\[|[*\s]*\S+$)", line)
        kept.append("" if fenced or whole else line)
    return "\n".join(kept)


def test_no_line_of_prose_is_longer_than_a_hundred_columns() -> None:
    texts = {name: prose(text) for name, text in own_text().items() if name.endswith(".md")}
    assert len(texts) > 20
    assert found(re.compile(rf"^.{{{LONGEST_LINE + 1},}}$"), texts) == []


def test_text_has_no_trailing_blanks_tabs_or_carriage_returns() -> None:
    for name, text in own_text().items():
        assert "\r" not in text, f"{name}: carriage return"
        assert text == "" or text.endswith("\n"), f"{name}: no newline at the end"
        if not name.endswith(".md"):
            assert found(re.compile(r"[ \t]+$"), {name: text}) == []
        if CODE.search(name):
            assert found(re.compile(r"^.*\t"), {name: text}) == [], "indented with tabs"


def test_no_file_contains_a_path_of_the_development_machine() -> None:
    assert found(MACHINE_PATH, own_text()) == []


def test_no_file_contains_a_host_name_other_than_of_cited_documents() -> None:
    places = found(HOST, own_text())
    assert [
        place for place in places if not KNOWN_HOSTS.search(place.rsplit(" ", maxsplit=1)[1])
    ] == []


def test_no_file_contains_a_marker_of_unfinished_work() -> None:
    assert found(UNFINISHED, own_text()) == []


@pytest.mark.parametrize(
    ("pattern", "line"),
    [
        (MACHINE_PATH, "see /ho" + "me/someone/x"),
        (MACHINE_PATH, '"/ro' + 'ot"'),
        (MACHINE_PATH, "cd /t" + "mp/build"),
        (HOST, "fetch https://mirror" + ".somewhere" + ".org/x"),
        (HOST, "index = packages" + ".com"),
        (UNFINISHED, "/* TO" + "DO: later */"),
        (UNFINISHED, "returns a dum" + "my value"),
    ],
)
def test_the_search_finds_every_forbidden_pattern(pattern: re.Pattern[str], line: str) -> None:
    assert pattern.search(line)


@pytest.mark.parametrize(
    ("pattern", "line"),
    [
        (MACHINE_PATH, "${CMAKE_BINARY_DIR}/root/x, host_sim/work, $ROOT/home"),
        (MACHINE_PATH, "<root></root>"),
        (MACHINE_PATH, "/usr/bin and /etc/os-release are the same everywhere"),
        (HOST, "flow.net, model.organ, scipy.io, x.com(1)"),
        (UNFINISHED, "a stubborn wheel; todo = [root]"),
    ],
)
def test_the_search_permits_ordinary_text(pattern: re.Pattern[str], line: str) -> None:
    assert not pattern.search(line)
