# SPDX-License-Identifier: Apache-2.0
"""Measured losses of a motor with its inverter: maps, no-load curves and coast-downs from CSV.

The heading names each column with its unit and thereby says what was measured:

    map          speed_rpm, torque_nm and one of efficiency_percent, loss_w, electrical_power_w
    no load      speed_rpm, no_load_power_w                         shaft free, bridge working
    coast-down   time_s, speed_rpm                                  bridge open, inertia known

A map may also have current_a (peak phase) and winding_temperature_c. Torque is the shaft's,
negative where it brakes; the efficiency is that of the way the power takes: shaft over electrical
power while driving, electrical over shaft power while braking. What is returned has the direction
of rotation as its positive one.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from regen_table import inputs
from regen_table.errors import ConfigurationError
from regen_table.models import Array

RPM = math.pi / 30.0  # rad/s
MAP_POWERS = ("efficiency_percent", "loss_w", "electrical_power_w")
NO_LOAD = ("speed_rpm", "no_load_power_w")
COAST_DOWN = ("time_s", "speed_rpm")
OPTIONAL = ("current_a", "winding_temperature_c")
WHAT = (
    "a table with the columns speed_rpm, torque_nm and one of efficiency_percent, loss_w,"
    " electrical_power_w (also current_a, winding_temperature_c); or speed_rpm, no_load_power_w;"
    " or time_s, speed_rpm"
)
HIGHEST_RPM = 1e5
COAST_STEPS = 20  # into which a coast-down is divided, each of them one loss
STEADY = 1e-9  # share of the speed: less of a fall in a stretch is none
COAST_STEP_ROWS = 4  # at least, in each


@dataclass(frozen=True)
class Losses:
    """Losses at points of steady state; arrays of one length.

    Attributes
    ----------
    speed_rad_s : array
        Shaft speed, positive.
    torque_nm : array
        At the shaft; negative brakes.
    loss_w : array
        Electrical power less shaft power, motor signs: positive in either direction of power.
    resolution_w : array
        Standard deviation of the loss because of the file's last digits alone.
    switching : bool array
        Whether the bridge works: a coast-down has it open.
    current_a : array
        Peak phase current, NaN where it was not measured.
    winding_temperature_c : array
        NaN where it was not measured.
    """

    speed_rad_s: Array
    torque_nm: Array
    loss_w: Array
    resolution_w: Array
    switching: npt.NDArray[np.bool_]
    current_a: Array
    winding_temperature_c: Array

    def __len__(self) -> int:
        """Count the points."""
        return len(self.speed_rad_s)

    def where(self, chosen: npt.NDArray[np.bool_] | npt.NDArray[np.signedinteger]) -> "Losses":
        """Return some of the points, or all in another order."""
        return Losses(*(getattr(self, field.name)[chosen] for field in fields(self)))

    @property
    def shaft_power_w(self) -> Array:
        """Power at the shaft, negative while braking."""
        return self.speed_rad_s * self.torque_nm

    @property
    def electrical_power_w(self) -> Array:
        """Power from the source, negative while it is charged."""
        return self.shaft_power_w + self.loss_w


def joined(parts: Sequence[Losses]) -> Losses:
    """Return the points of several measurements as one."""
    return Losses(
        *(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Losses))
    )


def load(path: Path, inertia_kg_m2: float | None = None) -> Losses:
    """Read one file.

    Parameters
    ----------
    inertia_kg_m2 : float or None
        Of all that turns in a coast-down.

    Raises
    ------
    ConfigurationError
        One line: file, line, what is accepted.
    """
    text, lines = inputs.read_numbered_table(path, WHAT, _suits)
    return from_text(path, text, lines, inertia_kg_m2)


def from_text(
    path: Path, text: dict[str, list[str]], lines: list[int], inertia_kg_m2: float | None = None
) -> Losses:
    """Return the losses of columns whose headings are known, with the line of each row."""
    columns = _Columns(path, text, lines)
    if set(COAST_DOWN) == set(text):
        return _of_coast_down(columns, inertia_kg_m2)
    if set(NO_LOAD) == set(text):
        return _of_no_load(columns)
    return _of_map(columns)


def _suits(names: Sequence[str]) -> bool:
    """Whether a heading is one of the three."""
    given = set(names)
    if len(given) != len(names):
        return False
    powers = given & set(MAP_POWERS)
    is_map = len(powers) == 1 and given - powers - set(OPTIONAL) == {"speed_rpm", "torque_nm"}
    return is_map or given in (set(NO_LOAD), set(COAST_DOWN))


@dataclass(frozen=True)
class _Columns:
    """The columns of a file as numbers, refusing with file and line what is none."""

    path: Path
    text: dict[str, list[str]]
    lines: list[int]

    def numbers(self, name: str, accepted: str, fits: Callable[[float], bool]) -> Array:
        """Return a column whose every number fits."""
        found = []
        for line, cell in zip(self.lines, self.text[name], strict=True):
            try:
                value = float(cell)
            except ValueError:
                value = math.nan
            if not (math.isfinite(value) and fits(value)):
                raise self.mistake(line, name, cell.strip(), accepted)
            found.append(value)
        return np.array(found, dtype=np.float64)

    def mistake(self, line: int, name: str, cell: str, accepted: str) -> ConfigurationError:
        """Return what is raised for a wrong cell."""
        return ConfigurationError(f"{self.path}:{line}: {name} {cell!r}, accepted: {accepted}")

    def deviation(self, name: str) -> float:
        """Return the standard deviation of rounding to a column's finest last digit."""
        return 10.0 ** -max((_decimals(cell) for cell in self.text[name]), default=0) / math.sqrt(
            12
        )


