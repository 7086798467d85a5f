# SPDX-License-Identifier: Apache-2.0
"""What the optimal regenerative torque map loses.

The table read exactly as the firmware reads it, against the optimum itself.

A grid is refused by the energy it loses to interpolation and quantisation over stops and cycles,
not by its looks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from regen_table import braking, ideal_cycles, models
from regen_table.braking import Production
from regen_table.errors import ConfigurationError
from regen_table.models import Array, ArrayLike
from regen_table.schema import Drive
from regen_table.torque_map import RegenMap

ENERGY_LOSS_MAX = 2e-4
POWER_LOSS_MAX = 1e-3
_TEMPERATURES = 9
_SPEEDS = 600
Whole = npt.NDArray[np.int64]
Ends = tuple[float, float]


@dataclass(frozen=True)
class GridLoss:
    """Energy lost to the grid in one manoeuvre at its worst temperature.

    J at the bus, all motors together.
    """

    manoeuvre: str
    winding_temperature_c: float
    relative: float
    returned_j: float
    lost_j: float


def read(table: RegenMap, speed_mrad_s: ArrayLike, temperature_cc: ArrayLike) -> Whole:
    """Read the table in whole numbers, as loss_maps_torque_mNm() does.

    Bilinear, rounded, no extrapolation, not below 0; mN m.
    """
    s, s_part = locate(np.abs(speed_mrad_s), table.torque_mNm.shape[1], table.speed_step_log2)
    origin = np.asarray(temperature_cc) - table.temperature_origin_cC
    t, t_part = locate(origin, table.torque_mNm.shape[0], table.temperature_step_log2)
    entries = table.torque_mNm.astype(np.int64) >> table.lsb_log2
    found = weighted(
        s_part << (20 - table.speed_step_log2),
        t_part << (20 - table.temperature_step_log2),
        table.lsb_log2,
        (entries[t, s], entries[t, s + 1]),
        (entries[t + 1, s], entries[t + 1, s + 1]),
    )
    return np.maximum(found, 0)


def locate(x: ArrayLike, points: int, step_log2: int) -> tuple[Whole, Whole]:
    """Mirror gridlocate(): index and fraction, the ends counting beyond the axis."""
    whole = np.clip(np.rint(np.asarray(x)).astype(np.int64), 0, (points - 1) << step_log2)
    index = np.minimum(whole >> step_log2, points - 2)
    return index, whole - (index << step_log2)


def between(a: Whole, b: Whole, fraction: Whole, step_log2: int) -> Whole:
    """Mirror grid_interpolate(): rounded to nearest."""
    return np.asarray(a + (((b - a) * fraction + ((1 << step_log2) >> 1)) >> step_log2))


def weighted(
    x_q20: Whole, y_q20: Whole, lsb_log2: int, cold: tuple[Whole, Whole], hot: tuple[Whole, Whole]
) -> Whole:
    """Mirror grid_weights() and grid_weighted(): bilinear, rounded to nearest."""
    x, y = x_q20 >> 4, y_q20 >> 4
    both = (x * y + (1 << 15)) >> 16
    sum_q16 = (
        ((1 << 16) - x - y + both) * cold[0]
        + (x - both) * cold[1]
        + (y - both) * hot[0]
        + both * hot[1]
    )
    return np.asarray((sum_q16 + ((1 << 15) >> lsb_log2)) >> (16 - lsb_log2))


def table_capability_nm(
    drive: Drive, table: RegenMap, speed_rad_s: ArrayLike, temperature_c: ArrayLike
) -> Array:
    """Capability in N m as the firmware has it: the table's entry clamped by torque and power."""
    stored = (
        read(table, np.asarray(speed_rad_s) * 1000.0, np.asarray(temperature_c) * 100.0) / 1000.0
    )
    return np.minimum(stored, braking.torque_limit_nm(drive, speed_rad_s))


def grid_losses(
    drive: Drive, table: RegenMap, made: Production = braking.ZERO_D_CURRENT
) -> list[GridLoss]:
    """Energy lost to the grid: a hard stop, a stop at rated torque, and every shipped cycle."""
    return [_loss(drive, table, made, index) for index in range(len(_manoeuvres(drive)))]


def suffices(drive: Drive, table: RegenMap, made: Production) -> bool:
    """Whether a grid loses at most 0.02 % of the energy of every manoeuvre."""
    return all(
        _loss(drive, table, made, index).relative <= ENERGY_LOSS_MAX
        for index in range(len(_manoeuvres(drive)))
    )


@lru_cache(maxsize=8)
def _manoeuvres(drive: Drive) -> list[tuple[str, Array, Array, Array]]:
    """Return name, mechanical rad/s, seconds and braking demands in N m of every manoeuvre.

    Below handover_end_rpm the motor does not brake: no loss there.
    """
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    speed = (np.arange(_SPEEDS) + 0.5) * top / _SPEEDS
    hardest = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    vehicle = drive.vehicle
    # A stop at constant demand spends equal times at equal steps of speed: m r^2 step / (motors
    # torque).
    inertia_step = vehicle.mass_kg * vehicle.wheel_radius_m**2 * top / _SPEEDS
    inertia_step /= vehicle.driven_wheels
    found = [
        (name, speed, np.full(_SPEEDS, inertia_step / torque), np.full(_SPEEDS, torque))
        for name, torque in (
            ("hard stop", hardest),
            ("stop at rated torque", drive.motor.rated_torque_nm),
        )
    ]
    for cycle in ideal_cycles.shipped(drive):
        asked = ideal_cycles.demand(drive, cycle)
        brakes = (asked.torque_nm < 0.0) & (asked.speed_rad_s > 0.0)
        found.append(
            (
                cycle.name,
                asked.speed_rad_s[brakes],
                asked.seconds[brakes],
                -asked.torque_nm[brakes],
            )
        )
    lowest = drive.control.handover_end_rpm * np.pi / 30.0
    return [
        (name, speed[speed >= lowest], seconds[speed >= lowest], demand[speed >= lowest])
        for name, speed, seconds, demand in found
    ]


