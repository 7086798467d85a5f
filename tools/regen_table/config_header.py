# SPDX-License-Identifier: Apache-2.0
"""The header config/config.h with its macros expanded, as text that ``layout`` understands.

The header is run through the C preprocessor of whatever compiler is at hand (``$CC``, cc, gcc,
clang or arm-none-eabi-gcc). An installed distribution has the result instead of the header
(host_sim/python/bake.py) and needs no compiler.
"""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

from regen_table import installation
from regen_table.errors import ConfigurationError

HEADER = installation.ROOT / "firmware" / "config" / "include" / "config" / "config.h"
# What an installed distribution has in the place of the header.
EXPANDED = installation.ROOT / "config_header.i"
LISTS_BEGIN = "regen_lists_begin"
_COMPILERS = ("cc", "gcc", "clang", "arm-none-eabi-gcc")


def expanded(header: Path = HEADER) -> str:
    """Return the declarations, then what stands in the field lists and constants."""
    if installation.INSTALLED and header == HEADER:
        return EXPANDED.read_text(encoding="utf-8")
    try:
        text = header.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{header}: cannot be read: {error.strerror}") from error
    lists = re.findall(
        r"^#define\s+(CONFIG_\w+_(?:FIELDS|ARRAY))\((\w)\)", text, flags=re.MULTILINE
    )
    constants = [
        name
        for name in re.findall(r"^#define\s+(CONFIG_\w+)[ \t]+\S", text, flags=re.MULTILINE)
        if not name.endswith(("_MEMBER", "_FIELDS", "_ARRAY"))
    ]
    # Standard headers say nothing about the layout, and cffi knows the fixed-width types by itself.
    bare = re.sub(r"^\s*#\s*include\s*<[^>]*>", "", text, flags=re.MULTILINE)
    source = [bare, LISTS_BEGIN]
    source.append(
        "#define REGEN_SCALAR(name, lowest, highest, unit, text) "
        "regen_field(name, 0, lowest, highest, unit, text) regen_end"
    )
    source.append(
        "#define REGEN_ARRAY(name, count, lowest, highest, unit, text) "
        "regen_field(name, count, lowest, highest, unit, text) regen_end"
    )
    source += [
        f'regen_list("{name}"); {name}({"REGEN_SCALAR" if letter == "X" else "REGEN_ARRAY"})'
        for name, letter in lists
    ]
    source += [f'regen_constant("{name}", {name});' for name in constants]
    return _preprocess("\n".join(source) + "\n", header)


def _preprocess(source: str, header: Path) -> str:
    """Run the first C preprocessor found over a text."""
    named = os.environ.get("CC")
    candidates = [shlex.split(named)] if named else []
    candidates += [[name] for name in _COMPILERS]
    command = next((c for c in candidates if shutil.which(c[0])), None)
    if command is None:
        raise ConfigurationError(
            f"no C preprocessor found to read {header.name}: "
            f"install one of {', '.join(_COMPILERS)} or set CC"
        )
    arguments = [*command, "-E", "-P", "-x", "c", "-I", str(header.parents[1]), "-"]
    done = subprocess.run(arguments, input=source, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = next(iter(done.stderr.strip().splitlines()), "no message")
        raise ConfigurationError(f"{header}: {command[0]} refused it: {reason}")
    return done.stdout
