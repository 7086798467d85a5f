# SPDX-License-Identifier: Apache-2.0
"""Write the diagrams beside this script, or check with ``--check`` that they are current.

The block diagram, the slow step and the timing diagram of the firmware, and the plots of its
modules.
"""

import argparse
import sys
from pathlib import Path

from diagrams.blending import blending
from diagrams.pedals import pedal_interpretations
from diagrams.slow_step import slow_step
from diagrams.svg import GREY, Box, Sheet

FOLDER = Path(__file__).resolve().parent
RED = "#a02020"

# Block diagram: backgrounds of the loops, fill of the monitoring.
SLOW = "#e4eefb"
FAST = "#e6f4e6"
WATCH = "#fbeede"

# Timing diagram: lengths, fills of the steps.
PERIOD_PX = 218
LEFT_PX = 170
FAST_STEP = "#bfe3bf"
SLOW_STEP = "#bcd6f5"
APPLY = "#f6d9a8"


def _slow_loop(sheet: Sheet) -> None:
    sheet.band(Box(120, 60, 830, 150, "slow loop, 1 kHz: torque/  (N m, A, rad/s; means)"), SLOW)
    sheet.band(Box(120, 250, 830, 90, ""), "#f0f0f0")
    sheet.text((235, 268), "controller/  (SI to per unit and back)", "start", GREY, "bold")
    sheet.band(Box(120, 380, 830, 190, ""), FAST)
    sheet.text((200, 399), "fast loop, PWM period: foc/  (per unit)", "start", GREY, "bold")

    vehicle = sheet.box(Box(10, 105, 90, 50, "CAN, pedal"))
    demand = sheet.box(Box(140, 105, 130, 50, "demand\nage, rate, jerk"))
    limits = sheet.box(Box(310, 105, 160, 50, "torque limits\none table, reasons"))
    blending = sheet.box(Box(510, 105, 160, 50, "brake blending\nloss-optimal share"))
    setpoint = sheet.box(Box(710, 105, 170, 50, "current setpoint\nmean i_d, i_q"))
    hydraulic = sheet.box(Box(510, 5, 160, 40, "hydraulic brake"))
    for one, two in ((vehicle, demand), (demand, limits), (limits, blending), (blending, setpoint)):
        sheet.arrow(one.right, two.left)
    sheet.arrow(blending.top, hydraulic.bottom)
    sheet.text((600, 82), "hydraulic torque command", "start", GREY)
    sheet.text((805, 235), "i_d, i_q", "start", GREY)

    down = sheet.box(Box(710, 275, 170, 46, "measure_setpoint\nfast_setpoint_t"))
    up = sheet.box(Box(140, 275, 170, 46, "measure\nmeasured_t"))
    enable = sheet.box(Box(510, 275, 160, 46, "modes\ntorque enable"), WATCH)
    monitor = sheet.box(Box(350, 275, 120, 46, "monitor\nfindings"), WATCH)
    sheet.arrow(setpoint.bottom, down.top)
    sheet.arrow((225, 275), (225, 190), (390, 190), limits.bottom)
    sheet.text((235, 184), "measured_t", "start", GREY)
    sheet.arrow(up.right, monitor.left)
    sheet.arrow(monitor.right, enable.left)
    sheet.arrow(enable.right, down.left)
    sheet.arrow((590, 275), (590, 220), (430, 220), (430, 155), colour=RED)
    sheet.text((600, 235), "torque enable", "start", RED)
    sheet.arrow((190, 425), (190, 321))
    sheet.text((200, 365), "fast_report_t", "start", GREY)


