# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the regen_table tests."""

import copy
import os
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
def firmware_library(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The host build's firmware above the controller, as one shared library for cffi."""
    library = tmp_path_factory.mktemp("firmware") / "firmware.so"
    folder = Path(os.environ["HUBFOC_BUILD_DIR"]) / "firmware"
    archives = [
        str(folder / name / f"libhubfoc_{name}.a")
        for name in ("controller", "foc", "modes", "monitor", "torque", "motor", "pedals")
    ]
    archives += [str(folder / name / f"libhubfoc_{name}.a") for name in ("config", "core")]
    whole = ["-Wl,--whole-archive", *archives, "-Wl,--no-whole-archive"]
    subprocess.run(["cc", "-shared", "-Wl,-z,defs", *whole, "-o", str(library)], check=True)
    return str(library)


@pytest.fixture(scope="session")
def validated(firmware_library: str) -> Validator:
    """Return the firmware's validator of images: what it refuses one for, "" where it accepts."""
    ffi: Any = cffi.FFI()
    ffi.cdef("""
        typedef struct {
            int code;
            const char *section, *field, *relation, *upper_section, *upper_field;
            int32_t value, lowest, highest;
        } outcome_t;
        outcome_t config_validate(const void *config, uint32_t size_bytes);
    """)
    firmware: Any = ffi.dlopen(firmware_library)

    def validate(raw: bytes) -> str:
        outcome = firmware.config_validate(ffi.from_buffer(raw), len(raw))
        if outcome.code == 0:
            return ""
        words = [outcome.section, outcome.field, outcome.relation]
        known = [ffi.string(word).decode() for word in words if word != ffi.NULL]
        return f"{outcome.code}: {' '.join(known)} {outcome.value}"

    return validate
