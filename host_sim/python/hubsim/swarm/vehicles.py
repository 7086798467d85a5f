# SPDX-License-Identifier: Apache-2.0
"""Healthy vehicles and what their drivers do, drawn around the drive that a controller is told.

A vehicle is its drive's file with every part wrong within its tolerance; the controller knows the
file only. Used by the study of healthy rides and by ``hubsim swarm``.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from regen_table import models
from regen_table.schema import Drive

from hubsim.run import plant
from hubsim.run.plant import STANDARD_AIR_KG_PER_M3, STANDARD_GRAVITY_M_PER_S2

PREPARED, STANDING, ROLLING = "prepared", "standing", "rolling"
"""How a ride begins: controllers that run already, that boot at rest, or on turning wheels."""
HOLD, DRIVE, COAST, BRAKE, REVERSE = "hold", "drive", "coast", "brake", "reverse"

# Parts beside their values in the drive's file: least and largest factor.
FACTORS: Mapping[str, tuple[float, float]] = {
    "motor.phase_resistance_ohm": (0.92, 1.08),
    # With the saturation below within a quarter, which is the error that the checks state.
    "motor.d_inductance_h": (0.9, 1.1),
    "motor.q_inductance_h": (0.9, 1.1),
    "motor.flux_linkage_wb": (0.96, 1.04),  # remanence, air gap
    "motor.iron_loss_resistance_ohm": (0.7, 1.3),
    "motor.iron_loss_resistance_slope_ohm_s": (0.7, 1.3),
    "motor.friction_torque_nm": (0.5, 2.0),
    "inverter.switch_resistance_ohm": (0.8, 1.3),
    "inverter.diode_forward_voltage_v": (0.85, 1.15),
    "inverter.diode_resistance_ohm": (0.7, 1.3),
    "inverter.dead_time_s": (0.85, 1.15),
    "inverter.turn_on_loss_j_per_a": (0.7, 1.4),
    "inverter.turn_off_loss_j_per_a": (0.7, 1.4),
    "battery.capacity_ah": (0.7, 1.05),  # age
    "battery.polarisation_capacitance_f": (0.7, 1.3),
    "vehicle.mass_kg": (0.8, 1.35),  # driver alone, or with load
    "vehicle.wheel_radius_m": (0.96, 1.03),  # wear, pressure
    "vehicle.frontal_area_m2": (0.8, 1.25),
    "vehicle.rolling_resistance": (0.7, 1.6),
    "brake.hydraulic_dead_time_s": (0.75, 1.3),
    "brake.hydraulic_time_constant_s": (0.75, 1.3),
    "thermal.winding_heat_capacity_j_per_k": (0.8, 1.25),
    "thermal.winding_thermal_resistance_k_per_w": (0.7, 1.4),
    "thermal.housing_heat_capacity_j_per_k": (0.8, 1.25),
    "thermal.housing_thermal_resistance_k_per_w": (0.7, 1.4),
    "thermal.switch_heat_capacity_j_per_k": (0.8, 1.25),
    "thermal.switch_thermal_resistance_k_per_w": (0.7, 1.4),
    "thermal.heatsink_heat_capacity_j_per_k": (0.8, 1.25),
    "thermal.heatsink_thermal_resistance_k_per_w": (0.7, 1.4),
}
AMBIENT_C = (-20.0, 40.0)
AGED = (0.8, 1.5)  # resistance of cells at 25 degC
COLD_PER_K = 1.5 / 45.0  # and its growth below
CELLS_REST = (
    0.3,
    0.8,
)  # of the pack's range, where the file has one voltage for all charges
STEEPEST = 0.12
PULL_SHARE = 0.4  # of the rated torque, that a slope takes at most
WIND_M_PER_S = 8.0  # at most, from either side
BRAKE_LOSS = 0.1  # of a hydraulic brake's torque, at most; as much more at most
HARDEST_M_PER_S2 = 8.0  # dry road
RIDE_S = 45.0
CRAWL_M_PER_S = 2.0


@dataclass(frozen=True)
class Phase:
    """One thing that the driver does.

    Attributes
    ----------
    kind : str
        HOLD: brakes and stands; DRIVE: to a speed, and keeps it; COAST: no pedal, or lift-off
        braking; BRAKE: until it stands, or for a time; REVERSE: as DRIVE, backwards.
    seconds : float
        For how long at most.
    speed_share : float
        Of the largest speed: where DRIVE and REVERSE go.
    torque_nm : float
        At the wheel: most of the accelerator, or the brake demand; lift-off braking of COAST.
    slope : float
        Of the road, rise over run, reached within a second.
    """

    kind: str
    seconds: float
    speed_share: float = 0.0
    torque_nm: float = 0.0
    slope: float = 0.0


class Lot:
    """Random numbers of one ride."""

    def __init__(self, seed: int, number: int) -> None:
        self._source = np.random.default_rng([seed, number])

    def within(self, low: float, high: float) -> float:
        """Return a number between, six digits of it."""
        return float(f"{self._source.uniform(low, high):.6g}")

    def chance(self, share: float) -> bool:
        """Return true so often."""
        return bool(self._source.random() < share)

    def one_of(self, *values: float) -> float:
        """Return one of these."""
        return float(self._source.choice(values))

    def whole(self, below: int) -> int:
        """Return a whole number from 0, below this one."""
        return int(self._source.integers(below))


def top_m_per_s(drive: Drive) -> float:
    """Return the largest speed of the configuration."""
    return drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m


def parts_of(lot: Lot, drive: Drive, ambient_c: float) -> dict[str, float]:
    """Return the parameters of a healthy world around a drive, each within its tolerance."""
    return {
        **_parts(lot, drive),
        **_battery(lot, drive, ambient_c),
        **_sensors(lot, drive),
        **_brake(lot, drive),
        "road.wind_m_per_s": lot.within(-WIND_M_PER_S, WIND_M_PER_S),
        "thermal.active": 1.0,
    }


def hold_torque_nm(rated_nm: float, radius_m: float, air_m2: float) -> float:
    """Return the hold torque at each wheel that no road and no wind drawn here overcomes.

    Parameters
    ----------
    air_m2 : float
        A driven wheel's share of frontal area times drag coefficient.
    """
    largest_m2 = air_m2 * FACTORS["vehicle.frontal_area_m2"][1]
    wind_n = 0.5 * STANDARD_AIR_KG_PER_M3 * largest_m2 * WIND_M_PER_S**2
    wind_nm = wind_n * radius_m * FACTORS["vehicle.wheel_radius_m"][1]
    return (PULL_SHARE * rated_nm + wind_nm) / (1.0 - BRAKE_LOSS)


@dataclass(frozen=True)
class Cells:
    """Charge (0 to 1) where a ride begins, and the pack's voltage at rest, which it decides."""

    soc: float
    rest_v: float


