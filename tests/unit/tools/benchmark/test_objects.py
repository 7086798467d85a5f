# SPDX-License-Identifier: Apache-2.0
"""An object is compiled again if and only if it would be another one."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark.objects import compile_if_changed

LATER_s = 10


class Object:
    """A source with a header whose name has a space, and its object."""

    def __init__(self, place: Path) -> None:
        compiler = shutil.which("cc") or shutil.which("gcc")
        assert compiler is not None
        self.source = place / "one.c"
        self.source.write_text('#include "a limit.h"\nint limit = LIMIT;\n', encoding="utf-8")
        self.header = place / "a limit.h"
        self.header.write_text("#define LIMIT 3\n", encoding="utf-8")
        for file in (self.source, self.header):
            os.utime(file, (1e9, 1e9))
        self.made = place / "one.o"
        self.command = [compiler, "-O1", "-c", str(self.source)]
        self.count = 0

    def compile(self) -> int:
        """Return how often the compiler has run so far."""

        def execute(words: list[str]) -> None:
            self.count += 1
            subprocess.run(words, check=True, capture_output=True)

        compile_if_changed(self.command, self.made, execute)
        return self.count

    def touch(self, file: Path) -> None:
        later = self.made.stat().st_mtime + LATER_s
        os.utime(file, (later, later))


@pytest.fixture(name="one")
def make_object(tmp_path: Path) -> Object:
    return Object(tmp_path)


def test_what_is_current_is_not_compiled_again(one: Object) -> None:
    assert [one.compile(), one.compile()] == [1, 1]


CHANGES: dict[str, Callable[[Object], object]] = {
    "the source": lambda one: one.touch(one.source),
    "a header": lambda one: one.touch(one.header),
    "an option": lambda one: one.command.insert(1, "-g"),
    "the object is gone": lambda one: one.made.unlink(),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_change_is_compiled(one: Object, what: str) -> None:
    one.compile()
    CHANGES[what](one)
    assert one.compile() == 2


def test_a_header_that_is_gone_is_an_error(one: Object) -> None:
    one.compile()
    one.header.unlink()
    with pytest.raises(subprocess.CalledProcessError):
        one.compile()


def test_a_failed_compilation_leaves_nothing_current(one: Object) -> None:
    one.compile()
    one.source.write_text("int limit = ;\n", encoding="utf-8")
    one.touch(one.source)
    for _ in range(2):
        with pytest.raises(subprocess.CalledProcessError):
            one.compile()
    assert one.count == 3
