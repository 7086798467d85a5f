# SPDX-License-Identifier: Apache-2.0
"""What the minimum-loss d-current map costs against the best i_d, and the grid chosen by it.

A grid is judged by what it loses to interpolation and quantisation: energy, over manoeuvres and
cycles, and power, at every speed at which the drive brakes, cold, hot and in between. First come as
few temperatures as keep within a share of that, with torque and speed taken exactly; then the
fewest points of torque and speed. What does not depend on the grid is computed once a drive, like
the choice itself, used by image and report.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from regen_table import audit, braking, current_map, ideal_cycles, joint, layout, models, torque_map
from regen_table.current_map import CurrentMap
from regen_table.errors import ConfigurationError
from regen_table.models import Array
from regen_table.schema import Drive

# Of what may be lost, half is the braking table's; of the rest, half is what temperature may take.
STORED_SHARE, TEMPERATURE_SHARE = 0.5, 0.25
LAYERS = (1, 2, 3, 5)
_TORQUE_INTERVALS = 32  # each way
_SPEED_INTERVALS = 64
_SPEEDS = 200
_POWER_SPEEDS, _POWER_TEMPERATURES = 36, 5


@dataclass(frozen=True)
class CurrentLoss:
    """What a table costs in one manoeuvre at the worst temperature, against least loss.

    Relative to the energy at the bus.

    Attributes
    ----------
    temperature : float
        What the few temperatures leave, with torque and speed exact.
    stored : float
        What the table costs.
    without_d_current : float
        What i_d = 0 would cost.
    """

    manoeuvre: str
    temperature: float
    stored: float
    without_d_current: float


@dataclass(frozen=True, eq=False)
class _Reference:
    """Points of a manoeuvre and the least power of each.

    Shape (points,) or (temperatures, points); the powers have the latter.
    """

    manoeuvre: str
    motor: models.Machine
    speed_rad_s: Array
    torque_nm: Array
    seconds: Array
    least_w: Array


# Sections that no map depends on: drives that differ in these alone have one search.
_APART = (
    *("rotor", "driver", "pedals", "service", "can", "tolerance", "monitor", "sensors", "bus"),
    *("bms", "thermal", "chassis", "tyre", "fields"),
)


def _of_maps(drive: Drive) -> Drive:
    """Return a drive without the sections that no map depends on: to read one fails."""
    return drive.model_copy(update=dict.fromkeys(_APART))


def choose(drive: Drive) -> CurrentMap:
    """Return the smallest grid that loses little enough.

    At most 0.01 % of any manoeuvre's energy and 0.05 % of braking power anywhere.

    Driving and braking count apart. Should it take more points than the firmware holds, the
    grid that exceeds these least. More than 0.02 % of a whole manoeuvre is refused.
    """
    return _chosen(_of_maps(drive))


@lru_cache(maxsize=8)
def _chosen(drive: Drive) -> CurrentMap:
    references, braked = _references(drive), _braking_reference(drive)
    layers = _layers(drive, references, braked)
    grids = list(_grids(drive, layers))
    for steps in grids:
        table = current_map.compute(drive, *steps, layers)
        if _loses_at_most(STORED_SHARE, references, braked, partial(_stored_power, drive, table)):
            return table

    def used(table: CurrentMap) -> float:
        made = partial(_stored_power, drive, table)
        energy = max(_energy_share(at, made(at)) for at in references)
        power = _power_share(braked, made(braked))
        return max(energy / audit.ENERGY_LOSS_MAX, power / audit.POWER_LOSS_MAX)

    best = min((current_map.compute(drive, *steps, layers) for steps in grids), key=used)
    lost = _whole_loss(drive, best, references)
    if lost > audit.ENERGY_LOSS_MAX:
        raise ConfigurationError(
            f"motor.q_inductance_h: the largest i_d map that the controller holds loses {lost:.3%}"
            f" of the energy of a manoeuvre, accepted: at most {audit.ENERGY_LOSS_MAX:.2%} (a less"
            " salient motor, or a lower max_torque_nm)"
        )
    return best


def braking_table(drive: Drive) -> torque_map.RegenMap:
    """Return the table of T_opt that belongs to the chosen i_d.

    On the grid that the drive names or on the smallest one.
    """
    return _braking_table(_of_maps(drive))


@lru_cache(maxsize=8)
def _braking_table(drive: Drive) -> torque_map.RegenMap:
    points: tuple[int, int] | None = None
    if "auto" in {drive.table.speed_points, drive.table.temperature_points}:
        points = smallest_grid(drive)
        if points is None:
            raise ConfigurationError(
                'table.speed_points, table.temperature_points: no grid suffices for "auto",'
                " accepted: a narrower temperature_range_c, or numbers"
            )
    return current_map.regen_map(drive, choose(drive), points)


def smallest_grid(drive: Drive, free: bool = False) -> tuple[int, int] | None:
    """Return the least numbers of speeds and temperatures that suffice (audit), or None.

    For the energy of every manoeuvre and for the power at every speed; where no grid does both, for
    the energy. A number that the drive names is kept, unless ``free``.
    """
    if free:
        auto = drive.table.model_copy(update={"speed_points": "auto", "temperature_points": "auto"})
        drive = drive.model_copy(update={"table": auto}).named(drive.name)
    currents = choose(drive)
    made = current_map.production(currents)
    for_energy: tuple[int, int] | None = None
    for points in torque_map.grids(drive, _ends_of_optima(drive, currents)):
        table = current_map.regen_map(drive, currents, points)
        if audit.suffices(drive, table, made):
            for_energy = for_energy or points
            if audit.worst_power_loss(drive, table, made) <= audit.POWER_LOSS_MAX:
                return points
    return for_energy


def _ends_of_optima(drive: Drive, currents: CurrentMap) -> Iterator[int]:
    """Yield, for each step of speed, the points until every optimum exceeds max_torque_nm."""
    motor = models.machine(drive, np.array([[t] for t in drive.table.temperature_range_c]))
    speed = np.linspace(0.0, 1.0, 257) * (drive.motor.max_speed_rpm * np.pi / 30.0)
    limit = 1.5 * drive.motor.max_torque_nm
    best = current_map.best_torque_nm(motor, models.bridge(drive), currents, speed, limit)
    beyond = np.flatnonzero(np.all(best >= drive.motor.max_torque_nm, axis=0))
    if beyond.size:
        for step in range(*torque_map.SPEED_STEP_LOG2):
            yield torque_map.points_over(1000.0 * float(speed[beyond[0]]), step)


def losses(drive: Drive, table: CurrentMap) -> list[CurrentLoss]:
    """Energy lost to the table over a hard stop, a full acceleration and the shipped cycles."""
    layers = table.current_d_mA.shape[0]

    def of(at: _Reference) -> CurrentLoss:
        without = _made_power(drive, at, np.zeros(1))
        without = np.where(
            np.isfinite(without), without, at.least_w
        )  # a torque that i_d = 0 cannot make is no loss
        made = (_gridless_power(drive, layers, at), _stored_power(drive, table, at), without)
        return CurrentLoss(at.manoeuvre, *(_energy_share(at, power) for power in made))

    return [of(at) for at in _references(drive)]


def worst_power_loss(drive: Drive, table: CurrentMap) -> float:
    """Largest relative loss of braking power, at the best torque of any speed and temperature."""
    at = _braking_reference(drive)
    return _power_share(at, _stored_power(drive, table, at))


def _layers(drive: Drive, references: list[_Reference], braked: _Reference) -> int:
    """Return how many temperatures are worth it."""
    for layers in LAYERS:
        if current_map.temperature_axis(drive, layers)[1] > torque_map.TEMPERATURE_STEP_LOG2[1]:
            continue
        made = partial(_gridless_power, drive, layers)
        if _loses_at_most(TEMPERATURE_SHARE, references, braked, made):
            return layers
    return LAYERS[-1]


def _grids(drive: Drive, layers: int) -> Iterator[tuple[int, int]]:
    """Step exponents of torque and speed of every grid that fits the firmware, smallest first."""
    header = layout.load()
    capacity = header.constants["CONFIG_CURRENT_MAP_POINTS_MAX"]
    accepted = header.sections["current_map"]
    torque, speed = (
        1000.0 * drive.motor.max_torque_nm,
        1000.0 * drive.motor.max_speed_rpm * math.pi / 30.0,
    )
    torque_steps = range(
        max(0, math.ceil(math.log2(torque / _TORQUE_INTERVALS))),
        min(max(1, math.ceil(math.log2(torque))), accepted["torque_step_log2"].highest + 1),
    )
    speed_steps = range(
        max(6, math.ceil(math.log2(speed / _SPEED_INTERVALS))),
        min(max(7, math.ceil(math.log2(speed)) + 1), accepted["speed_step_log2"].highest + 1),
    )
    found = [
        (math.prod(current_map.points_over(drive, *steps)), steps)
        for steps in itertools.product(torque_steps, speed_steps)
    ]
    return (steps for points, steps in sorted(found) if points * layers <= capacity)


@lru_cache(maxsize=8)
def _references(drive: Drive) -> list[_Reference]:
    """Collect the manoeuvres, at both ends of the temperature range and in its middle."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    speed = (np.arange(_SPEEDS, dtype=np.float64) + 0.5) * top / _SPEEDS
    strongest = braking.torque_limit_nm(drive, speed)
    manoeuvres = {
        "hard stop": (speed, np.ones(_SPEEDS), -strongest),
        "full acceleration": (speed, np.ones(_SPEEDS), strongest),
    }
    for cycle in ideal_cycles.shipped(drive):
        asked = ideal_cycles.demand(drive, cycle)
        moving, brakes = asked.speed_rad_s > 0.0, asked.torque_nm < 0.0
        brakes_on = (
            asked.speed_rad_s >= drive.control.handover_end_rpm * np.pi / 30.0
        )  # below, the motor does not brake
        for name, part in (
            (f"{cycle.name} driving", moving & ~brakes),
            (f"{cycle.name} braking", brakes & brakes_on),
        ):
            if not part.any():  # a vehicle so slow that a cycle ends its braking below that speed
                continue
            limit = braking.torque_limit_nm(drive, asked.speed_rad_s[part])
            manoeuvres[name] = (
                asked.speed_rad_s[part],
                asked.seconds[part],
                np.clip(asked.torque_nm[part], -limit, limit),
            )
    motor = models.machine(drive, np.linspace(*drive.table.temperature_range_c, 3)[:, np.newaxis])
    found = []
    for name, (speed, seconds, torque) in manoeuvres.items():
        best = _least(drive, motor, speed, np.broadcast_to(torque, (3, len(torque))))
        found.append(
            _Reference(
                name,
                motor,
                speed,
                torque,
                seconds,
                np.where(best.feasible, best.state.dc_power_w, np.nan),
            )
        )
    return found


