# SPDX-License-Identifier: Apache-2.0
"""What every run must hold, whatever its faults are called: the invariants of ``hubsim swarm``.

Each invariant measures one value and its limit, of the vehicle or of a wheel. Only the simulated
world is asked, never what a controller believes; modes and reasons are read to see whether they
flicker, heal or warn, not which they are. What physics forbids is in ``forbidden.toml``
(``allowances``): kinds of fault that widen the limit of one invariant to a stated bound.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from regen_table import derived, loops

from hubsim import reasons
from hubsim.engine import Rows, mode_text
from hubsim.run.plant import STANDARD_GRAVITY_M_PER_S2
from hubsim.scenario import faults
from hubsim.swarm import motion
from hubsim.swarm.allowances import limit as allowed
from hubsim.swarm.ride import Recording

ROWS_PER_S = 1000
VEHICLE = -1  # instead of a wheel's number
MOVES_M_PER_S = 0.05
PRESSED_NM = 0.1  # a brake pedal below it is none: the resolution of the message (hubfoc.dbc)
TURNS_M_PER_S = 0.2  # nothing is acknowledged any more: ten times what counts as rest
ROLLS_M_PER_S = 0.5  # a stop begins, or coasting is looked at
WRONG_NM, WRONG_SHARE, WRONG_MS = 2.0, 0.05, 5.0
EXCESS_NM, EXCESS_SHARE, EXCESS_ROWS = 5.0, 0.1, 100
SLOPE_ROWS = 50
PARTS_SHARE = 0.1  # of its torque, that a motor within its tolerances makes too much
FEASIBLE_SHARE = 1.25  # of the computed torque: resistance by temperature, parts
CURRENT_SHARE = 1.3  # of the over-current trip
HOTTER_K, HOTTER_SHARE = 10.0, 0.2  # above the end of derating; of the rise
LONGER_SHARE, LONGER_S, LONGER_M = 0.1, 0.1, 0.3
BRAKES_SHARE = 0.95  # of the demand or of the hydraulic brake's largest torque
RESIDUAL, LEAST_J_PER_KG = 1e-4, 12.5  # of the energy turned over, at least that at 5 m/s
CHANGES = 5
LEAST_CHARGE_A, CHARGE_SHARE = 0.2, 0.05  # beyond the limit; of the pack's own
BMS_ROWS = 150  # the longest period of the battery's message, and half of it
LIMP_NAME = "LIMP"
START = ("BOOT", "SELFTEST", "OFFSET_CAL", "READY")  # modes on the way to RUN
NOT_STARTED = "not started"
FORWARD, REVERSE = 1.0, 2.0  # drive_direction_t
SETTLED_LAGS = 4.6  # time constants to a hundredth
LINKS = "links"  # the group of faults of the messages to the wheels
SLACK_S = 0.03  # steps of the controllers and of the bus


@dataclass(frozen=True)
class Finding:
    """What one invariant came to: the largest value beside its limit, and when.

    ``wheel`` VEHICLE: of the whole; ``text``: what it was, for people.
    """

    invariant: str
    wheel: int
    time_s: float
    value: float
    limit: float
    unit: str
    text: str = ""

    @property
    def violated(self) -> bool:
        """Whether the limit is passed; a value that is no number passes it."""
        return not self.value <= self.limit

    @property
    def share(self) -> float:
        """Of the limit; infinite beyond a limit of zero."""
        if self.limit > 0.0:
            return self.value / self.limit
        return math.inf if self.violated else 0.0


Check = Callable[[Recording], Iterator[Finding]]


def judged(recording: Recording) -> list[Finding]:
    """Return what every invariant came to, allowances included."""
    healthy = not recording.faults
    checks = {**INVARIANTS, **OPEN, **(HEALTHY if healthy else {})}
    return [
        replace(
            each,
            invariant=name,
            limit=allowed(name, recording.faults, recording.drive, each.limit),
        )
        for name, check in checks.items()
        for each in check(recording)
    ]


def violations(findings: Sequence[Finding]) -> list[Finding]:
    """Return those that pass their limits, the first in time first."""
    found = (f for f in findings if f.violated and f.invariant not in OPEN)
    return sorted(found, key=lambda f: f.time_s)


def _rows(seconds: float) -> int:
    return max(math.ceil(seconds * ROWS_PER_S), 1)


def message_s(recording: Recording) -> float:
    """Return how late a demand reaches the brakes at most.

    With a fault of the link: until it counts as lost, the held demand has ended and the brake
    system takes its own path.
    """
    p, drive = recording.parameters, recording.drive
    late_s = p["driver.demand_period_s"] + p["driver.demand_jitter_s"] + SLACK_S
    if any(faults.table()[name].group == LINKS for name in recording.faults):
        late_s += drive.control.demand_timeout_s + drive.driver.lost_demand_hold_s
    return late_s + recording.most["fault.can_delay_s"]


def brakes_s(recording: Recording) -> float:
    """Return how late the hydraulic brake's torque follows its command, to a hundredth."""
    p = recording.parameters
    rises_s = recording.drive.brake.max_hydraulic_torque_nm / p["brake.hydraulic_rate_nm_per_s"]
    lag_s = SETTLED_LAGS * p["brake.hydraulic_time_constant_s"]
    late_s = recording.most["fault.hydraulic_late_s"]
    return p["brake.hydraulic_dead_time_s"] + late_s + lag_s + rises_s


