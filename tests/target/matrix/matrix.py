# SPDX-License-Identifier: Apache-2.0
"""Bit-exactness: the same inputs give the same outputs whatever compiles and executes the steps.

    ./tools/dev python tests/target/matrix/matrix.py [--whole] [--cells A,B] [--scenarios A,B]

Every cell is the firmware's modules compiled in another way, twice: with the trace sequences
(tests/target/trace.c), and as the processor in the loop of scenarios (host_sim/pil). A scenario
runs until two seconds after its last event, or whole. Exit status 1 if any hash of any cell is
another one.
"""

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from benchmark.objects import compile_if_changed
from hubsim import cli, emulator, run, scenario
from hubsim.run import evaluation
from hubsim.run.results import json_object
from hubsim.scenario import overrides
from hubsim.scenario.events import Event

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).resolve().parent
OUTPUT = ROOT / "build" / "matrix"
MODULES = ("core", "config", "foc", "motor", "torque", "monitor", "modes", "pedals", "controller")
PORT = ROOT / "hal" / "qemu_mps2"
PIL = ROOT / "host_sim" / "pil"
TARGET = ROOT / "tests" / "target"
DRIVE = cli.DEFAULT_CONFIG
CONFIG = "lu2013"

AFTER_EVENT_S = 2.0
INTERVAL_S, INTERVAL_OF_CYCLES_S = 0.001, 0.05
LONG = {"udds": 60.0}
"""Of a scenario of many minutes the beginning, s; tests/target/pil runs it whole."""
M4 = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
LINK_ARM = ("-nostartfiles", "--specs=nano.specs", "-Wl,--gc-sections", "-lm",
            f"-T{PORT / 'link.ld'}", "-Wl,--defsym=link_stack_size=0x20000")  # fmt: skip
WITHOUT_LIBRARY = ("-ffreestanding", "-fno-pic", "-fno-stack-protector")


@dataclass(frozen=True)
class Cell:
    """A way to compile and execute the steps."""

    name: str
    compiler: str
    flags: tuple[str, ...]
    link: tuple[str, ...] = ("-lm",)
    machine: str = ""
    """Of the emulator; none: this one."""

    @property
    def is_x86_32(self) -> bool:
        """Whether there is no C library."""
        return "-m32" in self.flags

    def sources(self, program: str) -> list[Path]:
        """Return what is compiled for ``trace`` or ``pil`` besides the modules."""
        own = {
            "trace": [TARGET / f"{name}.c" for name in ("trace", "digest", "print", "wheel")],
            "pil": [PIL / "serve.c", ROOT / "host_sim" / "bench" / "injection.c"],
        }[program]
        if self.machine:
            own += [PORT / "startup.c", PORT / "semihost.c"]
            return [*own, TARGET / "print_target.c" if program == "trace" else PIL / "target.c"]
        if self.is_x86_32:
            return [*own, HERE / "core32.c"]
        return [*own, TARGET / "print_host.c" if program == "trace" else HERE / "core.c"]


def arm(name: str, core: Sequence[str], optimise: str, machine: str = "mps2-an386") -> Cell:
    """Return a cell on an emulated core, compiled as the firmware's image but for these flags."""
    flags = (*core, optimise, "-ffunction-sections", "-fdata-sections", "-fno-common", "-include",
             str(ROOT / "hal" / "cortex_m" / "saturate.h"))  # fmt: skip
    return Cell(name, "arm-none-eabi-gcc", flags, (*core, *LINK_ARM), machine)