def cells(lot: Lot, drive: Drive) -> Cells:
    """Return a charge; both ends come more often than others."""
    low_v, high_v = drive.battery.min_voltage_v, drive.battery.max_voltage_v
    soc = min(max(lot.within(-0.08, 1.08), 0.0), 1.0)
    filled = CELLS_REST[0] + (CELLS_REST[1] - CELLS_REST[0]) * soc
    flat = isinstance(drive.battery.open_circuit_voltage_v, float | int)
    return Cells(
        soc,
        low_v + (high_v - low_v) * filled if flat else models.open_circuit_voltage_v(drive, soc),
    )


def begins(lot: Lot, sensor: str) -> str:
    """Return how a ride begins: not at rest with an encoder, which needs its index first."""
    kinds = (PREPARED, ROLLING) if sensor == "encoder" else (PREPARED, ROLLING, STANDING)
    return kinds[lot.whole(len(kinds))]


def _parts(lot: Lot, drive: Drive) -> dict[str, float]:
    nominal = plant.parameters(drive)
    found = {name: nominal[name] * lot.within(*factor) for name, factor in FACTORS.items()}
    motor = drive.motor
    coefficient = nominal["motor.flux_temperature_coefficient_per_k"]
    found["motor.flux_temperature_coefficient_per_k"] = coefficient + lot.within(-2e-4, 2e-4)
    found["motor.friction_torque_nm"] += lot.within(0.0, 0.01) * motor.rated_torque_nm
    if lot.chance(0.4):
        found["motor.q_saturation_current_a"] = lot.within(6.0, 12.0) * motor.max_phase_current_a
    if lot.chance(0.4):
        found["motor.cogging_torque_nm"] = lot.within(0.0, 0.02) * motor.max_torque_nm
        found["motor.cogging_per_turn"] = 6.0 * motor.pole_pairs
    if lot.chance(0.5):
        capacitance_f = drive.vehicle.driven_wheels * drive.inverter.bus_capacitance_f
        found["bus.capacitance_f"] = lot.within(0.8, 1.1) * capacitance_f
        found["bus.cable_resistance_ohm"] = (
            lot.within(0.0, 0.3) * drive.battery.series_resistance_ohm
        )
    return found


