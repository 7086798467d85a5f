# SPDX-License-Identifier: Apache-2.0
"""Runs of CBMC that are not repeated: what has been proved of the same content is known.

A run is known by a hash of everything that decides its result: the preprocessed text of every
source, all flags, the version of CBMC, what was expected, and this file. Comments, blank lines and
the place of the repository are not part of it. What CBMC reads is the text that was hashed.
"""

import re
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from run_tests import known, opened

ROOT = Path(__file__).resolve().parents[2]
# As CBMC preprocesses.
PREPROCESS = ("gcc", "-E", "-D__CPROVER__", "-m64", "-std=gnu11")
_MARKER = re.compile(r'^# \d+ "([^"<]+)"')


@dataclass(frozen=True)
class Outcome:
    """What is wrong with a run, nothing if it is good; and whether that was known before."""

    wrong: tuple[str, ...]
    cached: bool


def proved_line(kind: str, names: Sequence[str], cached: bool) -> str:
    """Return the line that says what was proved; run_tests counts by it."""
    before = " before (cached)" if cached else ""
    return f"{len(names)} {kind}{'s' * (len(names) != 1)} proved{before}: {', '.join(names)}"


@cache
def _version(cbmc: str) -> str:
    return subprocess.run([cbmc, "--version"], check=True, capture_output=True, text=True).stdout


def _preprocessed(source: str, options: Sequence[str]) -> str:
    command = [*PREPROCESS, *options, source]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def _content(text: str, folder: Path) -> str:
    """Return a preprocessed text without line markers, blank lines and the names of folders."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("# ")]
    return "\n".join(lines).replace(f"{folder}/", "").replace(f"{ROOT}/", "")


def _note_files(text: str) -> None:
    """Record which files a preprocessed text was made of, for the choice of tests by changes."""
    names = {match[1] for line in text.splitlines() if (match := _MARKER.match(line))}
    opened.note(map(Path, names))


def check(
    cbmc: str,
    arguments: Sequence[str],
    judge: Callable[[str], Sequence[str]],
    name: str,
    expected: str,
    folder: Path = ROOT,
) -> Outcome:
    """Run CBMC unless a run of the same content was good.

    Parameters
    ----------
    cbmc
        The checker.
    arguments
        Its arguments; sources end in ``.c``.
    judge
        Returns what is wrong with what CBMC printed.
    name
        Under which good results are kept.
    expected
        What a good result means, in words.
    folder
        Where sources were generated; its name has no meaning.
    """
    sources = [one for one in arguments if one.endswith(".c")]
    options = [one for one in arguments if one.startswith(("-I", "-D"))]
    flags = [one for one in arguments if one not in sources and one not in options]
    try:
        texts = [_preprocessed(source, options) for source in sources]
    except subprocess.CalledProcessError as error:
        return Outcome(tuple(error.stderr.splitlines()), False)
    own = Path(__file__).read_bytes()
    contents = [_content(text, folder) for text in texts]
    key = known.key_of([own, _version(cbmc), expected, *flags, "sources:", *contents])
    for text in texts:
        _note_files(text)
    if known.is_good(name, key):
        return Outcome((), True)
    with tempfile.TemporaryDirectory() as written:
        files = [Path(written) / f"{n}_{Path(source).stem}.i" for n, source in enumerate(sources)]
        for file, text in zip(files, texts, strict=True):
            file.write_text(text, encoding="utf-8")
        command = [cbmc, *map(str, files), *flags]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    wrong = tuple(judge(done.stdout + done.stderr))
    if not wrong:
        known.keep(name, key)
    return Outcome(wrong, False)