def motors_s(recording: Recording) -> float:
    """Return how long a motor's torque takes from one end to the other."""
    return 2.0 * recording.drive.motor.max_torque_nm / recording.drive.control.torque_rate_nm_per_s


def _against(recording: Recording, values: Rows) -> Rows:
    """Return a torque that is signed forwards as one that is signed as the vehicle moves."""
    return values * np.sign(recording.speed)


def braking_nm(recording: Recording, wheel: int) -> Rows:
    """Return what motor and hydraulic brake of a wheel take from the motion."""
    hydraulic = recording.wheel(wheel, "hydraulic_torque_nm")
    return _against(recording, hydraulic - recording.wheel(wheel, "motor_torque_nm"))


def demanded_nm(recording: Recording) -> Rows:
    """Return the braking demand at each wheel: brake pedal and lift-off braking.

    Lift-off braking is a drive demand against the engaged direction; it brakes a wheel that rolls
    back as well.
    """
    engaged = recording.wheel(0, "direction")
    along = np.where(engaged == FORWARD, 1.0, np.where(engaged == REVERSE, -1.0, 0.0))
    lifts = np.maximum(-along * recording.signals["driver.drive_nm"], 0.0)
    out: Rows = recording.signals["driver.brake_nm"] + lifts
    return out


def _stands_m_per_s(recording: Recording) -> float:
    """Return below which speed a wheel counts as at standstill, where it may be held."""
    per_s = recording.drive.monitor.standstill_rpm / 60.0
    radius_m = recording.parameters["vehicle.wheel_radius_m"]
    return max(2.0 * math.pi * per_s * radius_m, MOVES_M_PER_S)


def _wrong_nm(recording: Recording) -> float:
    """Return the torque of the wrong sign that counts, what cogging makes of it apart."""
    cogging_nm = recording.parameters["motor.cogging_torque_nm"]
    return max(WRONG_NM, WRONG_SHARE * recording.drive.motor.rated_torque_nm) + cogging_nm


