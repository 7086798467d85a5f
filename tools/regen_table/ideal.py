# SPDX-License-Identifier: Apache-2.0
"""An ideal controller: how it makes torque, and what its stops return.

With i_d = 0 as in the paper, or with the i_d of least loss.

Surface magnets: i_d = 0, the paper's closed form. Salient motors: both currents, because i_d = 0
would waste most of what the motor can do. Points inside the drive's limits then take the i_d that
the firmware has stored (current_map), which is within a fiftieth of a per cent of the least loss;
the lines without limits are searched for.

The ideal stop has a constant demand at every driven wheel, from a speed to standstill, and a steady
state at every speed: no delay, no blend-out, no drag. What remains is how the losses depend on the
share that the motor takes. For a given speed trace the pointwise optimum is the best over time, so
series_optimal bounds every real stop from above; with the battery's RC branch taken as settled it
does not, because that branch has no time to take its loss (packs).
"""

from dataclasses import asdict, dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from regen_table import braking, current_audit, current_map, joint, models, optimum, packs
from regen_table.models import Array, ArrayLike, Bridge, Machine
from regen_table.schema import Drive

SPEED_STEPS = 4000
Truth = npt.NDArray[np.bool_]


def salient(drive: Drive) -> bool:
    """Whether i_d matters for the torque."""
    return drive.motor.type == "ipmsm"


def production(drive: Drive) -> braking.Production:
    """Return how the drive makes torque inside its limits."""
    return (
        current_map.production(current_audit.choose(drive))
        if salient(drive)
        else braking.ZERO_D_CURRENT
    )


@dataclass(frozen=True)
class Lines:
    """Best braking without limits over speed.

    Torques are magnitudes in N m, currents peak phase magnitudes in A.

    NaN where there is none within three times the drive's phase current.
    """

    optimal_nm: Array
    zero_nm: Array
    optimal_a: Array
    zero_a: Array


def lines(drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike) -> Lines:
    """Return the torque of most returned power, and the larger one of zero power.

    At mechanical speeds in rad/s.
    """
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    if not salient(drive):
        best = optimum.closed_form(motor, inverter, omega)
        current = np.abs(best.current_q_a)
        return Lines(
            np.abs(best.torque_optimal_nm), np.abs(best.torque_zero_nm), current, 2.0 * current
        )
    bounds = current_audit.relaxed(drive)
    best_point, returns, inside = _best_of_both(motor, inverter, omega, bounds)
    zero = joint.zero_power_torque(motor, inverter, omega, bounds, best_point)
    at_zero = joint.least_power(motor, inverter, omega, zero, bounds).state
    ends = inside & (np.abs(at_zero.dc_power_w) < 1e-3 * np.abs(best_point.state.dc_power_w))
    return Lines(
        optimal_nm=_magnitude_nm(best_point, returns, inside),
        zero_nm=np.where(returns, np.where(ends, np.abs(zero), np.nan), 0.0),
        optimal_a=np.where(returns, np.where(inside, best_point.state.current_a, np.nan), 0.0),
        zero_a=np.where(returns, np.where(ends, at_zero.current_a, np.nan), 0.0),
    )


def optimal_nm(drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike) -> Array:
    """Return the torque of most returned power alone, as lines() does."""
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    if not salient(drive):
        return np.abs(optimum.closed_form(motor, inverter, omega).torque_optimal_nm)
    return _magnitude_nm(*_best_of_both(motor, inverter, omega, current_audit.relaxed(drive)))


def _best_of_both(
    motor: Machine, inverter: Bridge, omega: Array, bounds: joint.Limits
) -> tuple[joint.Point, Truth, Truth]:
    """Return the best braking point, whether it returns energy, and whether it is inside bounds."""
    best = joint.best_braking(motor, inverter, omega, bounds)
    returns = best.state.dc_power_w < 0.0  # else no torque returns energy
    return best, returns, best.state.current_a < 0.999 * np.asarray(bounds.current_a)


def _magnitude_nm(best: joint.Point, returns: Truth, inside: Truth) -> Array:
    return np.where(returns, np.where(inside, np.abs(best.torque_nm), np.nan), 0.0)


def state(
    drive: Drive, motor: Machine, inverter: Bridge, speed_rad_s: ArrayLike, torque_nm: ArrayLike
) -> models.State:
    """Steady state of a signed torque at a mechanical speed, also beyond the drive's limits."""
    if not salient(drive):
        return braking.state_of_torque(motor, inverter, speed_rad_s, torque_nm)
    omega = np.asarray(speed_rad_s) * motor.pole_pairs
    return joint.least_power(
        motor, inverter, omega, torque_nm, joint.Limits(10.0 * drive.motor.max_phase_current_a)
    ).state


