# SPDX-License-Identifier: Apache-2.0
"""The ideal drive cycle.

Every instant in steady state, the speed trace followed exactly as far as the limits allow.
"""

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from regen_table import braking, drive_cycles, installation, models
from regen_table.derived import AIR_DENSITY_KG_M3
from regen_table.errors import ConfigurationError
from regen_table.models import Array
from regen_table.schema import Drive

DIRECTORY = installation.ROOT / "host_sim" / "cycles"
GRAVITY_M_S2 = 9.80665
PARTS = 4  # steady states per sample of the trace


@dataclass(frozen=True)
class Cycle:
    """A speed trace: ``time_s``, ``speed_m_s`` and the road's rise over way, shape (samples,)."""

    name: str
    time_s: Array
    speed_m_s: Array
    slope: Array


@dataclass(frozen=True)
class CycleEnergies:
    """Energy of a cycle in J, all motors together, positive.

    ``traction`` is what the battery's cells gave.
    """

    traction: float
    braking_at_wheels: float
    battery_returned: float
    hydraulic: float
    copper: float
    iron: float
    inverter: float
    battery: float
    friction: float
    drag: float
    climbed: float

    @property
    def losses(self) -> dict[str, float]:
        """Heat between the cells and the road, hydraulic brake included, in J."""
        names = ("copper", "iron", "inverter", "battery", "friction", "hydraulic")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True)
class CycleResult:
    """Result of one cycle under one strategy."""

    cycle: str
    strategy: str
    winding_temperature_c: float
    energy_j: CycleEnergies
    while_driving_j: CycleEnergies
    while_braking_j: CycleEnergies
    braking_share_stored: float
    residual_relative: float

    def as_dict(self) -> dict[str, object]:
        """Return the result as nested mappings for JSON."""
        return asdict(self)


def load(path: Path, top_speed_kmh: float | None = None) -> Cycle:
    """Read a cycle (drive_cycles).

    ``top_speed_kmh`` scales the speeds so that the fastest one becomes it (None: as they are).
    """
    found = drive_cycles.read(path)
    speed = np.array(found.speed_kmh) / 3.6
    if not np.any(speed > 0.0):
        raise ConfigurationError(f"{path}: speed always 0, accepted: a cycle that moves")
    factor = 1.0 if top_speed_kmh is None else top_speed_kmh / 3.6 / float(np.max(speed))
    slope = np.array(found.slope) if found.slope else np.zeros_like(speed)
    return Cycle(path.stem, np.array(found.time_s), speed * factor, slope)


def shipped(drive: Drive) -> list[Cycle]:
    """Return the simulator's cycles, slowed down where they exceed the drive's top speed."""
    top = drive.motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m
    found = [load(path) for path in sorted(DIRECTORY.glob("*.csv"))]
    return [
        replace(c, speed_m_s=c.speed_m_s * min(1.0, top / float(np.max(c.speed_m_s))))
        for c in found
    ]


@dataclass(frozen=True)
class Demand:
    """Demand of a cycle at one wheel; arrays of the shape (steps,)."""

    seconds: Array
    speed_rad_s: Array
    torque_nm: Array  # at the wheel, positive drives
    drag_w: Array  # whole vehicle
    climbing_w: Array  # whole vehicle, negative downhill


