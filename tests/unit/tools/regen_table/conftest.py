# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the regen_table tests."""

import copy
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from regen_table import schema

ROOT = Path(__file__).resolve().parents[4]
PAPER = ROOT / "tools" / "motors" / "lu2013.toml"
sys.path.append(str(ROOT / "tests" / "property"))  # whose tests in C++ take the same random drives

Tree = dict[str, Any]


@pytest.fixture(scope="session")
def paper() -> schema.Drive:
    return schema.load(PAPER)


@pytest.fixture
def paper_tree() -> Tree:
    return tomllib.loads(PAPER.read_text(encoding="utf-8"))


@pytest.fixture
def change(paper_tree: Tree) -> Callable[..., schema.Drive]:
    """Return the paper's drive with keys changed ("section.key" = value; None removes the key)."""

    def changed(changes: dict[str, Any]) -> schema.Drive:
        tree = copy.deepcopy(paper_tree)
        for path, value in changes.items():
            section, _, key = path.partition(".")
            if value is None:
                del tree[section][key]
            elif key:
                tree.setdefault(section, {})[key] = value
            else:
                tree[section] = value
        return schema.parse(tree, "changed", "changed.toml")

    return changed


@pytest.fixture(scope="session")
def random_drives() -> list[schema.Drive]:
    """Two hundred plausible drives, always the same."""
    import plausible  # noqa: PLC0415, the path is known only now

    return plausible.drives()
