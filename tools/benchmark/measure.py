# SPDX-License-Identifier: Apache-2.0
"""Measure the firmware's two steps on emulated cores; write build/bench.json and print a table.

Instructions are exact and repeatable: a closed loop of firmware and motor runs on the emulator, and
a plugin counts what every call executes. They are instructions, not cycles: the emulator has no
pipeline, no flash and no bus. The exit status is 1 if a budget is missed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from rich.console import Console

from benchmark import (
    blocks,
    build,
    count,
    cycles,
    elf,
    interrupt,
    memory,
    ports,
    readme,
    show,
    slow_profile,
    stack_report,
)
from benchmark.functions import (
    CURRENT_LOOP,
    FAST_STEP,
    FUNCTIONS,
    IMAGE_CORE,
    INTERRUPT,
    OTHER_ROTORS,
    SLOW_STEP,
)

RIDE_FUNCTIONS = [CURRENT_LOOP, FAST_STEP]
"""Counted in a closed loop; the slow step, in states from the whole envelope."""
BEGIN = "begin_measuring"


@dataclass(frozen=True)
class Budget:
    """What a function may cost on a core; the project's goal, not a law of nature."""

    core: str
    function: str
    median_at_most: int
    spread_at_most: float | None = None
    p99_at_most: int | None = None
    max_at_most: int | None = None


INTERRUPT_BUDGET = Budget(IMAGE_CORE, INTERRUPT, 460, max_at_most=810)
"""From entry to return on the linked image."""
OTHER_CORE = "stm32g431"
BUDGETS = (
    Budget("cortex-m4", CURRENT_LOOP, 163, 1.05),
    Budget("cortex-m4", FAST_STEP, 315, p99_at_most=565, max_at_most=635),
    Budget("cortex-m4", f"{FAST_STEP}_encoder", 400, p99_at_most=535, max_at_most=610),
    Budget("cortex-m4", f"{FAST_STEP}_angle", 380, p99_at_most=515, max_at_most=590),
    Budget("cortex-m3", CURRENT_LOOP, 183),
    Budget("cortex-m0plus", CURRENT_LOOP, 395),
)
SLOW_BUDGET = Budget("cortex-m4", SLOW_STEP, 12000, max_at_most=interrupt.SLOW_STEP_AT_MOST)
"""Of each configuration, in every state of the envelope."""
LOOP_BYTES_AT_MOST = 3584
REFERENCE_GCC = 12
OTHER_GCC_SHARE = 1.05
"""The goals are those of the reference release; another one may need a twentieth more."""
EQUAL_CALLS = 4000
"""That the model of the chips has to count as the plugin does, of both functions together."""
EQUAL_STATES = 300
"""Likewise of the slow step."""
STATES = 100000
"""Of the envelope, a configuration, on the first core; the others get FEW_STATES."""
FEW_STATES = 4000


def measure_ride(
    core: build.Core, config: str, directory: Path, shared: list[str], plugin: Path | None
) -> tuple[dict[str, Any], Path]:
    """Measure the fast loop on one core, in a closed loop.

    Return also the plugin, which the next core can use.
    """
    program = build.compile_program(core, "ride", [config], directory, shared)[0]
    functions = elf.functions(program)
    symbols = elf.symbols(program)
    plugin = plugin or count.loadable_plugin(directory)
    each, _ = count.calls(core, program, plugin, functions, RIDE_FUNCTIONS, BEGIN)
    if core is build.CORES[0]:
        blocks.check_equal(program, functions, each, BEGIN, EQUAL_CALLS)
    counts = {name: count.summary(values) for name, values in each.items()}
    for name, sensor in OTHER_ROTORS.items() if core is build.CORES[0] else ():
        other, _ = count.calls(
            core, program, plugin, functions, [FAST_STEP], BEGIN, [f"rotor={sensor}"]
        )
        counts[name] = count.summary(other[FAST_STEP])
    frames = stack_report.compiled_frames(program, [program.parent, Path(shared[0]).parent])
    result = {
        "flags": " ".join([*core.flags, core.optimise]),
        "machine": core.machine,
        "instructions": {name: asdict(value) for name, value in counts.items()},
        "size_bytes": {name: elf.size_of(name, functions, symbols) for name in FUNCTIONS},
        "stack_bytes": {
            name: stack_report.worst_path(name, functions, frames).bytes for name in FUNCTIONS
        },
    }
    return result, plugin


