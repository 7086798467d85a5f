# SPDX-License-Identifier: Apache-2.0
"""The record of a wheel's first fault, as the page draws it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from hubsim import engine, reasons
from hubsim.report import black_box
from regen_table.schema import Drive

COMMAND = "blackbox"
TORQUES = ("command", "estimate", "hydraulic")


def shown(answer: str, drive: Drive) -> dict[str, Any]:
    """Return what the shell's answer says, and as curves where there is a complete record.

    Times are seconds from the fault.
    """
    if "0000: " not in answer:
        lines = [line.strip() for line in answer.splitlines() if line.strip()]
        answered = [line for line in lines if not line.lstrip("> ").startswith(COMMAND)]
        return {"reason": None, "text": "", "fault_s": None, "lines": answered, "panels": []}
    inverter = drive.inverter
    record = black_box.read(
        black_box.bytes_of(answer, "the wheel's answer"), "the wheel's answer",
        inverter.current_full_scale_a, inverter.voltage_full_scale_v,
    )  # fmt: skip
    return {
        "reason": record.reason,
        "text": engine.reason_text(reasons.codes()[record.reason]),
        "fault_s": record.fault_s,  # since the start of the wheel's program
        "lines": black_box.summary(record),
        "panels": _panels(record),
    }


def _panels(record: black_box.Record) -> list[dict[str, Any]]:
    fast, slow = record.fast_s, record.slow_s
    currents = {f"phase {phase}": record.current_a[:, k] for k, phase in enumerate("abc")}
    return [
        _panel("Phase currents", "A", fast, currents),
        _panel("Bus voltage", "V", fast, {"at the inverter": record.bus_v}),
        _panel("Torque", "N.m", slow, {name: record.slow[name] for name in TORQUES}),
        _panel("Wheel speed", "rad/s", slow, {"mechanical": record.slow["speed"]}),
    ]


def _panel(
    title: str, unit: str, time_s: npt.NDArray[np.float64],
    curves: dict[str, npt.NDArray[np.float64]],
) -> dict[str, Any]:  # fmt: skip
    return {
        "title": title,
        "unit": unit,
        "time_s": _rounded(time_s, 6),
        "curves": [
            {"name": name, "values": _rounded(column, 3)} for name, column in curves.items()
        ],
    }


def _rounded(values: npt.NDArray[np.float64], decimals: int) -> Sequence[float]:
    return [float(value) for value in np.round(values, decimals)]
