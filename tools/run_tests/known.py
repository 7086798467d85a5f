# SPDX-License-Identifier: Apache-2.0
"""Good results of long checks, kept by a hash of all that decides them, in ``.dev/known/NAME``.

One hash a line; a failed check is never kept. ``HUBFOC_NO_CACHE=1`` in the environment, which
``tools/dev test --no-cache`` sets, makes nothing known.
"""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

STORE = Path(__file__).resolve().parents[2] / ".dev" / "known"


def key_of(parts: Iterable[str | bytes]) -> str:
    """Return the hash of texts, each with its length, so that no two lists have the same one."""
    hashed = hashlib.sha256()
    for part in parts:
        raw = part.encode() if isinstance(part, str) else part
        hashed.update(f"{len(raw)} ".encode() + raw)
    return hashed.hexdigest()


def is_good(name: str, key: str) -> bool:
    """Return whether a check with this hash was good before."""
    file = STORE / name
    if os.environ.get("HUBFOC_NO_CACHE") or not file.is_file():
        return False
    return key in file.read_text(encoding="ascii").split()


def keep(name: str, key: str) -> None:
    """Keep a good result."""
    STORE.mkdir(parents=True, exist_ok=True)
    with (STORE / name).open("a", encoding="ascii") as out:
        out.write(f"{key}\n")