def meeting_rad_s(drive: Drive, motor: Machine, inverter: Bridge) -> float:
    """Mechanical speed above which the limits, not the optimum, bound the motor's braking."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0
    made = production(drive)
    low, high = 0.0, top
    for _ in range(30):
        middle = 0.5 * (low + high)
        limited = made.capability_nm(drive, motor, inverter, np.array([middle]))[
            0
        ] >= 0.999 * braking.torque_limit_nm(drive, middle)
        low, high = (low, middle) if limited else (middle, high)
    return high


@dataclass(frozen=True)
class Energies:
    """Where the energy of a stop went, in J, all motors together; sinks are >= 0.

    ``polarisation`` is left in the battery's RC branch at the end, on its way to heat; 0 where that
    branch is settled.
    """

    battery_returned: float
    hydraulic: float
    copper: float
    iron: float
    inverter: float
    battery: float
    polarisation: float
    friction: float


@dataclass(frozen=True)
class Stop:
    """Result of one stop; energies in J."""

    strategy: str
    battery: str
    demand_nm: float
    initial_speed_kmh: float
    winding_temperature_c: float
    kinetic_energy_j: float
    stop_distance_m: float
    stop_time_s: float
    energy_j: Energies
    stored_share_of_kinetic: float
    residual_relative: float

    def as_dict(self) -> dict[str, object]:
        """Return the result as nested mappings for JSON."""
        return asdict(self)


def stop(
    drive: Drive,
    strategy: str,
    demand_nm: float,
    initial_speed_kmh: float,
    temperature_c: float,
    soc: float | None = None,
    battery: str = packs.SETTLED,
) -> Stop:
    """Integrate one ideal stop.

    Parameters
    ----------
    demand_nm : float
        Braking torque at each driven wheel, magnitude, > 0; the motor's friction brakes on top of
        it.
    initial_speed_kmh : float
        > 0.
    temperature_c : float
        Winding temperature, constant.
    battery : str
        "settled" or "dynamic", see packs; the speed trace and the torques are the same for both.
    """
    motor, inverter = models.machine(drive, temperature_c), models.bridge(drive)
    wheels, radius, mass = (
        drive.vehicle.driven_wheels,
        drive.vehicle.wheel_radius_m,
        drive.vehicle.mass_kg,
    )
    initial = initial_speed_kmh / 3.6
    speed = _speeds_rad_s(drive, initial_speed_kmh)
    made = production(drive)
    needed = strategy == "series_optimal"
    capability = (
        _capability(drive, temperature_c, initial_speed_kmh) if needed else np.zeros_like(speed)
    )
    electric = braking.electric_torque_nm(drive, strategy, demand_nm, speed, capability)
    steady = made.state(motor, inverter, speed, -electric)
    wheel_torque = demand_nm + steady.loss_friction_w / speed
    deceleration = wheels * wheel_torque / (radius * mass)
    seconds = initial / SPEED_STEPS / deceleration
    # Time runs from the highest speed to the lowest.
    pack = packs.flow(drive, battery, wheels * steady.dc_power_w[::-1], seconds[::-1], soc)

    def total(power_w: Array) -> float:
        return float(np.sum(power_w * seconds))

    kinetic = 0.5 * mass * initial**2
    energies = Energies(
        battery_returned=-pack.chemical_j,
        hydraulic=total(wheels * (demand_nm - electric) * speed),
        copper=total(wheels * steady.loss_copper_w),
        iron=total(wheels * steady.loss_iron_w),
        inverter=total(wheels * steady.loss_inverter_w),
        battery=pack.heat_j,
        polarisation=pack.left_in_branch_j,
        friction=total(wheels * steady.loss_friction_w),
    )
    return Stop(
        strategy=strategy,
        battery=battery,
        demand_nm=demand_nm,
        initial_speed_kmh=initial_speed_kmh,
        winding_temperature_c=temperature_c,
        kinetic_energy_j=kinetic,
        stop_distance_m=total(speed * radius),
        stop_time_s=float(np.sum(seconds)),
        energy_j=energies,
        stored_share_of_kinetic=energies.battery_returned / kinetic,
        residual_relative=(kinetic - sum(asdict(energies).values())) / kinetic,
    )


def _speeds_rad_s(drive: Drive, initial_speed_kmh: float) -> Array:
    """Mechanical speeds of the midpoint rule over speed.

    The integrands have kinks at the limits and none at standstill.
    """
    step = initial_speed_kmh / 3.6 / SPEED_STEPS / drive.vehicle.wheel_radius_m
    return (np.arange(SPEED_STEPS, dtype=np.float64) + 0.5) * step


@lru_cache(maxsize=8)
def _capability(drive: Drive, temperature_c: float, initial_speed_kmh: float) -> Array:
    """Capability in N m at those speeds.

    Kept because a sweep of demands asks for it again and again.
    """
    motor, inverter = models.machine(drive, temperature_c), models.bridge(drive)
    return production(drive).capability_nm(
        drive, motor, inverter, _speeds_rad_s(drive, initial_speed_kmh)
    )
