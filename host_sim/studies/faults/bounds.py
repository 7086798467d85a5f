# SPDX-License-Identifier: Apache-2.0
"""Which harmful runs of the fault sweep lack their name because no measurement contains the fault.

Only what ``faults.csv`` and the drives' files hold is used. A run without a right first reason is
of the first of these kinds that fits:

no report
    A wrong hydraulic brake that does not report its torque: a slope decelerates the vehicle alike.
power
    A gain of all current sensors: once the message and the qualify time have passed (0.46 s), its
    share of the power at the motor's terminals is below what may lie between the loop's power and
    the battery's: an eighth of it for both sensors, and P_rated/64 for the bridge and other loads.
voltage
    Weak magnets: 30 % of the EMF less its tolerance of 15 % is below half of R i and of the dead
    time's voltage.
end of the stop
    Less than a tenth of the stop is left, or 0.15 s: less than the observer, the sum of currents
    or an index needs.
another name
    The measurements contain the fault, but another reason comes first.
late
    They contain it, and no reason comes.
"""

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from hubsim.scenario import faults
from hubsim.sweep import faults_sweep
from hubsim.sweep.faults_outcome import Outcome
from hubsim.sweep.faults_sweep import BACK_BRAKE_S, BRAKE_S, ROLL_BACK, Group
from regen_table.motor_section import Motor

POWER_NAMED_S, POWER_SHARE, POWER_RATED_SHARE = 0.46, 1.0 / 8.0, 1.0 / 64.0
FLUX_LOST, FLUX_TOLERANCE, VOLTAGE_SHARE = 0.3, 0.15, 0.5
LAST_S, LAST_SHARE = 0.15, 0.1
KINDS = ("no report", "power", "voltage", "end of the stop", "another name", "late")
CONTAINED = ("another name", "late")


def _group(o: Outcome) -> Group:
    return Group(o.config, o.rotor_sensor, o.situation, o.demand_nm)


def left_s(o: Outcome) -> float:
    """Return how long mass and demand alone take from the fault, or the braking, to standstill."""
    braked_s = BACK_BRAKE_S if o.situation == ROLL_BACK else BRAKE_S
    return braked_s + faults_sweep.stop_s(_group(o)) - max(o.instant_s, braked_s)


def speed_rad_s(o: Outcome, later_s: float = 0.0) -> float:
    """Return the speed of the wheel so long after the fault, or the braking, by mass and demand."""
    vehicle = faults_sweep.drive_of(o.config, o.rotor_sensor).vehicle
    inertia = vehicle.mass_kg / vehicle.driven_wheels * vehicle.wheel_radius_m**2
    return max(left_s(o) - later_s, 0.0) * o.demand_nm / inertia


def least_copper_w(motor: Motor, torque_nm: float) -> float:
    """Return the copper loss of a torque with the d-current of least loss."""
    d_a = np.linspace(0.0, -2.0 * motor.max_phase_current_a, 401)
    linkage_wb = motor.flux_linkage_wb + (motor.d_inductance_h - motor.q_inductance_h) * d_a
    q_a = torque_nm / (1.5 * motor.pole_pairs * linkage_wb)
    return float(1.5 * motor.phase_resistance_ohm * np.min(d_a**2 + q_a**2))


def _without_report(o: Outcome) -> bool:
    measured = o.fault.endswith(faults.MEASURED_SUFFIX)
    return faults.table()[o.fault].brake != "" and not measured


def _hides_in_power(o: Outcome) -> bool:
    if base(o) not in {"currents_gain_low", "currents_gain_high"}:
        return False
    motor = faults_sweep.drive_of(o.config, o.rotor_sensor).motor
    rated_w = motor.rated_torque_nm * motor.max_speed_rpm * math.pi / 30.0
    shown = 1.0 + faults.table()[o.fault].sets["fault.current_gain_error"]
    made_nm = min(o.demand_nm, motor.max_torque_nm) / shown
    power_w = made_nm * speed_rad_s(o, POWER_NAMED_S) - least_copper_w(motor, made_nm)
    return (abs(shown - 1.0) - POWER_SHARE * shown) * power_w <= POWER_RATED_SHARE * rated_w


def _hides_in_voltage(o: Outcome) -> bool:
    if o.fault != "magnets_weak":
        return False
    drive = faults_sweep.drive_of(o.config, o.rotor_sensor)
    motor, bridge = drive.motor, drive.inverter
    emf_v = motor.flux_linkage_wb * motor.pole_pairs * speed_rad_s(o)
    motor_nm = min(o.demand_nm, motor.max_torque_nm)
    current_a = motor_nm / (1.5 * motor.pole_pairs * motor.flux_linkage_wb)
    dead_v = bridge.dead_time_s * bridge.pwm_frequency_hz * drive.battery.max_voltage_v
    beside_v = VOLTAGE_SHARE * (motor.phase_resistance_ohm * current_a + dead_v)
    return (FLUX_LOST - FLUX_TOLERANCE) * emf_v <= beside_v


def base(o: Outcome) -> str:
    """Return the fault of a run, or that of which it is a mirror image."""
    return faults.table()[o.fault].image_of


def kind(o: Outcome) -> str:
    """Return why a harmful run has no right first reason."""
    if _without_report(o):
        return "no report"
    if _hides_in_power(o):
        return "power"
    if _hides_in_voltage(o):
        return "voltage"
    whole_s = faults_sweep.stop_s(_group(o))
    if left_s(o) <= max(LAST_S, LAST_SHARE * whole_s * (1.0 + 1e-3)):
        return "end of the stop"
    return "another name" if o.first_reason else "late"


def table(outcomes: Sequence[Outcome]) -> str:
    """Return a line for each group: its runs without a right first reason by kind."""
    known = faults.table()
    harmful = [o for o in outcomes if not o.harmless]
    found = {o.key: kind(o) for o in harmful if "reason" in o.misses()}
    lines = [
        f"| group | harmful | unnamed | {' | '.join(KINDS)} | largest share |",
        "|" + " --- |" * (len(KINDS) + 4),
    ]
    groups = dict.fromkeys(fault.group for fault in known.values())
    for group in (*groups, "all"):
        here = [o for o in harmful if group in ("all", known[o.fault].group)]
        kinds = Counter(found[o.key] for o in here if o.key in found)
        hidden = sum(number for name, number in kinds.items() if name not in CONTAINED)
        share = 100.0 * (1.0 - hidden / len(here)) if here else math.nan
        cells = [group, len(here), kinds.total(), *(kinds[name] for name in KINDS)]
        if kinds.total() or group == "all":
            lines.append(f"| {' | '.join(str(cell) for cell in cells)} | {share:.1f} % |")
    closed = sum(why in ("power", "no report") for why in found.values())
    hidden = sum(why not in CONTAINED for why in found.values()) - closed
    lines += [
        "",
        "With pressure or torque of the brake reported and a current sensor in the supply the "
        f"largest share\nis {100.0 * (1.0 - hidden / len(harmful)):.1f} %.",
    ]
    return "\n".join(lines) + "\n"
