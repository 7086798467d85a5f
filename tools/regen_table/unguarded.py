# SPDX-License-Identifier: Apache-2.0
"""What braking could return if nothing but physics bounded it.

At every instant the motor makes the torque of least DC power between zero and what is demanded,
both currents free inside the phase current and the voltage that the bus gives; the hydraulic brake
makes the rest at once. A demand D adds to the torque C of coasting, at zero current: both brakes
make max(D, C + D/2). A bridge whose EMF is as high as the bus cannot coast: there C = 0. No
derating, fold-back, charge limit, torque rate or blend-out, no table and no delay. For a given
speed trace the least power at every instant stores most (packs).
"""

from dataclasses import dataclass

import numpy as np

from regen_table import joint, models
from regen_table.models import Array
from regen_table.schema import Drive

OPENS_SHARE = 15.0 / 16.0
"""Of the phase voltage, an EMF up to which the firmware opens the bridge (bridge_choice.c)."""


@dataclass(frozen=True)
class Instants:
    """Instants of braking with as many seconds each; arrays of shape (instants,).

    ``demand_nm`` is the braking torque at one wheel, magnitude, bearings' friction included.
    ``branch_v`` is the voltage of the battery's RC branch, positive while it discharges.
    """

    seconds: Array
    demand_nm: Array
    speed_rad_s: Array
    winding_c: Array
    bus_v: Array
    branch_v: Array
    soc: Array


def returned_j(drive: Drive, at: Instants) -> float:
    """Return the energy that the cells take in, J, all wheels together."""
    if len(at.seconds) == 0:
        return 0.0
    motor, inverter = models.machine(drive, at.winding_c), models.bridge(drive)
    friction = motor.friction_nm + motor.viscous_nm_s * np.abs(at.speed_rad_s)
    open_bridge = models.evaluate(motor, inverter, at.speed_rad_s * motor.pole_pairs, 0.0, 0.0)
    opens = open_bridge.voltage_v < OPENS_SHARE * at.bus_v / np.sqrt(3.0)
    coasting_nm = np.where(opens, friction + np.abs(open_bridge.torque_nm), 0.0)
    total_nm = np.where(
        at.demand_nm > 0.0, np.maximum(at.demand_nm, coasting_nm + 0.5 * at.demand_nm), 0.0
    )
    best = joint.best_braking(
        motor,
        inverter,
        at.speed_rad_s * motor.pole_pairs,
        joint.Limits(drive.motor.max_phase_current_a, at.bus_v / np.sqrt(3.0)),
        np.maximum(total_nm - friction, 0.0),
        joint.AUDIT,
    )
    open_circuit = np.array([models.open_circuit_voltage_v(drive, soc) for soc in at.soc])
    power = drive.vehicle.driven_wheels * best.state.dc_power_w
    # A steady state behind the branch's present voltage.
    series_ohm = drive.battery.series_resistance_ohm + drive.bus.cable_resistance_ohm
    pack = models.battery_steady(open_circuit - at.branch_v, series_ohm, power)
    return float(-np.sum(open_circuit * pack.current_a * at.seconds))
