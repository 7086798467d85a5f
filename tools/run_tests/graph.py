# SPDX-License-Identifier: Apache-2.0
"""What depends on what in a build: build.ninja and the dependencies that compilers found."""

import os
import re
import subprocess
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

_WORD = re.compile(r"(?:\$.|[^ $])+")


def _words(statement: str) -> list[str]:
    """Return the words of a build statement, its colon a word of its own."""
    words = []
    for raw in _WORD.findall(statement):
        ends = raw.endswith(":") and not raw.endswith("$:")
        word = re.sub(r"\$(.)", r"\1", raw.removesuffix(":") if ends else raw)
        words.extend([word, ":"] if ends else [word])
    return words


class BuildGraph:
    """Files and what is made of them in one build directory."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._made_of: dict[Path, set[Path]] = defaultdict(set)
        self.outputs: set[Path] = set()
        text = (directory / "build.ninja").read_text(encoding="utf-8").replace("$\n", "")
        for line in text.splitlines():
            if line.startswith("build "):
                self._read(_words(line.removeprefix("build ")))
        deps = subprocess.run(
            ["ninja", "-C", str(directory), "-t", "deps"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        output = directory
        for line in deps.splitlines():
            if line.startswith("    "):
                self._made_of[self._path(line.strip())].add(output)
            elif ": #deps" in line:
                output = self._path(line.rpartition(": #deps")[0])

    def _path(self, name: str) -> Path:
        return Path(os.path.normpath(self._directory / name))

    def _read(self, words: list[str]) -> None:
        """Take in one statement: OUT... [| OUT...] : RULE IN... [| IN...] [|| ORDER...]."""
        colon = words.index(":")
        made = [self._path(word) for word in words[:colon] if word != "|"]
        self.outputs.update(path for path in made if path.is_relative_to(self._directory))
        for word in words[colon + 2 :]:
            if word == "||":  # only an order, not a content
                break
            if word != "|":
                self._made_of[self._path(word)].update(made)

    def affected(self, changed: Iterable[Path]) -> set[Path]:
        """Return the files and everything that is made of them, directly or not."""
        waiting = list(changed)
        found: set[Path] = set()
        while waiting:
            path = waiting.pop()
            if path not in found:
                found.add(path)
                waiting.extend(self._made_of.get(path, ()))
        return found
