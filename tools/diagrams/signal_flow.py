# SPDX-License-Identifier: Apache-2.0
"""Block diagram of the firmware: the two loops, the messages between them, the monitoring."""

from diagrams.svg import GREY, Box, Sheet

SLOW = "#e4eefb"
FAST = "#e6f4e6"
WATCH = "#fbeede"
RED = "#a02020"


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

    down = sheet.box(Box(710, 275, 170, 46, "fast_setpoint_t\nsetpoint, gains"))
    up = sheet.box(Box(140, 275, 170, 46, "fast_report_t\nsums, speed, trip"))
    enable = sheet.box(Box(510, 275, 160, 46, "modes\ntorque enable"), WATCH)
    monitor = sheet.box(Box(350, 275, 120, 46, "monitor\nfault, warning"), WATCH)
    sheet.arrow(setpoint.bottom, down.top)
    sheet.arrow((225, 275), (225, 190), (390, 190), limits.bottom)
    sheet.text((235, 184), "measured means", "start", GREY)
    sheet.arrow(up.right, monitor.left)
    sheet.arrow(monitor.right, enable.left)
    sheet.arrow(enable.right, down.left)
    sheet.arrow((590, 275), (590, 220), (430, 220), (430, 155), colour=RED)
    sheet.text((600, 235), "torque enable", "start", RED)
    sheet.arrow((190, 425), (190, 321))
    sheet.text((200, 365), "i_d, i_q, v_dc, angle", "start", GREY)


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


def draw() -> Sheet:
    """Return the block diagram."""
    sheet = Sheet(1080, 600, "hubfoc: signal flow")
    _slow_loop(sheet)
    _fast_loop(sheet)
    return sheet