def _fast_loop(sheet: Sheet) -> None:
    sense = sheet.box(Box(140, 425, 100, 50, "sense\nClarke"))
    park = sheet.box(Box(270, 425, 70, 50, "Park"))
    control = sheet.box(Box(370, 425, 170, 50, "current controller\nPI, decoupling"))
    inverse = sheet.box(Box(570, 425, 100, 50, "inverse\nPark"))
    modulation = sheet.box(Box(710, 425, 170, 50, "modulation\nSVPWM, dead time"))
    rotor = sheet.box(Box(140, 505, 200, 45, "rotor estimate\nangle, speed"))
    prefilter = sheet.box(Box(370, 505, 170, 45, "reference prefilter,\ncurrent predictor"))
    trip = sheet.box(Box(570, 505, 160, 45, "monitor: fast trip,\nbridge command"), WATCH)
    for one, two in ((sense, park), (park, control), (control, inverse), (inverse, modulation)):
        sheet.arrow(one.right, two.left)
    sheet.arrow((305, 505), park.bottom)
    sheet.arrow((345, 527), (355, 527), (355, 490), (620, 490), inverse.bottom, dash="4 3")
    sheet.line((340, 527), (346, 527), dash="4 3")
    sheet.arrow(prefilter.top, control.bottom)
    sheet.arrow((880, 298), (910, 298), (910, 562), (455, 562), prefilter.bottom)
    sheet.text((800, 556), "setpoint", "start", GREY)

    board = sheet.box(Box(10, 425, 90, 50, "converters"))
    sensor = sheet.box(Box(10, 505, 90, 45, "hall,\nencoder"))
    bridge = sheet.box(Box(970, 425, 100, 50, "bridge,\nmotor"))
    sheet.arrow(board.right, sense.left)
    sheet.arrow(sensor.right, rotor.left)
    sheet.arrow(modulation.right, bridge.left)
    sheet.arrow(trip.right, (1020, 527.5), bridge.bottom, colour=RED)
    sheet.text((1014, 545), "PWM, freewheel,\nshort circuit", "middle", RED)


def signal_flow() -> Sheet:
    """Return the block diagram: the two loops, the messages between them, the monitoring."""
    sheet = Sheet(1080, 600, "hubfoc: signal flow")
    _slow_loop(sheet)
    _fast_loop(sheet)
    return sheet


def _periods(sheet: Sheet) -> None:
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
        sheet.box(Box(top + 12, 150, 105, 34, f"compute {name}"), FAST_STEP)
        if number < 2:
            sheet.box(Box(tops[number + 1], 200, PERIOD_PX, 34, f"apply result of {name}"), APPLY)
    middle = tops[1] + PERIOD_PX / 2
    sheet.arrow((tops[0], 262), (middle, 262), colour=RED)
    sheet.line((middle, 234), (middle, 275), colour=RED, dash="3 4")
    sheet.text((tops[0] + PERIOD_PX / 2, 256), "delay 1.5 T on average", colour=RED)


def _milliseconds(sheet: Sheet) -> None:
    pitch = 41.0
    steps = (3, 13)
    sheet.text((20, 342), "fast step, 20 kHz", "start")
    sheet.text((20, 402), "slow step, 1 kHz", "start")
    sheet.text((20, 462), "background", "start")
    for number in range(21):
        x = LEFT_PX + number * pitch
        sheet.box(Box(x, 325, 16, 28, ""), FAST_STEP)
    sheet.text(
        (LEFT_PX + 8.5 * pitch, 316), "10 of 20 periods a millisecond are drawn", colour=GREY
    )
    for step in steps:
        x = LEFT_PX + step * pitch + 18
        sheet.box(Box(x, 385, 21, 28, ""), SLOW_STEP)
        sheet.box(Box(x + pitch, 385, 21, 28, ""), SLOW_STEP)
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


def timing() -> Sheet:
    """Return the timing diagram: sample, compute, apply; the slow step between periods."""
    sheet = Sheet(1080, 500, "hubfoc: sample, compute, apply")
    _periods(sheet)
    _milliseconds(sheet)
    return sheet


DIAGRAMS = {"signal_flow.svg": signal_flow, "slow_step.svg": slow_step, "timing.svg": timing}
# By the module whose README shows it.
PLOTS = {
    "blending.svg": ("torque", blending),
    "pedal_interpretations.svg": ("pedals", pedal_interpretations),
}


def main() -> int:
    """Return the exit status: 1 if a checked file differs."""
    parser = argparse.ArgumentParser(prog="diagrams", description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare only, write no file")
    check = parser.parse_args().check
    status = 0
    plots = {name: draw for name, (_, draw) in PLOTS.items()}
    for name, draw in (DIAGRAMS | plots).items():
        path, text = FOLDER / name, draw().svg()
        if not check:
            path.write_text(text, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            print(f"{path.name} is out of date: run tools/dev python -m diagrams", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
