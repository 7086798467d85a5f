# SPDX-License-Identifier: Apache-2.0
"""What runs at the edges of braking must show, kind by kind (``runs``).

Expected torques and times come from the drive's file and from models in double precision
(``least_torque``, ``regen_table``); nothing of the firmware.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
import numpy.typing as npt
from hubsim.engine import Rows
from regen_table import braking, models, stop_limits
from regen_table.schema import Drive
from studies import least_torque
from studies.edges import runs
from studies.edges.runs import (
    ANTI_LOCK,
    BOOT,
    EVENT_S,
    FIRST_S,
    LIFT_OFF,
    LOST_BOTH,
    LOST_BRAKE,
    LOST_DRIVE,
    LOW_BUS,
    LOW_BUS_STOP,
    MOST_BRAKE,
    MOST_DRIVE,
    ONSET,
    OVER_DRIVE,
    RECORD_S,
    Case,
)  # fmt: skip

AT_ONCE_S = 0.02  # anti-lock flag, brake over accelerator, driving demand lost
TOLERANCE_SHARE = 0.02  # of the rated torque or of the expected one, the larger
UNASKED_NM, UNASKED_SHARE = 2.0, 0.05  # the larger; share of the rated torque
FULL_SHARE = 0.95  # of the demand is there
EXCESS_NM, EXCESS_SHARE, EXCESS_AFTER_S = 5.0, 0.1, 0.1  # more than the demand, the larger
LATE_S = 0.02  # beyond the torque rate: a bridge that closes, means over MEAN_ROWS
LAGS, MARGIN_S = 2.5, 0.05  # what a hydraulic brake takes, beside its dead time
CURRENT_SHARE = 1.05  # of the phase current's limit: noise and a late edge
STOPS_LATE_S, STOPS_LATE_SHARE = 0.5, 0.05  # share of the time that the stop takes
BACK_M = 0.001
MEAN_ROWS = 5
LEFT_S = 0.1  # an anti-lock flag is judged for so long: the speed stays
RUNS_WITHIN_S = 0.3
RUN = 4
POINTS = 400
(TIME, AIRGAP, HYDRAULIC, SPEED, I_D, I_Q, BUS, MODE, BRIDGE, REASON, WARNING, FAULT, POLARISATION,
 WINDING, CHARGE, DISTANCE) = range(16)  # fmt: skip


@dataclass(frozen=True)
class Finding:
    """What a kind's judge found: torques in N m, times in s after the event."""

    expected_nm: float = 0.0
    torque_nm: float = 0.0
    off_nm: float = 0.0
    off_limit_nm: float = 0.0
    late_s: float = 0.0
    late_limit_s: float = 0.0
    full_s: float = 0.0
    full_limit_s: float = math.inf


def shaft_nm(drive: Drive, rows: Rows) -> Rows:
    """Return the motor's torque at the wheel: airgap torque less the friction of the bearings."""
    speed = rows[:, SPEED]
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * np.abs(speed)
    return np.asarray(rows[:, AIRGAP] - friction * np.sign(speed))


def drag_nm(drive: Drive, rows: Rows) -> Rows:
    """Return what an open bridge brakes with: iron and bearings."""
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * rows[:, SPEED]
    return least_torque.iron_drag_nm(drive, rows[:, SPEED]) + np.abs(friction)


def tolerance_nm(drive: Drive, torque_nm: float) -> float:
    """Return by how much a torque may miss; with an encoder what half a count makes of all i_d."""
    share = TOLERANCE_SHARE * max(drive.motor.rated_torque_nm, torque_nm)
    counts = drive.rotor.encoder_counts if drive.rotor.sensor == "encoder" else None
    if counts is None:
        return share
    motor = drive.motor
    peak = 1.5 * motor.pole_pairs * motor.flux_linkage_wb * motor.max_phase_current_a
    return max(share, peak * math.pi * motor.pole_pairs / counts)


def mean(torque_nm: Rows) -> Rows:
    """Return means over MEAN_ROWS."""
    return np.convolve(torque_nm, np.ones(MEAN_ROWS) / MEAN_ROWS, "same")