def _battery(lot: Lot, drive: Drive, ambient_c: float) -> dict[str, float]:
    """Return cells, and what the battery management sends.

    It lowers its limits as the cold raises the cells' resistance. Each of voltage, current and
    contactor may be absent from its message.
    """
    pack, each = drive.battery, 1.0 / drive.vehicle.driven_wheels
    aged = lot.within(*AGED)
    cold = 1.0 + COLD_PER_K * max(25.0 - ambient_c, 0.0)
    keeps = lot.chance(0.5)
    return {
        "battery.series_resistance_ohm": pack.series_resistance_ohm * aged * cold,
        "battery.polarisation_resistance_ohm": pack.polarisation_resistance_ohm * aged * cold,
        "battery.max_charge_current_a": pack.max_charge_current_a / cold,
        "battery.max_discharge_current_a": pack.max_discharge_current_a / cold,
        "bms.max_voltage_v": pack.max_voltage_v if keeps else 0.0,
        "bms.min_voltage_v": pack.min_voltage_v if keeps else 0.0,
        "bms.temperature_c": ambient_c,
        "bms.period_s": lot.one_of(0.01, 0.02, 0.05, 0.1),
        "bms.contactor_silent": float(lot.chance(0.2)),
        "bms.voltage_silent": float(lot.chance(0.2)),
        "bms.current_silent": float(lot.chance(0.2)),
        "bms.current_filter_s": lot.within(0.0, 2.0),
        "bms.current_error": lot.within(-0.05, 0.05),
        "bms.current_offset_a": lot.within(-0.005, 0.005) * each * pack.max_discharge_current_a,
        "bms.current_noise_a": lot.within(0.0, 0.005) * each * pack.max_discharge_current_a,
    }


def _sensors(lot: Lot, drive: Drive) -> dict[str, float]:
    """Return converters, current and bus sensors, rotor sensor, thermistors."""
    inverter, nominal = drive.inverter, plant.parameters(drive)
    full_a = inverter.current_full_scale_a
    found = {
        "sensors.current_noise_a": lot.within(0.0, 0.0025) * full_a,
        "sensors.current_offset_a": lot.within(-0.01, 0.01) * full_a,
        "sensors.current_drift_a_per_s": lot.within(-0.002, 0.002) * full_a / RIDE_S,
        "sensors.bus_voltage_noise_v": lot.within(0.0, 0.002) * inverter.voltage_full_scale_v,
        "sensors.bus_gain_error": lot.within(-0.01, 0.01),
        "sensors.sampling_delay_s": lot.one_of(0.0, 0.5) * inverter.dead_time_s,
        "sensors.angle_offset_deg": lot.within(-2.0, 2.0),
        "sensors.angle_error_deg": lot.within(0.0, 2.0),
        "winding_sensor.lag_s": lot.within(0.0, 300.0),
        "winding_sensor.offset_k": lot.within(-3.0, 3.0),
        "winding_sensor.gain_error": lot.within(-0.02, 0.02),
        "switch_sensor.lag_s": lot.within(0.0, 10.0),
        "switch_sensor.offset_k": lot.within(-3.0, 3.0),
        "switch_sensor.gain_error": lot.within(-0.02, 0.02),
        "encoder.index_deg": (nominal["encoder.index_deg"] + lot.within(-2.0, 2.0)) % 360.0,
    }
    for phase in "abc":
        found[f"sensors.current_{phase}_gain_error"] = lot.within(-0.015, 0.015)
    for k in range(6):
        name = f"sensors.hall_edge_{k}_deg"
        found[name] = (nominal[name] + lot.within(-4.0, 4.0)) % 360.0
    return found