def driving_while_braking(recording: Recording) -> Iterator[Finding]:
    """Driving torque while the driver brakes: how long it lasts.

    Counted from when the demand has arrived and the motor could have let go, also after the vehicle
    has begun to roll the other way.
    """
    settles = _rows(message_s(recording) + motors_s(recording))
    brakes = motion.smallest_of(recording.signals["driver.brake_nm"], settles) > PRESSED_NM
    moves = np.abs(recording.speed) > MOVES_M_PER_S
    one_way = np.abs(motion.means_of(np.sign(recording.speed), settles)) > 1.0 - 0.5 / settles
    for k in range(recording.wheels):
        drives = _against(recording, recording.wheel(k, "motor_torque_nm"))
        rows, at = motion.longest(brakes & moves & one_way & (drives > _wrong_nm(recording)))
        yield Finding("", k, float(recording.time_s[at]), float(rows), WRONG_MS, "ms")


def _slope_nm(recording: Recording) -> Rows:
    """Return what each wheel needs against the slope, uphill and just before it stands.

    A hill hold that has to act at standstill begins as much earlier as the brake follows late, and
    half of that more (hill_hold.h).
    """
    p, signals = recording.parameters, recording.signals
    slope = motion.slope_of(signals["vehicle.height_m"], signals["vehicle.distance_m"], SLOPE_ROWS)
    weight_nm = p["vehicle.mass_kg"] * STANDARD_GRAVITY_M_PER_S2 * p["vehicle.wheel_radius_m"]
    soon = _rows(message_s(recording) + 1.5 * brakes_s(recording))
    stands = motion.smallest_of(np.abs(recording.speed)[::-1], soon)[::-1] < MOVES_M_PER_S
    return np.where(stands, np.maximum(slope, 0.0) * weight_nm / recording.wheels, 0.0)


def excess_braking(recording: Recording) -> Iterator[Finding]:
    """Torque of both brakes beyond the demand, mean of 100 ms.

    Beside the demand stand what a coasting wheel loses, what the drawn brake makes more than it
    is asked for, the tolerance of the motor's parts, and cogging, which a slow wheel does not
    average out. A demand that has fallen counts until the brakes can have followed. At standstill,
    and ahead of it as far as a slope needs it, there is a hill hold, whatever is demanded.
    """
    window = _rows(message_s(recording) + brakes_s(recording))
    demand = motion.largest_of(np.maximum(demanded_nm(recording), _slope_nm(recording)), window)
    pressed = recording.signals["driver.brake_nm"] > PRESSED_NM
    moves = pressed & (np.abs(recording.speed) > _stands_m_per_s(recording))
    strong = max(1.0 - recording.parameters["brake.torque_loss"], 1.0)
    cogging_nm = recording.parameters["motor.cogging_torque_nm"]
    for k in range(recording.wheels):
        speed = recording.speed / recording.parameters["vehicle.wheel_radius_m"]
        motor = _against(recording, -recording.wheel(k, "motor_torque_nm"))
        hydraulic = braking_nm(recording, k) - motor
        healthy = motor - PARTS_SHARE * np.abs(motor) + hydraulic / strong
        beyond = healthy - demand - motion.coasting_nm(recording.drive, speed)
        limit = np.maximum(EXCESS_NM, EXCESS_SHARE * demand) + cogging_nm
        share = motion.means_of(np.where(moves, beyond / limit, 0.0), EXCESS_ROWS)
        at = int(np.argmax(share))
        yield Finding("", k, float(recording.time_s[at]), float(share[at] * limit[at]),
                      float(limit[at]), "N m")  # fmt: skip


def braking_without_demand(recording: Recording) -> Iterator[Finding]:
    """Braking torque that nobody asked for, beyond the least that physics allows."""
    window = _rows(message_s(recording) + brakes_s(recording) + motors_s(recording))
    demand = motion.largest_of(demanded_nm(recording), window)
    rolls = (demand <= 0.0) & (np.abs(recording.speed) > ROLLS_M_PER_S)
    asks = recording.signals["driver.drive_nm"]
    same_way = motion.smallest_of(_against(recording, asks), window) >= 0.0
    bus_v, charge_a = recording.signals["bus.voltage_v"], recording.signals["bms.charge_a"]
    share_a = charge_a / recording.wheels
    speed = recording.speed / recording.parameters["vehicle.wheel_radius_m"]
    least = motion.feasible_nm(recording.drive, speed, bus_v, share_a)
    least += motion.coasting_nm(recording.drive, speed)
    limit = _wrong_nm(recording)
    for k in range(recording.wheels):
        beyond = braking_nm(recording, k) - FEASIBLE_SHARE * least
        found = motion.means_of(np.where(rolls & same_way, beyond, 0.0), EXCESS_ROWS)
        at = int(np.argmax(found))
        yield Finding("", k, float(recording.time_s[at]), float(found[at]), limit, "N m")


