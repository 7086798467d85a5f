# SPDX-License-Identifier: Apache-2.0
"""Instructions of the PWM interrupt of the flashable image, from its entry to its return.

The linked ELF runs on a model of the chip (chip.py), with a motor on its bridge and a vehicle on
its CAN bus: start-up and calibration, then the same ride as tools/benchmark/ride/ride.c, through
standstill, both directions and the voltage limit, with demands to drive and to brake that change
every 50 ms.
"""

from __future__ import annotations

import math
import tomllib
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from hubsim import can_protocol

from benchmark import build, count, cycles, elf
from benchmark.build import BenchError
from benchmark.chip import EXCEPTION_ADC, EXCEPTION_SYSTICK, Chip

START_MS, RIDE_MS, DEMAND_MS = 300, 1200, 50
SUBSTEPS = 4
HALL_OF_SECTOR = (5, 1, 3, 2, 6, 4)
SLOW_STEP_AT_MOST = 16000  # instructions; the goal over the envelope (measure.py)
CODE_25_C = 2048  # the thermistors' dividers at 25 degC


@dataclass
class Random:
    """The generator of the ride and the motor: the same numbers every time."""

    state: int

    def next(self) -> int:
        """Return 32 bits, the upper ones the better."""
        self.state = (self.state * 1664525 + 1013904223) & 0xFFFFFFFF
        return self.state


@dataclass
class Motor:
    """The motor of ride/motor.c on an averaged bridge: rotor frame, peak phase quantities."""

    table: dict[str, dict[str, Any]]
    bus_v: float
    theta_rad: float = 0.0
    i_d_a: float = 0.0
    i_q_a: float = 0.0
    random: Random = field(default_factory=lambda: Random(1))

    def _noise(self) -> float:
        """One code either way."""
        return (self.random.next() >> 16) / 32768.0 - 1.0

    def _code(self, value: float) -> int:
        return min(max(math.floor(value + self._noise() + 0.5), 0), 4095)

    def sample(self, chip: Chip) -> int:
        """Set what the board's converters and inputs see. Returns the hall state."""
        inverter = self.table["inverter"]
        codes = []
        for x in range(3):
            angle = self.theta_rad - x * math.tau / 3.0
            i_a = self.i_d_a * math.cos(angle) - self.i_q_a * math.sin(angle)
            # The board's amplifiers fall with current into the motor.
            codes.append(
                4095 - self._code(2048.0 + 2048.0 * i_a / inverter["current_full_scale_a"])
            )
        bus = self._code(4096.0 * self.bus_v / inverter["voltage_full_scale_v"])
        chip.sample((codes[0], codes[1], codes[2]), bus, CODE_25_C)
        turns = self.theta_rad / math.tau
        state = HALL_OF_SECTOR[int((turns - math.floor(turns)) * 6.0) % 6]
        chip.halls(state)
        return state

    def step(
        self, on: bool, compare_counts: tuple[int, int, int], period_counts: int, w_rad_s: float
    ) -> None:
        """One PWM period at this electrical speed."""
        motor = self.table["motor"]
        r, l_d, l_q = (
            motor["phase_resistance_ohm"],
            motor["d_inductance_h"],
            motor["q_inductance_h"],
        )
        dt = 1.0 / self.table["inverter"]["pwm_frequency_hz"] / SUBSTEPS
        volts_per_count = 2.0 / 3.0 * self.bus_v / period_counts
        for _ in range(SUBSTEPS):
            if on:
                u_d = u_q = 0.0
                for x, counts in enumerate(compare_counts):
                    angle = self.theta_rad - x * math.tau / 3.0
                    u_d += volts_per_count * counts * math.cos(angle)
                    u_q -= volts_per_count * counts * math.sin(angle)
                i_d, i_q = self.i_d_a, self.i_q_a
                self.i_d_a += dt * (u_d - r * i_d + w_rad_s * l_q * i_q) / l_d
                self.i_q_a += (
                    dt
                    * (u_q - r * i_q - w_rad_s * l_d * i_d - w_rad_s * motor["flux_linkage_wb"])
                    / l_q
                )
            else:
                self.i_d_a = self.i_q_a = 0.0  # below the bus voltage nothing flows
            self.theta_rad += dt * w_rad_s


