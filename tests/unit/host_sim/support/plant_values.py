# SPDX-License-Identifier: Apache-2.0
"""Write drives' plant parameters as C tables, for tests that run without Python.

``plant_values.py OUT.c DRIVE.toml...``.
"""

import sys
from pathlib import Path

from hubsim.run import plant
from regen_table import schema


def tables(source: Path) -> list[str]:
    """Lines of C with one drive's parameters and voltage curve."""
    drive = schema.load(source)
    soc, volts = plant.voltage_curve(drive)
    values = plant.parameters(drive)
    lines = [f"static const plant_value_t VALUES_{source.stem}[] = {{"]
    lines += [f'    {{"{name}", {value!r}}},' for name, value in values.items()]
    lines += ["};", f"static const double SOC_{source.stem}[] = {{{', '.join(map(repr, soc))}}};"]
    lines += [f"static const double VOLTAGE_V_{source.stem}[] = {{{', '.join(map(repr, volts))}}};"]
    return lines


def entry(source: Path) -> str:
    """One drive's line in the table of drives."""
    name = source.stem
    count = f"(int)(sizeof VALUES_{name} / sizeof VALUES_{name}[0])"
    points = f"(int)(sizeof SOC_{name} / sizeof SOC_{name}[0])"
    return f'    {{"{name}", VALUES_{name}, {count}, SOC_{name}, VOLTAGE_V_{name}, {points}}},'


def main() -> int:
    """Read the drives, write the tables."""
    target, *sources = (Path(argument) for argument in sys.argv[1:])
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0 */",
        "/* Plant parameters of the drives. */",
        '#include "plant_values.h"',
        "",
    ]
    for source in sources:
        lines += tables(source)
    lines += ["const plant_drive_t PLANT_DRIVES[] = {", *map(entry, sources), "};"]
    lines += [f"const int PLANT_DRIVES_COUNT = {len(sources)};", ""]
    target.write_text("\n".join(lines), encoding="utf-8")
    return 0


sys.exit(main())