@lru_cache(maxsize=8)
def _braking_reference(drive: Drive) -> _Reference:
    """Find the best braking inside torque and power limits.

    From where the motor begins to brake up to the top speed.
    """
    motor = models.machine(
        drive, np.linspace(*drive.table.temperature_range_c, _POWER_TEMPERATURES)[:, np.newaxis]
    )
    speed = np.geomspace(
        max(drive.control.handover_end_rpm, 1e-3 * drive.motor.max_speed_rpm),
        drive.motor.max_speed_rpm,
        _POWER_SPEEDS,
    )
    speed = np.broadcast_to(speed * (np.pi / 30.0), (_POWER_TEMPERATURES, _POWER_SPEEDS))
    limit = braking.torque_limit_nm(drive, speed)
    best = joint.best_braking(
        motor, models.bridge(drive), speed * motor.pole_pairs, relaxed(drive), limit, joint.AUDIT
    )
    return _Reference(
        "braking", motor, speed, best.torque_nm, np.ones_like(speed), best.state.dc_power_w
    )


def _least(drive: Drive, motor: models.Machine, speed: Array, torque: Array) -> joint.Point:
    return joint.least_power(
        motor, models.bridge(drive), speed * motor.pole_pairs, torque, relaxed(drive), joint.AUDIT
    )


