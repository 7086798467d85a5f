# SPDX-License-Identifier: Apache-2.0
"""What is run: the parts of the oracle, divided into tasks of at most some seconds."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from oracle import programs, simulation
from oracle.baseline import Hashes, OracleError
from oracle.programs import Reached

DEFAULT = "lu2013"
CYCLE = "ece15"
LONG_SCENARIOS = {"udds": 30.0, CYCLE: 5.0, "descent_full": 6.0}  # s of processor time; not quick
# Entries of the programs with random inputs, and how many of them are quick.
RANDOM = {"random_slow": (75, 25), "random_fast": (20, 10), "application": (20, 10)}
ENTRIES_A_TASK = 5
QUICK_FAULTS = 3  # one of so many

# Of the built-in scenarios, what suits the other drives.
EVERY_DRIVE = (
    *("stop", "hill_hold", "contactor", "rotor_sensor_lost", "full_midstop", "hot_derate"),
    *("hall_dropout", "rolling_start", "hydraulic_weak", "demand_timeout", "lift_off"),
)
OTHER_DRIVES = {
    "ebike36v": (*EVERY_DRIVE, "reverse", "hill_start", "hydraulic_dead", "pedal_free_travel"),
    "scooter48v": (*EVERY_DRIVE, "direction", "low_bus_stop", "pedal_series", "overspeed"),
    "ipm400v": (*EVERY_DRIVE, "reverse", "ramp150", "no_other_brake", "pedal_ratio", "abs_flag"),
    "bench/wheel24v": (
        *("stop", "contactor", "rotor_sensor_lost", "full_midstop"),
        *("direction", "hill_hold", "lift_off", "reverse", "pedal_series"),
    ),
}
SLOW_DRIVES = {"bench/wheel24v": 12.0}  # km/h at which what begins faster begins


@dataclass(frozen=True)
class Done:
    """What a task has found, and the processor time it took; why it ended early, if it did."""

    part: str
    label: str
    entries: dict[str, Hashes]
    reached: Reached
    cpu_s: float
    failure: str = ""


@dataclass(frozen=True)
class Listing:
    """A file for every change of a value of one entry."""

    entry: str
    path: Path


Listed = Listing | None


@dataclass(frozen=True)
class ProgramTask:
    """Entries of a C program, in ``numbers`` from the first to the one before the end."""

    part: str
    numbers: tuple[int, int] | None
    cost: float

    @property
    def label(self) -> str:
        """Return it in words."""
        return "all" if self.numbers is None else f"{self.numbers[0]} to {self.numbers[1] - 1}"

    def run(self, listed: Listed) -> tuple[dict[str, Hashes], Reached]:
        """Run it, with the values of one entry listed."""
        arguments: list[object] = list(self.numbers or ())
        if listed is not None:
            names = list(programs.run(self.part, arguments)[0])
            arguments += ["--values", listed.path, names.index(listed.entry)]
        return programs.run(self.part, arguments, self.part == "application")

    def has(self, entry: str) -> bool:
        """Whether it is one of these entries, whose names end with their numbers."""
        if self.numbers is None:
            return True
        number = entry.rsplit(maxsplit=1)[-1]
        return number.isdecimal() and self.numbers[0] <= int(number) < self.numbers[1]


@dataclass(frozen=True)
class ScenarioTask:
    """A scenario with one drive."""

    part: str
    name: str
    drive: str = DEFAULT
    settings: Mapping[str, object] = field(default_factory=dict)
    strategy: str | None = None
    cost: float = 0.5

    @property
    def label(self) -> str:
        """Return the entry's name."""
        return " ".join([self.name, *([] if self.drive == DEFAULT else [self.drive]),
                         *([] if self.strategy is None else [self.strategy])])  # fmt: skip

    def run(self, listed: Listed) -> tuple[dict[str, Hashes], Reached]:
        """Run it, with its values listed."""
        before = simulation.oracle().reached()
        simulation.oracle().list_values(None if listed is None else listed.path)
        hashes = simulation.run_scenario(self.name, self.drive, self.settings, self.strategy)
        simulation.oracle().list_values(None)
        return {self.label: hashes}, _since(before)

    def has(self, entry: str) -> bool:
        """Whether it is this entry."""
        return entry == self.label


