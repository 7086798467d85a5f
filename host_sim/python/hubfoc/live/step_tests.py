# SPDX-License-Identifier: Apache-2.0
"""The step test of a wheel's current loop, beside the response that the loop is designed for.

The step is the end of the driving torque, which the wheel obeys in one slow step: the test takes
torque away and makes none. The scope records currents and references at the PWM frequency.

The designed response (``firmware/foc/DERIVATIONS.md``, Reference prefilter) is a first-order lag of
the configured bandwidth that begins 1.5 periods after the sample:

    y[n] = a y[n-1] + (1 - b) r[n-2] + (b - a) r[n-3]        b = exp(-w T/2), a = b^2
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from regen_table.schema import Drive

from hubfoc import addresses, measuring
from hubfoc.errors import HubfocError
from hubfoc.live.scopes import Column, Curve, Found, Scales
from hubfoc.service import Service

TIME_CONSTANTS = 15.0  # of the designed response, after the step; before it a quarter as long
LEAST_ROWS = 40
AXES = ("d", "q")
CURRENTS = {axis: f"fast_view.i_{axis}_pu" for axis in AXES}
REFERENCES = {axis: f"fast_view.i_{axis}_reference_pu" for axis in AXES}
VOLTAGES = {axis: f"fast_view.u_{axis}_pu" for axis in AXES}
LEAST_PU = 656  # a fiftieth of the current base: 41 codes of a 12-bit converter
LIMIT = 0.999  # of the voltage circle
ARMED_S = 0.05  # the rows before the step are there
WAIT_S = 5.0


def designed(reference: Column, bandwidth_hz: float, pwm_hz: float) -> Column:
    """Return the designed current of each sample; before the first the reference was constant."""
    b = math.exp(-math.pi * bandwidth_hz / pwm_hz)
    a = b * b
    r = np.concatenate((np.full(3, reference[0]), reference))
    out = np.empty(len(reference))
    last = float(reference[0])
    for n in range(len(reference)):
        last = a * last + (1.0 - b) * r[n + 1] + (b - a) * r[n]
        out[n] = last
    return out


@dataclass(frozen=True)
class Shape:
    """Of a response to a step, as a person reads it."""

    rise_s: float
    """From 10 to 90 %, straight lines between the samples."""
    overshoot: float
    """Largest distance beyond the new reference, share of the step."""

    @classmethod
    def of(cls, values: Column, first: float, last: float, period_s: float) -> "Shape":
        """Return that of samples from the step on."""
        share = (values - first) / (last - first)
        return cls(
            (_crossing(share, 0.9) - _crossing(share, 0.1)) * period_s,
            float(max(np.max(share) - 1.0, 0.0)),
        )

    def message(self) -> dict[str, float]:
        """Return it as the page takes it."""
        return {"rise_ms": 1e3 * self.rise_s, "overshoot": self.overshoot}


def _crossing(share: Column, level: float) -> float:
    """Return where samples rise to a level for the first time, in samples."""
    above = np.flatnonzero(share >= level)
    if len(above) == 0:
        raise HubfocError("the current has not followed the step")
    n = int(above[0])
    if n == 0:
        return 0.0
    return n - 1 + float((level - share[n - 1]) / (share[n] - share[n - 1]))


@dataclass(frozen=True)
class StepTest:
    """What the loop did and what it is designed for, from the step on."""

    found: Found
    step_a: tuple[float, float]
    measured: Shape
    expected: Shape
    worst_a: float
    """Largest distance of the current that steps from its designed response."""
    code_a: float
    """Of the current converter."""
    limited: bool
    """The voltage reached the circle: then the current is slower than designed."""

    @property
    def worst(self) -> float:
        """Return the largest distance as a share of the step."""
        return self.worst_a / abs(self.step_a[1] - self.step_a[0])

    def message(self) -> dict[str, Any]:
        """Return it as the page takes it."""
        return {
            **self.found.message(),
            "step_a": self.step_a,
            "measured": self.measured.message(),
            "designed": self.expected.message(),
            "worst_a": self.worst_a,
            "worst": self.worst,
            "code_a": self.code_a,
            "limited": self.limited,
        }


def record(wheel: Service, drive: Drive, step: Callable[[], None]) -> StepTest:
    """Record what ``step`` does, which ends the driving torque of the wheel at once."""
    now_pu = wheel.signal(REFERENCES["q"])
    if abs(now_pu) < LEAST_PU:
        least_a = LEAST_PU / 32768 * drive.inverter.current_full_scale_a
        raise HubfocError(
            f"nothing to take away, accepted: while this wheel drives with {least_a:.1f} A or more"
        )
    kind = measuring.KINDS.index("falls" if now_pu > 0 else "rises")

    def armed() -> None:
        time.sleep(ARMED_S)
        step()

    names = [*CURRENTS.values(), *REFERENCES.values(), *VOLTAGES.values()]
    bandwidth_hz = wheel.field("current_loop.bandwidth_Hz")[0]
    pwm_hz = wheel.field("drive.pwm_frequency_Hz")[0]
    wanted = max(round(TIME_CONSTANTS * pwm_hz / (2.0 * math.pi * bandwidth_hz)), LEAST_ROWS)
    before = min(wanted, wheel.scope_rows(names) * 4 // 5) // 4
    found = wheel.scope(
        names, trigger=measuring.Trigger(kind, REFERENCES["q"], now_pu // 2),
        before=before, rows=5 * before, wait_s=WAIT_S, armed=armed,
    )  # fmt: skip
    return compared(found, drive, bandwidth_hz, pwm_hz)


def compared(
    found: measuring.Recording, drive: Drive, bandwidth_hz: float, pwm_hz: float
) -> StepTest:
    """Put the designed response beside a recording with its step at time 0."""
    scales = Scales(drive)
    known = {signal.name: signal for signal in addresses.signals()}
    of = {name: scales.curve(known[name], raw) for name, raw in found.values.items()}
    answers = {
        axis: designed(of[name].values, bandwidth_hz, pwm_hz) for axis, name in REFERENCES.items()
    }
    text = "what the loop is designed for"
    curves = [
        curve
        for axis in reversed(AXES)
        for curve in (
            of[CURRENTS[axis]],
            Curve(f"designed.i_{axis}", of[CURRENTS[axis]].unit, text, answers[axis]),
            of[REFERENCES[axis]],
        )
    ]
    begin = int(np.searchsorted(found.time_s, -0.5 / pwm_hz))
    reference_a = of[REFERENCES["q"]].values
    current_a, expected_a = of[CURRENTS["q"]].values[begin:], answers["q"][begin:]
    first_a, last_a = float(reference_a[begin - 1]), float(reference_a[-1])
    u_d, u_q = (of[VOLTAGES[axis]].values[begin:] for axis in AXES)
    return StepTest(
        found=Found("", found.time_s, (*curves, *(of[name] for name in VOLTAGES.values()))),
        step_a=(first_a, last_a),
        measured=Shape.of(current_a, first_a, last_a, 1.0 / pwm_hz),
        expected=Shape.of(expected_a, first_a, last_a, 1.0 / pwm_hz),
        worst_a=float(np.max(np.abs(current_a - expected_a))),
        code_a=drive.inverter.current_full_scale_a / 2048,
        limited=bool(np.max(np.hypot(u_d, u_q)) >= LIMIT),
    )
