# SPDX-License-Identifier: Apache-2.0
"""What both brakes make when a limit of the motor falls under a constant braking demand.

The two equations of firmware/torque/README.md, Brake blending, with the brake of
tools/motors/lu2013.toml: a dead time, then a first-order lag.
"""

import math
import tomllib
from collections.abc import Callable
from pathlib import Path

from diagrams.svg import GREY, INK, Point, Sheet

ROOT = Path(__file__).resolve().parents[2]
BLUE = "#1f5fa8"
RED = "#a02020"
DEMAND_NM, BEFORE_NM, AFTER_NM = 40.0, 40.0, 10.0
BEGIN_S, END_S = -0.05, 0.40
WIDTH_PX, HEIGHT_PX, TOP_PX = 400.0, 200.0, 60.0
POINTS = 451

Torque = Callable[[float], float]


def _curve(sheet: Sheet, left: float, torque: Torque, colour: str, dash: str = "") -> None:
    times = [BEGIN_S + (END_S - BEGIN_S) * k / (POINTS - 1) for k in range(POINTS)]
    points: list[Point] = [_at(left, time, torque(time)) for time in times]
    sheet.line(*points, colour=colour, dash=dash, width=2.0)


def _at(left: float, time_s: float, torque_nm: float) -> Point:
    share = (time_s - BEGIN_S) / (END_S - BEGIN_S)
    height = torque_nm / (1.2 * DEMAND_NM) * HEIGHT_PX
    return round(left + share * WIDTH_PX, 1), round(TOP_PX + HEIGHT_PX - height, 1)


def _panel(sheet: Sheet, left: float, title: str, motor: Torque, hydraulic: Torque) -> None:
    sheet.text((left + WIDTH_PX / 2, 30), title, weight="bold")
    for torque in (0, 10, 20, 30, 40):
        x, y = _at(left, BEGIN_S, torque)
        sheet.line((x, y), (x + WIDTH_PX, y), colour="#dddddd")
        sheet.text((x - 8, y + 4), f"{torque}", "end", GREY)
    for time_ms in (0, 100, 200, 300, 400):
        x, y = _at(left, time_ms / 1000.0, 0.0)
        sheet.text((x, y + 18), f"{time_ms} ms", colour=GREY)
    _curve(sheet, left, lambda t: BEFORE_NM if t < 0 else AFTER_NM, GREY, "2 4")
    _curve(sheet, left, lambda t: 0.0 if t < 0 else DEMAND_NM - AFTER_NM, RED, "6 4")
    _curve(sheet, left, lambda t: motor(t) + hydraulic(t), INK)
    _curve(sheet, left, motor, BLUE)
    _curve(sheet, left, hydraulic, RED)


def blending() -> Sheet:
    """Return the two pictures side by side: a deferrable limit and a hard one."""
    drive = tomllib.loads((ROOT / "tools/motors/lu2013.toml").read_text(encoding="utf-8"))
    brake = drive["brake"]
    dead_s, lag_s = brake["hydraulic_dead_time_s"], brake["hydraulic_time_constant_s"]
    rate_nm_s = float(drive["control"]["torque_rate_nm_per_s"])

    def hydraulic(time_s: float) -> float:
        late = math.exp(-max(time_s - dead_s, 0.0) / lag_s)
        return (DEMAND_NM - AFTER_NM) * (1.0 - late)

    def deferred(time_s: float) -> float:
        return DEMAND_NM - hydraulic(time_s)

    def at_once(time_s: float) -> float:
        falling = BEFORE_NM - rate_nm_s * max(time_s, 0.0)
        return min(deferred(time_s), max(AFTER_NM, falling))

    sheet = Sheet(1000, 330, "hubfoc: a limit of the motor falls while the driver brakes")
    _panel(sheet, 60, "deferrable: the motor leaves as the brake comes", deferred, hydraulic)
    _panel(sheet, 550, "hard: the motor leaves at the torque rate", at_once, hydraulic)
    sheet.text((60, 315), "N m at one wheel:", "start", INK)
    for x, name, colour in (
        (185, "motor", BLUE),
        (240, "hydraulic brake (dashed: its command)", RED),
        (550, "both", INK),
        (605, "dotted: the motor's limit", GREY),
    ):
        sheet.text((x, 315), name, "start", colour, "bold")
    return sheet
