# SPDX-License-Identifier: Apache-2.0
"""``python -m conditions``: what ``tools/dev coverage --mcdc`` calls."""

import argparse
import os
import sys
from pathlib import Path

from conditions import measure
from conditions.explained import Table
from conditions.measure import MODULES, ROOT, ConditionsError
from conditions.reached import Module, modules_of

TABLE = ROOT / "tests" / "conditions" / "explained.toml"


def line_of(module: Module, explained: int) -> str:
    """Return a module's line of the table."""
    return (
        f"{module.name:<10} {module.branches_reached:>4} of {module.branches:<4}"
        f" {module.conditions_shown:>4} of {module.conditions:<4} {explained:>9}"
    )


def main() -> int:
    """Build and run the unit tests, print the table; fail with what is not explained."""
    parser = argparse.ArgumentParser(prog="tools/dev coverage --mcdc")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N")
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        parser.error("--jobs needs a number of at least 1")
    try:
        export = measure.run(arguments.jobs)
        table = Table(TABLE)
    except (ConditionsError, ValueError) as error:
        print(f"tools/dev coverage --mcdc: {error}", file=sys.stderr)
        return 1
    found = modules_of(export, ROOT / "firmware", MODULES, Path.read_text)
    print(f"{'module':<10} {'branches':>12} {'MC/DC':>12} {'explained':>9}")
    wrong = list(table.wrong)
    missing: set[str] = set()
    for module in found:
        known = [one for one in module.missing if one.name in table.reasons]
        print(line_of(module, len(known)))
        missing |= {one.name for one in module.missing}
        wrong += [
            f"{one.where}: {one.name}" for one in module.missing if one.name not in table.reasons
        ]
    wrong += [f"stale: {name}" for name in sorted(table.reasons.keys() - missing)]
    for text in wrong:
        print(text)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
