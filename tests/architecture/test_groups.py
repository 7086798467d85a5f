# SPDX-License-Identifier: Apache-2.0
"""The groups of hubsim's modules import one way, and none imports a study."""

import ast
from pathlib import Path

import pytest
from modules import ROOT

PACKAGE = ROOT / "host_sim" / "python" / "hubsim"
FLOOR = "floor"  # the modules directly in the package
# What a group may import besides itself: only groups above its own line.
MAY_IMPORT: dict[str, tuple[str, ...]] = {
    FLOOR: (),
    "report": (FLOOR,),
    "scenario": (FLOOR,),
    "run": (FLOOR, "scenario"),
    "sweep": (FLOOR, "scenario", "run"),
    "swarm": (FLOOR, "scenario", "run", "sweep"),
    "fmu": (FLOOR, "scenario", "run"),
    "cli": (FLOOR, "report", "scenario", "run", "sweep", "swarm"),
}
FACE = ("__init__.py", "__main__.py")  # of the package: public names, whatever group they are of


def group_of(path: Path) -> str:
    """Return the group of a module by its file."""
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else FLOOR


def imports_in(text: str) -> list[tuple[int, str]]:
    """Return line and full name of everything a module imports, in functions too."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            found += [(node.lineno, f"{module}.{alias.name}") for alias in node.names]
    return found


def refused(group: str, text: str) -> list[str]:
    """Return the imports of a module that its group may not have, each with its line."""
    found = []
    for line, name in imports_in(text):
        top, *rest = name.split(".")
        if top in ("", "studies"):
            found.append(f"{line}: {name}")
        elif top == "hubsim":
            first = rest[0] if rest else ""
            floor = (PACKAGE / f"{first}.py").is_file()
            of = FLOOR if floor else first
            if of not in (group, *MAY_IMPORT[group]):
                found.append(f"{line}: {name}")
    return found


MODULES = [
    path
    for path in sorted(PACKAGE.rglob("*.py"))
    if not (path.parent == PACKAGE and path.name in FACE)
]


def test_every_folder_of_the_package_is_a_group() -> None:
    folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert folders | {FLOOR} == set(MAY_IMPORT)
    assert {group_of(path) for path in MODULES} == set(MAY_IMPORT)


def test_a_group_may_only_import_those_above_it() -> None:
    order = list(MAY_IMPORT)
    for group, others in MAY_IMPORT.items():
        assert all(order.index(other) < order.index(group) for other in others)


def test_modules_import_only_what_their_group_may() -> None:
    found = {
        path.relative_to(ROOT).as_posix(): lines
        for path in MODULES
        if (lines := refused(group_of(path), path.read_text(encoding="utf-8")))
    }
    assert found == {}


@pytest.mark.parametrize(
    ("group", "text"),
    [
        ("scenario", "from hubsim import run"),
        ("scenario", "def f():\n    from hubsim.run.results import RunResult"),
        ("run", "import hubsim.sweep.cases"),
        ("report", "from hubsim.scenario import Scenario"),
        (FLOOR, "from hubsim.run import stops"),
        ("run", "from hubsim import Bench"),  # a public name: the module has a place of its own
        ("run", "from hubsim import stops"),
        ("run", "from . import results"),
        ("cli", "from studies import common"),
    ],
)
def test_an_import_against_the_order_is_found(group: str, text: str) -> None:
    assert len(refused(group, text)) == 1


@pytest.mark.parametrize(
    ("group", "text"),
    [
        ("scenario", "from hubsim import engine, files"),
        ("run", "from hubsim.scenario import Scenario\nfrom hubsim.run import stops"),
        ("cli", "from hubsim import report, run\nimport numpy as np"),
    ],
)
def test_an_import_in_the_order_is_accepted(group: str, text: str) -> None:
    assert refused(group, text) == []


def test_no_other_package_of_the_distribution_imports_a_study() -> None:
    for path in sorted((ROOT / "tools" / "regen_table").rglob("*.py")):
        names = [name for _, name in imports_in(path.read_text(encoding="utf-8"))]
        assert [name for name in names if name.partition(".")[0] == "studies"] == [], path
