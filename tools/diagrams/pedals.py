# SPDX-License-Identifier: Apache-2.0
"""What the brake pedal means: total, motor and friction torque over its travel.

After Fig. 8 of Lu et al. 2013, with the numbers of tools/motors/lu2013.toml and the optimum of
firmware/config/generated/lu2013.c.
"""

import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

from diagrams.svg import GREY, INK, Point, Sheet

ROOT = Path(__file__).resolve().parents[2]
BLUE = "#1f5fa8"
RED = "#a02020"
FULL_NM = 200.0  # 40 N m of the motor are the paper's share of 1 : 4
FREE_TRAVEL = 0.3  # default of [pedals]
WIDTH_PX, HEIGHT_PX, TOP_PX = 260.0, 200.0, 60.0
POINTS = 201
SPEEDS = ((1, ""), (2, "6 3"))  # points of the map at 62 degC, and how they are drawn

Split = Callable[[float], tuple[float, float]]


def _optimum_nm(row: int) -> tuple[float, float]:
    """Return speed in r/min and optimal braking torque in N m of one point of the stored map."""
    text = (ROOT / "firmware/config/generated/lu2013.c").read_text(encoding="utf-8")
    grid = text[text.index(".regen_map = {") :]
    step = re.search(r"\.speed_step_log2\s*=\s*(\d+)", grid)
    entries = re.search(r"\.torque_lsb = \{(.*?)\n        \}", grid, flags=re.DOTALL)
    lsb = re.search(r"\.lsb_log2\s*=\s*(\d+)", grid)
    assert step is not None and entries is not None and lsb is not None
    rows = re.sub(r"/\*.*?\*/", "", entries[1], flags=re.DOTALL).split(",")
    points = re.search(r"\.speed_points\s*=\s*(\d+)", grid)
    assert points is not None
    speed_rad_s = (row << int(step[1])) / 1000.0
    return speed_rad_s * 30.0 / math.pi, (int(rows[int(points[1]) + row]) << int(lsb[1])) / 1000.0


def _panel(sheet: Sheet, left: float, title: str, splits: list[tuple[str, Split]]) -> None:
    bottom = TOP_PX + HEIGHT_PX

    def at(travel: float, torque_nm: float) -> Point:
        return round(left + travel * WIDTH_PX, 1), round(
            bottom - torque_nm / FULL_NM * HEIGHT_PX, 1
        )

    sheet.text((left + WIDTH_PX / 2, 24), title, weight="bold")
    for percent in (0, 50, 100):
        x, y = at(percent / 100.0, 0.0)
        sheet.text((x, y + 18), f"{percent} %", colour=GREY)
    for torque in (0, 40, 100, 200):
        x, y = at(0.0, torque)
        sheet.line((x, y), (x + WIDTH_PX, y), colour="#dddddd")
        sheet.text((x - 8, y + 4), f"{torque}", "end", GREY)
    for dash, split in splits:
        travels = [k / (POINTS - 1) for k in range(POINTS)]
        both = [split(travel) for travel in travels]
        sheet.line(*(at(x, m + f) for x, (m, f) in zip(travels, both, strict=True)), colour=GREY)
        sheet.line(
            *(at(x, m) for x, (m, _) in zip(travels, both, strict=True)),
            colour=BLUE,
            dash=dash,
            width=2.0,
        )
        sheet.line(
            *(at(x, f) for x, (_, f) in zip(travels, both, strict=True)),
            colour=RED,
            dash=dash,
            width=2.0,
        )


def pedal_interpretations() -> Sheet:
    """Return the three pictures side by side."""
    drive = tomllib.loads((ROOT / "tools/motors/lu2013.toml").read_text(encoding="utf-8"))
    rated = drive["brake"]["electric_rated_torque_nm"]
    share = drive["brake"]["parallel_electric_share"]

    def ratio(travel: float) -> tuple[float, float]:
        total = FULL_NM * travel
        motor = min(share * total, rated)
        return motor, total - motor

    def free_travel(travel: float) -> tuple[float, float]:
        if travel <= FREE_TRAVEL:
            return rated * travel / FREE_TRAVEL, 0.0
        return rated, (FULL_NM - rated) * (travel - FREE_TRAVEL) / (1.0 - FREE_TRAVEL)

    def series(optimum_nm: float) -> Split:
        def split(travel: float) -> tuple[float, float]:
            total = FULL_NM * travel
            motor = min(total, optimum_nm, rated)
            return motor, total - motor

        return split

    optima = [(*_optimum_nm(row), dash) for row, dash in SPEEDS]
    sheet = Sheet(1020, 330, "Interpretations of the brake pedal")
    _panel(sheet, 60, "(a) proportional, parallel_ratio", [("", ratio)])
    _panel(sheet, 395, "(b) free_travel, parallel_free_travel", [("", free_travel)])
    _panel(
        sheet,
        730,
        "(c) proportional, series_optimal",
        [(dash, series(torque)) for _, torque, dash in optima],
    )
    speeds = ", dashed ".join(f"{speed:.0f} r/min" for speed, _, _ in optima)
    sheet.text((60, 318), "N m at one wheel over brake pedal travel:", "start", INK)
    sheet.text((370, 318), "motor", "start", BLUE, "bold")
    sheet.text((430, 318), "friction brake", "start", RED, "bold")
    sheet.text((550, 318), "both", "start", GREY, "bold")
    sheet.text((700, 318), f"(c): {speeds}, 62 degC", "start", INK)
    return sheet
