# SPDX-License-Identifier: Apache-2.0
"""Processor in the loop: an emulated Cortex-M4 that executes the controllers of a run.

The emulator runs a program with the firmware's modules as they are cross-compiled for the image
(host_sim/pil). Its RAM is a file that the engine shares.
"""

import contextlib
import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

from regen_table import installation

from hubsim.engine import ROOT, Engine
from hubsim.errors import HubsimError

MACHINE = "mps2-an386"
MEMORY_BYTES = 16 << 20  # what that machine has at 0x2100 0000
ENDED_OFFSET = 8  # PIL_ENDED_OFFSET of host_sim/pil/message.h
SHARED_MEMORY = Path("/dev/shm")
PROGRAM = Path("host_sim") / "pil" / "hubfoc_pil.elf"
PLUGIN = Path("host_sim") / "pil" / "pil_plugin.so"
Command = Callable[[str], list[str]]
BRINGS = "./tools/dev hubsim run SCENARIO --on qemu"


def build_directory() -> Path:
    """Return the build of the preset qemu: beside ``HUBFOC_BUILD_DIR`` if that is set."""
    named = os.environ.get("HUBFOC_BUILD_DIR")
    return Path(named).parent / "qemu" if named else ROOT / "build" / "qemu"


def _files() -> tuple[str, Path, Path]:
    """Return emulator, program and plugin."""
    if installation.INSTALLED:
        raise HubsimError("--on qemu: accepted in the repository, which has the firmware's sources")
    emulator = shutil.which("qemu-system-arm")
    if emulator is None:
        raise HubsimError(
            f"--on qemu: qemu-system-arm was not found, '{BRINGS}' installs it (or './tools/dev "
            "setup qemu')"
        )
    program, plugin = (build_directory() / path for path in (PROGRAM, PLUGIN))
    for path in (program, plugin):
        if not path.is_file():
            raise HubsimError(
                f"--on qemu: {path} is not built, '{BRINGS}' builds it (or 'cmake --build --preset "
                "qemu --target hubfoc_pil hubfoc_pil_plugin')"
            )
    return emulator, program, plugin


def _note_end(core: subprocess.Popen[bytes], memory: int) -> None:
    """Tell the engine, which may wait for an answer, that the emulator has ended."""
    core.wait()
    os.pwrite(memory, b"\1", ENDED_OFFSET)


def command() -> Command:
    """Return how the emulator is started; an error if anything is missing."""
    return machine(*_files())


def machine(emulator: str, program: Path, plugin: Path, name: str = MACHINE) -> Command:
    """Return how an emulated machine with this program is started."""
    return lambda memory: [
        *(emulator, "-M", f"{name},memory-backend=ram", "-display", "none"),
        *("-monitor", "none", "-serial", "null"),
        *("-semihosting-config", "enable=on,target=native"),
        *("-object", f"memory-backend-file,id=ram,size={MEMORY_BYTES},mem-path={memory},share=on"),
        *("-plugin", f"{plugin},memory={memory}"),
        *("-kernel", str(program)),
    ]


@contextlib.contextmanager
def attached(engine: Engine, start: Command) -> Iterator[None]:
    """Let another processor execute the controllers of an engine that has not started.

    Parameters
    ----------
    engine : Engine
        Whose run begins and ends within the context.
    start : Command
        Arguments of the program that is or emulates the processor, from the file that is the
        shared memory.
    """
    place = SHARED_MEMORY if SHARED_MEMORY.is_dir() else None
    with (
        tempfile.NamedTemporaryFile(prefix=f"hubfoc_pil_{os.getpid()}_", dir=place) as memory,
        tempfile.TemporaryFile() as output,
    ):
        memory.truncate(MEMORY_BYTES)
        core = subprocess.Popen(
            start(memory.name), stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
        )
        watch = threading.Thread(target=_note_end, args=(core, memory.fileno()))
        watch.start()
        try:
            engine.attach_processor(memory.name)
            yield
        except HubsimError as error:
            output.seek(0)
            lines = output.read().decode(errors="replace").split("\n")
            shown = next((line for line in lines if line.strip()), "")
            raise HubsimError(f"{error}{f' ({shown})' if shown else ''}") from error
        finally:
            core.kill()
            watch.join()
