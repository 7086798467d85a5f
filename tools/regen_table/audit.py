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
    return [_loss(drive, table, made, *manoeuvre) for manoeuvre in _manoeuvres(drive)]


def suffices(drive: Drive, table: RegenMap, made: Production) -> bool:
    """Whether a grid loses at most 0.02 % of the energy of every manoeuvre."""
    return all(
        _loss(drive, table, made, *manoeuvre).relative <= ENERGY_LOSS_MAX
        for manoeuvre in _manoeuvres(drive)
    )


@lru_cache(maxsize=8)
def _manoeuvres(drive: Drive) -> list[tuple[str, Array, Array, Array]]:
    """Return name, mechanical rad/s, seconds and braking demands in N m of every manoeuvre."""
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
    return found


def _loss(
    drive: Drive,
    table: RegenMap,
    made: Production,
    name: str,
    speed: Array,
    seconds: Array,
    demand: Array,
) -> GridLoss:
    """Energy lost in one manoeuvre at its worst temperature, over what the optimum returns.

    Below handover_end_rpm the motor does not brake: no loss there.
    """
    temperatures = np.linspace(
        table.temperatures_c[0],
        min(table.temperatures_c[-1], drive.motor.max_winding_temperature_c),
        _TEMPERATURES,
    )
    brakes = speed >= drive.control.handover_end_rpm * np.pi / 30.0
    speed, seconds, demand = speed[brakes], seconds[brakes], demand[brakes]
    winding = temperatures[:, np.newaxis]
    motor, inverter = models.machine(drive, winding), models.bridge(drive)
    exact = np.minimum(made.capability_nm(drive, motor, inverter, speed), demand)
    stored = np.minimum(table_capability_nm(drive, table, speed, winding), demand)
    power = [made.state(motor, inverter, speed, -torque).dc_power_w for torque in (exact, stored)]
    returned = -np.sum(power[0] * seconds, axis=1)
    lost = np.sum((power[1] - power[0]) * seconds, axis=1)
    relative = np.divide(lost, returned, out=np.zeros_like(lost), where=returned > 0.0)
    worst = int(np.argmax(relative))
    wheels = drive.vehicle.driven_wheels
    return GridLoss(
        name,
        float(temperatures[worst]),
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
    winding = np.linspace(
        table.temperatures_c[0],
        min(table.temperatures_c[-1], drive.motor.max_winding_temperature_c),
        17,
    )[:, np.newaxis]
    lowest, top = (
        drive.control.handover_end_rpm * np.pi / 30.0,
        drive.motor.max_speed_rpm * np.pi / 30.0,
    )
    speed = np.concatenate(
        [np.geomspace(max(lowest, 1e-3 * top), top, 100), np.linspace(lowest, top, 100)]
    )
    motor, inverter = models.machine(drive, winding), models.bridge(drive)
    exact = made.state(
        motor, inverter, speed, -made.capability_nm(drive, motor, inverter, speed)
    ).dc_power_w
    power = made.state(
        motor, inverter, speed, -table_capability_nm(drive, table, speed, winding)
    ).dc_power_w
    return float(
        np.max(np.divide(power - exact, -exact, out=np.zeros_like(exact), where=exact < 0.0))
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