def _brake(lot: Lot, drive: Drive) -> dict[str, float]:
    """Return hydraulic brake with its sensor, and the bus of the messages."""
    most_nm = drive.brake.max_hydraulic_torque_nm
    return {
        "brake.torque_loss": lot.within(-BRAKE_LOSS, BRAKE_LOSS),
        "brake_sensor.fitted": float(lot.chance(0.5)),
        "brake_sensor.period_s": lot.one_of(0.01, 0.02, 0.04),
        "brake_sensor.delay_s": lot.one_of(0.005, 0.01, 0.015),
        "brake_sensor.gain_error": lot.within(-0.03, 0.03),
        "brake_sensor.offset_nm": lot.within(-0.003, 0.003) * most_nm,
        "brake_sensor.noise_nm": lot.within(0.0, 0.003) * most_nm,
        "driver.demand_period_s": lot.one_of(0.0, 0.005, 0.01, 0.02),
        "driver.demand_jitter_s": lot.within(0.0, 0.01),
        "fault.can_delay_s": lot.one_of(0.0, 0.0, 0.001, 0.003, 0.005),
    }


def phases_of(lot: Lot, drive: Drive, world: Mapping[str, float], rolls: bool) -> tuple[Phase, ...]:
    """Return what the driver does for RIDE_S, a stop at the end; reverse from a stop only.

    ``rolls``: the ride begins on turning wheels.
    """
    inertia = world["vehicle.mass_kg"] / drive.vehicle.driven_wheels
    inertia *= world["vehicle.wheel_radius_m"]
    pull = inertia * STANDARD_GRAVITY_M_PER_S2
    steepest = min(PULL_SHARE * drive.motor.rated_torque_nm / pull, STEEPEST)
    motor, brake = drive.motor, drive.brake
    hardest = min(HARDEST_M_PER_S2 * inertia, motor.max_torque_nm + brake.max_hydraulic_torque_nm)
    out: list[Phase] = []
    stands = not rolls
    slope = 0.0
    if stands:
        out.append(Phase(HOLD, lot.within(0.8, 2.0), torque_nm=0.2 * hardest))
    while sum(phase.seconds for phase in out) < RIDE_S:
        if lot.chance(0.5):
            slope = lot.within(-steepest, steepest)
        climbs_nm = max(slope * pull, 0.0)
        accelerator_nm = climbs_nm + lot.within(0.15, 1.0) * (motor.max_torque_nm - climbs_nm)
        if stands and lot.chance(0.15):
            out.append(Phase(REVERSE, lot.within(2.0, 6.0), 0.15, 0.5 * accelerator_nm, slope))
            out.append(Phase(BRAKE, 5.0, 0.0, 0.3 * hardest, slope))
            continue
        if stands and lot.chance(0.15):
            out.append(Phase(COAST, lot.within(0.5, 3.0), slope=slope))  # rolls
        share = lot.within(0.1, 0.95)
        gains_s = share * top_m_per_s(drive) * inertia / accelerator_nm
        lasts_s = min(lot.within(0.5, 1.5) * gains_s, 20.0) + lot.within(0.0, 8.0)
        out.append(Phase(DRIVE, lasts_s, share, accelerator_nm, slope))
        if lot.chance(0.5):
            lift_off_nm = lot.within(0.0, 0.3) * motor.rated_torque_nm if lot.chance(0.4) else 0.0
            out.append(Phase(COAST, lot.within(1.0, 6.0), 0.0, lift_off_nm, slope))
        stands = lot.chance(0.6)
        hard = lot.chance(0.3)
        brake_nm = lot.within(0.4, 1.0) * hardest if hard else lot.within(0.02, 0.3) * hardest
        out.append(Phase(BRAKE, 20.0 if stands else lot.within(0.5, 2.0), 0.0, brake_nm, slope))
        if stands:
            out.append(Phase(HOLD, lot.within(0.5, 2.5), 0.0, 0.2 * hardest, slope))
    out.append(Phase(BRAKE, 20.0, 0.0, 0.3 * hardest, slope))
    return tuple(out)
