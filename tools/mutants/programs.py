# SPDX-License-Identifier: Apache-2.0
"""The unit tests of a module, linked with the module that has all mutants in it.

The compile and link commands are those of the host preset's build (``ninja -t commands``): what is
not changed comes from there.
"""

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from unit_programs import programs_of

from mutants import schema
from mutants.operators import Change, changes, parse

ROOT = Path(__file__).resolve().parents[2]
# A test names the build that it belongs to, which is complete.
_GIVEN = os.environ.get("HUBFOC_BUILD_DIR")
HOST = Path(_GIVEN) if _GIVEN else ROOT / "build" / "host"
FOLDER = HOST.parent / "mutants"
TOOL = Path(__file__).resolve().parent
_LIST = ROOT / "tests" / "mutants" / "modules.txt"
MODULES = tuple(re.findall(r"(?m)^[a-z]\w*$", _LIST.read_text(encoding="utf-8")))
# As the sanitizers' build has no undefined result to hide behind, a mutant's overflow wraps, and
# its null pointer is read.
_DEFINED = ("-fwrapv", "-fno-delete-null-pointer-checks")
_FLAGS = ("-O1", "-w", "-g0", *_DEFINED, "-include", str(TOOL / "runtime.h"))
_OWN = re.compile(r"-(O\w|g|W\w.*|M[DTF]?)")


class MutantsError(Exception):
    """Something that keeps the mutants from being tested, in one line."""


@dataclass(frozen=True)
class Compile:
    """One compile command of the host preset: the words before its source, source and object."""

    words: tuple[str, ...]
    source: Path
    output: str


@dataclass(frozen=True)
class Build:
    """A module with all its mutants: the changes by number and the test programs."""

    module: str
    changes: dict[int, tuple[Path, Change]]
    programs: list[Path]
    compiles: list[Compile]


def sources_of(module: str) -> list[Path]:
    """Return the files of a module that are changed; the host has none of a small port's."""
    folder = ROOT / "firmware" / module
    files = [
        path
        for path in folder.rglob("*.[ch]")
        if "generated" not in path.parts and not path.stem.endswith("_absent")
    ]
    return sorted(files, key=lambda path: (path.suffix, path))


def changes_of(module: str) -> dict[int, tuple[Path, Change]]:
    """Return the changes of a module by number, from 1."""
    found = [
        (path, change)
        for path in sources_of(module)
        for change in changes(parse(path.read_bytes()))
    ]
    return dict(enumerate(found, 1))