def current(recording: Recording) -> Iterator[Finding]:
    """Length of the current vector, active short circuits apart."""
    drive = recording.drive
    trip_a = loops.overcurrent_pu(drive) * drive.inverter.current_full_scale_a
    for k, peak_a in enumerate(recording.peak_current_a):
        length = np.hypot(recording.wheel(k, "current_d_a"), recording.wheel(k, "current_q_a"))
        at_s = float(recording.time_s[int(np.argmax(length))])
        yield Finding("", k, at_s, peak_a, CURRENT_SHARE * trip_a, "A")


def bus_voltage(recording: Recording) -> Iterator[Finding]:
    """Voltage at the bridges, against what their switches and capacitors stand."""
    limit = derived.device_voltage_v(recording.drive)
    at_s = float(recording.time_s[int(np.argmax(recording.signals["bus.voltage_v"]))])
    yield Finding("", VEHICLE, at_s, recording.bus_peak_v, limit, "V")


def temperature(recording: Recording) -> Iterator[Finding]:
    """Windings and switches, against the end of their derating."""
    drive = recording.drive
    limits = {"winding": drive.motor.max_winding_temperature_c}
    if drive.inverter.max_switch_temperature_c is not None:
        limits["switch"] = drive.inverter.max_switch_temperature_c
    for k in range(recording.wheels):
        for part, end_c in limits.items():
            found = recording.wheel(k, f"{part}_temperature_c")
            at = int(np.argmax(found))
            rise_k = float(found[at] - found[0])
            limit = max(end_c, float(found[0])) + HOTTER_K + HOTTER_SHARE * rise_k
            yield Finding("", k, float(recording.time_s[at]), float(found[at]), limit, "degC", part)


def stopping_distance(recording: Recording) -> Iterator[Finding]:
    """Way of each braking, against what the healthy brakes alone would need.

    The reference vehicle has the road, drag and mass of the run. It brakes with 95 % of the demand,
    or of the hydraulic brake's own largest torque where that is less, from when demand and
    brake can have followed; the motor's share may be zero.
    """
    brake = recording.signals["driver.brake_nm"]
    late = _rows(message_s(recording) + brakes_s(recording))
    lost = recording.most["brake.torque_loss"] + recording.most["fault.hydraulic_flicker_loss"]
    gain = min(max(1.0 - lost, 0.0), 1.0)
    most = recording.drive.brake.max_hydraulic_torque_nm
    sure = BRAKES_SHARE * gain * np.minimum(motion.smallest_of(brake, late), most)
    sure[: late - 1] = 0.0
    total = np.sum([braking_nm(recording, k) for k in range(recording.wheels)], axis=0)
    p = recording.parameters
    per_nm = 1.0 / (p["vehicle.mass_kg"] * p["vehicle.wheel_radius_m"])
    beyond = (total - recording.wheels * sure) * per_nm
    worst = Finding("", VEHICLE, 0.0, 0.0, LONGER_M, "m")
    for first, last in _stops(brake, recording.speed):
        speed = np.abs(recording.speed[first:last])
        reference = speed + np.cumsum(beyond[first:last]) / ROWS_PER_S
        stands = np.flatnonzero(reference <= 0.0)
        reference[int(stands[0]) if len(stands) else len(reference) :] = 0.0
        needed_m = float(np.sum(np.maximum(reference, 0.0))) / ROWS_PER_S
        limit = (1.0 + LONGER_SHARE) * needed_m + LONGER_S * float(speed[0]) + LONGER_M
        found = Finding("", VEHICLE, float(recording.time_s[first]),
                        float(np.sum(speed)) / ROWS_PER_S, limit, "m")  # fmt: skip
        worst = max(worst, found, key=lambda f: f.share)
    yield worst


