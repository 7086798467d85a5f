# SPDX-License-Identifier: Apache-2.0
"""Questions to a wheel's shell: the table of torque limits all the time, others when asked for."""

import re
from concurrent.futures import Future
from dataclasses import asdict, dataclass
from typing import Any

from hubsim import engine, reasons
from hubsim.engine import Rows

from hubfoc.errors import HubfocError
from hubfoc.live.vehicle import LiveVehicle

QUESTION = b"limits\r"
PROMPT = b"\n> "
EVERY_S = 0.2
GIVE_UP_S = 1.0  # of the table
COMMAND_S = 10.0  # of a long answer, 18 kB at 115 200 baud take 1.6 s
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


@dataclass
class _Asked:
    """A question that waits for the end of its answer."""

    since_s: float
    future: Future[str] | None  # None: the table
    answer: bytes = b""

    @property
    def until_s(self) -> float:
        return self.since_s + (GIVE_UP_S if self.future is None else COMMAND_S)


class Inquiry:
    """Asks one wheel after the other through its shell, without a terminal's reader seeing it.

    Whoever types at a wheel's terminal has the shell alone for half a minute.
    """

    def __init__(self) -> None:
        self.wanted: set[int] = set()  # wheels whose table is
        self.tables: dict[int, tuple[float, list[Limit]]] = {}
        self._commands: dict[int, list[tuple[bytes, Future[str]]]] = {}
        self._asked: dict[int, _Asked] = {}
        self._table_s: dict[int, float] = {}
        self._typed_s: dict[int, float] = {}

    def begin(self) -> None:
        """Start with another vehicle; what was asked is not answered any more."""
        waiting = [future for asked in self._commands.values() for _, future in asked]
        waiting += [asked.future for asked in self._asked.values() if asked.future is not None]
        for future in waiting:
            future.set_exception(HubfocError("the vehicle has begun again"))
        self.tables, self._commands = {}, {}
        self._asked, self._table_s, self._typed_s = {}, {}, {}

    def command(self, wheel: int, command: str, now_s: float) -> Future[str]:
        """Ask a wheel's shell this as soon as it is free; return its answer to come."""
        if self.is_left_alone(wheel, now_s):
            raise HubfocError("somebody types at this wheel's shell, accepted: half a minute later")
        future: Future[str] = Future()
        self._commands.setdefault(wheel, []).append((command.encode("ascii") + b"\r", future))
        return future

    def ask(self, vehicle: LiveVehicle) -> None:
        """Ask where an answer is wanted and due."""
        now_s = vehicle.time_s
        for wheel in self.wanted | set(self._commands):
            asked = self._asked.get(wheel)
            if asked is not None:
                if now_s < asked.until_s:
                    continue
                del self._asked[wheel]
                if asked.future is not None:
                    asked.future.set_exception(HubfocError("this wheel's shell does not answer"))
            if not self.is_left_alone(wheel, now_s):
                self._ask_next(vehicle, wheel, now_s)

    def _ask_next(self, vehicle: LiveVehicle, wheel: int, now_s: float) -> None:
        commands = self._commands.get(wheel)
        if commands:
            text, future = commands.pop(0)
            if not commands:
                del self._commands[wheel]
        elif wheel in self.wanted and now_s - self._table_s.get(wheel, -EVERY_S) >= EVERY_S:
            text, future = QUESTION, None
            self._table_s[wheel] = now_s
        else:
            return
        self._asked[wheel] = _Asked(now_s, future)
        vehicle.serial_type(wheel, text)

    def typed(self, wheel: int, now_s: float) -> None:
        """Somebody has typed at this wheel's terminal."""
        self._typed_s[wheel] = now_s

    def is_left_alone(self, wheel: int, now_s: float) -> bool:
        """Return whether somebody else uses this wheel's shell."""
        return now_s - self._typed_s.get(wheel, -LEFT_ALONE_S) < LEFT_ALONE_S

    def received(self, wheel: int, written: bytes, now_s: float) -> bytes:
        """Take what belongs to an answer; return what is for the terminal."""
        asked = self._asked.get(wheel)
        if asked is None:
            return written
        asked.answer += written
        head, prompt, rest = asked.answer.partition(PROMPT)
        if not prompt:
            return b""
        del self._asked[wheel]
        text = head.decode("ascii", "replace")
        if asked.future is not None:
            asked.future.set_result(text)
        elif found := parsed(text):
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
