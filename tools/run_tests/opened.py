# SPDX-License-Identifier: Apache-2.0
"""Record which files of the project a Python program reads: what a test depends on.

The environment's .pth file imports this module at the start of every interpreter for which
``HUBFOC_OPENED`` names a file. At the end of the process one path a line is added to it: files
opened, modules imported and libraries loaded, as far as they lie under ``HUBFOC_OPENED_ROOT``.
"""

import atexit
import os
import sys
from collections.abc import Iterable
from pathlib import Path

_seen: set[Path] = set()


def _note(event: str, arguments: tuple[object, ...]) -> None:
    if event == "open":
        path, _, flags = arguments
        if isinstance(path, str) and isinstance(flags, int) and flags & os.O_ACCMODE == os.O_RDONLY:
            _seen.add(Path(path).absolute())


def note(paths: Iterable[Path]) -> None:
    """Add files that another program reads for this one."""
    _seen.update(path.absolute() for path in paths)


def source_of(path: Path) -> Path:
    """Return the source of a cached module; of any other file its own path."""
    if path.parent.name == "__pycache__" and path.suffix == ".pyc":
        return path.parent.parent / (path.name.partition(".")[0] + ".py")
    return path


def _mapped() -> set[Path]:
    """Return the files that are mapped into the process: the libraries it has loaded."""
    try:
        text = Path("/proc/self/maps").read_text(encoding="utf-8")
    except OSError:
        return set()
    return {Path(line.split(maxsplit=5)[5]) for line in text.splitlines() if "/" in line}


def _write(target: Path, root: Path) -> None:
    inside = [path for path in map(source_of, _seen | _mapped()) if path.is_relative_to(root)]
    own = {str(path) for path in inside if ".dev" not in path.parts and path.is_file()}
    with target.open("a", encoding="utf-8") as out:
        out.writelines(f"{path}\n" for path in sorted(own))


def start(target: Path, root: Path) -> None:
    """Begin to record; the list is written when the interpreter ends."""
    sys.addaudithook(_note)
    atexit.register(_write, target, root)


if "HUBFOC_OPENED" in os.environ:
    start(Path(os.environ["HUBFOC_OPENED"]), Path(os.environ["HUBFOC_OPENED_ROOT"]))
