# SPDX-License-Identifier: Apache-2.0
"""The list of runs of the reduced sweep that miss a limit; run as a program: write it anew."""

from collections.abc import Sequence
from pathlib import Path

from hubsim.sweep import faults_sweep
from hubsim.sweep.faults_outcome import Outcome

LIST = Path(__file__).with_name("fault_misses.txt")
HEAD = "# Runs of 'hubsim faults --reduced' that miss a limit: fault, vehicle, sensor, s: limits\n"


def as_text(outcomes: Sequence[Outcome], slack: float = 0.0) -> str:
    """Return a line for each run that misses a limit widened by this share."""
    lines = [
        f"{o.fault}, {o.config}, {o.rotor_sensor}, {o.situation} {o.demand_nm:g} N m, "
        f"{o.instant_s:g} s: {', '.join(o.misses(slack))}\n"
        for o in outcomes
        if o.misses(slack)
    ]
    return HEAD + "".join(sorted(lines))


def listed(text: str) -> dict[str, list[str]]:
    """Return the limits that each run misses."""
    pairs = [line.split(": ") for line in text.splitlines() if not line.startswith("#")]
    return {run: limits.split(", ") for run, limits in pairs}


if __name__ == "__main__":
    lots = list(faults_sweep.tasks(faults_sweep.reduced()))
    made = [outcome for group, several in lots for outcome in faults_sweep.measure(group, several)]
    LIST.write_text(as_text(made), encoding="utf-8")