def _stops(brake: Rows, speed: Rows) -> Iterator[tuple[int, int]]:
    """Yield the rows of each braking, from the demand to its end or the first standstill."""
    pressed = (brake > PRESSED_NM).astype(np.int8)
    edges = np.flatnonzero(np.diff(pressed, prepend=0, append=0))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if abs(speed[first]) < ROLLS_M_PER_S:
            continue
        stands = np.flatnonzero(speed[first:last] * np.sign(speed[first]) <= MOVES_M_PER_S)
        yield int(first), int(first + stands[0]) if len(stands) else int(last)


def energy(recording: Recording) -> Iterator[Finding]:
    """Energy that the simulated world makes or loses."""
    turned_j = recording.turned_over_j + LEAST_J_PER_KG * recording.parameters["vehicle.mass_kg"]
    share = abs(recording.residual_j) / turned_j
    yield Finding("", VEHICLE, recording.duration_s, share, RESIDUAL, "1")


def healed(recording: Recording) -> Iterator[Finding]:
    """Count latched faults that go away by themselves, or on a turning wheel; restarts apart."""
    resets = recording.parameters["driver.fault_reset_every_s"] > 0.0
    moves = np.abs(recording.speed[1:]) > TURNS_M_PER_S
    boot = [code for code in range(8) if mode_text(code) == "BOOT"]
    latched = list(latched_codes())
    for k in range(recording.wheels):
        codes = recording.wheel(k, "fault_reason")
        starts = np.isin(recording.wheel(k, "mode"), boot)
        restarted = motion.largest_of(starts.astype(float), 2)[1:] > 0.0
        gone = np.isin(codes[:-1], latched) & (codes[1:] == 0.0) & ~restarted
        wrong = np.flatnonzero(gone & (moves | (not resets)))
        at_s = float(recording.time_s[int(wrong[0]) + 1]) if len(wrong) else 0.0
        text = reasons.identifier(codes[int(wrong[0])]) if len(wrong) else ""
        yield Finding("", k, at_s, float(len(wrong)), 0.0, "1", text)


@cache
def latched_codes() -> frozenset[int]:
    """Return the codes of faults that an acknowledgement or a restart clears (core/reason.h)."""
    text = reasons.HEADER.read_text(encoding="utf-8")
    lines = re.findall(r"X\((\d+), \w+,[^X]*?(ACKNOWLEDGED|RESTART)", text)
    return frozenset(int(code) for code, _ in lines)


def changes(recording: Recording) -> Iterator[Finding]:
    """How often mode, fault, warning or limit change within a second, a start's sequence apart."""
    start = [_mode(name) for name in START]
    quiet = {
        f"wheel{k}.{name}": _without(
            recording.wheel(k, name), np.isin(recording.wheel(k, "mode"), start)
        )
        for k in range(recording.wheels)
        for name in ("mode", "reason")
    }
    seen = replace(recording, signals={**recording.signals, **quiet})
    yield from _most_changes(seen, ("mode", "fault_reason", "warning_reason", "reason"))


def _without(values: Rows, apart: np.typing.NDArray[np.bool_]) -> Rows:
    """Return a signal that stays what it was in some of its rows."""
    rows = np.where(apart, -1, np.arange(len(values)))
    before = np.maximum.accumulate(rows)
    return np.where(before >= 0, values[np.maximum(before, 0)], -1.0)