CELLS = (
    Cell("x86-64 gcc -O0", "gcc", ("-O0",)),
    Cell("x86-64 gcc -O2", "gcc", ("-O2",)),
    Cell("x86-64 gcc -O3", "gcc", ("-O3",)),
    Cell("x86-64 clang -O2 with sanitizers", "clang", ("-O2", *SANITIZED), (*SANITIZED, "-lm")),
    Cell(
        "x86 32-bit gcc -O2",
        "gcc",
        ("-m32", "-O2", *WITHOUT_LIBRARY, "-ffunction-sections", f"-I{HERE / 'freestanding'}"),
        ("-m32", "-nostdlib", "-static", "-no-pie", "-Wl,--gc-sections"),
    ),
    arm("Cortex-M4 gcc -O2", M4, "-O2"),
    arm("Cortex-M4 gcc -Os", M4, "-Os"),
    arm("Cortex-M4 gcc -O0", M4, "-O0"),
    arm("Cortex-M3 gcc -O2", ("-mcpu=cortex-m3", "-mthumb"), "-O2", "mps2-an385"),
    # No emulated board has a Cortex-M0+ with enough memory; its instruction set is a subset of the
    # M4's.
    arm("Cortex-M0+ gcc -Os", ("-mcpu=cortex-m0plus", "-mthumb"), "-Os"),
)


class MatrixError(Exception):
    """Something is missing or failed; one line for the user."""


def executed(command: Sequence[str | Path], what: str) -> str:
    """Run a program and return what it printed."""
    done = subprocess.run([str(part) for part in command], check=False, capture_output=True,
                          text=True, stdin=subprocess.DEVNULL)  # fmt: skip
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()
        raise MatrixError(f"{what}: exit status {done.returncode}: {lines[0]}")
    return done.stdout + done.stderr


def includes() -> list[str]:
    """Return the folders of headers."""
    folders = [ROOT / "firmware" / module / "include" for module in MODULES]
    folders += [ROOT / "host_sim" / part / "include" for part in ("bench", "plant", "exchange")]
    folders += [PIL, PORT, TARGET, ROOT / "tests" / "unit" / "firmware" / "support"]
    return [f"-I{folder}" for folder in folders]


def compiled(cell: Cell, program: str) -> Path:
    """Compile what has changed of one program of a cell, link it, and return it."""
    directory = OUTPUT / "".join(c if c.isalnum() else "_" for c in cell.name)
    directory.mkdir(parents=True, exist_ok=True)
    if shutil.which(cell.compiler) is None:
        raise MatrixError(f"{cell.compiler} was not found, './tools/dev setup' installs it")
    caching = os.environ.get("CMAKE_C_COMPILER_LAUNCHER")
    compiler = [caching, cell.compiler] if caching else [cell.compiler]
    own = ["-DCORE32_SERVES"] if program == "pil" else ["-Dmain=trace_main"] * cell.is_x86_32
    modules = [
        path
        for module in MODULES
        for path in sorted((ROOT / "firmware" / module).glob("*.c"))
        if not path.stem.endswith("_absent")  # what a port leaves out
    ]
    image = ROOT / "firmware" / "config" / "generated" / f"{CONFIG}.c"

    def one(source: Path) -> Path:
        shared = source in modules or source == image
        made = directory / f"{'' if shared else program}_{source.parent.name}_{source.stem}.o"
        what = f"{cell.name}: {source.name}"
        if not (shared and program == "pil"):  # the trace's, compiled just before
            alias = f"-DCONFIG_{CONFIG.upper()}=CONFIG_IMAGE"
            flags = [*cell.flags, "-std=c11", alias, *([] if shared else own), *includes()]
            command = [*compiler, *flags, "-c", str(source)]
            compile_if_changed(command, made, lambda words: executed(words, what))
        return made

    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        objects = list(pool.map(one, [*modules, image, *cell.sources(program)]))
    made = directory / program
    executed([cell.compiler, *objects, *cell.link, "-o", made], f"{cell.name}: linking {program}")
    return made


def sequences(cell: Cell, program: Path) -> dict[str, str]:
    """Return the hash of every trace sequence."""
    command: list[str | Path] = [program]
    if cell.machine:
        command = ["qemu-system-arm", "-M", cell.machine, "-display", "none", "-monitor", "none",
                   "-serial", "null", "-semihosting-config", "enable=on,target=native",
                   "-kernel", program]  # fmt: skip
    lines = executed(command, f"{cell.name}: trace sequences").splitlines()
    return {name: crc for crc, _, name in (line.partition("  ") for line in lines)}