def last_s(time_s: Rows, wrong: npt.NDArray[np.bool_], since_s: float) -> float:
    """Return how long after ``since_s`` something is wrong for the last time, 0 never."""
    when = time_s[(time_s >= since_s) & wrong]
    return float(when[-1] - since_s + RECORD_S) if len(when) else 0.0


def anti_lock(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that the motor has what is left to it, at most what it had, at once."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    before = -float(motor[(time > EVENT_S - 0.02) & (time < EVENT_S)].mean())
    expected = max(min(case.motor_share * case.brake_nm, before), 0.0)
    tolerance = tolerance_nm(drive, before)
    least = np.maximum(case.motor_share * case.brake_nm, drag_nm(drive, rows))
    off = np.maximum(motor, -motor - least)
    off = np.maximum(off, motor + expected if expected > 0.0 else 0.0)
    judged = (time >= EVENT_S) & (time < EVENT_S + LEFT_S)
    after = judged & (time >= EVENT_S + AT_ONCE_S)
    return Finding(
        expected_nm=-expected,
        torque_nm=float(motor[after].mean()),
        off_nm=float(np.max(off[after])),
        off_limit_nm=tolerance,
        late_s=last_s(time, judged & (off > tolerance), EVENT_S),
        late_limit_s=AT_ONCE_S,
    )


def comes(drive: Drive, case: Case, rows: Rows, since_s: float) -> Finding:
    """Judge that both brakes make the demand as fast as they may, and no more."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    demand, rate = case.brake_nm, drive.control.torque_rate_nm_per_s
    smooth = mean(rows[:, HYDRAULIC] - motor)
    whole = time < time[-1] - MEAN_ROWS * RECORD_S
    end = whole & (time > time[-1] - 0.1)
    alone = float(rows[since_s < time, HYDRAULIC].max()) < tolerance_nm(drive, demand)
    enough = demand - max((1.0 - FULL_SHARE) * demand, tolerance_nm(drive, demand))
    if np.any(rows[since_s < time, BRIDGE] == 0.0):  # diodes braked, and then no more
        enough = -math.inf
    rolls = whole & (rows[:, SPEED] > drive.control.handover_end_rpm * math.pi / 30.0)
    full = last_s(time, rolls & (smooth < enough), since_s)
    limit = demand / rate + LATE_S
    if not alone:
        brake = drive.brake
        limit += brake.hydraulic_dead_time_s + LAGS * brake.hydraulic_time_constant_s + MARGIN_S
    later = whole & (time > since_s + EXCESS_AFTER_S)
    return Finding(
        expected_nm=-demand,
        torque_nm=float(motor[end].mean()),
        off_nm=float(np.max(smooth[later])) - demand,
        off_limit_nm=max(EXCESS_NM, EXCESS_SHARE * demand),
        full_s=full,
        full_limit_s=limit,
    )


def over_drive(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that the drive is gone at once and the brake comes at the rate from there on."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    found = comes(drive, case, rows, EVENT_S)
    late = last_s(time, motor > tolerance_nm(drive, 0.0), EVENT_S)
    limit = found.full_limit_s + AT_ONCE_S
    return _with(found, late_s=late, late_limit_s=AT_ONCE_S, full_limit_s=limit)


def onset(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge a brake that is pressed on a coasting vehicle."""
    return comes(drive, case, rows, EVENT_S)


def lost_drive(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that driving ends at once after the timeout and nothing brakes instead."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    since = EVENT_S + drive.control.demand_timeout_s
    after = rows[time > since + AT_ONCE_S]
    excess, least = unasked_nm(drive, case, after, np.zeros(len(after)))
    return Finding(
        expected_nm=-least,
        torque_nm=float(motor[-1]),
        off_nm=excess,
        off_limit_nm=unasked_limit_nm(drive),
        late_s=last_s(time, mean(motor) > tolerance_nm(drive, 0.0), since),
        late_limit_s=AT_ONCE_S,
    )


def lost_brake(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that the sum stays, kept and then by the brake system, and the motor leaves."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    total = mean(rows[:, HYDRAULIC] - motor)
    counted = (time > EVENT_S - 0.1) & (time < time[-1] - MEAN_ROWS * RECORD_S)
    since = EVENT_S + drive.control.demand_timeout_s + drive.driver.lost_demand_hold_s
    brake = drive.brake
    beyond = mean(np.maximum(motor, -motor - drag_nm(drive, rows)))
    return Finding(
        expected_nm=-case.brake_nm,
        torque_nm=float(motor[-1]),
        off_nm=float(np.max(np.abs(total - case.brake_nm)[counted])),
        off_limit_nm=max(EXCESS_SHARE * case.brake_nm, tolerance_nm(drive, 0.0)),
        late_s=last_s(time, beyond > tolerance_nm(drive, case.brake_nm), since),
        late_limit_s=brake.hydraulic_dead_time_s + 5.0 * brake.hydraulic_time_constant_s + MARGIN_S,
    )


def lost_both(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge a lost brake, and that a masked driving demand never becomes torque."""
    found = lost_brake(drive, case, rows)
    motor = shaft_nm(drive, rows)
    drove = float(np.max(mean(motor)[rows[:, TIME] > FIRST_S + AT_ONCE_S]))
    off = max(found.off_nm, drove * found.off_limit_nm / tolerance_nm(drive, 0.0))
    return _with(found, off_nm=off)


def unasked_nm(drive: Drive, case: Case, rows: Rows, wanted_nm: Rows) -> tuple[float, float]:
    """Return the largest torque beyond the wanted or the least possible one, and that one.

    Means over MEAN_ROWS, beyond iron and bearings (``least_torque``).
    """
    torque = np.abs(rows[:, AIRGAP])
    whole = len(rows) // MEAN_ROWS * MEAN_ROWS
    means, at = (v[:whole].reshape(-1, MEAN_ROWS, *v.shape[1:]).mean(axis=1)
                 for v in (torque, rows))  # fmt: skip
    wanted = wanted_nm[:whole].reshape(-1, MEAN_ROWS).max(axis=1)
    beyond = means - wanted - drag_nm(drive, at)
    worst = (-math.inf, 0.0)
    for k in np.argsort(-beyond):
        if beyond[k] <= worst[0]:
            break
        row = at[k]
        least = least_torque.least(drive, state_of(case, row)).torque_nm
        excess = float(beyond[k]) - max(least - float(wanted[k]), 0.0)
        if excess > worst[0]:
            worst = (excess, least)
    return worst


def state_of(case: Case, row: Rows) -> least_torque.State:
    """Return speed, battery and winding of a row as the model of letting go has them."""
    return least_torque.State(
        speed_rad_s=abs(row[SPEED]),
        source_v=case.open_circuit_v - row[POLARISATION],
        bus_v=row[BUS],
        winding_c=row[WINDING],
        charge_a=row[CHARGE],
        connected=True,
    )


def current_limit_share(drive: Drive, case: Case, rows: Rows) -> float:
    """Return the accepted phase current of its limit: that of diodes where PWM has none."""
    row = rows[int(np.argmax(np.abs(rows[:, SPEED])))]
    at = state_of(case, row)
    if not row[BUS] or least_torque.pwm_nm(drive, at) is not None:
        return CURRENT_SHARE
    diodes = least_torque.freewheel(drive, at)[1] / drive.motor.max_phase_current_a
    return CURRENT_SHARE * max(diodes, 1.0)


def unasked_limit_nm(drive: Drive) -> float:
    """Return how much unasked torque is accepted."""
    return max(UNASKED_NM, UNASKED_SHARE * drive.motor.rated_torque_nm)


def low_bus(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that there is no more torque than demanded or unavoidable, and no less."""
    wanted = np.where(rows[:, TIME] >= FIRST_S, case.brake_nm, 0.0)
    excess, least = unasked_nm(drive, case, rows, wanted)
    found = comes(drive, case, rows, FIRST_S)
    return _with(found, expected_nm=-least, off_nm=excess, off_limit_nm=unasked_limit_nm(drive))


def boot(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge a start on a rolling wheel: no torque but the diodes', then the brake works."""
    wanted = np.where(rows[:, TIME] >= EVENT_S, case.brake_nm, 0.0)
    starting = np.flatnonzero(rows[:, MODE] < RUN)
    began = int(starting[-1]) + 1 if len(starting) else 0
    after = slice(began + MEAN_ROWS, None)  # the diodes' current has ended
    excess, least = unasked_nm(drive, case, rows[after], wanted[after])
    found = comes(drive, case, rows, EVENT_S)
    return _with(
        found, expected_nm=-least, off_nm=excess, off_limit_nm=unasked_limit_nm(drive),
        late_s=float(rows[min(began, len(rows) - 1), TIME]), late_limit_s=RUNS_WITHIN_S,
    )  # fmt: skip


def lift_off(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge that it stands in the end, never rolls back and is never driven."""
    time, motor = rows[:, TIME], shaft_nm(drive, rows)
    slows = (case.drive_nm + runs.pull_nm(drive, case.slope_percent)) / runs.inertia(drive)
    begins = case.speed_share * runs.top_rad_s(drive) * drive.vehicle.wheel_radius_m
    stands = np.flatnonzero(rows[:, SPEED] <= 0.0)
    first = int(stands[0]) if len(stands) else len(rows) - 1
    moved = float(np.ptp(rows[first:, DISTANCE]))
    drove = float(np.max(motor[(time > FIRST_S + AT_ONCE_S) & (np.arange(len(rows)) < first)]))
    return Finding(
        expected_nm=-case.drive_nm,
        torque_nm=float(motor[time < time[first]].min()),
        off_nm=drove if moved <= BACK_M else math.inf,
        off_limit_nm=tolerance_nm(drive, 0.0),
        late_s=float(time[first]) - FIRST_S - begins / slows if len(stands) else math.inf,
        late_limit_s=STOPS_LATE_S + STOPS_LATE_SHARE * begins / slows,
    )


def most(drive: Drive, case: Case, rows: Rows) -> Finding:
    """Judge the largest torque: that of currents inside circle and ellipse."""
    sign = -1.0 if case.kind == MOST_BRAKE else 1.0
    steady = rows[rows[:, TIME] > EVENT_S]
    made = float(sign * shaft_nm(drive, steady).mean())
    expected = largest_nm(drive, steady.mean(axis=0), sign)
    return Finding(
        expected_nm=sign * expected,
        torque_nm=sign * made,
        off_nm=abs(expected - made),
        off_limit_nm=TOLERANCE_SHARE * drive.motor.max_torque_nm,
    )


def largest_nm(drive: Drive, row: Rows, sign: float) -> float:
    """Return the largest torque at the wheel inside the limits at this speed and bus voltage.

    A search over all currents; nothing of the firmware.
    """
    machine = models.machine(drive, float(row[WINDING]))
    speed = float(row[SPEED])
    omega = np.array(machine.pole_pairs * speed)
    voltage = float(stop_limits.largest_voltage_v(drive, omega, row[BUS]))
    amperes = drive.motor.max_phase_current_a * np.linspace(0.0, 1.0, POINTS)[:, np.newaxis]
    angle = np.linspace(0.5 * math.pi, math.pi, POINTS)
    state = models.evaluate(
        machine, models.bridge(drive), omega, amperes * np.cos(angle),
        sign * amperes * np.sin(angle),
    )  # fmt: skip
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * speed
    possible = state.voltage_v <= voltage
    wheels, pack = drive.vehicle.driven_wheels, drive.battery
    each_w = float(row[BUS]) / wheels
    possible &= state.dc_power_w <= pack.max_discharge_current_a * each_w
    possible &= state.dc_power_w >= -pack.max_charge_current_a * each_w
    electric = np.max(sign * state.torque_nm, where=possible, initial=0.0)
    limit = float(braking.torque_limit_nm(drive, np.array(speed)))
    return min(float(electric) - sign * friction, limit)


JUDGES: dict[str, Callable[[Drive, Case, Rows], Finding]] = {
    ANTI_LOCK: anti_lock,
    OVER_DRIVE: over_drive,
    ONSET: onset,
    LOW_BUS: low_bus,
    LOW_BUS_STOP: low_bus,
    LOST_DRIVE: lost_drive,
    LOST_BRAKE: lost_brake,
    LOST_BOTH: lost_both,
    BOOT: boot,
    LIFT_OFF: lift_off,
    MOST_BRAKE: most,
    MOST_DRIVE: most,
}


def _with(found: Finding, **changes: float) -> Finding:
    return Finding(**(asdict(found) | changes))
