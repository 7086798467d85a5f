# SPDX-License-Identifier: Apache-2.0
"""Facts of the boards that the firmware has a header for (hal/PORT/boards/NAME.h).

The header is the only place where they stand; this module reads its constants and computes from
them what a drive's keys need, as the port's ``board.h`` does for the firmware. Standard library
only.
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from regen_table import installation

if TYPE_CHECKING:
    from collections.abc import Callable

    from regen_table.sections import Drive

TIMER_CLOCK_HZ = {"stm32f405": 168_000_000, "stm32g431": 170_000_000}  # CLOCK_TIMER1_Hz
SAMPLING_S = {"stm32f405": 714e-9, "stm32g431": 294e-9}  # ANALOG_SAMPLING_ns
HOT_OVER_COLD = 1.6  # resistance of a silicon MOSFET at 125 degC over that at 25 degC
DESCRIPTION = "gate_board"  # of an inverter of one's own: no board that exists

_CONSTANT = re.compile(r"\bBOARD_(\w+) = (-?\d+)\b")
_INCLUDED = re.compile(r'#include "boards/(\w+)\.h"')


@dataclass(frozen=True)
class Board:
    """What a drive's keys follow from.

    Attributes
    ----------
    current_full_scale_a, voltage_full_scale_v : float
        What half, and the whole, of the converter's range stands for.
    current_most_a : float
        Largest phase current that the board may carry (peak).
    voltage_most_v : float
        Largest bus voltage that it may have; the converter's range where the header names none.
    dead_time_s : float
        The least that its switches permit.
    settled_s : float or None
        What low-side shunts need to settle and be sampled; None: shunts in the phases, which need
        no window.
    switch_resistance_ohm : float or None
        Of a cold switch; None where the header names no switch.
    offset_tolerance_codes : int or None
        Where the header states that zero current lies beside the middle of the range.
    switch_sensor_beta_k, switch_sensor_divider_ohm : float
        Of the thermistor beside the switches, 10 kOhm at 25 degC, to the supply; to ground.
    """

    name: str
    port: str
    current_full_scale_a: float
    voltage_full_scale_v: float
    current_most_a: float
    voltage_most_v: float
    dead_time_s: float
    timer_clock_hz: int
    settled_s: float | None
    switch_resistance_ohm: float | None
    offset_tolerance_codes: int | None
    switch_sensor_beta_k: float
    switch_sensor_divider_ohm: float

    def window_s(self, dead_time_s: float) -> float | None:
        """Return what the low side has to conduct before the top; None: no shunt needs it.

        With current into the board it conducts half the dead time less.
        """
        return None if self.settled_s is None else self.settled_s + dead_time_s / 2.0


def fitting(
    drive: "Drive", over_current_margin: float, refusing: "Callable[[Drive, str], list[str]]"
) -> str:
    """Return which boards bear a drive as it is, and what the others would cost it.

    ``refusing`` names the keys for which the drive is refused with another board. The ranges of
    the description are those of whoever builds it.
    """
    volts, amperes = drive.battery.max_voltage_v, drive.motor.max_phase_current_a
    fits, costs = [], []
    for board in sorted(known().values(), key=lambda one: (one.voltage_most_v, one.name)):
        carried = board.current_most_a / over_current_margin
        if volts > board.voltage_most_v:
            costs.append(f"{board.name} bears {board.voltage_most_v:g} of {volts:g} V")
        elif amperes > carried:
            costs.append(f"{board.name} carries {carried:.0f} of {amperes:g} A")
        elif board.name != DESCRIPTION and (keys := refusing(drive, board.name)):
            costs.append(f"{board.name} takes other {', '.join(keys)}")
        else:
            fits.append(board.name)
    return "; ".join([f"boards that fit: {', '.join(fits) or 'none'}", *costs])


@cache
def known() -> dict[str, Board]:
    """Return all boards by name, those of the stm32f405 first."""
    folders = [installation.ROOT / "hal" / port / "boards" for port in TIMER_CLOCK_HZ]
    headers = [path for folder in folders for path in sorted(folder.glob("*.h"))]
    found = [_read(path) for path in headers if not path.stem.endswith("_common")]
    return {board.name: board for board in found}


def _read(path: Path) -> Board:
    facts, port = _constants(path), path.parent.parent.name
    gain = facts.get("AMPLIFIER_GAIN") or (
        facts["AMPLIFIER_GAIN_NUMERATOR"] / facts["AMPLIFIER_GAIN_DENOMINATOR"]
    )
    reference_v, upper, lower = (
        facts["REFERENCE_mV"] * 1e-3,
        facts["DIVIDER_UPPER_Ohm"],
        facts["DIVIDER_LOWER_Ohm"],
    )
    full_scale_v = reference_v * (upper + lower) / lower
    settling_s = facts["AMPLIFIER_SETTLING_ns"] * 1e-9
    hot = facts.get("SWITCH_HOT_uOhm")
    return Board(
        name=path.stem,
        port=port,
        current_full_scale_a=reference_v / 2.0 / (facts["SHUNT_nOhm"] * 1e-9 * gain),
        voltage_full_scale_v=full_scale_v,
        current_most_a=float(facts["CURRENT_MOST_A"]),
        voltage_most_v=float(facts.get("VOLTAGE_MOST_V", full_scale_v)),
        dead_time_s=facts["DEAD_TIME_LEAST_ns"] * 1e-9,
        timer_clock_hz=TIMER_CLOCK_HZ[port],
        settled_s=settling_s + SAMPLING_S[port] if settling_s > 0.0 else None,
        switch_resistance_ohm=None if hot is None else hot * 1e-6 / HOT_OVER_COLD,
        offset_tolerance_codes=facts.get("OFFSET_TOLERANCE_codes"),
        switch_sensor_beta_k=float(facts["SWITCH_NTC_BETA_K"]),
        switch_sensor_divider_ohm=float(facts["SWITCH_NTC_GROUND_Ohm"]),
    )


def _constants(path: Path) -> dict[str, int]:
    """Return the constants of a header and of the ones that it includes from its folder."""
    text = path.read_text(encoding="utf-8")
    found: dict[str, int] = {}
    for name in _INCLUDED.findall(text):
        found |= _constants(path.with_name(f"{name}.h"))
    return found | {name: int(value) for name, value in _CONSTANT.findall(text)}
