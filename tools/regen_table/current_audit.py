"""What the stored i_d costs against the best one, and the grid chosen by it.

A grid is judged by what it loses to interpolation: energy, over manoeuvres and cycles hot and cold, and power, at every
speed and temperature at which the drive brakes. The measure is a map without a grid, the exact i_d of the mean
temperature, because a finer grid cannot do better than that; what leaving the temperature out costs is told apart. Both
are the same for all grids, so they are computed once a drive, like the choice itself, which image and report both ask for.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from regen_table import audit, braking, current_map, cycles, joint, models
from regen_table.current_map import CurrentMap
from regen_table.errors import ConfigurationError
from regen_table.models import Array
from regen_table.schema import Drive

GRIDS = tuple((torque, speed) for torque in (5, 9, 17) for speed in (2, 3, 5, 9, 17))
REFUSED = 1e-3
# Shares of what may be lost. The rest is the braking table's and that of the temperature, which is no axis here.
ENERGY_SHARE, POWER_SHARE = 0.25, 0.5
_SPEEDS = 200
_POWER_SPEEDS = 48


@dataclass(frozen=True)
class CurrentLoss:
    """What a table costs in one manoeuvre at the worse end of the temperatures, relative to the energy at the bus.

    Attributes
    ----------
    interpolation : float
        Against the exact i_d of the mean temperature.
    stored : float
        Against the least loss at the temperature that is.
    without_d_current : float
        What i_d = 0 would cost against the least loss.
    """

    manoeuvre: str
    interpolation: float
    stored: float
    without_d_current: float


@dataclass(frozen=True)
class _Reference:
    """Points of a manoeuvre at one winding temperature.

    With the power in W of each at the least loss, at the i_d that is best at the mean temperature, and at i_d = 0.
    """

    manoeuvre: str
    motor: models.Machine
    speed_rad_s: Array
    torque_nm: Array
    seconds: Array
    least_w: Array
    gridless_w: Array
    without_w: Array


@lru_cache(maxsize=8)
def choose(drive: Drive) -> CurrentMap:
    """Return the smallest grid that interpolation makes lose at most 0.005 % of any manoeuvre and 0.05 % of braking power anywhere.

    Should it take more than 17 x 17 points, the grid that exceeds these least. More than 0.1 % of a manoeuvre is refused.
    """
    references, braked = _references(drive), _braking_reference(drive)
    found = []
    for torque_points, speed_points in sorted(GRIDS, key=lambda grid: grid[0] * grid[1]):
        table = current_map.compute(drive, torque_points, speed_points)
        energy = max(loss.interpolation for loss in _losses(drive, table, references))
        power = _worst_share(drive, table, braked)
        used = max(energy / (ENERGY_SHARE * audit.ENERGY_LOSS_MAX), power / (POWER_SHARE * audit.POWER_LOSS_MAX))
        if used <= 1.0:
            return table
        found.append((used, energy, table))
    _, energy, table = min(found, key=lambda triple: triple[0])
    if energy > REFUSED:
        raise ConfigurationError(
            f"current_map: {GRIDS[-1][0]} x {GRIDS[-1][1]} points lose {energy:.2%} of the energy to interpolation, "
            f"accepted: at most {REFUSED:.1%} (a less salient motor)"
        )
    return table


def losses(drive: Drive, table: CurrentMap) -> list[CurrentLoss]:
    """Energy lost to the table over a hard stop, a full acceleration and the shipped cycles, hot and cold, at worst."""
    return _losses(drive, table, _references(drive))


def worst_power_loss(drive: Drive, table: CurrentMap) -> float:
    """Largest relative loss of braking power to interpolation at any speed and temperature, at the best torque there."""
    return _worst_share(drive, table, _braking_reference(drive))


@lru_cache(maxsize=8)
def _references(drive: Drive) -> list[_Reference]:
    """Collect the manoeuvres at both ends of the temperature range."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    speed = (np.arange(_SPEEDS, dtype=np.float64) + 0.5) * top / _SPEEDS
    strongest = braking.torque_limit_nm(drive, speed)
    manoeuvres = {"hard stop": (speed, np.ones(_SPEEDS), -strongest), "full acceleration": (speed, np.ones(_SPEEDS), strongest)}
    for cycle in cycles.shipped(drive):
        asked = cycles.demand(drive, cycle)
        moving = asked.speed_rad_s > 0.0
        limit = braking.torque_limit_nm(drive, asked.speed_rad_s[moving])
        manoeuvres[cycle.name] = (asked.speed_rad_s[moving], asked.seconds[moving], np.clip(asked.torque_nm[moving], -limit, limit))
    found = []
    for name, (speed, seconds, torque) in manoeuvres.items():
        exact = _exact_current(drive, speed, torque)
        for temperature in drive.table.temperature_range_c:
            motor, inverter = models.machine(drive, temperature), models.bridge(drive)
            omega = speed * motor.pole_pairs
            best = joint.least_power(motor, inverter, omega, torque, _relaxed(drive))
            gridless, zero = (current_map.state(motor, inverter, omega, torque, i_d).dc_power_w for i_d in (exact, 0.0))
            known = best.feasible & np.isfinite(zero) & np.isfinite(gridless)
            points = (speed, torque, seconds, best.state.dc_power_w, gridless, zero)
            found.append(_Reference(name, motor, *(values[known] for values in points)))
    return found


