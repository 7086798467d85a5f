# SPDX-License-Identifier: Apache-2.0
"""Small programs for the emulated core, made on the spot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from benchmark import build

CORE = build.CORES[0]


@pytest.fixture
def program(tmp_path: Path) -> Callable[..., Path]:
    """Compile C text (and the port's start-up) into an ELF.

    Flags beyond the core's own are passed through; link: further ones of the linker.
    """

    def make(text: str, *flags: str, link: Sequence[str] = ()) -> Path:
        source = tmp_path / "program.c"
        source.write_text(text)
        port = build.ROOT / "hal" / "qemu_mps2"
        elf = tmp_path / "program.elf"
        command = [
            build.PREFIX + "gcc",
            *CORE.flags,
            "-O2",
            "-std=gnu11",
            f"-I{port}",
            "-fcallgraph-info=su",
            *flags,
        ]
        objects = []
        for path in (source, port / "startup.c", port / "semihost.c"):
            target = tmp_path / f"{path.stem}.o"
            build.run([*command, "-c", str(path), "-o", str(target)], f"compiling {path.name}")
            objects.append(str(target))
        linked = [
            *link,
            "-fcallgraph-info=su",
            "-nostartfiles",
            "--specs=nano.specs",
            f"-T{port / 'link.ld'}",
            "-Wl,--defsym=link_stack_size=0x4000",
        ]
        build.run([build.PREFIX + "gcc", *CORE.flags, *linked, *objects, "-o", str(elf)], "linking")
        return elf

    return make