@dataclass(frozen=True)
class _Optimum:
    """What every table of a drive is compared with: the best torque at speeds and temperatures."""

    winding_c: Array
    torque_nm: Array
    power_w: Array


# Every grid that is tried is compared with the same one, and its search takes longest.
@lru_cache(maxsize=64)
def _optimum_in_manoeuvre(drive: Drive, made: Production, index: int, ends_c: Ends) -> _Optimum:
    """Find the best torque, at most the demanded one, at the speeds of a manoeuvre."""
    _, speed, _, demand = _manoeuvres(drive)[index]
    winding = np.linspace(*ends_c, _TEMPERATURES)[:, np.newaxis]
    return _optimum(drive, made, winding, speed, demand)


@lru_cache(maxsize=64)
def _optimum_at_all_speeds(drive: Drive, made: Production, ends_c: Ends) -> _Optimum:
    """Find the best torque at the speeds that worst_power_loss() compares."""
    return _optimum(
        drive, made, np.linspace(*ends_c, 17)[:, np.newaxis], _all_speeds(drive), np.inf
    )


def _optimum(
    drive: Drive, made: Production, winding: Array, speed: Array, most_nm: ArrayLike
) -> _Optimum:
    motor, inverter = models.machine(drive, winding), models.bridge(drive)
    torque = np.minimum(made.capability_nm(drive, motor, inverter, speed), most_nm)
    return _Optimum(winding, torque, made.state(motor, inverter, speed, -torque).dc_power_w)


def _stored_power_w(
    drive: Drive,
    table: RegenMap,
    made: Production,
    speed: Array,
    winding: Array,
    most_nm: ArrayLike,
) -> Array:
    """DC power in W of the table's torque, at most ``most_nm``."""
    torque = np.minimum(table_capability_nm(drive, table, speed, winding), most_nm)
    motor = models.machine(drive, winding)
    return made.state(motor, models.bridge(drive), speed, -torque).dc_power_w


def _compared_ends_c(drive: Drive, table: RegenMap) -> Ends:
    """Return the lowest and highest winding temperature in degC at which a table is compared."""
    highest = min(table.temperatures_c[-1], drive.motor.max_winding_temperature_c)
    return float(table.temperatures_c[0]), float(highest)


def _loss(drive: Drive, table: RegenMap, made: Production, index: int) -> GridLoss:
    """Energy lost in one manoeuvre at its worst temperature, over what the optimum returns."""
    name, speed, seconds, demand = _manoeuvres(drive)[index]
    best = _optimum_in_manoeuvre(drive, made, index, _compared_ends_c(drive, table))
    stored = _stored_power_w(drive, table, made, speed, best.winding_c, demand)
    returned = -np.sum(best.power_w * seconds, axis=1)
    lost = np.sum((stored - best.power_w) * seconds, axis=1)
    relative = np.divide(lost, returned, out=np.zeros_like(lost), where=returned > 0.0)
    worst = int(np.argmax(relative))
    wheels = drive.vehicle.driven_wheels
    return GridLoss(
        name,
        float(best.winding_c[worst, 0]),
        float(relative[worst]),
        wheels * float(returned[worst]),
        wheels * float(lost[worst]),
    )


def worst_power_loss(
    drive: Drive, table: RegenMap, made: Production = braking.ZERO_D_CURRENT
) -> float:
    """Largest relative loss of regenerated power at any temperature and any speed.

    Inside torque and power limits.

    From the blend-out speed; where no torque returns energy the loss is zero.
    """
    best = _optimum_at_all_speeds(drive, made, _compared_ends_c(drive, table))
    exact = best.power_w
    power = _stored_power_w(drive, table, made, _all_speeds(drive), best.winding_c, np.inf)
    return float(
        np.max(np.divide(power - exact, -exact, out=np.zeros_like(exact), where=exact < 0.0))
    )


def _all_speeds(drive: Drive) -> Array:
    """Return mechanical rad/s from the blend-out speed to the largest one."""
    lowest, top = (
        drive.control.handover_end_rpm * np.pi / 30.0,
        drive.motor.max_speed_rpm * np.pi / 30.0,
    )
    return np.concatenate(
        [np.geomspace(max(lowest, 1e-3 * top), top, 100), np.linspace(lowest, top, 100)]
    )


def refuse_lossy_grid(
    losses: list[GridLoss], smallest: Callable[[], tuple[int, int] | None] = lambda: None
) -> None:
    """Raise ConfigurationError when the grid loses more than 0.02 % of any manoeuvre's energy.

    ``smallest`` finds the least numbers of speeds and temperatures that suffice.
    """
    worst = max(losses, key=lambda loss: loss.relative)
    if worst.relative <= ENERGY_LOSS_MAX:
        return
    found = smallest()
    remedy = (
        "more points or a narrower table.temperature_range_c"
        if found is None
        else (
            f"the smallest grid that suffices is speed_points = {found[0]}, temperature_points ="
            f" {found[1]}"
        )
    )
    raise ConfigurationError(
        f"table.speed_points, table.temperature_points: the grid loses {worst.relative:.3%} of the"
        f" energy of the {worst.manoeuvre} at {worst.winding_temperature_c:.0f} degC, accepted: at"
        f" most {ENERGY_LOSS_MAX:.2%}; {remedy}"
    )