def command_of(cell: Cell, program: Path) -> emulator.Command:
    """Return how the cell's processor is started."""
    if not cell.machine:
        return lambda memory: [str(program), memory]
    plugin = emulator.build_directory() / emulator.PLUGIN
    return emulator.machine("qemu-system-arm", program, plugin, cell.machine)


def last_event_s(events: Sequence[Event]) -> float:
    """Return when the last thing happens that a scenario plans, s."""
    return max((e.until_s or e.at_s + e.over_s for e in events), default=0.0)


def scenario_hash(name: str, processor: emulator.Command | None, whole: bool) -> str:
    """Return the hash of all recorded signals and figures of a run."""
    _, chosen, _ = scenario.load(name, {})
    given = {"record_interval_s": INTERVAL_OF_CYCLES_S if chosen.follows else INTERVAL_S}
    most_s = LONG.get(name, chosen.max_duration_s)
    if not whole:
        most_s = min(most_s, last_event_s(list(chosen.events.values())) + AFTER_EVENT_S)
    title, chosen, beside = scenario.load(name, given | {"max_duration_s": most_s})
    drive = overrides.load_drive(DRIVE, overrides.parse([]), chosen)
    result = run.simulate(title, drive, chosen, beside, ("*",), processor=processor)
    outcomes = [o.as_object() for o in evaluation.evaluate(chosen, drive, result)] * whole
    figures = json_object(replace(result, criteria=outcomes))
    for key in ("provenance", "realtime_factor"):
        del figures[key]
    text = json.dumps(figures, sort_keys=True)
    return hashlib.sha256(result.rows.tobytes() + text.encode()).hexdigest()[:8].upper()


def row(cell: Cell, names: Sequence[str], whole: bool) -> dict[str, str]:
    """Return all hashes of a cell by the name of what was hashed."""
    found = sequences(cell, compiled(cell, "trace"))
    if names:
        processor = command_of(cell, compiled(cell, "pil"))
        found |= {name: scenario_hash(name, processor, whole) for name in names}
    return found


def folded(hashes: dict[str, str], names: Sequence[str]) -> str:
    """Return one hash of several."""
    return hashlib.sha256(" ".join(hashes[name] for name in names).encode()).hexdigest()[:8].upper()


def main() -> int:
    """Print one row a cell, and every hash that is not the first cell's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--whole", action="store_true", help="scenarios to their end")
    parser.add_argument("--cells", metavar="TEXT,...", help="whose names contain one of these")
    parser.add_argument("--scenarios", metavar="NAME,...", help="'' for none; default: all")
    options = parser.parse_args()
    wanted = options.cells.split(",") if options.cells else [""]
    cells = [cell for cell in CELLS if any(text in cell.name for text in wanted)]
    names = scenario.builtin_names()
    if options.scenarios is not None:
        names = [name for name in options.scenarios.split(",") if name]
    here = {name: scenario_hash(name, None, options.whole) for name in names}
    apart = []
    print("| cell | trace sequences | scenarios |\n| --- | --- | --- |", flush=True)
    if names:
        print(f"| engine of hubsim, gcc -O3, LTO | | {folded(here, names)} |", flush=True)
    for cell in cells:
        found = row(cell, names, options.whole)
        of_trace = [name for name in found if name not in names]
        if not here.keys() & of_trace:
            here |= {name: found[name] for name in of_trace}
        print(f"| {cell.name} | {folded(found, of_trace)} "
              f"| {folded(found, names) if names else ''} |", flush=True)  # fmt: skip
        apart += [f"{cell.name}: {k}: {v}, not {here.get(k)}" for k, v in found.items()
                  if here.get(k) != v]  # fmt: skip
        if found.keys() != here.keys():
            apart.append(f"{cell.name}: {len(found)} hashes instead of {len(here)}")
    print(f"{len(here)} hashes in each of {len(cells)} cells, {len(apart)} differ")
    for line in apart:
        print(line)
    return 1 if apart else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except MatrixError as error:
        print(f"matrix: {error}", file=sys.stderr)
        sys.exit(1)
