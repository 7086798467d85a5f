# SPDX-License-Identifier: Apache-2.0
"""What the parts of a slow step cost: instructions by function, over states of the envelope.

A function named below counts what it executes itself and what the functions that are not named
execute for it, so that the parts of a step add up to the whole. The sum of a group is taken in each
state; its median is not the sum of the medians. The program is not optimised whole, where functions
lose their boundaries.
"""

from __future__ import annotations

import statistics
from collections import Counter
from pathlib import Path
from typing import Any

from benchmark import build, count, elf

SLOW_STEP = "controller_slow_step"
BEGIN = "begin_measuring"
STATES = 4000
README = build.HERE / "README.md"
BEGINS, ENDS = "<!-- parts of the slow step -->\n", "<!-- end of the parts -->\n"
LIMITS = "Messages, translation between the loops, limits, plausibility"
EDGES = "Braking at the edges"
FAULTS = "Detection of faults"
PARTS = {
    LIMITS: {
        SLOW_STEP: "messages between the modules",
        "operating_point_of": "means, sampling correction, SI units",
        "operating_point_setpoint": "setpoint, gains, dead-time slope",
        "modes_step": "state machine",
        "monitor_step": "table of checks",
        "monitor_emf_step": "angle against the EMF",
        "monitor_speed_step": "speed upper bound",
        "torque_step": "messages of the torque path",
        "motor_model_around": "motor at speed, temperature and currents",
        "motor_model_bus_current_mA": "bus current of the model",
        "demand_step": "demand",
        "torque_limits_step": "table of limits",
        "feasible_side_at": "one direction of the limits",
        "feasible_by_voltage_and_current": "lines of voltage and phase current",
        "feasible_cap_power": "battery power at the end of a direction",
        "feasible_by_drawn_at": "lines of drawn bus current",
        "feasible_by_returned_at": "lines of returned bus current",
        "foldback_step": "fold-back of the bus voltage",
        "loss_maps_torque_mNm": "optimal regenerative torque map",
        "torque_command_step": "rate and jerk",
        "current_setpoint_step": "setpoint of the currents",
    },
    EDGES: {
        "feasible_set_at": "feasible set",
        "brake_blending_step": "brake blending, without what follows",
        "hydraulic_model_step": "model of the hydraulic brake",
        "hydraulic_feedback_step": "reports of the hydraulic brake",
        "road_step": "road under the wheel",
        "loss_braking_at": "loss braking: largest losses",
        "loss_braking_torque_mNm": "loss braking: torque",
        "loss_braking_setpoint": "loss braking: setpoint",
        "lift_off_split": "lift-off braking",
        "hill_hold_step": "hold on a slope",
        "stop_lamp_step": "stop lamp",
        "available_ahead_step": "available torque now and ahead",
        "safe_state_step": "freewheel or short circuit",
        "safe_state_short_surges": "begin of a short circuit",
        "bridge_choice_step": "choice of the bridge command",
        "closing_voltage_mV": "voltage without the diodes' current",
    },
    FAULTS: {
        "operating_point_rotor": "view of rotor sensor and EMF observer",
        "observer_tuning": "tuning of the EMF observer",
        "angle_choice_step": "rotor sensor against observer",
        "monitor_current_step": "currents all zero",
        "current_expectation": "least current expected",
        "monitor_open_step": "open phase",
        "monitor_gain_step": "gain of the current sensors",
        "monitor_bus_step": "bus sensor against battery",
        "monitor_bus_swings": "bus without battery",
        "monitor_stuck_step": "switch stuck closed",
        "temperatures_step": "broken thermistors",
        "thermal_model_step": "thermal estimate",
    },
}


def _steps(trace: list[count.Call]) -> list[tuple[int, Counter[str]]]:
    """Instructions of each slow step, and its named parts."""
    steps = []
    parts: Counter[str] = Counter()
    for call in trace:
        parts[call.name] += call.own
        if call.name == SLOW_STEP:
            steps.append((call.instructions, parts))
            parts = Counter()
    return steps


def summary(trace: list[count.Call]) -> dict[str, Any]:
    """Return median, what the worst state has, and the most: of step, groups and parts."""
    steps = _steps(trace)
    worst, worst_parts = max(steps, key=lambda step: step[0])

    def figures(names: list[str]) -> dict[str, int]:
        sums = [sum(parts[name] for name in names) for _, parts in steps]
        return {
            "median": int(statistics.median(sums)),
            "in_worst": sum(worst_parts[name] for name in names),
            "max": max(sums),
        }

    median = int(statistics.median(total for total, _ in steps))
    return {
        "step": {"median": median, "in_worst": worst, "max": worst},
        "groups": {
            group: {
                "sum": figures(list(names)),
                "parts": {name: figures([name]) for name in names},
            }
            for group, names in PARTS.items()
        },
    }


def measure(core: build.Core, directory: Path, shared: list[str], plugin: Path) -> dict[str, Any]:
    """Return the profile of each configuration. shared: as that of build.compile_program()."""
    names = [name for group in PARTS.values() for name in group]
    found = {}
    configs = build.configurations()
    programs = build.compile_program(core, "envelope", configs, directory, shared, whole=False)
    for config, program in zip(configs, programs, strict=True):
        functions = elf.functions(program)
        options = [f"states={STATES}"]
        trace, _ = count.trace(core, program, plugin, functions, names, BEGIN, options)
        found[config] = summary(trace)
    return found


def _row(text: str, figures: list[dict[str, int]], most: bool = False) -> str:
    columns = ("median", "in_worst", *(("max",) if most else ()))
    cells = [" / ".join(str(value[column]) for column in columns) for value in figures]
    return f"| {' | '.join([text, *cells])} |\n"


def table(profile: dict[str, Any]) -> str:
    """Return the table in Markdown."""
    configs = list(profile)
    heading = "median / in the worst state / most"
    text = f"| {heading} | {' | '.join(configs)} |\n|---|{'---|' * len(configs)}\n"
    text += _row("**slow step**", [profile[c]["step"] for c in configs], most=True)
    for group, names in PARTS.items():
        found = [profile[c]["groups"][group] for c in configs]
        text += _row(f"**{group}**", [value["sum"] for value in found], most=True)
        for name, meaning in names.items():
            text += _row(f"`{name}`: {meaning}", [value["parts"][name] for value in found])
    return text


def updated(text: str, profile: dict[str, Any]) -> str:
    """Return the README with this profile's table."""
    before, _, rest = text.partition(BEGINS)
    return before + BEGINS + table(profile) + ENDS + rest.partition(ENDS)[2]


def update(report: dict[str, Any]) -> None:
    """Bring the table up to date."""
    README.write_text(updated(README.read_text(), report["slow_profile"]))