def _exact_current(drive: Drive, speed: Array, torque: Array) -> Array:
    """i_d in A of least loss at the temperature the table is made for."""
    motor = models.machine(drive, float(np.mean(drive.table.temperature_range_c)))
    return joint.least_power(motor, models.bridge(drive), speed * motor.pole_pairs, torque, _relaxed(drive)).state.current_d_a


def _losses(drive: Drive, table: CurrentMap, references: list[_Reference]) -> list[CurrentLoss]:
    worst: dict[str, CurrentLoss] = {}
    for at in references:
        made = _power(drive, table, at.motor, at.speed_rad_s, at.torque_nm)
        energy = float(np.sum(np.abs(at.least_w) * at.seconds))
        pairs = ((made, at.gridless_w), (made, at.least_w), (at.without_w, at.least_w))
        here = [float(np.sum((a - b) * at.seconds)) / energy for a, b in pairs]
        before = worst.get(at.manoeuvre)
        if before is not None:
            here = list(map(max, here, (before.interpolation, before.stored, before.without_d_current)))
        worst[at.manoeuvre] = CurrentLoss(at.manoeuvre, *here)
    return list(worst.values())


@lru_cache(maxsize=8)
def _braking_reference(drive: Drive) -> _Reference:
    """Find the best braking inside torque and power limits from where the motor begins to brake up to the top speed."""
    lowest, highest = drive.table.temperature_range_c
    motor, inverter = models.machine(drive, np.array([lowest, 0.5 * (lowest + highest), highest])[:, np.newaxis]), models.bridge(drive)
    speed = np.geomspace(max(drive.control.handover_end_rpm, 1e-3 * drive.motor.max_speed_rpm), drive.motor.max_speed_rpm, _POWER_SPEEDS)
    speed = np.broadcast_to(speed * (np.pi / 30.0), (3, _POWER_SPEEDS))
    omega, limit = speed * motor.pole_pairs, braking.torque_limit_nm(drive, speed)
    best = joint.best_braking(motor, inverter, omega, _relaxed(drive), limit)
    exact = _exact_current(drive, speed, best.torque_nm)
    gridless, zero = (current_map.state(motor, inverter, omega, best.torque_nm, i_d).dc_power_w for i_d in (exact, 0.0))
    return _Reference("braking", motor, speed, best.torque_nm, np.ones_like(speed), best.state.dc_power_w, gridless, zero)


def _worst_share(drive: Drive, table: CurrentMap, at: _Reference) -> float:
    """Loss to interpolation relative to the power that comes back, where any does."""
    lost = _power(drive, table, at.motor, at.speed_rad_s, at.torque_nm) - at.gridless_w
    return float(np.max(np.divide(lost, -at.least_w, out=np.zeros_like(lost), where=at.least_w < 0.0)))


def _power(drive: Drive, table: CurrentMap, motor: models.Machine, speed: Array, torque: Array) -> Array:
    """DC power in W of torques made with the stored i_d."""
    i_d = current_map.read(table, torque, speed)
    return current_map.state(motor, models.bridge(drive), speed * motor.pole_pairs, torque, i_d).dc_power_w


def _relaxed(drive: Drive) -> joint.Limits:
    return joint.Limits(current_map.RELAXED * drive.motor.max_phase_current_a)


def bus_voltage_loss(drive: Drive) -> float:
    """Largest relative power lost by leaving the bus voltage out: all speeds, both directions, lowest bus voltage.

    Compared are the least power under the voltage limit, and the least power without it from which field weakening
    lowers i_d at constant torque until the voltage suffices.
    """
    speed = np.linspace(0.02, 1.0, 40)[:, np.newaxis] * (drive.motor.max_speed_rpm * np.pi / 30.0)
    torque = np.linspace(-1.0, 1.0, 24) * braking.torque_limit_nm(drive, speed)
    motor, inverter = models.machine(drive, float(np.mean(drive.table.temperature_range_c))), models.bridge(drive)
    omega, voltage = speed * motor.pole_pairs, drive.battery.min_voltage_v / np.sqrt(3.0)
    current = drive.motor.max_phase_current_a
    best = joint.least_power(motor, inverter, omega, torque, joint.Limits(current, voltage))
    free = joint.least_power(motor, inverter, omega, torque, joint.Limits(current)).state.current_d_a
    low, high = np.full_like(free, -current), free
    for _ in range(50):
        middle = 0.5 * (low + high)
        enough = current_map.state(motor, inverter, omega, torque, middle).voltage_v <= voltage
        low, high = np.where(enough, middle, low), np.where(enough, high, middle)
    suffices = current_map.state(motor, inverter, omega, torque, free).voltage_v <= voltage
    made = current_map.state(motor, inverter, omega, torque, np.where(suffices, free, low))
    scale = np.abs(best.state.dc_power_w) + best.state.loss_copper_w + best.state.loss_iron_w
    known = best.feasible & (made.voltage_v <= voltage * (1.0 + 1e-6))
    return float(np.max(np.where(known, (made.dc_power_w - best.state.dc_power_w) / scale, 0.0)))
