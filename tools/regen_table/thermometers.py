# SPDX-License-Identifier: Apache-2.0
"""Temperature sensors of every kind as one curve: temperature over the converter's code.

    R(T) --> divider --> code = 4096 R/(R + R_divider), sensor to ground; else 4096 less that

    ntc     R = R_25 exp(B (1/T - 1/298.15 K))
    pt1000  IEC 60751: R = 1000 Ohm (1 + A T + B T^2 + C (T - 100) T^3), C below 0 degC only
    kty84   NXP's data sheet of the KTY84/130: typical values, 1000 Ohm at 100 degC
    table   the file's points

Between points of a table ln R is linear in T. The firmware interpolates between codes 64 apart
(hal/analog_curve.h); what that costs is ``Curve.error_k``. A code outside the kind's own range is
one of a broken sensor, or of one of another kind.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from regen_table.sections import Drive

Array = npt.NDArray[np.float64]
Which = Literal["winding", "switch"]

CODES, STEP, POINTS = 4096, 64, 64
LOWEST_CODE, HIGHEST_CODE = 16, STEP * (POINTS - 1) - 1  # beyond: shorted, open
CELSIUS_K, REFERENCE_C = 273.15, 25.0
AUDITED_C = (-40.0, 150.0)
LARGEST_ERROR_K = 2.5
KTY84 = (
    *((-40, 359), (-30, 391), (-20, 424), (-10, 460), (0, 498), (10, 538), (20, 581), (25, 603)),
    *((30, 626), (40, 672), (50, 722), (60, 773), (70, 826), (80, 882), (90, 940), (100, 1000)),
    *((110, 1062), (120, 1127), (130, 1194), (140, 1262), (150, 1334), (160, 1407), (170, 1482)),
    *((180, 1560), (190, 1640), (200, 1722), (210, 1807), (220, 1893), (230, 1982), (240, 2073)),
    *((250, 2166), (260, 2261), (270, 2357), (280, 2452), (290, 2542), (300, 2624)),
)
PT1000_A, PT1000_B, PT1000_C = 3.9083e-3, -5.775e-7, -4.183e-12
RANGE_C = {"ntc": (-40.0, 196.0), "kty84": (-40.0, 300.0), "pt1000": (-50.0, 250.0)}


@dataclass(frozen=True)
class Sensor:
    """A sensor and its divider.

    Attributes
    ----------
    points : tuple
        Of kind "table": (degC, Ohm), rising temperature.
    to_supply : bool
        It hangs on the supply and the divider's resistor on ground; else the other way round.
    """

    kind: str
    ohm_25c: float
    beta_k: float
    points: tuple[tuple[float, float], ...]
    divider_ohm: float
    to_supply: bool

    @property
    def range_c(self) -> tuple[float, float]:
        """Return the temperatures that the kind can show."""
        return RANGE_C.get(self.kind) or (self.points[0][0], self.points[-1][0])

    def resistance_ohm(self, celsius: Array) -> Array:
        """Return R(T)."""
        if self.kind == "ntc":
            exponent = self.beta_k * (1.0 / (celsius + CELSIUS_K) - 1.0 / (REFERENCE_C + CELSIUS_K))
            return np.asarray(self.ohm_25c * np.exp(exponent))
        if self.kind == "pt1000":
            cold = PT1000_C * (celsius - 100.0) * celsius**3 * (celsius < 0.0)
            return np.asarray(1000.0 * (1.0 + PT1000_A * celsius + PT1000_B * celsius**2 + cold))
        known_c, known_ohm = np.array(KTY84 if self.kind == "kty84" else self.points).T
        return np.exp(_line(celsius, known_c, np.log(known_ohm)))

    def code(self, celsius: Array) -> Array:
        """Return what the converter shows, not rounded."""
        ohm = self.resistance_ohm(celsius)
        share = ohm / (ohm + self.divider_ohm)
        return np.asarray(CODES * (1.0 - share if self.to_supply else share))


@dataclass(frozen=True)
class Curve:
    """What the firmware has of a sensor.

    Attributes
    ----------
    error_k : float
        Largest difference from the sensor's formula, -40 to 150 degC as far as the kind goes.
    step_k : float
        Largest temperature of one code there.
    """

    point_cc: tuple[int, ...]
    lowest_code: int
    highest_code: int
    error_k: float
    step_k: float

    def celsius(self, code: float) -> float | None:
        """Return what the firmware shows; None: broken."""
        whole = int(code)
        if not self.lowest_code <= whole <= self.highest_code:
            return None
        left, right = self.point_cc[whole // STEP], self.point_cc[whole // STEP + 1]
        return (left + (right - left) * (whole % STEP) / STEP) / 100.0


NONE = Curve((0,) * POINTS, 1, 0, 0.0, 0.0)


def of_drive(drive: "Drive", which: Which) -> Sensor | None:
    """Return the sensor of the winding or of the switches; None: none is fitted."""
    m = drive.monitor
    if which == "winding":
        sensor = Sensor(
            m.winding_sensor, m.winding_sensor_ohm_25c, m.winding_sensor_beta_k,
            m.winding_sensor_points or (), m.winding_sensor_divider_ohm, m.winding_sensor_to_supply,
        )  # fmt: skip
    else:
        sensor = Sensor(
            m.switch_sensor, m.switch_sensor_ohm_25c, m.switch_sensor_beta_k,
            m.switch_sensor_points or (), m.switch_sensor_divider_ohm, m.switch_sensor_to_supply,
        )  # fmt: skip
    return None if sensor.kind == "none" else sensor


def curve(sensor: Sensor | None) -> Curve:
    """Return the points, the codes of a whole sensor, and what the points cost."""
    if sensor is None:
        return NONE
    fine_c = np.linspace(-150.0, 500.0, 65_001)
    codes = sensor.code(fine_c)
    if codes[-1] < codes[0]:
        fine_c, codes = fine_c[::-1], codes[::-1]
    at = STEP * np.arange(POINTS, dtype=np.float64)
    points = np.clip(np.round(_line(at, codes, fine_c) * 100.0), -32767.0, 32767.0)
    ends = np.sort(sensor.code(np.array(sensor.range_c)))
    lowest = max(LOWEST_CODE, int(np.ceil(ends[0])))
    highest = min(HIGHEST_CODE, int(np.floor(ends[1])))
    whole = np.arange(lowest, highest + 1, dtype=np.float64)
    exact, shown = np.interp(whole, codes, fine_c), np.interp(whole, at, points) / 100.0
    audited = (exact >= AUDITED_C[0]) & (exact <= AUDITED_C[1])
    return Curve(
        tuple(int(point) for point in points),
        lowest,
        highest,
        float(np.max(np.abs(shown - exact)[audited], initial=0.0)),
        float(np.max(np.abs(np.diff(exact))[audited[1:]], initial=0.0)),
    )


def instead(sensor: Sensor, made: Curve) -> dict[str, float | None]:
    """Return what sensors of other kinds would show in its place at 25 degC; None: broken."""
    others = {
        kind: Sensor(kind, 10e3, 3380.0, (), sensor.divider_ohm, sensor.to_supply)
        for kind in RANGE_C
        if kind != sensor.kind
    }
    at_25c = np.array([REFERENCE_C])
    return {kind: made.celsius(float(other.code(at_25c)[0])) for kind, other in others.items()}


def describe(drive: "Drive") -> list[str]:
    """Return a line for each sensor, for people."""
    lines = []
    for which in ("winding", "switch"):
        sensor = of_drive(drive, which)
        if sensor is None:
            continue
        made = curve(sensor)
        wrong = ", ".join(
            f"{kind} {'broken' if shown is None else f'{shown:.0f} degC'}"
            for kind, shown in instead(sensor, made).items()
        )
        lines.append(
            f"{drive.name}: {which} sensor: {sensor.kind} within {made.error_k:.2f} K, a code at"
            f" most {made.step_k:.2f} K; at 25 degC another kind would show: {wrong}"
        )
    return lines


def _line(at: Array, x: Array, y: Array) -> Array:
    """Return y over rising x by lines, the first and the last one prolonged."""
    first = y[0] + (at - x[0]) * (y[1] - y[0]) / (x[1] - x[0])
    last = y[-1] + (at - x[-1]) * (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.where(at < x[0], first, np.where(at > x[-1], last, np.interp(at, x, y)))
