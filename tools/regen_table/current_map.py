# SPDX-License-Identifier: Apache-2.0
"""The minimum-loss d-current map: i_d over torque, speed and winding temperature.

All axes have steps that are powers of two.

Only i_d is stored. The controller computes i_q from the torque, the speed and the i_d that really
flows (this table's plus what field weakening adds), so the torque is exact whatever the
interpolation did to i_d, whose error costs power only in second order. For the same reason bus
voltage is no axis: at a given torque the power has one minimum along i_d, so under a voltage limit
the best point is the limit itself, which is where field weakening at constant torque goes
(current_audit measures what that leaves).

The torque axis counts in the direction of rotation, driving positive; its middle point is zero.
Along winding temperature there are as few layers as the loss allows; a single one is made for the
middle of the range.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
import numpy.typing as npt

from regen_table import audit, braking, joint, models, optimum, torque_map
from regen_table.models import Array, ArrayLike
from regen_table.schema import Drive

TORQUE_RANGE = 4.0  # the braking table holds at least torques up to so many times the largest one
BEYOND_CLOSED_FORM = 1.25  # and up to so many times the optimum with i_d = 0, where that is more
# nodes beyond the current limit continue the curve, so that it does not bend inside the last cell
RELAXED = 3.0
_NEAR = 0.99  # of a torque: less than it by more than an entry's rounding
_BLOCK = 1000  # points searched at a time, so that their candidates stay in the cache


@dataclass(frozen=True, eq=False)
class CurrentMap:
    """``current_d_mA`` has the shape (temperature, speed, torque points).

    The middle torque point is zero. Entries are whole multiples of 2^``lsb_log2``.
    """

    torque_step_log2: int
    speed_step_log2: int
    temperature_step_log2: int
    temperature_origin_cC: int  # noqa: N815, units keep their letters
    current_d_mA: npt.NDArray[np.int32]  # noqa: N815
    lsb_log2: int = 0

    @property
    def torques_nm(self) -> Array:
        """Torque of each column in N m, in the direction of rotation."""
        count = self.current_d_mA.shape[2]
        return np.asarray(
            (np.arange(count, dtype=np.float64) - count // 2)
            * (2.0**self.torque_step_log2 / 1000.0)
        )

    @property
    def speeds_rad_s(self) -> Array:
        """Mechanical speed of each row in rad/s."""
        return np.arange(self.current_d_mA.shape[1], dtype=np.float64) * (
            2.0**self.speed_step_log2 / 1000.0
        )

    @property
    def temperatures_c(self) -> Array:
        """Winding temperature of each layer in degC."""
        return temperatures_c(
            self.temperature_origin_cC, self.temperature_step_log2, self.current_d_mA.shape[0]
        )


def temperatures_c(origin_cc: int, step_log2: int, points: int) -> Array:
    """Winding temperatures in degC of an axis."""
    return np.asarray((origin_cc + np.arange(points, dtype=np.float64) * 2.0**step_log2) / 100.0)


def temperature_axis(drive: Drive, points: int) -> tuple[int, int]:
    """Origin in hundredths of a degree and step exponent of so many layers.

    Over the range, or one in its middle.
    """
    lowest, highest = drive.table.temperature_range_c
    if points == 1:
        return round(50.0 * (lowest + highest)), torque_map.TEMPERATURE_STEP_LOG2[0]
    return round(100.0 * lowest), torque_map.step_log2(
        100.0 * (highest - lowest), points, torque_map.TEMPERATURE_STEP_LOG2[0]
    )


def points_over(drive: Drive, torque_step_log2: int, speed_step_log2: int) -> tuple[int, int]:
    """Points along torque and speed that cover max_torque_nm either way and max_speed_rpm."""
    torque, speed = (
        1000.0 * drive.motor.max_torque_nm,
        1000.0 * drive.motor.max_speed_rpm * math.pi / 30.0,
    )
    return (
        2 * math.ceil(torque / 2.0**torque_step_log2 - 1e-12) + 1,
        math.ceil(speed / 2.0**speed_step_log2 - 1e-12) + 1,
    )


def compute(drive: Drive, torque_step_log2: int, speed_step_log2: int, layers: int) -> CurrentMap:
    """Compute the table on one grid.

    A straight line between two points of a curve lies to one side of it, by an eighth of the second
    difference in the middle. Moving every point by a sixteenth to the other side leaves half that
    error, at the points and between them alike, and a quarter of the power it costs. At no torque
    the point stays where it is: a motor that idles takes least. Along temperature, where the curve
    is nearly straight, the points lie on it.
    """
    torque_points, speed_points = points_over(drive, torque_step_log2, speed_step_log2)
    origin, temperature_step = temperature_axis(drive, layers)
    empty = CurrentMap(
        torque_step_log2,
        speed_step_log2,
        temperature_step,
        origin,
        np.zeros((layers, speed_points, torque_points), np.int32),
    )
    motor = models.machine(drive, empty.temperatures_c[:, np.newaxis, np.newaxis])
    # One point more all around but at standstill, for the differences.
    speeds = np.append(empty.speeds_rad_s, empty.speeds_rad_s[-1] + empty.speeds_rad_s[1])
    torques = (
        np.arange(-1, torque_points + 1) * (2.0**torque_step_log2 / 1000.0) + empty.torques_nm[0]
    )
    limits = joint.Limits(RELAXED * drive.motor.max_phase_current_a)
    torques = np.broadcast_to(torques, (layers, len(speeds), len(torques)))
    best = joint.least_power(
        motor, models.bridge(drive), speeds[:, np.newaxis] * drive.motor.pole_pairs, torques, limits
    )
    exact = np.where(best.feasible, best.state.current_d_a, 0.0)
    bent = exact[:, :-1, :-2] - 2.0 * exact[:, :-1, 1:-1] + exact[:, :-1, 2:]
    bent[:, 1:] += exact[:, :-2, 1:-1] - 2.0 * exact[:, 1:-1, 1:-1] + exact[:, 2:, 1:-1]
    bent[:, :, torque_points // 2] = 0.0
    current, lsb_log2 = torque_map.resolved(
        "current_map", 1000.0 * (exact[:, :-1, 1:-1] - bent / 16.0)
    )
    return replace(empty, current_d_mA=current, lsb_log2=lsb_log2)


def read(
    table: CurrentMap,
    torque_nm: ArrayLike,
    speed_rad_s: ArrayLike,
    winding_temperature_c: ArrayLike,
) -> Array:
    """Read i_d in A in whole numbers, as the controller would.

    Linear: bilinear over speed and temperature, rounded, then between two torques, rounded; the
    edges count beyond the grid.
    """
    layers, rows, columns = table.current_d_mA.shape
    turning = np.where(np.asarray(speed_rad_s) < 0.0, -1.0, 1.0)
    from_edge = (
        np.asarray(torque_nm) * turning * 1000.0 + (columns // 2) * 2.0**table.torque_step_log2
    )
    s, s_part = audit.locate(np.abs(speed_rad_s) * 1000.0, rows, table.speed_step_log2)
    t, t_part = audit.locate(from_edge, columns, table.torque_step_log2)
    entries = table.current_d_mA.astype(np.int64).ravel() >> table.lsb_log2
    corner = s * columns + t
    speed_q20, warm_q20, hotter = s_part << (20 - table.speed_step_log2), np.zeros_like(t_part), 0
    if layers > 1:
        above = np.asarray(winding_temperature_c) * 100.0 - table.temperature_origin_cC
        w, w_part = audit.locate(above, layers, table.temperature_step_log2)
        warm_q20, hotter = w_part << (20 - table.temperature_step_log2), rows * columns
        corner = corner + w * hotter

    def at_torque(first: audit.Whole) -> audit.Whole:
        return audit.weighted(
            speed_q20,
            warm_q20,
            table.lsb_log2,
            (entries[first], entries[first + columns]),
            (entries[first + hotter], entries[first + hotter + columns]),
        )

    found = audit.between(at_torque(corner), at_torque(corner + 1), t_part, table.torque_step_log2)
    return np.asarray(found / 1000.0)


def state(
    motor: models.Machine,
    inverter: models.Bridge,
    omega: ArrayLike,
    torque_nm: ArrayLike,
    i_d: ArrayLike,
) -> models.State:
    """Steady state of a torque with a given terminal i_d."""
    i_q = _current_q_a(motor, omega, torque_nm, i_d)
    return models.evaluate(motor, inverter, omega, i_d, i_q)


def _current_q_a(
    motor: models.Machine, omega: ArrayLike, torque_nm: ArrayLike, i_d: ArrayLike
) -> Array:
    """Terminal i_q in A of a torque, from the quadratic that the iron branch leaves.

    With i_dt = i_d + g L_q i_qt and s = L_q - L_d the torque is
    1.5 p i_qt (psi - s i_d - s g L_q i_qt).
    """
    g, saliency = motor.iron_ratio(omega), motor.q_inductance_h - motor.d_inductance_h
    per_flux = np.asarray(torque_nm) / (1.5 * motor.pole_pairs)
    flux = motor.flux_wb - saliency * np.asarray(i_d)
    square = np.square(flux) - 4.0 * saliency * g * motor.q_inductance_h * per_flux
    i_qt = 2.0 * per_flux / (flux + np.sqrt(np.where(square >= 0.0, square, np.nan)))
    i_dt = i_d + g * motor.q_inductance_h * i_qt
    return np.asarray(i_qt + g * (motor.d_inductance_h * i_dt + motor.flux_wb))


def best_torque_nm(
    motor: models.Machine,
    inverter: models.Bridge,
    table: CurrentMap,
    speed_rad_s: ArrayLike,
    strongest_nm: ArrayLike,
    scans: int = joint.EXACT,
) -> Array:
    """Braking torque magnitude in N m that returns the most power with the stored i_d.

    At most ``strongest_nm``.

    ``scans``: joint.EXACT, or joint.AUDIT where only the power matters.
    """
    speed, strongest, _ = np.broadcast_arrays(speed_rad_s, strongest_nm, motor.resistance_ohm)
    shape = speed.shape
    temperature, resistance, flux = (
        np.broadcast_to(values, shape).ravel()
        for values in (motor.winding_temperature_c, motor.resistance_ohm, motor.flux_wb)
    )
    speed, strongest = speed.ravel(), strongest.ravel().astype(np.float64)
    first, found = (65 if scans == joint.EXACT else 17), [np.zeros(0)]
    for block in (slice(k, k + _BLOCK) for k in range(0, speed.size, _BLOCK)):
        part = replace(
            motor,
            winding_temperature_c=temperature[block, np.newaxis],
            resistance_ohm=resistance[block, np.newaxis],
            flux_wb=flux[block, np.newaxis],
        )
        at = speed[block, np.newaxis]
        power = partial(_braking_power, part, inverter, table, at)
        low = -strongest[block]
        found.append(-joint.shrink(power, low, np.zeros(low.shape), first, scans)[0])
    return np.asarray(np.concatenate(found).reshape(shape))


def _braking_power(
    motor: models.Machine, inverter: models.Bridge, table: CurrentMap, speed: Array, torque: Array
) -> Array:
    """DC power in W of torques made with the stored i_d."""
    i_d = read(table, torque, speed, motor.winding_temperature_c)
    omega = speed * motor.pole_pairs
    i_q = _current_q_a(motor, omega, torque, i_d)
    return models.dc_power_w(motor, inverter, omega, i_d, i_q)


@lru_cache(maxsize=8)
def production(table: CurrentMap) -> braking.Production:
    """Return how torque is made with the stored i_d, for the audit of the braking table."""

    def capability(
        drive: Drive, motor: models.Machine, inverter: models.Bridge, speed: ArrayLike
    ) -> Array:
        limit = braking.torque_limit_nm(drive, speed)
        return best_torque_nm(motor, inverter, table, speed, limit, joint.AUDIT)

    def made(
        motor: models.Machine, inverter: models.Bridge, speed: ArrayLike, torque: ArrayLike
    ) -> models.State:
        i_d = read(table, torque, speed, motor.winding_temperature_c)
        return state(motor, inverter, np.asarray(speed) * motor.pole_pairs, torque, i_d)

    return braking.Production(capability, made)


def regen_map(
    drive: Drive, currents: CurrentMap, points: tuple[int, int] | None = None
) -> torque_map.RegenMap:
    """Return the braking table of the stored i_d: its optimum at every point, unclamped.

    The grid reaches up to the top speed, as without i_d, unless it loses too much power somewhere.
    It does for a salient motor, whose optimum runs away at the speed where the power loses its
    minimum (it is stored up to a bound then): a finer grid that ends where every optimum is beyond
    max_torque_nm is better, because from there on the limits decide, and the firmware takes the
    nearest edge. ``points`` as in torque_map.regen_map().
    """
    plain = torque_map.regen_map(drive, points)
    made = production(currents)
    whole = _filled(drive, currents, plain, plain.speed_step_log2)
    if audit.worst_power_loss(drive, whole, made) <= audit.POWER_LOSS_MAX:
        return whole
    largest = drive.motor.max_torque_nm
    steps = np.arange(torque_map.SPEED_STEP_LOG2[0], plain.speed_step_log2)
    ends = (plain.torque_mNm.shape[1] - 1) * 2.0**steps / 1000.0
    reached = np.min(_best_at(drive, currents, plain, ends), axis=0) >= _NEAR * largest
    for step in map(int, steps[reached]):
        short = _filled(drive, currents, plain, step)
        if np.all(short.torque_mNm[:, -1] >= 1000.0 * largest):
            return min(whole, short, key=lambda table: audit.worst_power_loss(drive, table, made))
    return whole


def _filled(
    drive: Drive, currents: CurrentMap, plain: torque_map.RegenMap, step_log2: int
) -> torque_map.RegenMap:
    """Fill a braking table with another distance of its speeds.

    At standstill the closed form's continuation below zero.
    """
    grid = replace(plain, speed_step_log2=step_log2)
    torque = _best_at(drive, currents, grid, grid.speeds_rad_s) * 1000.0
    torque[:, 0] = torque_map.closed_form_mnm(drive, grid)[:, 0]
    return torque_map.filled(grid, torque)


def _best_at(drive: Drive, currents: CurrentMap, grid: torque_map.RegenMap, speeds: Array) -> Array:
    """Return the best braking torques in N m at a grid's temperatures and these speeds."""
    motor = models.machine(drive, grid.temperatures_c[:, np.newaxis])
    inverter = models.bridge(drive)
    without = np.abs(
        optimum.closed_form(motor, inverter, speeds * motor.pole_pairs).torque_optimal_nm
    )
    strongest = np.maximum(TORQUE_RANGE * drive.motor.max_torque_nm, BEYOND_CLOSED_FORM * without)
    return best_torque_nm(motor, inverter, currents, speeds, strongest)
