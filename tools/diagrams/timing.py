# SPDX-License-Identifier: Apache-2.0
"""Timing diagram of the firmware: sample, compute, apply; and the slow step between periods."""

from diagrams.svg import GREY, Box, Sheet

PERIOD_PX = 218
LEFT_PX = 170
FAST = "#bfe3bf"
APPLY = "#f6d9a8"
SLOW = "#bcd6f5"
RED = "#a02020"


def _fast(sheet: Sheet) -> None:
    tops = [LEFT_PX + (number + 0.5) * PERIOD_PX for number in range(4)]
    high, low = 60.0, 130.0
    sheet.text((20, 100), "PWM counter", "start")
    points = [(tops[0] - PERIOD_PX / 2, low)]
    for top in tops:
        points += [(top, high), (top + PERIOD_PX / 2, low)]
    sheet.line(*points, width=1.6)
    sheet.text((20, 40), "period", "start", GREY)
    for number, top in enumerate(tops):
        sheet.line((top, high), (top, 275), colour=GREY, dash="3 4")
        sheet.dot((top, high), RED)
        sheet.text((top, 40), "k" if number == 0 else f"k + {number}", colour=GREY)
    sheet.text((tops[0] + 12, 62), "sample", "start", RED)
    sheet.text((20, 172), "fast step", "start")
    sheet.text((20, 222), "voltage at bridge", "start")
    for number, top in enumerate(tops[:3]):
        name = "k" if number == 0 else f"k+{number}"
        sheet.box(Box(top + 12, 150, 105, 34, f"compute {name}"), FAST)
        if number < 2:
            sheet.box(Box(tops[number + 1], 200, PERIOD_PX, 34, f"apply result of {name}"), APPLY)
    middle = tops[1] + PERIOD_PX / 2
    sheet.arrow((tops[0], 262), (middle, 262), colour=RED)
    sheet.line((middle, 234), (middle, 275), colour=RED, dash="3 4")
    sheet.text((tops[0] + PERIOD_PX / 2, 256), "delay 1.5 T on average", colour=RED)


def _slow(sheet: Sheet) -> None:
    pitch = 41.0
    steps = (3, 13)
    sheet.text((20, 342), "fast step, 20 kHz", "start")
    sheet.text((20, 402), "slow step, 1 kHz", "start")
    sheet.text((20, 462), "background", "start")
    for number in range(21):
        x = LEFT_PX + number * pitch
        sheet.box(Box(x, 325, 16, 28, ""), FAST)
    sheet.text(
        (LEFT_PX + 8.5 * pitch, 316), "10 of 20 periods a millisecond are drawn", colour=GREY
    )
    for step in steps:
        x = LEFT_PX + step * pitch + 18
        sheet.box(Box(x, 385, 21, 28, ""), SLOW)
        sheet.box(Box(x + pitch, 385, 21, 28, ""), SLOW)
        sheet.line((x + 21, 399), (x + pitch, 399), colour=GREY, dash="3 4")
        sheet.arrow((x - 10, 353), (x - 10, 399), (x, 399))
        sheet.text((x - 16, 378), "report", "end", GREY)
        end = x + pitch + 21
        sheet.arrow((end, 399), (end + 10, 399), (end + 10, 353))
        sheet.text((end + 16, 378), "setpoint", "start", GREY)
    x = LEFT_PX
    sheet.box(
        Box(x, 445, 20.5 * pitch, 28, "CAN, serial line, watchdog: in the remaining time"),
        "#f0f0f0",
    )


def draw() -> Sheet:
    """Return the timing diagram."""
    sheet = Sheet(1080, 500, "hubfoc: sample, compute, apply")
    _fast(sheet)
    _slow(sheet)
    return sheet