def demand(drive: Drive, cycle: Cycle) -> Demand:
    """Compute the demand at a driven wheel: mass, grade, rolling resistance and air drag."""
    vehicle = drive.vehicle
    share = np.arange(PARTS + 1) / PARTS
    time = cycle.time_s[:-1, np.newaxis] + np.diff(cycle.time_s)[:, np.newaxis] * share
    speed = cycle.speed_m_s[:-1, np.newaxis] + np.diff(cycle.speed_m_s)[:, np.newaxis] * share
    seconds = np.diff(time, axis=1).ravel()
    middle = (0.5 * (speed[:, 1:] + speed[:, :-1])).ravel()
    acceleration = np.diff(speed, axis=1).ravel() / seconds
    slope = cycle.slope[:-1, np.newaxis] + np.diff(cycle.slope)[:, np.newaxis] * share
    tangent = (0.5 * (slope[:, 1:] + slope[:, :-1])).ravel()
    weight = vehicle.mass_kg * GRAVITY_M_S2 / np.sqrt(1.0 + tangent**2)  # on the road
    climbing = weight * tangent * (middle > 0.0)
    rolling = vehicle.rolling_resistance * weight * (middle > 0.0)
    drag = (
        rolling
        + 0.5 * AIR_DENSITY_KG_M3 * vehicle.drag_coefficient * vehicle.frontal_area_m2 * middle**2
    )
    force = vehicle.mass_kg * acceleration + drag + climbing
    return Demand(
        seconds,
        middle / vehicle.wheel_radius_m,
        force * vehicle.wheel_radius_m / vehicle.driven_wheels,
        drag * middle,
        climbing * middle,
    )


def run(
    drive: Drive,
    cycle: Cycle,
    strategy: str,
    temperature_c: float,
    soc: float | None = None,
    made: braking.Production = braking.ZERO_D_CURRENT,
) -> CycleResult:
    """Drive one cycle, making torque as ``made`` says (ideal.production).

    The battery's state of charge stays where it is.
    """
    motor, inverter, wheels = (
        models.machine(drive, temperature_c),
        models.bridge(drive),
        drive.vehicle.driven_wheels,
    )
    asked = demand(drive, cycle)
    speed = asked.speed_rad_s
    friction = np.where(speed > 0.0, motor.friction_nm + motor.viscous_nm_s * speed, 0.0)
    braking_demand = np.maximum(-asked.torque_nm - friction, 0.0)
    electric = braking.electric_torque_nm(
        drive, strategy, braking_demand, speed, made.capability_nm(drive, motor, inverter, speed)
    )
    driving = np.maximum(asked.torque_nm + friction, 0.0)
    moving = speed > 0.0
    state = made.state(motor, inverter, speed, np.where(moving, driving - electric, 0.0))
    resistance = drive.battery.series_resistance_ohm + drive.battery.polarisation_resistance_ohm
    pack = models.battery_steady(
        models.open_circuit_voltage_v(drive, soc), resistance, wheels * state.dc_power_w
    )

    brakes = asked.torque_nm < -friction

    def part(chosen: npt.NDArray[np.bool_]) -> CycleEnergies:
        weight = asked.seconds * chosen

        def total(power_w: Array) -> float:
            return float(np.sum(power_w * weight))

        return CycleEnergies(
            traction=total(np.maximum(pack.chemical_power_w, 0.0)),
            braking_at_wheels=total(wheels * braking_demand * speed),
            battery_returned=total(np.maximum(-pack.chemical_power_w, 0.0)),
            hydraulic=total(wheels * (braking_demand - electric) * speed),
            copper=total(wheels * state.loss_copper_w),
            iron=total(wheels * state.loss_iron_w),
            inverter=total(wheels * state.loss_inverter_w),
            battery=total(pack.loss_w),
            friction=total(wheels * friction * speed),
            drag=total(asked.drag_w),
            climbed=total(asked.climbing_w),
        )

    energies = part(np.ones_like(brakes))
    kinetic = (
        0.5 * drive.vehicle.mass_kg * float(cycle.speed_m_s[-1] ** 2 - cycle.speed_m_s[0] ** 2)
    )
    residual = (
        energies.traction
        - energies.battery_returned
        - sum(energies.losses.values())
        - energies.drag
        - energies.climbed
        - kinetic
    )
    return CycleResult(
        cycle=cycle.name,
        strategy=strategy,
        winding_temperature_c=temperature_c,
        energy_j=energies,
        while_driving_j=part(~brakes),
        while_braking_j=part(brakes),
        braking_share_stored=(
            energies.battery_returned / energies.braking_at_wheels
            if energies.braking_at_wheels > 0.0
            else 0.0
        ),
        residual_relative=residual / max(energies.traction, 1e-9),
    )
