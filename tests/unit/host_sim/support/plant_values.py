"""Write a drive's plant parameters as a C table, for tests that run without Python: ``plant_values.py DRIVE.toml OUT.c``."""

import sys
from pathlib import Path

from hubsim import plant
from regen_table import schema


def main() -> int:
    """Read the drive, write the table."""
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    drive = schema.load(source)
    soc, volts = plant.voltage_curve(drive)
    lines = [f"/* Plant parameters of {source.name}. */", '#include "plant_values.h"', "", "const plant_value_t PLANT_VALUES[] = {"]
    lines += [f'    {{"{name}", {value!r}}},' for name, value in plant.parameters(drive).items()]
    lines += ["};", f"const int PLANT_VALUES_COUNT = {len(plant.parameters(drive))};"]
    lines += [f"const double PLANT_SOC[] = {{{', '.join(map(repr, soc))}}};"]
    lines += [f"const double PLANT_VOLTAGE_V[] = {{{', '.join(map(repr, volts))}}};", f"const int PLANT_VOLTAGE_POINTS = {len(soc)};", ""]
    target.write_text("\n".join(lines), encoding="utf-8")
    return 0


sys.exit(main())