def _decimals(cell: str) -> int:
    """Return how many decimals a number is written with; exponents count."""
    mantissa, _, exponent = cell.strip().lower().partition("e")
    return len(mantissa.partition(".")[2]) - int(exponent or 0)


def _speeds(columns: _Columns) -> Array:
    accepted = f"a number from {-HIGHEST_RPM:g} to {HIGHEST_RPM:g} r/min other than zero"
    return RPM * columns.numbers(
        "speed_rpm", accepted, lambda value: 0.0 < abs(value) <= HIGHEST_RPM
    )


def _of_map(columns: _Columns) -> Losses:
    speed = _speeds(columns)
    torque = columns.numbers(
        "torque_nm", "a number from -1e5 to 1e5 N m", lambda value: abs(value) <= 1e5
    )
    shaft_w = speed * torque
    torque_deviation = columns.deviation("torque_nm")
    if "efficiency_percent" in columns.text:
        name, accepted = "efficiency_percent", "a number above 0 and below 100 %"
        share = 0.01 * columns.numbers(name, accepted, lambda value: 0.0 < value < 100.0)
        drives = shaft_w > 0.0
        ratio = np.where(drives, 1.0 / share - 1.0, share - 1.0)  # of loss to shaft power
        slope = np.where(drives, 1.0 / np.square(share), 1.0)  # of that to the efficiency
        loss = shaft_w * ratio
        resolution = np.hypot(
            speed * ratio * torque_deviation, shaft_w * slope * 0.01 * columns.deviation(name)
        )
        _refuse_rest(columns, shaft_w)
    else:
        name = next(name for name in MAP_POWERS if name in columns.text)
        power = columns.numbers(name, "a number from -1e8 to 1e8 W", lambda value: abs(value) < 1e8)
        loss = power - shaft_w if name == "electrical_power_w" else power
        through_torque = speed * torque_deviation if name == "electrical_power_w" else 0.0 * speed
        resolution = np.hypot(through_torque, columns.deviation(name))
        _refuse_gain(columns, name, loss)
    current, temperature = (_optional(columns, name) for name in OPTIONAL)
    return _forward(speed, torque, loss, resolution, np.abs(current), temperature)


def _refuse_rest(columns: _Columns, shaft_w: Array) -> None:
    """Refuse an efficiency where no power passes the shaft."""
    for k in np.flatnonzero(shaft_w == 0.0):
        raise columns.mistake(
            columns.lines[k],
            "torque_nm",
            columns.text["torque_nm"][k].strip(),
            "a torque other than zero, beside which an efficiency has a meaning",
        )


