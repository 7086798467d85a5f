# SPDX-License-Identifier: Apache-2.0
"""Diagram of the slow step: its parts in order, and what each reads of the step before."""

from itertools import pairwise

from diagrams.svg import GREY, Box, Sheet

RED = "#a02020"
BAND = "#e4eefb"
DELAY = "#fbeede"

LEFT_PX = 290
PITCH_PX = 150
TOP_PX = 250
ROW_PX = 30

PARTS = ("measure", "monitor", "modes", "torque", "bridge choice")
RECORDS = (
    "measured_t",
    "monitored_t",
    "modes_output_t",
    "torque_output_t",
    "bridge_mode_t",
)
# What of last_t is read by which parts, and what for.
DELAYS = (
    ("torque_command_mNm", {"monitor": "torque check", "torque": "rate, handover"}),
    ("torque_estimate_mNm", {"monitor": "torque check"}),
    ("hydraulic_added_mNm", {"torque": "handover"}),
    ("hydraulic_apart_mNm", {"torque": "handover"}),
    ("reference_pu", {"monitor": "does it flow?", "bridge choice": "least current"}),
    ("temperature", {"measure": "correction"}),
    ("safe_bridge", {"monitor": "safe state"}),
    ("engaged", {"modes": "waits for"}),
    ("at_rest", {"measure": "acknowledge"}),
    ("current_missing_q15", {"measure": "heat"}),
)
LATE = (
    ("BRAKE_WEAK, _DEAD, ...", "torque"),
    ("FORCED_TORQUE", "bridge choice"),
)  # fmt: skip


def _x(part: str) -> float:
    return LEFT_PX + PARTS.index(part) * PITCH_PX + PITCH_PX / 2


def _parts(sheet: Sheet) -> None:
    sheet.band(
        Box(10, 20, 1060, 190, "slow step: each part reads what stands left of it"),
        BAND,
    )
    boxes = []
    for part in PARTS:
        boxes.append(sheet.box(Box(_x(part) - 52, 76, 104, 40, part)))
    inputs = sheet.box(Box(120, 76, 110, 40, "fast_report_t,\nslow_input_t"))
    sheet.arrow(inputs.right, boxes[0].left)
    for one, two in pairwise(boxes):
        sheet.arrow(one.right, two.left)
    for part, record in zip(PARTS, RECORDS, strict=True):
        sheet.text((_x(part), 68), record, colour=GREY)
    findings = sheet.box(Box(LEFT_PX + 22, 150, 5 * PITCH_PX - 44, 40, ""), "#ffffff")
    sheet.text((_x("modes"), 167), "findings_t", weight="bold")
    sheet.text((_x("modes"), 183), "checks set rows; modes acts by the reactions", colour=GREY)
    for part in PARTS:
        sheet.arrow((_x(part) - 20, 116), (_x(part) - 20, findings.y), colour=RED)
    for part in ("modes", "torque"):
        sheet.arrow((_x(part) + 20, findings.y), (_x(part) + 20, 116), colour=RED)


def _delays(sheet: Sheet) -> None:
    bottom = TOP_PX + len(DELAYS) * ROW_PX
    height = (len(DELAYS) + len(LATE)) * ROW_PX + 62
    sheet.band(Box(10, TOP_PX - 30, 1060, height, "of the step before: last_t"), DELAY)
    for number, (name, readers) in enumerate(DELAYS):
        y = TOP_PX + number * ROW_PX + 14
        sheet.text((30, y + 4), name, "start")
        right = LEFT_PX + 5 * PITCH_PX
        sheet.line((right, y), (210, y), colour=GREY, dash="3 4")
        for part, use in readers.items():
            sheet.dot((_x(part), y), RED)
            sheet.text((_x(part) + 8, y - 4), use, "start", GREY)
    sheet.text((20, bottom + 24), "findings set behind modes, which act in the next step", "start",
               GREY, "bold")  # fmt: skip
    for number, (name, setter) in enumerate(LATE):
        y = bottom + number * ROW_PX + 44
        sheet.text((30, y + 4), name, "start")
        sheet.dot((_x(setter), y), GREY)
        sheet.arrow((_x(setter), y), (_x("modes"), y), colour=RED)


def slow_step() -> Sheet:
    """Return the diagram: parts and records above, every unit delay of the slow loop below."""
    sheet = Sheet(1080, 660, "hubfoc: the slow step and its unit delays")
    _parts(sheet)
    _delays(sheet)
    return sheet
