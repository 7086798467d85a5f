# SPDX-License-Identifier: Apache-2.0
"""Processor time of every built-in scenario, of the latest run of the tests pil_SCENARIO.

ctest --preset qemu -L full -R '^pil_'
./tools/dev python tests/target/pil/times.py        the table of host_sim/pil/README.md
"""

import json
import os
from pathlib import Path

from hubsim import emulator, scenario

ENGINE, LOOP, EMULATOR = "engine_s", "loop_s", "emulator_s"


def spent_s() -> tuple[float, float]:
    """Return processor time of this process and of its children that have ended, s."""
    now = os.times()
    return now.user + now.system, now.children_user + now.children_system


def folder() -> Path:
    """Return where the tests leave their times."""
    return emulator.build_directory() / "pil_times"


def note(name: str, simulated_s: float, spent: list[tuple[float, float]]) -> None:
    """Keep the times before the engine's own run, between both runs, and after the emulated one."""
    (before, _), (between, children), (after, children_after) = spent
    folder().mkdir(parents=True, exist_ok=True)
    found = {"simulated_s": simulated_s, ENGINE: between - before, LOOP: after - between,
             EMULATOR: children_after - children}  # fmt: skip
    (folder() / f"{name}.json").write_text(json.dumps(found) + "\n")


def main() -> None:
    """Print the table, in seconds; a scenario that was not run is left out."""
    print("| scenario | simulated | engine alone | engine in the loop | emulator |")
    print("|---|---|---|---|---|")
    kept = {path.stem: json.loads(path.read_text()) for path in folder().glob("*.json")}
    rows = {name: kept[name] for name in scenario.builtin_names() if name in kept}
    for name, row in rows.items():
        print(f"| `{name}` | " + " | ".join(f"{value:.1f}" for value in row.values()) + " |")
    sums = [sum(values) for values in zip(*(row.values() for row in rows.values()), strict=True)]
    print(f"| {len(rows)} scenarios | " + " | ".join(f"{value:.0f}" for value in sums) + " |")


if __name__ == "__main__":
    main()