def _refuse_gain(columns: _Columns, name: str, loss_w: Array) -> None:
    """Refuse what would be a gain."""
    for k in np.flatnonzero(loss_w <= 0.0):
        raise columns.mistake(
            columns.lines[k],
            name,
            columns.text[name][k].strip(),
            "a power that leaves a loss above 0 W (torque negative where it brakes)",
        )


def _optional(columns: _Columns, name: str) -> Array:
    if name not in columns.text:
        return np.full(len(columns.lines), np.nan)
    if name == "current_a":
        return columns.numbers(name, "a number from 0 to 1e4 A", lambda value: 0.0 <= value <= 1e4)
    return columns.numbers(
        name, "a number from -100 to 300 degC", lambda value: -100.0 <= value <= 300.0
    )


def _of_no_load(columns: _Columns) -> Losses:
    speed = _speeds(columns)
    power = columns.numbers(
        "no_load_power_w", "a number above 0 W, up to 1e8", lambda value: 0.0 < value < 1e8
    )
    resolution = np.full(len(speed), columns.deviation("no_load_power_w"))
    unknown = np.full(len(speed), np.nan)
    return _forward(speed, np.zeros(len(speed)), power, resolution, unknown, unknown)


def _of_coast_down(columns: _Columns, inertia_kg_m2: float | None) -> Losses:
    """Return the loss of each of COAST_STEPS equal stretches: inertia x speed x deceleration.

    Deceleration and speed of a stretch are those of the straight line through its rows.
    """
    path = columns.path
    if inertia_kg_m2 is None:
        raise ConfigurationError(f"{path}: a coast-down, accepted: together with --inertia-kg-m2")
    time = columns.numbers("time_s", "a number from -1e6 to 1e6 s", lambda value: abs(value) <= 1e6)
    speed = np.abs(_speeds(columns))
    for k in np.flatnonzero(np.diff(time) <= 0.0):
        raise columns.mistake(
            columns.lines[k + 1],
            "time_s",
            columns.text["time_s"][k + 1].strip(),
            "a later time than in the row before",
        )
    if len(time) < COAST_STEPS * COAST_STEP_ROWS:
        raise ConfigurationError(
            f"{path}: {len(time)} rows, accepted: at least {COAST_STEPS * COAST_STEP_ROWS} of a"
            " coast-down"
        )
    found = []
    for part in np.array_split(np.arange(len(time)), COAST_STEPS):
        at = time[part] - np.mean(time[part])
        mean = float(np.mean(speed[part]))
        squares = float(np.sum(at * at))
        slope = float(np.sum(at * speed[part])) / squares
        if slope * float(np.ptp(at)) > -STEADY * mean:
            raise ConfigurationError(
                f"{path}:{columns.lines[part[0]]}: the speed does not fall up to line"
                f" {columns.lines[part[-1]]}, accepted: a recording of one coast-down"
            )
        rest = speed[part] - mean - slope * at
        deviation = max(
            math.sqrt(float(np.sum(rest * rest)) / (len(part) - 2)),
            RPM * columns.deviation("speed_rpm"),
        ) / math.sqrt(squares)
        found.append((mean, -inertia_kg_m2 * mean * slope, inertia_kg_m2 * mean * deviation))
    mean_speed, loss, resolution = np.array(found).T
    unknown = np.full(len(found), np.nan)
    open_bridge = _forward(mean_speed, np.zeros(len(found)), loss, resolution, unknown, unknown)
    return replace(open_bridge, switching=np.zeros(len(found), dtype=np.bool_))


def _forward(
    speed: Array, torque: Array, loss: Array, resolution: Array, current: Array, temperature: Array
) -> Losses:
    """Return points with the direction of rotation as the positive one."""
    return Losses(
        speed_rad_s=np.abs(speed),
        torque_nm=torque * np.sign(speed),
        loss_w=loss,
        resolution_w=np.abs(resolution),
        switching=np.ones(len(speed), dtype=np.bool_),
        current_a=current,
        winding_temperature_c=temperature,
    )
