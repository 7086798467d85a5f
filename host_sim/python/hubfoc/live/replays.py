# SPDX-License-Identifier: Apache-2.0
"""A recording run again for the page, and the curves of one wheel, recorded and replayed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from hubsim import configuration, steps, variables
from hubsim.configuration import Configuration
from hubsim.controller import Controller
from hubsim.engine import Steps

from hubfoc import replay
from hubfoc.recording import Part, Recording

SHOWN_LINES = 2  # what it is, and the first difference
GROUPS = 1000  # on a curve, each as its least and its largest value

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Replayed:
    """The slow steps' outputs of one wheel by raw name, a row each millisecond."""

    wheel: int
    words: str
    open_loop: bool
    simulated: bool
    equal: bool
    time_s: Column
    recorded: npt.NDArray[np.int32]
    replayed: npt.NDArray[np.int32]
    image: bytes


def run(file: Path, wheel: int, values: Mapping[str, Sequence[int]], *, simulate: bool) -> Replayed:
    """Replay a recording, with other values for some fields of the configuration."""

    def changed(image: bytes) -> bytes:
        own: dict[tuple[str, str], int | list[int]] = {}
        for name, found in values.items():
            section, _, field = name.partition(".")
            own[section, field] = list(found) if len(found) > 1 else found[0]
        return configuration.changed_image(image, own)

    times: list[Column] = []
    before: list[npt.NDArray[np.int32]] = []
    after: list[npt.NDArray[np.int32]] = []
    images: list[bytes] = []
    first = len(steps.inputs(steps.SLOW))
    last = first + len(steps.outputs(steps.SLOW))

    def take(part: Part, now: Steps) -> None:
        if part.wheel == wheel:
            rows = part.steps["kind"] == steps.SLOW
            times.append(part.time_s[rows])
            before.append(part.steps["values"][rows, first:last])
            after.append(now["values"][rows, first:last])
            images.extend(part.images)

    parameters = changed if values else None
    found = replay.compared(Recording(file), parameters, simulate=simulate, take=take)
    lines = replay.in_words(found, others=bool(values)).splitlines()
    return Replayed(
        wheel, "\n".join(lines[:SHOWN_LINES]), found.open_loop, simulate, found.equal,
        np.concatenate(times), np.concatenate(before), np.concatenate(after), images[0],
    )  # fmt: skip


def signals() -> dict[str, list[str]]:
    """Return unit and text of what can be drawn, by name."""
    rows = variables.of_port(variables.SLOW_OUTPUT)
    return {row.name: [row.unit, row.text] for row in rows}


def curve(result: Replayed, name: str) -> dict[str, Any]:
    """Return times and values of a signal, recorded and replayed, in its unit."""
    place = [row.name for row in variables.of_port(variables.SLOW_OUTPUT)].index(name)
    controller = Controller(Configuration("recorded", result.image))
    zero, per_unit = controller.scale(variables.SLOW_OUTPUT, place)
    length = max(-(-len(result.time_s) // GROUPS), 1)
    return {
        "signal": name,
        "time_s": _first_and_last(result.time_s, length),
        **{
            kind: _bounds((values[:, place] - zero) / per_unit, length)
            for kind, values in (("recorded", result.recorded), ("replayed", result.replayed))
        },
    }


def _groups(values: npt.NDArray[Any], length: int) -> npt.NDArray[Any]:
    """Return values in rows of a length; the last is filled with the last value."""
    missing = -len(values) % length
    return np.pad(values, (0, missing), mode="edge").reshape(-1, length)


def _first_and_last(times: Column, length: int) -> list[float]:
    found = _groups(times, length)
    return [float(t) for t in np.round(found[:, [0, -1]] if length > 1 else found, 6).ravel()]


def _bounds(values: npt.NDArray[Any], length: int) -> list[float]:
    found = _groups(values, length)
    if length == 1:
        return [float(value) for value in found.ravel()]
    return [float(v) for v in np.stack([found.min(axis=1), found.max(axis=1)], axis=1).ravel()]
