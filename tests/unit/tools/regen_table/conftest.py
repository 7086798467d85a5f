# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the regen_table tests."""

import copy
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cffi
import pytest
from regen_table import schema

ROOT = Path(__file__).resolve().parents[4]
PAPER = ROOT / "tools" / "motors" / "lu2013.toml"
sys.path.append(str(ROOT / "tests" / "property"))  # whose tests in C++ take the same random drives

Tree = dict[str, Any]
Validator = Callable[[bytes], str]


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


@pytest.fixture(scope="session")
def validated(tmp_path_factory: pytest.TempPathFactory) -> Validator:
    """Return the firmware's validator of images: what it refuses one for, "" where it accepts."""
    library = tmp_path_factory.mktemp("firmware") / "validate.so"
    includes = [f"-I{ROOT / 'firmware' / module / 'include'}" for module in ("config", "core")]
    names = ("derived.c", "fields.c", "flux_relations.c", "physics.c", "validate.c")
    sources = [str(ROOT / "firmware" / "config" / name) for name in names]
    subprocess.run(
        ["cc", "-std=c11", "-O1", "-shared", "-fPIC", *includes, *sources, "-o", str(library)],
        check=True,
    )
    ffi: Any = cffi.FFI()
    ffi.cdef("""
        typedef struct {
            int code;
            const char *section, *field, *relation, *upper_section, *upper_field;
            int32_t value, lowest, highest;
        } outcome_t;
        outcome_t config_validate(const void *config, uint32_t size_bytes);
    """)
    firmware: Any = ffi.dlopen(str(library))

    def validate(raw: bytes) -> str:
        outcome = firmware.config_validate(ffi.from_buffer(raw), len(raw))
        if outcome.code == 0:
            return ""
        words = [outcome.section, outcome.field, outcome.relation]
        known = [ffi.string(word).decode() for word in words if word != ffi.NULL]
        return f"{outcome.code}: {' '.join(known)} {outcome.value}"

    return validate
