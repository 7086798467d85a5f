# SPDX-License-Identifier: Apache-2.0
"""The programs that are measured.

The firmware's modules with a closed loop around them, for each core, and the plugin.
"""

from __future__ import annotations

import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from benchmark.functions import FUNCTIONS
from benchmark.objects import compile_if_changed

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
IMAGES = ROOT / "firmware" / "config" / "generated"
MODULES = ("core", "config", "foc", "motor", "torque", "monitor", "modes", "controller")
OPTIMISE = ROOT / "tools" / "cmake" / "optimise.txt"
WHOLE_OBJECTS = ["-flto", "-ffat-lto-objects"]
"""Of the modules, as in the images (HubfocModule.cmake)."""
WHOLE_PROGRAM = ["-flto", "-flto-partition=one", "-fcallgraph-info=su"]
PREFIX = "arm-none-eabi-"
PLUGIN_INTERFACES = (1, 4, 3, 2, 5)
"""Versions of QEMU's plugin interface, tried in turn: 1 of QEMU 7 and 8, 4 of QEMU 10."""


class BenchError(Exception):
    """Something is missing or went wrong; the message is one line for the user."""


@dataclass(frozen=True)
class Core:
    """A core to build for, and the emulated machine that runs its code."""

    name: str
    flags: tuple[str, ...]
    optimise: str
    machine: str


CORES = (
    Core(
        "cortex-m4",
        ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
        "-O2",
        "mps2-an386",
    ),
    Core("cortex-m3", ("-mcpu=cortex-m3", "-mthumb"), "-O2", "mps2-an385"),
    # No emulated board has a Cortex-M0+ with enough memory; its instruction set is a subset of the
    # M4's.
    Core("cortex-m0plus", ("-mcpu=cortex-m0plus", "-mthumb"), "-Os", "mps2-an386"),
)


def tool(name: str, package: str) -> str:
    """Path of a program, or an error that names the package to install."""
    found = shutil.which(name)
    if not found:
        raise BenchError(f"{name} was not found; ./tools/dev setup installs it (package {package})")
    return found


def run(command: list[str], what: str, typed: str | None = None, **options: float) -> str:
    """Run a program and return its output; an error with its last line otherwise.

    typed: what it reads from its standard input.
    """
    try:
        done = subprocess.run(
            command,
            input=typed,
            capture_output=True,
            text=True,
            check=False,
            timeout=options.get("timeout_s", 300.0),
        )
    except subprocess.TimeoutExpired as error:
        raise BenchError(f"{what}: no end after {error.timeout:.0f} s") from error
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()
        raise BenchError(f"{what}: exit status {done.returncode}: {lines[-1]}")
    return done.stdout + done.stderr


def configurations() -> list[str]:
    """Names of the configurations that are checked in, in alphabetical order."""
    return sorted(path.stem for path in IMAGES.glob("*.c"))


def shared_sources() -> list[Path]:
    """Everything that goes into both measured programs, besides a configuration."""
    modules = [
        path
        for module in MODULES
        for path in sorted((ROOT / "firmware" / module).glob("*.c"))
        if not path.stem.endswith("_absent")  # what a port leaves out
    ]
    port, core = ROOT / "hal" / "qemu_mps2", ROOT / "hal" / "cortex_m"
    return [
        *modules,
        port / "semihost.c",
        port / "startup.c",
        core / "copy.c",
        core / "divide64.c",
    ]


def optimisation() -> tuple[dict[Path, list[str]], set[Path]]:
    """Return the flags of folders and files of the firmware, and the files compiled for size."""
    lines = [line.split() for line in OPTIMISE.read_text().splitlines() if not line.startswith("#")]
    flags: dict[Path, list[str]] = {}
    for kind, *words in lines:
        if kind in {"flags", "file"}:
            flags.setdefault(ROOT / "firmware" / words[0], []).extend(words[1:])
    size = {ROOT / "firmware" / words[0] for kind, *words in lines if kind == "size"}
    return flags, size


