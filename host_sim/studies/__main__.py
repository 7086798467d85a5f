# SPDX-License-Identifier: Apache-2.0
"""``python -m studies``: what ``./tools/dev study`` does.

Exit status 0: done, and what the study asks for holds; 1: it does not hold, or failed; 2: refused;
130: interrupted. The list loads the standard library alone.
"""

import ast
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path

from regen_table.suggest import suggestion

FOLDER = Path(__file__).resolve().parent
HELP = ("-h", "--help")
USAGE = "Usage: tools/dev study NAME [OPTION...]"


def names() -> list[str]:
    """Return the names of all studies."""
    return sorted(path.parent.name for path in FOLDER.glob("*/study.py"))


def docstring(name: str) -> str:
    """Return what a study says of itself, read without what it imports."""
    text = (FOLDER / name / "study.py").read_text(encoding="utf-8")
    return ast.get_docstring(ast.parse(text)) or ""


def question(name: str) -> str:
    """Return what a study asks, in one line: the first of its module."""
    return docstring(name).partition("\n")[0]


def listed() -> str:
    """Return a line for each study."""
    return "\n".join(f"  {name:15} {question(name)}" for name in names())


def main(arguments: Sequence[str]) -> int:
    """List the studies, or run one."""
    if not arguments or arguments[0] in HELP:
        print(f"{USAGE}\n" if arguments else "studies:", listed(), sep="\n")
        print("\ntools/dev study NAME --help has the options.")
        return 0
    name = arguments[0].replace("-", "_")
    if name not in names():
        hint = suggestion(name, names())
        print(f"study: no study {arguments[0]!r}, {hint}", file=sys.stderr)
        return 2
    try:
        study = importlib.import_module(f"studies.{name}.study")
    except ModuleNotFoundError as error:
        if not set(HELP) & set(arguments[1:]):
            raise
        print(f"{USAGE}\n\n{docstring(name)}")
        print(f"{error.name} is not installed, without which it cannot list its options, accepted:")
        print("after './tools/dev setup sim figures'")
        return 0
    return int(study.main(arguments[1:]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