def relaxed(drive: Drive) -> joint.Limits:
    """Bounds of the search that a table is made and judged with.

    The drive's own current limit acts at run time.
    """
    return joint.Limits(current_map.RELAXED * drive.motor.max_phase_current_a)


def _made_power(drive: Drive, at: _Reference, i_d: Array) -> Array:
    """DC power in W of a reference's torques made with some i_d."""
    return current_map.state(
        at.motor, models.bridge(drive), at.speed_rad_s * at.motor.pole_pairs, at.torque_nm, i_d
    ).dc_power_w


def _stored_power(drive: Drive, table: CurrentMap, at: _Reference) -> Array:
    return _made_power(
        drive,
        at,
        current_map.read(table, at.torque_nm, at.speed_rad_s, at.motor.winding_temperature_c),
    )


@lru_cache(maxsize=64)
def _gridless_power(drive: Drive, layers: int, at: _Reference) -> Array:
    """DC power in W with i_d exact over torque and speed, linear between the temperatures."""
    warm = current_map.temperatures_c(*current_map.temperature_axis(drive, layers), layers)
    exact = [
        _least(
            drive, models.machine(drive, float(t)), at.speed_rad_s, at.torque_nm
        ).state.current_d_a
        for t in warm
    ]
    place = np.clip(
        np.interp(at.motor.winding_temperature_c, warm, np.arange(layers)), 0.0, layers - 1.0
    )
    i_d = sum(
        (np.maximum(0.0, 1.0 - np.abs(place - k)) * exact[k] for k in range(layers)),
        start=np.zeros(1),
    )
    return _made_power(drive, at, i_d)