def compile_sources(core: Core, sources: list[Path], directory: Path) -> list[str]:
    """Compile what has changed of sources for one core and return the objects, in their order.

    The compiler leaves its stack figures in the same directory, in which nothing else stays.
    """
    compiler = tool(PREFIX + "gcc", "gcc-arm-none-eabi")
    directory.mkdir(parents=True, exist_ok=True)
    stems = {f"{source.parent.name}_{source.stem}" for source in sources}
    for path in directory.iterdir():
        if path.name.partition(".")[0] not in stems:
            path.unlink()
    includes = [ROOT / "firmware" / module / "include" for module in MODULES] + [
        ROOT / "hal" / "qemu_mps2",
        ROOT / "tests" / "unit" / "firmware" / "support",
    ]
    flags, for_size = optimisation()
    common = [
        *core.flags,
        "-std=c11",
        "-ffunction-sections",
        "-fdata-sections",
        "-fno-common",
    ]
    common += ["-fcallgraph-info=su", "-include", str(ROOT / "hal" / "cortex_m" / "saturate.h")]
    common += [f"-I{path}" for path in includes]
    modules = {ROOT / "firmware" / module for module in MODULES}

    def compile_one(source: Path) -> str:
        target = directory / f"{source.parent.name}_{source.stem}.o"
        small = source in for_size or source.parent.name == "cortex_m"
        optimise = ["-Os" if small else core.optimise]
        optimise += flags.get(source.parent, []) + flags.get(source, [])
        optimise += WHOLE_OBJECTS if source.parent in modules and core is CORES[0] else []
        what = f"compiling {source.relative_to(ROOT)} for {core.name}"
        command = [compiler, *common, *optimise, "-c", str(source)]
        compile_if_changed(command, target, lambda words: run(words, what))
        return str(target)

    with ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(compile_one, sources))


def compile_program(
    core: Core,
    program: str,
    configs: list[str],
    directory: Path,
    shared: list[str],
    whole: bool = True,
) -> list[Path]:
    """Compile a program for one core and make it with each of the configurations.

    It is linked with the first of them; in copies the bytes of the others, which are as many and
    which no code was optimised for, are in their place.

    shared: the objects of `shared_sources` for this core. whole: on the core of the images the
    modules are optimised once more when they are linked, as there; else each function stays one.
    Returns the ELFs, in the order of the configurations.
    """
    compiler = tool(PREFIX + "gcc", "gcc-arm-none-eabi")
    images = [IMAGES / f"{config}.c" for config in configs]
    for config, image in zip(configs, images, strict=True):
        if not image.is_file():
            raise BenchError(
                f"no configuration firmware/config/generated/{config}.c; ./tools/dev table makes it"
            )
    own = sorted((HERE / program).glob("*.c"))
    objects = compile_sources(core, [*own, images[0]], directory)
    script = ROOT / "hal" / "qemu_mps2" / "link.ld"
    link = [
        core.optimise,
        *(WHOLE_PROGRAM if whole and core is CORES[0] else ["-fno-lto"]),
        "-nostartfiles",
        "--specs=nano.specs",
        f"-T{script}",
        "-Wl,--gc-sections",
        "-Wl,--defsym=link_stack_size=0x4000",
        *(f"-Wl,--undefined={name}" for name in FUNCTIONS),
    ]

    elfs = [directory / f"{program}_{name}{'' if whole else '_parts'}.elf" for name in configs]
    symbol = "".join(c if c.isalnum() else "_" for c in configs[0]).upper()
    alias = f"-Wl,--defsym=CONFIG_IMAGE=CONFIG_{symbol}"
    run(
        [compiler, *core.flags, *link, alias, *shared, *objects, "-lm", "-o", str(elfs[0])],
        f"linking {program} with {configs[0]} for {core.name}",
    )
    linked, first = elfs[0].read_bytes(), images[0].with_suffix(".bin").read_bytes()
    for elf, image in zip(elfs[1:], images[1:], strict=True):
        other = image.with_suffix(".bin").read_bytes()
        if linked.count(first) != 1 or len(other) != len(first):
            raise BenchError(f"{elfs[0].name}: not the bytes of {configs[0]}.bin, once")
        elf.write_bytes(linked.replace(first, other))
    return elfs


def compile_plugin(interface: int, directory: Path) -> Path:
    """Compile the counting plugin for one version of the emulator's interface."""
    compiler = shutil.which("cc") or tool("gcc", "gcc")
    plugin = directory / f"count_api{interface}.so"
    flags = [
        "-std=c11",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-fPIC",
        "-shared",
        "-fvisibility=hidden",
        f"-DQEMU_PLUGIN_API={interface}",
    ]
    run(
        [compiler, *flags, str(HERE / "plugin.c"), "-o", str(plugin)],
        "compiling the counting plugin",
    )
    return plugin
