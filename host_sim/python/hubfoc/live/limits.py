# SPDX-License-Identifier: Apache-2.0
"""The table of torque limits of a wheel, as its firmware's shell answers ``limits``."""

import re
from dataclasses import asdict, dataclass
from typing import Any

from hubsim import engine, reasons
from hubsim.engine import Rows

from hubfoc.live.vehicle import LiveVehicle

QUESTION = b"limits\r"
PROMPT = b"\n> "
EVERY_S = 0.2
GIVE_UP_S = 1.0
LEFT_ALONE_S = 30.0  # after somebody typed at a wheel's terminal
LINE = re.compile(r"^([A-Z_]+) +(-|[\d.]+)( \*)? +(-|[\d.]+)( \*)?(?: +(\S.*))?$")
# The reasons that a line can give; every other one is the line ENABLE's.
REASONS = {
    "MAX_TORQUE": ("MAX_TORQUE",),
    "MAX_POWER": ("MAX_POWER",),
    "PHASE_CURRENT": ("PHASE_CURRENT",),
    "VOLTAGE": ("VOLTAGE", "OVERSPEED"),
    "DRAWN": ("DISCHARGE_CURRENT", "BUS_VOLTAGE_LOW"),
    "RETURNED": ("CHARGE_CURRENT", "BUS_VOLTAGE_HIGH"),
    "MAX_SPEED": ("MAX_SPEED",),
    "WINDING": ("WINDING_TEMPERATURE",),
    "SWITCH": ("SWITCH_TEMPERATURE",),
    "ROTOR": ("ROTOR_UNCERTAIN",),
    "CURRENT_GAIN": ("CURRENT_GAIN",),
    "LOSS_OPTIMUM": ("LOSS_OPTIMUM",),
    "ELECTRIC_RATED": ("ELECTRIC_RATED",),
    "BLEND_OUT": ("BLEND_OUT",),
    "ELECTRIC_SHARE": ("ELECTRIC_SHARE",),
    "ABS": ("ABS",),
}
NO_LINE = ("NONE", "TORQUE_RATE")  # reasons that are no line of the table


@dataclass(frozen=True)
class Limit:
    """One line: bounds in N m, None: no bound; whether it is the tightest of its side."""

    name: str
    driving_nm: float | None
    braking_nm: float | None
    tightest_driving: bool
    tightest_braking: bool
    text: str


def parsed(answer: str) -> list[Limit]:
    """Return the lines of the shell's answer."""
    out = []
    for line in answer.splitlines():
        found = LINE.match(line.rstrip())
        if found:
            name, driving, driving_star, braking, braking_star, text = found.groups()
            bounds = [None if bound == "-" else float(bound) for bound in (driving, braking)]
            stars = (bool(driving_star), bool(braking_star))
            out.append(Limit(name, bounds[0], bounds[1], *stars, text or ""))
    return out


def cost_of_lines(cost_j: Rows) -> dict[str, float]:
    """Return the heat of a wheel's hydraulic brake by the line that limited its motor.

    ``cost_j``: by the code of the reason.
    """
    codes = reasons.codes()
    out = {line: sum(cost_j[codes[name]] for name in names) for line, names in REASONS.items()}
    elsewhere = sum(cost_j[codes[name]] for name in NO_LINE)
    out["ENABLE"] = cost_j.sum() - sum(out.values()) - elsewhere
    out["TORQUE_RATE"] = cost_j[codes["TORQUE_RATE"]]
    return {line: float(max(cost, 0.0)) for line, cost in out.items()}


def texts() -> dict[str, str]:
    """Return a text for each line, for where the shell gives none because it has no bound."""
    codes = reasons.codes()
    return {
        line: engine.reason_text(codes[names[0]])
        for line, names in (*REASONS.items(), ("ENABLE", ("TORQUE_ENABLE",)))
    }


class Inquiry:
    """Asks one wheel after the other through its shell, without a terminal's reader seeing it.

    Whoever types at a wheel's terminal has the shell alone for half a minute.
    """

    def __init__(self) -> None:
        self.wanted: set[int] = set()
        self.tables: dict[int, tuple[float, list[Limit]]] = {}
        self._asked: dict[int, float] = {}
        self._answers: dict[int, bytes] = {}
        self._typed_s: dict[int, float] = {}

    def begin(self) -> None:
        """Start with another vehicle."""
        self.tables = {}
        self._asked, self._answers, self._typed_s = {}, {}, {}

    def ask(self, vehicle: LiveVehicle) -> None:
        """Ask where an answer is wanted and due."""
        now_s = vehicle.time_s
        for wheel in self.wanted:
            asked_s = self._asked.get(wheel, -EVERY_S)
            waits = wheel in self._answers and now_s - asked_s < GIVE_UP_S
            if waits or now_s - asked_s < EVERY_S or self.is_left_alone(wheel, now_s):
                continue
            self._asked[wheel] = now_s
            self._answers[wheel] = b""
            vehicle.serial_type(wheel, QUESTION)

    def typed(self, wheel: int, now_s: float) -> None:
        """Somebody has typed at this wheel's terminal."""
        self._typed_s[wheel] = now_s

    def is_left_alone(self, wheel: int, now_s: float) -> bool:
        """Return whether somebody else uses this wheel's shell."""
        return now_s - self._typed_s.get(wheel, -LEFT_ALONE_S) < LEFT_ALONE_S

    def received(self, wheel: int, written: bytes, now_s: float) -> bytes:
        """Take what belongs to an answer; return what is for the terminal."""
        if wheel not in self._answers:
            return written
        answer = self._answers[wheel] + written
        head, prompt, rest = answer.partition(PROMPT)
        if not prompt:
            self._answers[wheel] = answer
            return b""
        del self._answers[wheel]
        found = parsed(head.decode("ascii", "replace"))
        if found:
            self.tables[wheel] = (now_s, found)
        return rest

    def shown(self, wheel: int, cost_j: Rows) -> dict[str, Any]:
        """Return a wheel's table as the page shows it."""
        asked_s, lines = self.tables.get(wheel, (None, []))
        return {
            "wheel": wheel,
            "time_s": asked_s,
            "in_use": self.is_left_alone(wheel, asked_s or 0.0),
            "lines": [asdict(line) for line in lines],
            "cost_j": cost_of_lines(cost_j),
        }