@dataclass
class Vehicle:
    """CAN messages: a demand every 10 ms and the battery's limits, as in the benchmark's ride."""

    table: dict[str, dict[str, Any]]
    share_of_256: int = 0
    counter: int = 0
    random: Random = field(default_factory=lambda: Random(7))

    def frames(self, ms: int) -> list[tuple[int, bytes]]:
        """Return the frames of this millisecond."""
        if ms % DEMAND_MS == 0:
            self.share_of_256 = (self.random.next() >> 23) - 256
        if ms % 10 != 0:
            return []
        self.counter = (self.counter + 1) % 256
        most = self.table["motor"]["max_torque_nm"]
        share = self.share_of_256 / 256.0
        battery = self.table["battery"]
        demand = {
            "enable": int(ms > START_MS // 2),
            "drive_torque_nm": max(share, 0.0) * most,
            "brake_torque_nm": max(-share, 0.0) * 2.0 * most,
        }
        limits = {
            "charge_current_a": battery["max_charge_current_a"],
            "discharge_current_a": battery["max_discharge_current_a"],
        }
        return [
            can_protocol.encode("Demand", demand, counter=self.counter),
            can_protocol.encode("BatteryLimits", limits, counter=self.counter),
        ]


def speed_rad_s(table: dict[str, dict[str, Any]], ms: int) -> float:
    """Electrical speed: rest, forward to the highest, back, and as far the other way."""
    motor = table["motor"]
    most: float = motor["max_speed_rpm"] * math.tau / 60.0 * motor["pole_pairs"]
    part = (ms - START_MS) / RIDE_MS
    if part < 0.05:
        return 0.0
    if part < 0.35:
        return most * (part - 0.05) / 0.3
    if part < 0.45:
        return most
    return most - 2.0 * most * (part - 0.45) / 0.5 if part < 0.95 else -most


def _state(was_on: bool, share_of_256: int, edge: bool, new_setpoint: bool) -> str:
    """Return what an interrupt met, in the words of the report."""
    if not was_on:
        return "idle"
    base = "driving" if share_of_256 > 0 else "braking"
    return base + (", hall edge" if edge else "") + (", new setpoint" if new_setpoint else "")


def _summary(calls: list[tuple[str, int]]) -> dict[str, Any]:
    """All calls, and those of each state, with the state of the worst one."""
    of_state: dict[str, list[int]] = {}
    for state, instructions in calls:
        of_state.setdefault(state, []).append(instructions)
    worst_state, _ = max(calls, key=lambda call: call[1])
    return {
        "instructions": asdict(count.summary([n for _, n in calls])),
        "worst_state": worst_state,
        "states": {state: asdict(count.summary(n)) for state, n in sorted(of_state.items())},
    }


def _motor_table(symbols: dict[str, elf.Symbol]) -> tuple[str, dict[str, dict[str, Any]]]:
    """Name of the configuration in an image, and what its motor is made from."""
    names = {path.stem: path for path in (build.ROOT / "tools" / "motors").rglob("*.toml")}
    for name, path in names.items():
        if f"CONFIG_{name.upper()}" in symbols:
            table = tomllib.loads(path.read_text())
            if table.get("rotor", {}).get("sensor") != "hall":
                raise BenchError(f"{name}: the ride of the PWM interrupt is one with hall sensors")
            return name, table
    raise BenchError("the image holds no configuration of tools/motors")


def _bus_voltage_v(battery: dict[str, Any]) -> float:
    """Bus voltage of the ride: of a pack with a curve, the one where work begins, to its point."""
    voltage = battery["open_circuit_voltage_v"]
    if isinstance(voltage, float):
        return voltage
    begin = battery.get("initial_soc", 1.0)
    return float(min(voltage, key=lambda point: abs(point[0] - begin))[1])


def _cycles(
    fast: list[cycles.Cost],
    slow: list[tuple[cycles.Cost, int]],
    periods: int,
    clock_hz: float,
) -> dict[str, Any]:
    """Cycles of both interrupts, and the share of the core's time in the worst millisecond.

    That has only the longest PWM interrupts, and a slow step of the instructions of the budget over
    the envelope, at the most cycles an instruction that the ride has.
    """
    each = max(cost.most / instructions for cost, instructions in slow)
    each_cold = max(cost.cold / instructions for cost, instructions in slow)
    most_instructions = max(SLOW_STEP_AT_MOST, *(instructions for _, instructions in slow))
    found: dict[str, Any] = {
        "pwm_interrupt": cycles.summary(fast),
        "millisecond_interrupt": cycles.summary([cost for cost, _ in slow]),
        "cold_an_instruction": round(each_cold, 4),
    }
    for name, longest, an_instruction in (
        ("load_warm", found["pwm_interrupt"]["most"]["max"], each),
        ("load_cold", found["pwm_interrupt"]["cold"]["max"], each_cold),
    ):
        total = periods * longest + an_instruction * most_instructions
        found[name] = round(total / (clock_hz / 1000.0), 4)
    return found


def measure(
    image: Path,
    blocks: Counter[tuple[int, int]] | None = None,
    chip_type: type[Chip] = Chip,
    machine: cycles.Machine = cycles.STM32F405,
) -> dict[str, Any]:
    """Drive an image. blocks: if given, receives how often each stretch of code was entered."""
    if not image.is_file():
        raise BenchError(f"no image {image}; ./tools/dev firmware makes it")
    symbols = elf.symbols(image)
    config, table = _motor_table(symbols)
    background = symbols["app_background"].address
    chip = chip_type(image)
    chip.boot(background)
    motor = Motor(table, bus_v=_bus_voltage_v(table["battery"]))
    vehicle = Vehicle(table)
    periods = round(table["inverter"]["pwm_frequency_hz"] / 1000.0)
    active = (False, (0, 0, 0))
    last_hall, running_ms = -1, 0
    calls: list[tuple[str, int]] = []
    table_of = cycles.Table(image, machine)
    fast: list[cycles.Cost] = []
    slow: list[tuple[cycles.Cost, int]] = []
    for ms in range(START_MS + RIDE_MS):
        chip.frames.extend(vehicle.frames(ms))
        w_rad_s = speed_rad_s(table, ms)
        for period in range(periods):
            hall = motor.sample(chip)
            was_on = chip.outputs_on
            chip.blocks = blocks
            instructions = chip.interrupt(EXCEPTION_ADC)
            chip.blocks = None
            fast.append(table_of.cost(chip.path))
            state = _state(was_on, vehicle.share_of_256, hall != last_hall, period == 0)
            calls.append((state, instructions))
            last_hall = hall
            chip.take_pending()
            motor.step(*active, chip.period_counts, w_rad_s)
            active = (chip.outputs_on, chip.compare_counts)
        running_ms += chip.outputs_on and ms >= START_MS
        instructions = chip.interrupt(EXCEPTION_SYSTICK)
        slow.append((table_of.cost(chip.path), instructions))
        chip.call(background)
    if running_ms < RIDE_MS:
        raise BenchError(f"{image.name}: the bridge was on for {running_ms} of {RIDE_MS} ms")
    return {
        "image": image.name,
        "config": config,
        **_summary(calls),
        "cycles": _cycles(fast, slow, periods, chip.CLOCK_HZ),
    }
