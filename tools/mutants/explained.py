# SPDX-License-Identifier: Apache-2.0
"""The tables of mutants that no test kills (tests/mutants): each with its reason, or open.

``explained_MODULE*.toml`` hold what needs no test: equivalent to the unchanged code, or excluded by
a precondition. ``open_MODULE.txt`` lists what a test should kill and none does yet.
"""

import tomllib
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from mutants.operators import Change

KINDS = ("equivalent", "unreachable")
OPEN_HEAD = """\
# SPDX-License-Identifier: Apache-2.0
# Mutants that no unit test kills and that are not explained: work that is left.
# Written by ./tools/dev mutants {module} --write-open
"""


def names(numbered: Mapping[int, tuple[Path, Change]]) -> dict[int, str]:
    """Return a name for every mutant that does not change when lines are moved.

    File, function, change and the line's text; a number if these four occur more than once.
    """
    seen: Counter[str] = Counter()
    out = {}
    for number, (path, change) in numbered.items():
        what = f"{change.original} -> {change.replacement or '(removed)'}"
        name = f"{path.name}: {change.function}: {what}"
        if change.line_text != change.original:
            name += f" in: {change.line_text}"
        seen[name] += 1
        out[number] = name if seen[name] == 1 else f"{name} #{seen[name]}"
    return out


class Tables:
    """The tables of one module."""

    def __init__(self, folder: Path, module: str) -> None:
        self._module = module
        self.open_file = folder / f"open_{module}.txt"
        self.explained: dict[str, str] = {}
        self.open: set[str] = set()
        self.wrong: list[str] = []
        for path in sorted(folder.glob(f"explained_{module}*.toml")):
            self._read(path.name, tomllib.loads(path.read_text(encoding="utf-8")))
        if self.open_file.is_file():
            lines = self.open_file.read_text(encoding="utf-8").splitlines()
            self.open = {line for line in lines if line and not line.startswith("#")}

    def _read(self, name: str, table: Mapping[str, list[dict[str, object]]]) -> None:
        for entry in table.get("explained", []):
            where = f"{entry.get('file')}: {entry.get('function')}: "
            reason, kind = str(entry.get("reason", "")).strip(), entry.get("kind")
            listed = entry.get("changes", [])
            assert isinstance(listed, list)
            for change in listed:
                self.explained[where + change] = reason
            if kind not in KINDS or not reason:
                self.wrong.append(f"{name}: {where}needs a kind and a reason")

    def write_open(self, left: list[str]) -> None:
        """List every mutant that is left as open."""
        if left:
            text = OPEN_HEAD.format(module=self._module) + "\n".join(left) + "\n"
            self.open_file.write_text(text, encoding="utf-8")
        else:
            self.open_file.unlink(missing_ok=True)
