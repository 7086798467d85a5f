# SPDX-License-Identifier: Apache-2.0
"""Instructions and cycles of the interrupts of the flashable images, from entry to return.

The linked ELF runs unchanged on the model of its chip (tests/target/chip/ride.c), with the bench's
plant at its pins. The figures are those of ``ride``: rest, forward to the highest speed, back and
as far the other way, with demands to drive and to brake that change every 50 ms. The other rides
have their own.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmark import blocks, build, count, cycles, elf
from benchmark.build import BenchError

RIDE, WITHOUT_FAULT = "ride", ("stop", "encoder")
OTHERS = (*WITHOUT_FAULT, "faults")
PWM, MILLISECOND = "pwm", "millisecond"
SLOW_STEP_AT_MOST = 18000  # instructions, in any state of the envelope
PERIODS_A_MILLISECOND = 20


@dataclass(frozen=True)
class Port:
    """A chip with its model, and the vehicle of that."""

    program: str
    config: str
    machine: cycles.Machine
    clock_hz: float


PORTS = {
    "stm32f405": Port("chip_ride", "lu2013", cycles.STM32F405, 168e6),
    "stm32g431": Port("chip_ride_g431", "wheel24v", cycles.STM32G431, 170e6),
}


@dataclass(frozen=True)
class Interrupt:
    """What one interrupt met and took."""

    name: str
    met: str
    instructions: int
    cost: cycles.Cost


class Costs:
    """Cycles of paths, each looked up once."""

    def __init__(self, image: Path, machine: cycles.Machine) -> None:
        """Disassemble the image."""
        self._table = cycles.Table(image, machine)
        self._known: dict[str, cycles.Cost] = {}

    def of(self, executed: blocks.Executed) -> cycles.Cost:
        """Return the cycles; an error if model and disassembly disagree on the instructions."""
        if executed.blocks not in self._known:
            path = executed.path
            disassembled = sum(len(self._table.instructions(block)) for block in path)
            if disassembled != executed.instructions:
                raise BenchError(
                    f"the model counts {executed.instructions} instructions where the"
                    f" disassembly has {disassembled}"
                )
            self._known[executed.blocks] = self._table.cost(path)
        return self._known[executed.blocks]


def drive(image: Path, port: Port, ride: str, output: Path) -> None:
    """Run an image on the model of its chip."""
    command = [str(blocks.program(port.program)), str(image), ride, str(output)]
    build.run(command, f"{image.name}, {ride}", timeout_s=blocks.SECONDS_AT_MOST)


def interrupts(
    image: Path, port: Port, ride: str, costs: Costs, names: tuple[str, ...] = (PWM,)
) -> list[Interrupt]:
    """Return the interrupts of a ride that have these names, in the order of their returns."""
    with tempfile.TemporaryDirectory() as scratch:
        output = Path(scratch) / ride
        drive(image, port, ride, output)
        return [
            Interrupt(each.name, each.met, each.instructions, costs.of(each))
            for each in blocks.read(output)
            if each.name in names
        ]


def _summary(calls: list[Interrupt]) -> dict[str, Any]:
    """All calls, and those of each state, with the state of the worst one."""
    of_state: dict[str, list[int]] = {}
    for call in calls:
        of_state.setdefault(call.met, []).append(call.instructions)
    worst = max(calls, key=lambda call: call.instructions)
    return {
        "instructions": asdict(count.summary([call.instructions for call in calls])),
        "worst_state": worst.met,
        "states": {state: asdict(count.summary(n)) for state, n in sorted(of_state.items())},
    }


def _cycles(fast: list[Interrupt], slow: list[Interrupt], clock_hz: float) -> dict[str, Any]:
    """Cycles of both interrupts, and the share of the core's time in the worst millisecond.

    That has only the longest PWM interrupts, and a slow step of the instructions of the budget over
    the envelope, at the most cycles an instruction that the ride has.
    """
    each = max(call.cost.most / call.instructions for call in slow)
    each_cold = max(call.cost.cold / call.instructions for call in slow)
    most_instructions = max(SLOW_STEP_AT_MOST, *(call.instructions for call in slow))
    found: dict[str, Any] = {
        "pwm_interrupt": cycles.summary([call.cost for call in fast]),
        "millisecond_interrupt": cycles.summary([call.cost for call in slow]),
        "cold_an_instruction": round(each_cold, 4),
    }
    for name, longest, an_instruction in (
        ("load_warm", found["pwm_interrupt"]["most"]["max"], each),
        ("load_cold", found["pwm_interrupt"]["cold"]["max"], each_cold),
    ):
        total = PERIODS_A_MILLISECOND * longest + an_instruction * most_instructions
        found[name] = round(total / (clock_hz / 1000.0), 4)
    return found


def longest(calls: Iterable[Interrupt]) -> dict[str, int]:
    """Return the longest of some PWM interrupts."""
    costs = [(call.instructions, call.cost) for call in calls]
    return {
        "calls": len(costs),
        "instructions": max(n for n, _ in costs),
        "least": max(cost.least for _, cost in costs),
        "most": max(cost.most for _, cost in costs),
        "cold": max(cost.cold for _, cost in costs),
    }


def _other_rides(image: Path, port: Port, costs: Costs) -> dict[str, dict[str, int]]:
    """Return the longest PWM interrupt of each other ride, and after each fault."""
    found = {}
    for ride in OTHERS:
        fast = interrupts(image, port, ride, costs)
        if ride != "faults":
            found[ride] = longest(fast)
            continue
        for fault in sorted({call.met for call in fast}):
            found[fault] = longest(call for call in fast if call.met == fault)
    return found


def _check_vehicle(image: Path, port: Port) -> None:
    if not image.is_file():
        raise BenchError(f"no image {image}; ./tools/dev firmware makes it")
    if f"CONFIG_{port.config.upper()}" not in elf.symbols(image):
        raise BenchError(
            f"{image.name}: the vehicle at the model's pins is {port.config}, which is not the"
            " image's configuration"
        )


def measure(
    image: Path,
    port: Port = PORTS["stm32f405"],
    machine: cycles.Machine | None = None,
    others: bool = True,
) -> dict[str, Any]:
    """Drive an image. machine: another core or flash than the port's; others: the other rides."""
    _check_vehicle(image, port)
    costs = Costs(image, machine or port.machine)
    calls = interrupts(image, port, RIDE, costs, (PWM, MILLISECOND))
    fast = [call for call in calls if call.name == PWM]
    slow = [call for call in calls if call.name == MILLISECOND]
    return {
        "image": image.name,
        "config": port.config,
        **_summary(fast),
        "cycles": _cycles(fast, slow, port.clock_hz),
        "other_rides": _other_rides(image, port, costs) if others else {},
    }
