# SPDX-License-Identifier: Apache-2.0
"""Where a motor's hall edges and an encoder's index lie.

From a recording of a wheel that was spun by hand.

The bridge is off, so that what is seen between the motor's wires is its back-EMF, which gives
the angle of the rotor: no motion is commanded and no torque made. Two differential channels on the
wires, three channels on the halls (or one on the index), some turns of the wheel in one direction
and some in the other: a hall sensor switches late in both, so that the middle between them is its
edge. In one direction alone half of that hysteresis counts as the edge's place, which is said.

Offsets of the voltage channels are estimated from the recording and taken off; a logic channel
switches where it crosses the middle between its own levels.

    e_a = -w psi sin(theta),  e_b and e_c lag by a third and two thirds of a turn
    alpha = (2 v_ab + v_bc) / 3,  beta = v_bc / sqrt(3)
    theta = atan2(-alpha, beta) forward, half a turn more backward: the EMF has the speed's sign
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from regen_table import halls, inputs
from regen_table.errors import ConfigurationError

Array = npt.NDArray[np.float64]
Levels = npt.NDArray[np.bool_]
# Spacing and order: each of the eight sequences of states that three sensors can turn through.
WIRINGS = (
    *((120, order) for order in ("abc", "acb")),
    *((60, order) for order in ("abc", "acb", "bac", "bca", "cab", "cba")),
)
VOLTAGES = ("v_ab_v", "v_bc_v")
HALLS = ("hall_a", "hall_b", "hall_c")
INDEX = "index"
SLOWEST_SHARE = 0.2  # of the largest EMF: below it the angle of the EMF is noise
LEAST_EDGES = 3
LEAST_ROWS = 10
WIDEST_SPREAD_DEG = 6.0
WIDEST_HYSTERESIS_DEG = 30.0
OFFSET_PASSES = 4  # the angle, which weights the samples, is off by the offset itself
FORWARD, BACKWARD = 1, -1


@dataclass(frozen=True)
class Place:
    """An electrical angle in degrees.

    Attributes
    ----------
    angle_deg : float
        The middle between the means of both directions, or the mean of the only one.
    edges : int
        How many there were.
    spread_deg : float
        Distance of the farthest one from the mean of its direction.
    hysteresis_deg : float or None
        From the mean of one direction to that of the other; None: turned in one only.
    """

    angle_deg: float
    edges: int
    spread_deg: float
    hysteresis_deg: float | None


@dataclass(frozen=True)
class Calibration:
    """What was found in a recording; edges are in the order of the configuration."""

    hall_edges: tuple[Place, ...]
    hall_wiring: tuple[int, str]
    index: Place | None

    @property
    def both_directions(self) -> bool:
        """Whether every place was seen in both directions."""
        places = (*self.hall_edges, *filter(None, [self.index]))
        return all(place.hysteresis_deg is not None for place in places)


def load(path: Path) -> dict[str, Array]:
    """Read a recording: a row a sample, columns by name, voltages in V, logic levels 0 or 1."""
    what = (
        f"a table with the columns {', '.join(VOLTAGES)} and either {', '.join(HALLS)} or {INDEX}"
    )
    columns = inputs.read_table(path, what, _suits)
    present = [name for name in (*VOLTAGES, *HALLS, INDEX) if name in columns]
    try:
        table = {name: np.array([float(cell) for cell in columns[name]]) for name in present}
    except ValueError as error:
        raise ConfigurationError(f"{path}: a value is no number: {error}") from error
    if not all(np.all(np.isfinite(values)) for values in table.values()):
        raise ConfigurationError(f"{path}: a value is not finite, accepted: {what}")
    if len(table[VOLTAGES[0]]) < LEAST_ROWS:
        raise ConfigurationError(
            f"{path}: accepted: at least {LEAST_ROWS} rows, some turns of the wheel"
        )
    return table


def _suits(columns: Sequence[str]) -> bool:
    """Whether a recording has voltages, and halls or an index."""
    sensors = INDEX in columns or all(name in columns for name in HALLS)
    return sensors and all(name in columns for name in VOLTAGES)


def rotor_angle_turn(v_ab_v: Array, v_bc_v: Array) -> Array:
    """Return the electrical angle in turns, continuous, from the EMF between the wires.

    NaN where there is too little EMF.

    Parameters
    ----------
    v_ab_v, v_bc_v : (samples,) arrays
        Wire a against b and b against c, V; a constant offset of each is taken off.
    """
    alpha, beta = (2.0 * v_ab_v + v_bc_v) / 3.0, v_bc_v / math.sqrt(3.0)
    for _ in range(OFFSET_PASSES):
        weight = _weight(np.unwrap(np.arctan2(-alpha, beta)), _strong(np.hypot(alpha, beta)))
        alpha, beta = (part - np.average(part, weights=weight) for part in (alpha, beta))
    angle = np.unwrap(np.arctan2(-alpha, beta)) / (2.0 * math.pi)
    # The direction, from the angle's rise over some samples either side; the phase of the EMF turns
    # with the rotor.
    half_window = max(1, min(len(angle) // 100, 50))
    rise = np.convolve(np.gradient(angle), np.ones(2 * half_window + 1), mode="same")
    angle = np.where(rise >= 0.0, angle, angle + 0.5)
    return np.where(_strong(np.hypot(alpha, beta)), angle, np.nan)


def _strong(strength: Array) -> npt.NDArray[np.bool_]:
    return strength >= SLOWEST_SHARE * float(np.max(strength, initial=0.0))


def _weight(phase: Array, strong: npt.NDArray[np.bool_]) -> Array:
    """Return the weights with which the mean of an EMF is its channel's offset.

    Steps of phase under a Hann window over each stretch of enough EMF: a sine of many turns whose
    amplitude changes slowly has no mean under it.
    """
    step = np.abs(np.gradient(phase))
    weight = np.zeros_like(phase)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], strong, [False]]).astype(np.int64)))
    for first, last in ends.reshape(-1, 2):
        progress = np.cumsum(step[first:last])
        window = np.sin(np.pi * progress / max(float(progress[-1]), 1e-12)) ** 2
        weight[first:last] = step[first:last] * window
    return weight if np.any(weight > 0.0) else np.ones_like(phase)


def _mean_turn(turn: Array) -> float:
    return float(np.angle(np.mean(np.exp(2j * np.pi * turn)))) / (2.0 * math.pi)


def _beside_deg(turn: Array, mean: float) -> Array:
    return ((turn - mean + 0.5) % 1.0 - 0.5) * 360.0


def _place(found: Sequence[tuple[float, int]], what: str) -> Place:
    """Return where something is that was seen at some angles (turns), each with its direction."""
    if len(found) < LEAST_EDGES:
        raise ConfigurationError(
            f"{what}: {len(found)} times in the recording, accepted: at least {LEAST_EDGES}"
        )
    ways = [
        np.array([angle for angle, direction in found if direction == way])
        for way in (FORWARD, BACKWARD)
    ]
    ways = [turn for turn in ways if len(turn)]
    means = [_mean_turn(turn) for turn in ways]
    spread = max(
        float(np.max(np.abs(_beside_deg(turn, mean))))
        for turn, mean in zip(ways, means, strict=True)
    )
    apart = float(_beside_deg(np.array(means[-1]), means[0]))
    if spread > WIDEST_SPREAD_DEG or abs(apart) > WIDEST_HYSTERESIS_DEG:
        raise ConfigurationError(
            f"{what}: up to {max(spread, abs(apart) / 2.0):.1f} deg beside its mean, accepted:"
            f" {WIDEST_SPREAD_DEG:g} deg; are wires a, b, c and the sensors in the order of the"
            " inverter's?"
        )
    middle = (means[0] * 360.0 + apart / 2.0) % 360.0
    return Place(middle, len(found), spread, abs(apart) if len(ways) == 2 else None)


def _edges(signal: Array) -> tuple[npt.NDArray[np.bool_], Array]:
    """Return a logic channel's levels, and how far into each step of samples it crosses its middle.

    A share of the step from a sample to the next, of meaning where the level changes.
    """
    middle = 0.5 * (float(np.min(signal)) + float(np.max(signal)))
    step = np.diff(signal)
    share = (middle - signal[:-1]) / np.where(step == 0.0, 1.0, step)
    return signal > middle, np.clip(share, 0.0, 1.0)


def _at(angle_turn: Array, before: int, share: float) -> float:
    return float(angle_turn[before] + share * (angle_turn[before + 1] - angle_turn[before]))


def _edges_if(
    angle_turn: Array, sensors: Sequence[tuple[Levels, Array]], states: Sequence[int]
) -> tuple[Place, ...] | str:
    """Return the edges of sectors with these states, or what there should be instead."""
    a, b, c = (level.astype(np.int64) for level, _ in sensors)
    state = a | b << 1 | c << 2
    found: list[list[tuple[float, int]]] = [[] for _ in states]
    for k in np.flatnonzero(np.diff(state)).tolist():
        here, there = int(state[k]), int(state[k + 1])
        known = here in states and there in states
        way = (states.index(there) - states.index(here)) % 6 if known else 0
        if way not in {1, 5}:
            return "one sensor changing at a time, through six states"
        changed = (here ^ there).bit_length() - 1
        angle = _at(angle_turn, k, float(sensors[changed][1][k]))
        if math.isfinite(angle):
            edge = states.index(there if way == 1 else here)
            found[edge].append((angle, FORWARD if way == 1 else BACKWARD))
    places = tuple(_place(angles, f"hall edge {k}") for k, angles in enumerate(found))
    widths = [
        (after.angle_deg - before.angle_deg) % 360.0
        for before, after in zip(places, (*places[1:], places[0]), strict=True)
    ]
    forward = math.isclose(sum(widths), 360.0) and all(30.0 <= width <= 90.0 for width in widths)
    return places if forward else "edges 30 to 90 deg apart"


def hall_edges(
    angle_turn: Array, sensors: Sequence[Array]
) -> tuple[tuple[Place, ...], tuple[int, str]]:
    """Return where sectors 0 to 5 begin when turning forward, and the wiring: of ``WIRINGS``."""
    seen = [_edges(sensor) for sensor in sensors]
    wanted = set()
    for spacing_deg, order in WIRINGS:
        found = _edges_if(angle_turn, seen, halls.states(spacing_deg, "", order))
        if not isinstance(found, str):
            return found, (spacing_deg, order)
        wanted.add(found)
    raise ConfigurationError(f"halls: accepted: {', '.join(sorted(wanted))}")


def index_place(angle_turn: Array, signal: Array) -> Place:
    """Return where an encoder's index begins when turning forward; backward it ends there."""
    level, share = _edges(signal)
    change = np.diff(level.astype(np.int64))
    found = []
    for k in np.flatnonzero(change).tolist():
        angle, rise = _at(angle_turn, k, float(share[k])), angle_turn[k + 1] - angle_turn[k]
        way = FORWARD if rise > 0.0 else BACKWARD
        if math.isfinite(angle) and change[k] == way:
            found.append((angle, way))
    return _place(found, "index")


