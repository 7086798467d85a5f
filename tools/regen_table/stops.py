"""The ideal stop: constant demand at every driven wheel from a speed to standstill, steady state at every speed.

No delay, no hand-over, no drag: what is left is how the losses depend on the share that the motor takes. For a given
speed trace the pointwise optimum is the best over time, so series_optimal bounds every real stop from above.
"""

from dataclasses import asdict, dataclass

import numpy as np

from regen_table import braking, models
from regen_table.models import Array
from regen_table.schema import Drive

SPEED_STEPS = 4000


@dataclass(frozen=True)
class Energies:
    """Where the energy of a stop or a cycle went, in J, all motors together; sinks are >= 0."""

    battery_returned: float
    hydraulic: float
    copper: float
    iron: float
    inverter: float
    battery: float
    friction: float


@dataclass(frozen=True)
class Stop:
    """Result of one stop; energies in J."""

    strategy: str
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


def stop(drive: Drive, strategy: str, demand_nm: float, initial_speed_kmh: float, temperature_c: float, soc: float | None = None) -> Stop:
    """Integrate one ideal stop.

    Parameters
    ----------
    demand_nm : float
        Braking torque at each driven wheel, magnitude, > 0; the motor's friction brakes on top of it.
    initial_speed_kmh : float
        > 0.
    temperature_c : float
        Winding temperature, constant.
    """
    motor, inverter = models.machine(drive, temperature_c), models.bridge(drive)
    wheels, radius, mass = drive.vehicle.driven_wheels, drive.vehicle.wheel_radius_m, drive.vehicle.mass_kg
    initial = initial_speed_kmh / 3.6
    # The midpoint rule over speed: the integrands have kinks at the limits and none at standstill.
    speed = (np.arange(SPEED_STEPS, dtype=np.float64) + 0.5) * (initial / SPEED_STEPS / radius)
    capability = braking.capability_nm(drive, motor, inverter, speed)
    electric = braking.electric_torque_nm(drive, strategy, demand_nm, speed, capability)
    state = braking.state_of_torque(motor, inverter, speed, -electric)
    pack_resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    pack = models.battery_steady(models.open_circuit_voltage_v(drive, soc), pack_resistance, wheels * state.dc_power_w)
    wheel_torque = demand_nm + state.loss_friction_w / speed
    deceleration = wheels * wheel_torque / (radius * mass)
    seconds = initial / SPEED_STEPS / deceleration

    def total(power_w: Array) -> float:
        return float(np.sum(power_w * seconds))

    kinetic = 0.5 * mass * initial**2
    energies = Energies(
        battery_returned=-total(pack.chemical_power_w),
        hydraulic=total(wheels * (demand_nm - electric) * speed),
        copper=total(wheels * state.loss_copper_w),
        iron=total(wheels * state.loss_iron_w),
        inverter=total(wheels * state.loss_inverter_w),
        battery=total(pack.loss_w),
        friction=total(wheels * state.loss_friction_w),
    )
    return Stop(
        strategy=strategy,
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
