# SPDX-License-Identifier: Apache-2.0
"""Units for co-simulation (FMI 2.0 and 3.0).

Model descriptions and packages, made from the lists the C code is made of.

python -m hubsim.fmu table --kind controller|vehicle --config DRIVE.toml -o table.c
python -m hubsim.fmu pack --kind ... --config ... --fmi 2|3 --binary LIBRARY --sources LIST --table
table.c -o UNIT.fmu
"""

KINDS = ("controller", "vehicle")
