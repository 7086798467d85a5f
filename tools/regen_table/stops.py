# SPDX-License-Identifier: Apache-2.0
"""The ideal stop: constant demand at every driven wheel, from a speed to standstill.

Steady state at every speed.

No delay, no blend-out, no drag: what remains is how the losses depend on the share that the motor
takes. For a given speed trace the pointwise optimum is the best over time, so series_optimal bounds
every real stop from above; with the battery's RC branch taken as settled it does not, because that
branch has no time to take its loss (packs). Surface magnets brake with i_d = 0, as in the paper,
salient motors with the i_d of least loss (ideal).
"""

from dataclasses import asdict, dataclass
from functools import lru_cache

import numpy as np

from regen_table import braking, ideal, models, packs
from regen_table.models import Array
from regen_table.schema import Drive

SPEED_STEPS = 4000


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
    made = ideal.production(drive)
    needed = strategy == "series_optimal"
    capability = (
        _capability(drive, temperature_c, initial_speed_kmh) if needed else np.zeros_like(speed)
    )
    electric = braking.electric_torque_nm(drive, strategy, demand_nm, speed, capability)
    state = made.state(motor, inverter, speed, -electric)
    wheel_torque = demand_nm + state.loss_friction_w / speed
    deceleration = wheels * wheel_torque / (radius * mass)
    seconds = initial / SPEED_STEPS / deceleration
    # Time runs from the highest speed to the lowest.
    pack = packs.flow(drive, battery, wheels * state.dc_power_w[::-1], seconds[::-1], soc)

    def total(power_w: Array) -> float:
        return float(np.sum(power_w * seconds))

    kinetic = 0.5 * mass * initial**2
    energies = Energies(
        battery_returned=-pack.chemical_j,
        hydraulic=total(wheels * (demand_nm - electric) * speed),
        copper=total(wheels * state.loss_copper_w),
        iron=total(wheels * state.loss_iron_w),
        inverter=total(wheels * state.loss_inverter_w),
        battery=pack.heat_j,
        polarisation=pack.left_in_branch_j,
        friction=total(wheels * state.loss_friction_w),
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
    return ideal.production(drive).capability_nm(
        drive, motor, inverter, _speeds_rad_s(drive, initial_speed_kmh)
    )
