# SPDX-License-Identifier: Apache-2.0
"""The modules of the firmware.

Permitted includes, files of a module, and C text without comments and strings.
"""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"

# What a module may include besides itself: core <- config <- foc, motor, monitor, modes, pedals <-
# torque <- controller <- app -> hal.
MAY_INCLUDE: dict[str, tuple[str, ...]] = {
    "core": (),
    "config": ("core",),
    "foc": ("core", "config"),
    "motor": ("core", "config"),
    "torque": ("core", "config", "motor"),
    "monitor": ("core", "config"),
    "modes": ("core", "config"),
    "pedals": ("core", "config"),
    "comms": ("core", "config"),
    "controller": ("core", "config", "foc", "motor", "torque", "monitor", "modes"),
    "app": (
        "core",
        "config",
        "foc",
        "motor",
        "torque",
        "monitor",
        "modes",
        "pedals",
        "comms",
        "controller",
        "hal",
    ),
}

# Pure: state, configuration and inputs in, outputs out, without access to hardware or the C
# library.
PURE = ("core", "config", "foc", "motor", "torque", "monitor", "modes", "pedals", "controller")

WARNINGS = [
    *(
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wconversion",
        "-Wshadow",
        "-Wundef",
        "-Wswitch-enum",
        "-Wmissing-prototypes",
    ),
    *("-Wstrict-prototypes", "-Wcast-align"),
]
# ISO C without compiler extensions.
STRICT_C = ["-std=c11", "-pedantic-errors", *WARNINGS]


def files_of(module: str) -> list[Path]:
    """Return every C file of a module but those a generator wrote."""
    found = [path for pattern in ("*.c", "*.h") for path in (FIRMWARE / module).rglob(pattern)]
    return sorted(path for path in found if "generated" not in path.parts)


def sources_of(module: str) -> list[Path]:
    return [path for path in files_of(module) if path.suffix == ".c"]


def include_options(module: str) -> list[str]:
    """Return the -I options a module is compiled with.

    Its own headers and those of the modules it may include.
    """
    visible = (module, *MAY_INCLUDE[module])
    return [
        f"-I{ROOT / 'hal/include' if name == 'hal' else FIRMWARE / name / 'include'}"
        for name in visible
    ]


def includes_in(text: str) -> list[tuple[str, str]]:
    """Return (kind, name) of every include: ('"', "core/q15.h") or ("<", "stdint.h")."""
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', text, re.MULTILINE)


def code_only(text: str) -> str:
    """Return C text with comments, strings and characters blanked, so that only code can be found
    in it.
    """
    pattern = re.compile(
        r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL
    )
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