def calibrate(table: dict[str, Array]) -> Calibration:
    """Evaluate a recording."""
    angle = rotor_angle_turn(table[VOLTAGES[0]], table[VOLTAGES[1]])
    fitted = all(name in table for name in HALLS)
    places, wiring = (
        hall_edges(angle, [table[name] for name in HALLS]) if fitted else ((), WIRINGS[0])
    )
    return Calibration(
        places,
        wiring,
        index_place(angle, table[INDEX]) if INDEX in table else None,
    )


def _uncertainty(places: Sequence[Place]) -> str:
    """Return what is known of the accuracy of some places."""
    spread = max(place.spread_deg for place in places)
    known = [place.hysteresis_deg for place in places if place.hysteresis_deg is not None]
    if len(known) < len(places):
        return f"within {spread:.1f} deg and half the hysteresis, as turned in one direction only"
    return f"within {spread:.1f} deg, hysteresis {max(known):.1f} deg"


def as_toml(found: Calibration) -> str:
    """Return the lines for the [rotor] section of a drive's file."""
    lines = ["[rotor]"]
    if found.hall_edges:
        edges = ", ".join(f"{place.angle_deg:.1f}" for place in found.hall_edges)
        count = min(place.edges for place in found.hall_edges)
        lines += [
            'sensor = "hall"',
            f"hall_edges_deg = [{edges}]"
            f"  # at least {count} each, {_uncertainty(found.hall_edges)}",
        ]
        spacing_deg, order = found.hall_wiring
        lines += ["hall_spacing_deg = 60"] if spacing_deg == 60 else []
        lines += [f'hall_order = "{order}"'] if order != "abc" else []
    if found.index is not None:
        lines += ['sensor = "encoder"'] if not found.hall_edges else []
        lines.append(
            f"encoder_index_deg = {found.index.angle_deg:.1f}  # {found.index.edges} pulses,"
            f" {_uncertainty([found.index])}"
        )
    return "\n".join(lines)