def _loses_at_most(
    share: float,
    references: list[_Reference],
    braked: _Reference,
    made: Callable[[_Reference], Array],
) -> bool:
    """Whether a way to make torque loses at most an allowed share, in power and manoeuvres."""
    return _power_share(braked, made(braked)) <= share * audit.POWER_LOSS_MAX and all(
        _energy_share(at, made(at)) <= share * audit.ENERGY_LOSS_MAX for at in references
    )


def _whole_loss(drive: Drive, table: CurrentMap, references: list[_Reference]) -> float:
    """Largest share of energy lost in a whole manoeuvre, driving and braking together."""
    parts: dict[str, list[Array]] = {}
    for at in references:
        lost = np.sum(_lost_w(at, _stored_power(drive, table, at)) * at.seconds, axis=1)
        turned_over = np.nansum(np.abs(at.least_w) * at.seconds, axis=1)
        parts.setdefault(at.manoeuvre.removesuffix(" driving").removesuffix(" braking"), []).append(
            np.array([lost, turned_over])
        )
    return max(float(np.max(np.divide(*np.sum(found, axis=0)))) for found in parts.values())


def _energy_share(at: _Reference, made: Array) -> float:
    """Energy lost relative to the energy at the bus, at the worst temperature.

    What no current makes does not count.
    """
    lost = np.sum(_lost_w(at, made) * at.seconds, axis=1)
    return float(np.max(lost / np.nansum(np.abs(at.least_w) * at.seconds, axis=1)))


def _power_share(at: _Reference, made: Array) -> float:
    """Loss relative to the power that comes back, where any does."""
    lost = _lost_w(at, made)
    return float(
        np.max(np.divide(lost, -at.least_w, out=np.zeros_like(lost), where=at.least_w < 0.0))
    )


def _lost_w(at: _Reference, made: Array) -> Array:
    """Power lost in W; without bound where a torque that some current makes is not made."""
    lost = np.where(np.isfinite(at.least_w), made - at.least_w, 0.0)
    return np.where(np.isnan(lost), np.inf, lost)


def bus_voltage_loss(drive: Drive) -> float:
    """Largest relative power lost by leaving the bus voltage out.

    All speeds, both directions, lowest bus voltage.

    Compared are the least power under the voltage limit, and the least power without it from which
    field weakening lowers i_d at constant torque until the voltage suffices.
    """
    speed = np.linspace(0.02, 1.0, 40)[:, np.newaxis] * (drive.motor.max_speed_rpm * np.pi / 30.0)
    torque = np.linspace(-1.0, 1.0, 24) * braking.torque_limit_nm(drive, speed)
    motor, inverter = (
        models.machine(drive, float(np.mean(drive.table.temperature_range_c))),
        models.bridge(drive),
    )
    omega, voltage = speed * motor.pole_pairs, drive.battery.min_voltage_v / np.sqrt(3.0)
    current = drive.motor.max_phase_current_a
    best = joint.least_power(motor, inverter, omega, torque, joint.Limits(current, voltage))
    free = joint.least_power(
        motor, inverter, omega, torque, joint.Limits(current)
    ).state.current_d_a
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