def measure_envelope(
    core: build.Core, directory: Path, shared: list[str], plugin: Path, states: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Measure the slow step in random states.

    Of all configurations together, and of each by the reason shown.
    """
    configs = build.configurations()
    everything: list[int] = []
    each: dict[str, Any] = {}
    programs = build.compile_program(core, "envelope", configs, directory, shared)
    functions = elf.functions(programs[0])  # only their configurations differ
    for config, program in zip(configs, programs, strict=True):
        found, text = count.calls(
            core,
            program,
            plugin,
            functions,
            [SLOW_STEP],
            BEGIN,
            [f"states={states}", "reasons=1"],
        )
        if core is build.CORES[0] and config == configs[0]:
            options = [f"states={states}"]
            blocks.check_equal(program, functions, found, BEGIN, EQUAL_STATES, options)
        counts = found[SLOW_STEP]
        worst = {"index": max(range(len(counts)), key=counts.__getitem__)}
        each[config] = {**asdict(count.summary(counts)), "worst_state": worst}
        each[config]["by_reason"] = count.by_reason(text, counts)
        everything += counts
    return asdict(count.summary(everything)), each


def goal_with(compiler: str, budget: Budget) -> Budget:
    """Return the budget as it is for a compiler, given the first line of its version."""
    release = re.search(r"(\d+)\.\d+\.\d+", compiler.rpartition(")")[2])
    if release and int(release[1]) == REFERENCE_GCC:
        return budget

    def more(limit: int | None) -> int | None:
        return None if limit is None else int(limit * OTHER_GCC_SHARE)

    return replace(
        budget,
        median_at_most=int(budget.median_at_most * OTHER_GCC_SHARE),
        p99_at_most=more(budget.p99_at_most),
        max_at_most=more(budget.max_at_most),
    )


def outcome_of(budget: Budget, config: str, value: dict[str, Any]) -> dict[str, Any]:
    """Compare one function's counts with its budget."""
    spread = value["max"] / value["median"]
    met = (
        value["median"] <= budget.median_at_most
        and (budget.spread_at_most is None or spread <= budget.spread_at_most)
        and (budget.p99_at_most is None or value["p99"] <= budget.p99_at_most)
        and (budget.max_at_most is None or value["max"] <= budget.max_at_most)
    )
    return {
        **asdict(budget),
        "config": config,
        "median": value["median"],
        "p99": value["p99"],
        "max": value["max"],
        "spread": round(spread, 3),
        "met": met,
    }


def judge(
    config: str, cores: dict[str, Any], envelope: dict[str, Any], compiler: str
) -> list[dict[str, Any]]:
    """Compare with the budgets. envelope: the slow step of each configuration on the first core."""
    goals = [goal_with(compiler, budget) for budget in BUDGETS if budget.core in cores]
    outcomes = [
        outcome_of(goal, config, cores[goal.core]["instructions"][goal.function]) for goal in goals
    ]
    for name, value in envelope.items():
        outcomes.append(outcome_of(goal_with(compiler, SLOW_BUDGET), name, value))
    size = sum(cores["cortex-m4"]["size_bytes"][CURRENT_LOOP].values())
    outcomes.append(
        {
            "core": "cortex-m4",
            "config": config,
            "function": CURRENT_LOOP,
            "bytes_at_most": LOOP_BYTES_AT_MOST,
            "bytes": size,
            "met": size <= LOOP_BYTES_AT_MOST,
        }
    )
    return outcomes


def simulation_speed(config: str) -> dict[str, float]:
    """Measure simulated seconds a second of processor time on one core, four wheels and one.

    The best of three stops each, the wheels with their share of the mass.
    """
    toml = build.ROOT / "tools" / "motors" / f"{config}.toml"
    vehicle = tomllib.loads(toml.read_text(encoding="utf-8"))["vehicle"]
    mass_kg = vehicle["mass_kg"] / vehicle["driven_wheels"]
    return {
        f"realtime_factor_{name}": round(max(_stop(toml, n, n * mass_kg) for _ in range(3)), 1)
        for name, n in (("four_wheels", 4), ("one_wheel", 1))
    }


def _stop(toml: Path, wheels: int, mass_kg: float) -> float:
    """Simulate a stop; return simulated time over processor time."""
    with tempfile.TemporaryDirectory() as scratch:
        result = Path(scratch) / "stop.json"
        settings = (f"vehicle.driven_wheels={wheels}", f"vehicle.mass_kg={mass_kg}")
        chosen = [part for setting in settings for part in ("--set", setting)]
        command = [sys.executable, "-m", "hubsim", "run", "stop", "--config", str(toml), *chosen]
        build.run([*command, "--json", str(result)], "the simulated stop")
        return float(json.loads(result.read_text(encoding="utf-8"))["realtime_factor"])


def first_line(command: list[str]) -> str:
    """Version line of a tool."""
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[
        0
    ]


def write_json(path: Path, report: dict[str, Any]) -> None:
    """Write beside and rename, so that no half-written file is ever seen."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".json.new")
    beside.write_text(json.dumps(report, indent=2) + "\n")
    beside.replace(path)


def measure_interrupt(
    image: Path, compiler: str, others: bool
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Measure the PWM interrupt of the linked image; returns it and its outcomes.

    others: the other rides, too. Those without a fault have the same budget of cycles.
    """
    measured = interrupt.measure(image, others=others)
    goal = goal_with(compiler, INTERRUPT_BUDGET)
    longest = {INTERRUPT: measured["cycles"]["pwm_interrupt"]["most"]["max"]}
    for ride in interrupt.WITHOUT_FAULT if others else ():
        longest[f"PWM interrupt, {ride}"] = measured["other_rides"][ride]["most"]
    outcomes = [outcome_of(goal, measured["config"], measured["instructions"])]
    outcomes += judge_cycles(longest)
    return measured, [*outcomes, judge_load(IMAGE_CORE, measured)]


def judge_cycles(longest: dict[str, int]) -> list[dict[str, Any]]:
    """Compare the cycles of the longest PWM interrupt of each ride with the budget."""
    return [
        {"core": IMAGE_CORE, "function": ride, **cycles.judge(most)}
        for ride, most in longest.items()
    ]


def judge_load(core: str, measured: dict[str, Any]) -> dict[str, Any]:
    """Compare the load of a port's core with its budget."""
    return {"core": core, "function": "load of the core", **cycles.judge_load(measured["cycles"])}


def judge_memory(image: Path, compiler: str) -> list[dict[str, Any]]:
    """Compare flash and RAM of the flashable image with their budgets."""
    flash = goal_with(compiler, Budget(IMAGE_CORE, "flash", memory.FLASH_AT_MOST)).median_at_most
    return [{"core": IMAGE_CORE, **outcome} for outcome in memory.judge(image, flash)]


def bench_interrupt(options: argparse.Namespace) -> int:
    """Only the PWM interrupt."""
    compiler = first_line([build.PREFIX + "gcc", "--version"])
    measured, outcomes = measure_interrupt(options.image, compiler, others=False)
    outcomes += judge_memory(options.image, compiler)
    report = {
        "compiler": compiler,
        "interrupt": measured,
        "budgets": outcomes,
        "firmware_bytes": {IMAGE_CORE: memory.firmware(options.image)},
    }
    write_json(options.output, report)
    console = Console(stderr=False, width=None if sys.stdout.isatty() else 132)
    show.interrupt(console, measured)
    show.budgets(console, outcomes)
    memory.show(console, report)
    if options.update_readme:
        readme.update(report)
    return 0 if all(value["met"] for value in outcomes) else 1


def bench(options: argparse.Namespace) -> int:
    """Run the command line."""
    directory = build.ROOT / "build" / "bench"
    cores: dict[str, Any] = {}
    plugin: Path | None = None
    console = Console(stderr=False, width=None if sys.stdout.isatty() else 132)
    envelope: dict[str, Any] = {}
    profile: dict[str, Any] = {}
    for core in build.CORES[:1] if options.first_core else build.CORES:
        console.print(f"{core.name} ...", style="dim")
        shared = build.compile_sources(
            core, build.shared_sources(), directory / f"{core.name}-shared"
        )
        result, plugin = measure_ride(core, options.config, directory / core.name, shared, plugin)
        states = options.states if core is build.CORES[0] else min(FEW_STATES, options.states)
        result["instructions"][SLOW_STEP], each = measure_envelope(
            core, directory / f"{core.name}-envelope", shared, plugin, states
        )
        if core is build.CORES[0]:
            count.describe_worst(core, directory / f"{core.name}-envelope", each)
            envelope = each
        if core is build.CORES[0] and not options.first_core:  # of no budget
            profile = slow_profile.measure(
                core, directory / f"{core.name}-envelope", shared, plugin
            )
        cores[core.name] = result
    images = {p: build.ROOT / f"build/{p}/hubfoc_{p}.elf" for p in (*ports.PORTS, "qemu")}
    compiler = first_line([build.PREFIX + "gcc", "--version"])
    report: dict[str, Any] = {
        "config": options.config,
        "compiler": compiler,
        "emulator": first_line(["qemu-system-arm", "--version"]),
        "cores": cores,
        "envelope": envelope,
        "slow_profile": profile,
        "budgets": judge(options.config, cores, envelope, compiler),
        "firmware_bytes": {port: memory.firmware(image) for port, image in images.items()},
        "simulation": {} if options.no_simulation else simulation_speed(options.config),
    }
    if options.only != "steps":
        console.print(f"{IMAGE_CORE} ...", style="dim")
        measured, outcomes = measure_interrupt(options.image, compiler, others=True)
        report["interrupt"] = measured
        report["ports"] = ports.of(report)
        report["budgets"] += [*outcomes, *judge_memory(options.image, compiler)]
        other = report["ports"].get(OTHER_CORE)
        report["budgets"] += [judge_load(OTHER_CORE, other)] if other else []
    write_json(options.output, report)
    show.steps(console, report)
    if "interrupt" in report:
        show.interrupt(console, report["interrupt"])
        ports.show(console, report["ports"])
    show.budgets(console, report["budgets"])
    show.sizes(console, report)
    if options.update_readme:
        readme.update(report)
        if profile:
            slow_profile.update(report)
        if "ports" in report:
            ports.update(report)
    return 0 if all(value["met"] for value in report["budgets"]) else 1


def main(arguments: list[str] | None = None) -> int:
    """Entry point; mistakes are answered with one line on stderr."""
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--config",
        default="lu2013",
        help="a configuration in firmware/config/generated (default: %(default)s)",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=build.ROOT / "build" / "bench.json",
        help="default: build/bench.json",
    )
    parser.add_argument(
        "--no-simulation", action="store_true", help="leave out the speed of the simulation"
    )
    parser.add_argument(
        "--only",
        choices=("steps", "interrupt"),
        help="measure the step functions only, or the linked image's PWM interrupt only",
    )
    parser.add_argument(
        "--first-core",
        action="store_true",
        help=f"the step functions on {build.CORES[0].name} only, without their profile",
    )
    parser.add_argument(
        "--image",
        type=Path,
        default=build.ROOT / "build" / "stm32f405" / "hubfoc_stm32f405.elf",
        help="whose PWM interrupt is counted (default: %(default)s)",
    )
    parser.add_argument(
        "--update-readme",
        action="store_true",
        help="write the tables of tools/benchmark/README.md",
    )
    parser.add_argument(
        "--states",
        type=int,
        default=STATES,
        help="states of the envelope, a configuration (default: %(default)s)",
    )
    options = parser.parse_args(arguments)
    if not count.CALLS_AT_LEAST <= options.states <= 10 * STATES:
        parser.error(f"--states {options.states}: {count.CALLS_AT_LEAST} to {10 * STATES}")
    if not re.fullmatch(r"[A-Za-z0-9_-]+", options.config):
        parser.error(f"--config {options.config}: a name of letters, digits, - and _, not a path")
    try:
        return bench_interrupt(options) if options.only == "interrupt" else bench(options)
    except (build.BenchError, stack_report.StackError, OSError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    sys.exit(main())
