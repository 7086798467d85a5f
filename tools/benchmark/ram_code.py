# SPDX-License-Identifier: Apache-2.0
"""Whether the code in RAM needs the flash, which cannot be read while it is erased or written.

    python -m benchmark.ram_code IMAGE...

Of each linked image, every function in RAM may call functions in RAM alone, and none of its
constants may be an address in the flash, as that of a table is. Exit status 1 if one is, or if an
image has no code in RAM.
"""

from __future__ import annotations

import sys
from pathlib import Path

from benchmark import elf
from benchmark.elf import RAM_BEGINS

FLASH = range(0x08000000, 0x10000000)
"""Where both chips have their flash (RM0090 section 2.3, RM0440 section 2.2.2)."""


def needs(functions: dict[str, elf.Function]) -> list[str]:
    """Say what functions in RAM call or read in the flash."""
    in_ram = {name: f for name, f in functions.items() if f.address >= RAM_BEGINS}
    if not in_ram:
        return ["there is no code in RAM"]
    found = []
    for name, function in sorted(in_ram.items()):
        if function.indirect:
            found.append(f"{name} calls through a pointer")
        found += [
            f"{name} calls {called}" for called in sorted(function.calls) if called not in in_ram
        ]
        found += [
            f"{name} has the address {word:#x}" for word in sorted(function.words) if word in FLASH
        ]
    return found


def main(images: list[str]) -> int:
    """Examine images."""
    complaints = [
        f"{Path(image).name}: {text}"
        for image in images
        for text in needs(elf.functions(Path(image)))
    ]
    for complaint in complaints:
        print(f"ram_code: {complaint}", file=sys.stderr)
    return 1 if complaints or not images else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