def _run(words: Iterable[str], folder: Path = HOST) -> str:
    done = subprocess.run(list(words), cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = (done.stdout + done.stderr).splitlines()
        wrong = (
            [line for line in lines if re.search("error|undefined|multiple", line)]
            or lines
            or ["?"]
        )
        raise MutantsError(wrong[0].replace(f"{ROOT}/", ""))
    return done.stdout


def _compile(words: list[str]) -> Compile:
    kept, skip, source, output = [], False, "", ""
    for word, after in zip(words, [*words[1:], ""], strict=True):
        if skip:
            skip = False
        elif word in ("-MT", "-MF", "-o", "-c"):
            skip = True
            output = after if word == "-o" else output
            source = after if word == "-c" else source
        elif not _OWN.fullmatch(word):
            kept.append(word)
    return Compile(tuple(kept), Path(source), output)


def build(module: str, folder: Path, jobs: int, numbered: dict[int, tuple[Path, Change]]) -> Build:
    """Write the module with its mutants into a folder, compile it and link its test programs."""
    shutil.rmtree(folder, ignore_errors=True)
    targets = programs_of([module], _run(("ninja", "-t", "targets", "all")))
    if not targets:
        raise MutantsError(f"no unit tests of {module} in build/host")
    _run(("ninja", *targets))  # which are no part of the host preset's default target
    commands = [
        shlex.split(line) for line in _run(("ninja", "-t", "commands", *targets)).splitlines()
    ]
    _write(module, folder, numbered)
    _copy(ROOT / "firmware" / module, folder / "unchanged" / "firmware" / module)
    original = f"{ROOT}/firmware/{module}"
    changed = f"{folder}/firmware/{module}"

    def moved(word: str) -> str:
        return re.sub(rf"^(-I|-isystem)?{re.escape(original)}(?=/|$)", rf"\1{changed}", word)

    own = (f"firmware/{module}/", f"tests/unit/firmware/{module}/")
    compiles = [
        one
        for words in commands
        if "-c" in words and (one := _compile(words)).output.startswith(own)
    ]
    made = {one.output: folder / one.output for one in compiles}

    def compile_one(one: Compile) -> None:
        made[one.output].parent.mkdir(parents=True, exist_ok=True)
        words = (moved(word) for word in (*one.words, *_FLAGS, "-c", str(one.source)))
        _run((*words, "-o", str(made[one.output])))

    unity = next(one for one in compiles if one.source.name.startswith("suite_"))
    runtime = folder / "runtime.o"
    with ThreadPoolExecutor(jobs) as pool:
        _each(pool, compile_one, compiles)
        _run((*unity.words, "-O1", "-w", "-c", str(TOOL / "runtime.c"), "-o", str(runtime)))
        library = folder / f"lib{module}.a"
        _run(("ar", "qc", str(library), *(str(made[n]) for n in made if n.startswith(own[0]))))
        links = [words for words in commands if "-o" in words and "-c" not in words]

        def link(words: list[str]) -> Path:
            program = folder / words[words.index("-o") + 1]
            _run((*_link_words(words, made, library, module), str(runtime), "-o", str(program)))
            return program

        wanted = [words for words in links if words[words.index("-o") + 1] in targets]
        programs = list(pool.map(link, wanted))
    return Build(module, numbered, programs, compiles)


def _link_words(words: list[str], made: dict[str, Path], library: Path, module: str) -> list[str]:
    """Return a link command of the host preset with what has mutants in place of what has none."""
    out, skip = [], False
    for word in words:
        if skip:
            skip = False
        elif word == "-o":
            skip = True
        elif word in made:
            out.append(str(made[word]))
        elif word == f"firmware/{module}/libhubfoc_{module}.a":
            out.append(str(library))
        elif word not in (":", "&&"):
            out.append(word)
    return [*out, "-Wl,--wrap=UnityConcludeTest"]


def _each(pool: ThreadPoolExecutor, do: Callable[[Compile], None], items: list[Compile]) -> None:
    for _ in pool.map(do, items):
        pass


def _write(module: str, folder: Path, numbered: dict[int, tuple[Path, Change]]) -> None:
    """Copy the module with all its mutants in it."""
    original = ROOT / "firmware" / module
    for path in sources_of(module):
        mine = {number: change for number, (file, change) in numbered.items() if file == path}
        target = folder / "firmware" / module / path.relative_to(original)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(schema.with_all(path.read_bytes(), mine))
    for path in original.rglob("generated"):
        (folder / "firmware" / module / path.relative_to(original)).symlink_to(path)


class SameCode:
    """Whether the compiler makes the same instructions with a mutant as without it."""

    def __init__(self, build: Build, folder: Path) -> None:
        self._build = build
        self._folder = folder / "one"
        self._plain = folder / "unchanged"
        self._unchanged: dict[Path, str] = {}

    def __call__(self, number: int) -> bool:
        """Compare a mutant's code with the code without it, in every file that it is part of."""
        path, change = self._build.changes[number]
        own = f"firmware/{self._build.module}/"
        units = [one for one in self._build.compiles if one.output.startswith(own)]
        if path.suffix == ".c":
            units = [one for one in units if one.source == path]
        copy = self._folder / str(number)
        _copy(self._plain / own, copy / own)
        (copy / path.relative_to(ROOT)).write_bytes(
            schema.with_one((self._plain / path.relative_to(ROOT)).read_bytes(), change)
        )
        same = bool(units) and all(self._is_same(one, copy, own) for one in units)
        shutil.rmtree(copy)
        return same

    def _is_same(self, one: Compile, copy: Path, own: str) -> bool:
        if one.source not in self._unchanged:
            self._unchanged[one.source] = self._assembly(one, self._plain, own)
        changed = self._assembly(one, copy, own)
        return changed == self._unchanged[one.source]

    def _assembly(self, one: Compile, root: Path, own: str) -> str:
        words = (word.replace(str(ROOT / own), str(root / own)) for word in one.words)
        source = root / one.source.relative_to(ROOT)
        text = _run((*words, "-O2", "-w", "-g0", "-S", "-o", "-", str(source)))
        kept = (line for line in text.splitlines() if not line.strip().startswith(".file"))
        return "\n".join(kept)


def _copy(module: Path, copy: Path) -> None:
    """Copy a module; what is generated stays where it is."""
    shutil.copytree(module, copy, ignore=shutil.ignore_patterns("*.md", "generated"))
    for generated in module.rglob("generated"):
        (copy / generated.relative_to(module)).symlink_to(generated)
