# SPDX-License-Identifier: Apache-2.0
"""The scope of a wheel for the page: any eight signals at the PWM frequency, in their units."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from hubsim import configuration, reasons, variables
from hubsim.controller import Controller
from regen_table.schema import Drive

from hubfoc import addresses, measuring
from hubfoc.addresses import Signal
from hubfoc.errors import HubfocError
from hubfoc.service import Service

WAIT_S = 30.0  # for the trigger

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """One signal of a recording, in its unit."""

    name: str
    unit: str
    text: str
    values: Column


@dataclass(frozen=True)
class Found:
    """What the page draws; time 0 is that of the trigger."""

    words: str
    time_s: Column
    curves: tuple[Curve, ...]

    def message(self) -> dict[str, Any]:
        """Return it as the page takes it."""
        return {
            "words": self.words,
            "time_s": [float(value) for value in np.round(self.time_s, 7)],
            "curves": [
                {
                    "name": curve.name,
                    "unit": curve.unit,
                    "text": curve.text,
                    "values": [float(f"{value:.7g}") for value in curve.values],
                }
                for curve in self.curves
            ],
        }

    def columns(self) -> dict[str, Column]:
        """Return time and values by name."""
        return {"time_s": self.time_s, **{curve.name: curve.values for curve in self.curves}}


def signals() -> dict[str, list[str]]:
    """Return unit and text of every signal of the scope by name."""
    return {s.name: [s.variable.unit, s.variable.text] for s in addresses.signals()}


def record(
    wheel: Service, drive: Drive, wanted: Mapping[str, Any], armed: Callable[[], None]
) -> Found:
    """Record what the page wants: ``signals``, ``trigger``, ``on``, ``level``, and so on.

    ``level`` is in the signal's unit, or the name of a finding's reason; ``before`` is a share of
    the rows, of which there are as many as the wheel's memory holds. ``armed`` is called when the
    scope waits for its trigger.
    """
    scales = Scales(drive)
    names = [str(name) for name in wanted["signals"]]
    every = int(wanted["every"])
    known = {signal.name: signal for signal in addresses.signals()}
    for name in names:
        if name not in known:
            raise HubfocError(f"{name}: no such signal, accepted: those of the list")
    rows = wheel.scope_rows(names)
    before = min(int(float(wanted["before"]) * rows), rows - 1)
    trigger = _trigger(wanted, known, scales)
    found = wheel.scope(
        names, trigger=trigger, before=before, every=every, wait_s=WAIT_S, armed=armed
    )
    curves = tuple(scales.curve(known[name], found.values[name]) for name in names)
    rate = f"a row every {every} PWM periods" if every > 1 else "every PWM period"
    return Found(f"{len(found.time_s)} rows, {rate}", found.time_s, curves)


def _trigger(
    wanted: Mapping[str, Any], known: Mapping[str, Signal], scales: "Scales"
) -> measuring.Trigger:
    kind, on, level = str(wanted["trigger"]), str(wanted["on"]), str(wanted["level"])
    if kind == "none":
        return measuring.Trigger()
    if kind == "finding":
        if level and level not in reasons.codes():
            raise HubfocError(f"{level}: no such reason, accepted: one of the findings, or none")
        return measuring.Trigger.of(f"finding:{level}" if level else "finding")
    if on not in known:
        raise HubfocError(f"{on}: no such signal to trigger on, accepted: those of the list")
    try:
        value = float(level)
    except ValueError as error:
        raise HubfocError(f"level: {level!r}, accepted: a number in the signal's unit") from error
    return measuring.Trigger(measuring.KINDS.index(kind), on, scales.raw(known[on], value))


class Scales:
    """Raw values of a wheel's signals and those in their units."""

    def __init__(self, drive: Drive) -> None:
        image = configuration.image_of(drive)
        self._controller = Controller(configuration.Configuration(drive.name, image))

    def curve(self, signal: Signal, raw: npt.NDArray[np.int64]) -> Curve:
        """Return raw values in their unit."""
        zero, per_unit = self._of(signal)
        row = signal.variable
        values = (raw.astype(np.float64) - zero) / per_unit
        return Curve(signal.name, row.unit, row.text, values)

    def raw(self, signal: Signal, value: float) -> int:
        """Return the nearest raw value of a signal."""
        zero, per_unit = self._of(signal)
        row = signal.variable
        return int(min(max(round(zero + value * per_unit), row.lowest_raw), row.highest_raw))

    def _of(self, signal: Signal) -> tuple[float, float]:
        if signal.variable.kind != variables.REAL:
            return 0.0, 1.0
        return self._controller.scale(signal.list, signal.number)
