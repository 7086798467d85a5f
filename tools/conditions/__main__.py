# SPDX-License-Identifier: Apache-2.0
"""``python -m conditions``: what ``tools/dev coverage --mcdc`` calls."""

import argparse
import os
import sys
from pathlib import Path

from conditions import measure
from conditions.measure import MODULES, ROOT, ConditionsError
from conditions.reached import Module, modules_of

LEAST = 0.95


def line_of(module: Module) -> str:
    """Return a module's line of the table."""
    return (
        f"{module.name:<10} {module.branches_reached:>4} of {module.branches:<4}"
        f" {module.conditions_shown:>4} of {module.conditions:<4}"
    ).rstrip()


def main() -> int:
    """Build and run the unit tests, print table and what is missing; fail below the least share."""
    parser = argparse.ArgumentParser(prog="tools/dev coverage --mcdc")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N")
    parser.add_argument("--least", type=float, default=LEAST, metavar="SHARE")
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        parser.error("--jobs needs a number of at least 1")
    if not 0.0 <= arguments.least <= 1.0:
        parser.error("--least needs a share from 0 to 1")
    try:
        export = measure.run(arguments.jobs)
    except (ConditionsError, ValueError) as error:
        print(f"tools/dev coverage --mcdc: {error}", file=sys.stderr)
        return 1
    found = modules_of(export, ROOT / "firmware", MODULES, Path.read_text)
    print(f"{'module':<10} {'branches':>12} {'MC/DC':>12}")
    for module in found:
        print(line_of(module))
    for module in found:
        for missing in module.missing:
            print(missing)
    low = [module.name for module in found if module.share < arguments.least]
    if low:
        print(f"below {100 * arguments.least:g} %: {' '.join(low)}")
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main())
