# SPDX-License-Identifier: Apache-2.0
"""Where a motor's hall edges and an encoder's index lie.

From a recording of a wheel that was spun by hand.

The bridge is off, so that what is seen between the motor's wires is its back-EMF, which gives
the angle of the rotor: no motion is commanded and no torque made. Two differential channels on the
wires, three logic channels on the halls (or one on the index), some turns of the wheel, in either
direction.

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

from regen_table import inputs
from regen_table.errors import ConfigurationError

Array = npt.NDArray[np.float64]
STATES = (
    5,
    1,
    3,
    2,
    6,
    4,
)  # of sectors 0 to 5 turning forward, bits C B A, as in firmware/foc/hall.c
VOLTAGES = ("v_ab_v", "v_bc_v")
HALLS = ("hall_a", "hall_b", "hall_c")
INDEX = "index"
SLOWEST_SHARE = 0.2  # of the largest EMF: below it the angle of the EMF is noise
LEAST_EDGES = 3
LEAST_ROWS = 10
WIDEST_SPREAD_DEG = 6.0


@dataclass(frozen=True)
class Place:
    """A mean electrical angle in degrees, from how many edges, and the farthest one's distance."""

    angle_deg: float
    edges: int
    spread_deg: float


@dataclass(frozen=True)
class Calibration:
    """What was found in a recording; edges are in the order of the configuration."""

    hall_edges: tuple[Place, ...]
    index: Place | None


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
        Wire a against b and b against c, V.
    """
    alpha, beta = (2.0 * v_ab_v + v_bc_v) / 3.0, v_bc_v / math.sqrt(3.0)
    strength = np.hypot(alpha, beta)
    angle = np.unwrap(np.arctan2(-alpha, beta)) / (2.0 * math.pi)
    # The direction, from the angle's rise over some samples either side; the phase of the EMF turns
    # with the rotor.
    half_window = max(1, min(len(angle) // 100, 50))
    rise = np.convolve(np.gradient(angle), np.ones(2 * half_window + 1), mode="same")
    angle = np.where(rise >= 0.0, angle, angle + 0.5)
    return np.where(strength >= SLOWEST_SHARE * float(np.max(strength, initial=0.0)), angle, np.nan)


def _place(angles_turn: Sequence[float], what: str) -> Place:
    if len(angles_turn) < LEAST_EDGES:
        raise ConfigurationError(
            f"{what}: {len(angles_turn)} times in the recording, accepted: at least {LEAST_EDGES}"
        )
    turn = np.array(angles_turn)
    mean = float(np.angle(np.mean(np.exp(2j * np.pi * turn)))) / (2.0 * math.pi)
    beside = float(np.max(np.abs((turn - mean + 0.5) % 1.0 - 0.5))) * 360.0
    if beside > WIDEST_SPREAD_DEG:
        raise ConfigurationError(
            f"{what}: up to {beside:.1f} deg beside its mean, accepted: {WIDEST_SPREAD_DEG:g} deg; "
            "are wires a, b, c and the sensors in the order of the inverter's?"
        )
    return Place(mean % 1.0 * 360.0, len(angles_turn), beside)


def _between(angle_turn: Array, before: int) -> float:
    return 0.5 * float(angle_turn[before] + angle_turn[before + 1])


def hall_edges(angle_turn: Array, state: npt.NDArray[np.int64]) -> tuple[Place, ...]:
    """Return the angles at which sectors 0 to 5 begin when turning forward."""
    found: list[list[float]] = [[] for _ in STATES]
    for k in np.flatnonzero(np.diff(state)).tolist():
        here, there = int(state[k]), int(state[k + 1])
        if here not in STATES or there not in STATES:
            raise ConfigurationError(
                f"halls: state {here} to {there} at row {k + 2}, accepted: one sensor changing at a"
                " time"
            )
        left, entered = STATES.index(here), STATES.index(there)
        if (entered - left) % 6 not in {1, 5}:
            raise ConfigurationError(
                f"halls: state {here} to {there} at row {k + 2}, accepted: one sensor changing at a"
                " time"
            )
        if math.isfinite(_between(angle_turn, k)):
            found[entered if (entered - left) % 6 == 1 else left].append(_between(angle_turn, k))
    places = tuple(_place(angles, f"hall edge {k}") for k, angles in enumerate(found))
    widths = [
        (b.angle_deg - a.angle_deg) % 360.0
        for a, b in zip(places, (*places[1:], places[0]), strict=True)
    ]
    if not math.isclose(sum(widths), 360.0) or not all(30.0 <= width <= 90.0 for width in widths):
        raise ConfigurationError(
            "halls: not in forward order, 30 to 90 deg apart; swap two hall lines or two motor"
            " wires"
        )
    return places


def calibrate(table: dict[str, Array]) -> Calibration:
    """Evaluate a recording."""
    angle = rotor_angle_turn(table[VOLTAGES[0]], table[VOLTAGES[1]])
    edges: tuple[Place, ...] = ()
    if all(name in table for name in HALLS):
        a, b, c = (table[name] > 0.5 for name in HALLS)
        edges = hall_edges(angle, (a * 1 + b * 2 + c * 4).astype(np.int64))
    index = None
    if INDEX in table:
        rising = np.flatnonzero(np.diff((table[INDEX] > 0.5).astype(np.int64)) > 0).tolist()
        index = _place(
            [_between(angle, k) for k in rising if math.isfinite(_between(angle, k))], "index"
        )
    return Calibration(edges, index)


def as_toml(found: Calibration) -> str:
    """Return the lines for the [rotor] section of a drive's file."""
    lines = ["[rotor]"]
    if found.hall_edges:
        edges = ", ".join(f"{place.angle_deg:.1f}" for place in found.hall_edges)
        worst = max(place.spread_deg for place in found.hall_edges)
        count = min(place.edges for place in found.hall_edges)
        lines += [
            'sensor = "hall"',
            f"hall_edges_deg = [{edges}]  # at least {count} each, within {worst:.1f} deg",
        ]
    if found.index is not None:
        lines += ['sensor = "encoder"'] if not found.hall_edges else []
        lines.append(
            f"encoder_index_deg = {found.index.angle_deg:.1f}  # {found.index.edges} pulses, within"
            f" {found.index.spread_deg:.1f} deg"
        )
    return "\n".join(lines)