@dataclass(frozen=True)
class FaultTask:
    """Faults that share their beginning."""

    part: str
    beginning: simulation.Beginning
    runs: tuple[simulation.FaultRun, ...]
    cost: float

    @property
    def label(self) -> str:
        """Return it in words."""
        return f"{len(self.runs)} of {self.beginning.name()}"

    def run(self, listed: Listed) -> tuple[dict[str, Hashes], Reached]:
        """Run it, with the values of one entry listed."""
        before = simulation.oracle().reached()
        files = {} if listed is None else {listed.entry: listed.path}
        entries = dict(simulation.run_faults(self.beginning, self.runs, files))
        return entries, _since(before)

    def has(self, entry: str) -> bool:
        """Whether it is one of these entries."""
        return entry in [self.beginning.name(), *(one.name() for one in self.runs)]


Task = ProgramTask | ScenarioTask | FaultTask


def _since(before: Reached) -> Reached:
    now = simulation.oracle().reached()
    return {key: steps - before.get(key, 0) for key, steps in now.items()}


def done(task: Task, listed: Listed = None) -> Done:
    """Run a task. A run that cannot go on, as of a battery that collapses, is a finding too."""
    begun = _cpu_s()
    try:
        entries, reached = task.run(listed)
    except (OracleError, simulation.RunError) as error:
        return Done(task.part, task.label, {}, {}, _cpu_s() - begun, str(error))
    return Done(task.part, task.label, entries, reached, _cpu_s() - begun)


def _cpu_s() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


# ---- the plan ----


def _random(part: str, quick: bool) -> list[Task]:
    count = RANDOM[part][1 if quick else 0]
    return [
        ProgramTask(part, (k, min(k + ENTRIES_A_TASK, count)), 0.4)
        for k in range(0, count, ENTRIES_A_TASK)
    ]


def _scenarios(quick: bool) -> list[Task]:
    names = [n for n in simulation.builtin_scenarios() if not (quick and n in LONG_SCENARIOS)]
    own = [ScenarioTask("scenarios", n, cost=LONG_SCENARIOS.get(n, 0.5)) for n in names]
    others = [
        ScenarioTask("scenarios", name, drive, _settings(name, drive))
        for drive, several in OTHER_DRIVES.items()
        for name in several
    ]
    return [*own, *others]


def _settings(name: str, drive: str) -> dict[str, object]:
    most_kmh = SLOW_DRIVES.get(drive)
    begins_kmh = simulation.initial_speed_kmh(name)
    return {} if most_kmh is None or begins_kmh <= most_kmh else {"initial_speed_kmh": most_kmh}


def _cycle(quick: bool) -> list[Task]:
    cost = LONG_SCENARIOS[CYCLE]
    several = [] if quick else simulation.STRATEGIES
    return [ScenarioTask("cycle", CYCLE, strategy=one, cost=cost) for one in several]


def _faults(quick: bool) -> list[Task]:
    groups: dict[simulation.Beginning, list[simulation.FaultRun]] = {}
    for one in simulation.fault_runs()[:: QUICK_FAULTS if quick else 1]:
        groups.setdefault(one.beginning, []).append(one)
    return [
        FaultTask("faults", beginning, tuple(runs), 0.2 * len(runs))
        for beginning, runs in groups.items()
    ]


PARTS = ("sequences", *RANDOM, "scenarios", "cycle", "faults")


def of_part(part: str, quick: bool) -> list[Task]:
    """Return the tasks of a part."""
    if part == "sequences":
        return [ProgramTask(part, None, 0.3)]
    if part in RANDOM:
        return _random(part, quick)
    makers = {"scenarios": _scenarios, "cycle": _cycle, "faults": _faults}
    if part not in makers:
        raise OracleError(f"no part {part!r}, there are: {', '.join(PARTS)}")
    return makers[part](quick)


def plan(parts: Sequence[str], quick: bool) -> list[Task]:
    """Return the tasks of these parts."""
    found = [task for part in PARTS if part in parts for task in of_part(part, quick)]
    if not found:
        raise OracleError(f"--quick leaves nothing of {', '.join(parts)}")
    return found