def charge_current(recording: Recording) -> Iterator[Finding]:
    """Charge beyond the limit that the pack's management sends, mean of a second."""
    most_a = recording.drive.battery.max_charge_current_a
    limit_a = motion.largest_of(recording.signals["bms.charge_a"], ROWS_PER_S + BMS_ROWS)
    beyond = -recording.signals["battery.current_a"] - limit_a
    found = motion.means_of(beyond, ROWS_PER_S)
    found[: ROWS_PER_S + BMS_ROWS] = 0.0
    at = int(np.argmax(found))
    limit = LEAST_CHARGE_A + CHARGE_SHARE * most_a
    yield Finding("", VEHICLE, float(recording.time_s[at]), float(found[at]), limit, "A")


def _most_changes(recording: Recording, names: Sequence[str]) -> Iterator[Finding]:
    for k in range(recording.wheels):
        worst = Finding("", k, 0.0, 0.0, float(CHANGES), "1/s")
        for name in names:
            found = motion.changes_in(recording.wheel(k, name), ROWS_PER_S)
            at = int(np.argmax(found))
            each = Finding("", k, float(recording.time_s[at]), float(found[at]), float(CHANGES),
                           "1/s", name)  # fmt: skip
            worst = max(worst, each, key=lambda f: f.value)
        yield worst


def finite(recording: Recording) -> Iterator[Finding]:
    """Every number is one, and every command within what the drive can be asked for."""
    motor, brake = recording.drive.motor, recording.drive.brake
    for k in range(recording.wheels):
        ranges: Mapping[str, tuple[float, float]] = {
            "command_nm": (-1.001 * motor.max_torque_nm, 1.001 * motor.max_torque_nm),
            "hydraulic_command_nm": (0.0, 1.001 * brake.max_hydraulic_torque_nm),
            "available_nm": (0.0, 1.001 * motor.max_torque_nm),
        }
        bad = np.zeros(len(recording.time_s), dtype=bool)
        for name, values in recording.signals.items():
            if not name.startswith("wheel") or name.startswith(f"wheel{k}."):
                bad |= ~np.isfinite(values)
        for name, (low, high) in ranges.items():
            values = recording.wheel(k, name)
            bad |= (values < low - 1e-3) | (values > high + 1e-3)
        at = int(np.argmax(bad))
        yield Finding("", k, float(recording.time_s[at]), float(np.sum(bad)), 0.0, "1")


def warning(recording: Recording) -> Iterator[Finding]:
    """Warnings, faults and LIMP of a vehicle that has nothing wrong."""
    for k in range(recording.wheels):
        limps = recording.wheel(k, "mode") == _mode(LIMP_NAME)
        fault, warns = (recording.wheel(k, f"{kind}_reason") for kind in ("fault", "warning"))
        any_row = limps | (fault != 0.0) | (warns != 0.0)
        at = int(np.argmax(any_row))
        text = ""
        if any_row[at]:
            codes = (fault[at], warns[at])
            text = next((reasons.identifier(code) for code in codes if code), LIMP_NAME)
        yield Finding("", k, float(recording.time_s[at]), float(np.sum(any_row)), 0.0, "ms", text)


@cache
def _mode(name: str) -> int:
    return next(code for code in range(16) if mode_text(code) == name)


INVARIANTS: Mapping[str, Check] = {
    check.__name__: check
    for check in (
        driving_while_braking,
        excess_braking,
        braking_without_demand,
        current,
        bus_voltage,
        temperature,
        stopping_distance,
        energy,
        healed,
        changes,
        finite,
    )
}
HEALTHY: Mapping[str, Check] = {"warning": warning}
# Measured and shown, but no violation. The charge limit is kept by the losses of the drive's file,
# which the parts' tolerances make wrong; what a trim on the pack's measured current leaves is to be
# judged once there is one.
OPEN: Mapping[str, Check] = {"charge_current": charge_current}
STORED_SHARE = "stored_share"  # measured beside a healthy run (``stop``)
PROCESS = "process"  # a crash, a hang, too much memory: found from outside (``isolated``)
NAMES = (*INVARIANTS, *HEALTHY, *OPEN, STORED_SHARE, PROCESS)
