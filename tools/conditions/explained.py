# SPDX-License-Identifier: Apache-2.0
"""The table of branches and conditions that no test can reach, each with its reason."""

import tomllib
from pathlib import Path


class Table:
    """The entries of ``explained.toml`` by name, and what is wrong with the file."""

    def __init__(self, path: Path) -> None:
        self.reasons: dict[str, str] = {}
        self.wrong: list[str] = []
        if not path.is_file():
            return
        for entry in tomllib.loads(path.read_text(encoding="utf-8")).get("explained", []):
            where = f"{entry.get('file')}: {entry.get('function')}: "
            reason = str(entry.get("reason", "")).strip()
            if not reason:
                self.wrong.append(f"{path.name}: {where}needs a reason")
            for name in entry.get("missing", []):
                self.reasons[where + name] = reason
