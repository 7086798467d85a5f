# SPDX-License-Identifier: Apache-2.0
"""The ideal stop inside the limits of a drive's own file.

At every instant the motor's torque is the one of least DC power inside the limits, both currents
free; the hydraulic brake makes the rest of the demand at once. So the demand alone decides speed
over time, and the least power at every instant stores most (packs). Friction of the bearings is
part of the demand, as the controllers have it.

The limits have names (``regen_table.STOP_LIMITS``); the largest torque and power always hold:

    phase_current        |i| <= max_phase_current
    voltage              |u| <= (modulation_target - modulation_reserve) of what the bridge can make
                         of the bus voltage, as its mean over a PWM period
    charge_current       the pack's largest charge current, as its management fades it
    fold_back            charge current straight from all at the fold-back voltage to none at
                         max_voltage, at the terminal voltage that the same current makes
    winding_temperature  straight from max_torque where derating begins to none at the end
    torque_rate          of the demand, from none at the beginning
    blend_out            straight between the two hand-over speeds

A stop takes a tenth of a second.
"""

import math
from collections.abc import Collection
from dataclasses import asdict, dataclass

import numpy as np

from regen_table import DYNAMIC, STOP_LIMITS, joint, models, stop_limits
from regen_table.ideal import Energies
from regen_table.models import Array
from regen_table.schema import Drive

RATE_STEPS, STEPS = 60, 600  # while the torque rises, and from there to standstill
PASSES_MAX = 6  # of torque over bus voltage and back
VOLTAGE_STEP_MAX = 1e-4  # of the bus voltage from one pass to the next
BISECTIONS = 29  # of the search for the strongest torque that can be made
POWER_STEPS = 12  # of the search for the torque of a power
ON_A_LIMIT = 1e-3  # of a limit: nearer is on it
UNLIMITED = 3.0  # times the drive's phase current, where that is no limit: the search needs an end
WEAKER = 0.98  # a bound is the best torque where so much of it returns less


@dataclass(frozen=True)
class LimitedStop:
    """Result of one stop; energies in J, all motors together.

    Attributes
    ----------
    limits : tuple of str
        Which limits held.
    impossible_s : float
        For how long no currents inside the limits exist for the demand or any smaller torque: the
        bus voltage is too low for the speed. What the stop stores means nothing then.
    hydraulic_by_reason_j : dict
        The hydraulic brake's share of the energy, by what kept the motor from taking it.
    """

    strategy: str
    battery: str
    limits: tuple[str, ...]
    demand_nm: float
    initial_speed_kmh: float
    winding_temperature_c: float
    kinetic_energy_j: float
    stop_distance_m: float
    stop_time_s: float
    impossible_s: float
    energy_j: Energies
    hydraulic_by_reason_j: dict[str, float]
    stored_share_of_kinetic: float
    residual_relative: float

    def as_dict(self) -> dict[str, object]:
        """Return the result as nested mappings for JSON."""
        return asdict(self)


@dataclass(frozen=True)
class Trace:
    """A stop over time: shape (steps,), means over steps of ``seconds``.

    Torques are of one wheel: ``motor_nm`` electromagnetic, signed; ``hydraulic_nm`` a magnitude.
    ``charge_a`` is into the pack, ``bus_v`` at its terminals.
    """

    seconds: Array
    speed_rad_s: Array
    motor_nm: Array
    hydraulic_nm: Array
    charge_a: Array
    bus_v: Array
    state: models.State
    possible: np.typing.NDArray[np.bool_]
    reason: list[str]


@dataclass(frozen=True)
class _Battery:
    """What a trace of power did: arrays over the steps, energies in J."""

    charge_a: Array
    bus_v: Array
    power_w: Array
    reason: list[str]
    chemical_j: float
    heat_j: float
    left_in_branch_j: float


def stop(
    drive: Drive,
    strategy: str,
    demand_nm: float,
    initial_speed_kmh: float,
    temperature_c: float,
    soc: float | None = None,
    limits: Collection[str] = STOP_LIMITS,
) -> LimitedStop:
    """Integrate one ideal stop with the battery's RC branch at rest before it.

    Parameters
    ----------
    demand_nm : float
        Whole braking torque at each driven wheel, magnitude, > 0.
    initial_speed_kmh : float
        > 0.
    temperature_c : float
        Winding temperature, constant.
    soc : float, optional
        State of charge where the stop begins; by default the drive's own.
    limits : collection of str
        Names of ``STOP_LIMITS``.
    """
    trace, pack = _solve(drive, strategy, demand_nm, initial_speed_kmh, temperature_c, soc, limits)
    wheels, radius = drive.vehicle.driven_wheels, drive.vehicle.wheel_radius_m
    kinetic = 0.5 * drive.vehicle.mass_kg * (initial_speed_kmh / 3.6) ** 2

    def total(power_w: Array) -> float:
        return float(np.sum(wheels * power_w * trace.seconds))

    hydraulic_w = trace.hydraulic_nm * trace.speed_rad_s
    energies = Energies(
        battery_returned=-pack.chemical_j,
        hydraulic=total(hydraulic_w),
        copper=total(trace.state.loss_copper_w),
        iron=total(trace.state.loss_iron_w),
        inverter=total(trace.state.loss_inverter_w),
        battery=pack.heat_j,
        polarisation=pack.left_in_branch_j,
        friction=total(trace.state.loss_friction_w),
    )
    by_reason = {
        name: float(np.sum(np.where(np.array(trace.reason) == name, hydraulic_w, 0.0)
                           * trace.seconds)) * wheels
        for name in sorted(set(trace.reason))
    }  # fmt: skip
    return LimitedStop(
        strategy=strategy,
        battery=DYNAMIC,
        limits=tuple(name for name in STOP_LIMITS if name in limits),
        demand_nm=demand_nm,
        initial_speed_kmh=initial_speed_kmh,
        winding_temperature_c=temperature_c,
        kinetic_energy_j=kinetic,
        stop_distance_m=float(np.sum(trace.speed_rad_s * trace.seconds)) * radius,
        stop_time_s=float(np.sum(trace.seconds)),
        impossible_s=float(np.sum(trace.seconds[~trace.possible])),
        energy_j=energies,
        hydraulic_by_reason_j={name: joule for name, joule in by_reason.items() if joule > 0.0},
        stored_share_of_kinetic=energies.battery_returned / kinetic,
        residual_relative=(kinetic - sum(asdict(energies).values())) / kinetic,
    )


def trace_of(
    drive: Drive,
    strategy: str,
    demand_nm: float,
    initial_speed_kmh: float,
    temperature_c: float,
    soc: float | None = None,
    limits: Collection[str] = STOP_LIMITS,
) -> Trace:
    """Return torque, current and voltage over time of the same stop."""
    return _solve(drive, strategy, demand_nm, initial_speed_kmh, temperature_c, soc, limits)[0]


def _solve(
    drive: Drive,
    strategy: str,
    demand_nm: float,
    initial_speed_kmh: float,
    temperature_c: float,
    soc: float | None,
    limits: Collection[str],
) -> tuple[Trace, _Battery]:
    """Torque over bus voltage, bus voltage over torque, until the voltage stands still."""
    motor, inverter = models.machine(drive, temperature_c), models.bridge(drive)
    wheels = drive.vehicle.driven_wheels
    seconds, speed, demand = _steps(drive, demand_nm, initial_speed_kmh, limits)
    friction = motor.friction_nm + motor.viscous_nm_s * speed
    table = stop_limits.bounds(drive, strategy, demand, speed, temperature_c, limits)
    names = list(table)
    bounds = np.stack([table[name] for name in names])
    tightest = np.argmin(bounds, axis=0)
    strongest = np.maximum(np.min(bounds, axis=0) - friction, 0.0)
    omega = speed * motor.pole_pairs
    current = drive.motor.max_phase_current_a
    if "phase_current" not in limits:
        current *= UNLIMITED
    bus_v = np.full_like(speed, models.open_circuit_voltage_v(drive, soc))
    for _ in range(PASSES_MAX):
        voltage = (
            stop_limits.largest_voltage_v(drive, omega, bus_v)
            if "voltage" in limits
            else np.full_like(speed, np.inf)
        )
        within = joint.Limits(current, voltage)
        free = _strongest_or_best(motor, inverter, omega, within, strongest, strategy)
        pack = _carry(drive, wheels * free.state.dc_power_w, seconds, soc, limits)
        change = float(np.max(np.abs(pack.bus_v - bus_v)))
        bus_v = pack.bus_v
        if change <= VOLTAGE_STEP_MAX * float(np.max(bus_v)) or "voltage" not in limits:
            break
    charging = np.array([reason != "" for reason in pack.reason])
    made = _with_power(motor, inverter, omega, within, free, pack.power_w / wheels, charging)
    state = made.state
    reason = [
        pack.reason[k] or _reason_at(state, within, names[tightest[k]], strongest, k)
        for k in range(len(seconds))
    ]
    shaft = np.maximum(-state.torque_nm + friction, 0.0)
    hydraulic = np.maximum(demand - shaft, 0.0)
    found = Trace(
        seconds,
        speed,
        state.torque_nm,
        hydraulic,
        pack.charge_a,
        pack.bus_v,
        state,
        free.feasible,
        reason,
    )
    return found, pack


def _steps(
    drive: Drive, demand_nm: float, initial_speed_kmh: float, limits: Collection[str]
) -> tuple[Array, Array, Array]:
    """Durations (s), mean speeds (mechanical, rad/s) and mean demands (N m) of a stop's steps.

    The rate shapes the demand itself, so both brakes rise with it. The midpoint rule: power has
    kinks where one limit takes over from another.
    """
    vehicle = drive.vehicle
    initial = initial_speed_kmh / 3.6 / vehicle.wheel_radius_m
    slowing = vehicle.driven_wheels / (vehicle.wheel_radius_m**2 * vehicle.mass_kg)
    rising = demand_nm / drive.control.torque_rate_nm_per_s if "torque_rate" in limits else 0.0
    # A stop may be over while the demand still rises: v0 = slowing rate t^2 / 2.
    if rising > 0.0:
        rising = min(rising, math.sqrt(2.0 * initial * rising / (slowing * demand_nm)))
    begun = np.linspace(0.0, rising, RATE_STEPS + 1)
    demand = np.full(RATE_STEPS, demand_nm)
    if rising > 0.0:
        demand = drive.control.torque_rate_nm_per_s * 0.5 * (begun[1:] + begun[:-1])
    lost = slowing * np.cumsum(demand * np.diff(begun))
    left = initial - lost[-1]
    end = max(left, 0.0) / (slowing * demand_nm)
    nodes = np.concatenate([begun[:-1], rising + np.linspace(0.0, end, STEPS + 1)])
    seconds = np.diff(nodes)
    demand = np.concatenate([demand, np.full(STEPS, demand_nm)])
    kept = seconds > 0.0
    seconds, demand = seconds[kept], demand[kept]
    after = initial - slowing * np.cumsum(demand * seconds)
    return seconds, after + 0.5 * slowing * demand * seconds, demand


def _strongest_or_best(
    motor: models.Machine,
    inverter: models.Bridge,
    omega: Array,
    within: joint.Limits,
    strongest: Array,
    strategy: str,
) -> joint.Point:
    """Return the best torque up to the strongest; the parallel strategies take all they can.

    The least power over torque has one minimum, so a bound where it still falls is the best.
    """
    if strategy == "series_optimal":
        whole, part = (
            joint.least_power(motor, inverter, omega, -share * strongest, within, joint.AUDIT)
            for share in (1.0, WEAKER)
        )
        search = ~whole.feasible | (part.state.dc_power_w <= whole.state.dc_power_w)
        torque = -strongest
        if np.any(search):
            at = _some(within, search)
            torque[search] = joint.best_braking(
                motor, inverter, omega[search], at, strongest[search], joint.AUDIT
            ).torque_nm
        return joint.least_power(motor, inverter, omega, torque, within, joint.AUDIT)
    # Almost everywhere the strongest torque can be made; the rest is searched.
    torque = -strongest
    whole = joint.least_power(motor, inverter, omega, torque, within, joint.AUDIT)
    search = ~whole.feasible
    if not np.any(search):
        return whole
    at, inner, outer = _some(within, search), np.zeros(int(np.sum(search))), strongest[search]
    for _ in range(BISECTIONS):
        middle = 0.5 * (inner + outer)
        made = joint.least_power(motor, inverter, omega[search], -middle, at, joint.AUDIT).feasible
        inner, outer = np.where(made, middle, inner), np.where(made, outer, middle)
    torque[search] = -inner
    return joint.least_power(motor, inverter, omega, torque, within, joint.AUDIT)


def _some(within: joint.Limits, chosen: np.typing.NDArray[np.bool_]) -> joint.Limits:
    """Return the limits at some of the points; the current's is the same for all."""
    return joint.Limits(within.current_a, np.asarray(within.voltage_v)[chosen])


def _reason_at(
    state: models.State, within: joint.Limits, bound: str, strongest: Array, k: int
) -> str:
    """Return what bounded the torque of a step that the battery did not bound."""
    if -state.torque_nm[k] >= strongest[k] * (1.0 - ON_A_LIMIT):
        return bound
    voltage = np.broadcast_to(within.voltage_v, strongest.shape)[k]
    if state.voltage_v[k] >= voltage * (1.0 - ON_A_LIMIT):
        return "voltage"
    most = np.broadcast_to(within.current_a, strongest.shape)[k]
    if state.current_a[k] >= most * (1.0 - ON_A_LIMIT):
        return "phase_current"
    return "loss_optimum"


def _with_power(
    motor: models.Machine,
    inverter: models.Bridge,
    omega: Array,
    within: joint.Limits,
    free: joint.Point,
    power_w: Array,
    chosen: np.typing.NDArray[np.bool_],
) -> joint.Point:
    """Return the points, where ``chosen`` with the torque that makes the given DC power.

    Between no torque and the free one the least power falls with the torque.
    """
    torque = free.torque_nm.copy()
    if np.any(chosen):
        inner, outer = np.zeros(int(np.sum(chosen))), torque[chosen]
        at = _some(within, chosen)
        for _ in range(POWER_STEPS):
            middle = 0.5 * (inner + outer)
            found = joint.least_power(motor, inverter, omega[chosen], middle, at, joint.AUDIT)
            beyond = found.state.dc_power_w < power_w[chosen]
            inner, outer = np.where(beyond, inner, middle), np.where(beyond, middle, outer)
        torque[chosen] = 0.5 * (inner + outer)
    return joint.least_power(motor, inverter, omega, torque, within, joint.AUDIT)


def _carry(
    drive: Drive, power_w: Array, seconds: Array, soc: float | None, limits: Collection[str]
) -> _Battery:
    """Carry a trace of power through the pack, charging bounded.

    Within a step the current is constant, and the branch's mean voltage is exact for it
    (packs.dynamic). Open-circuit voltage and state of charge are those of the step's beginning.
    """
    pack = drive.battery
    charge = pack.initial_soc if soc is None else soc
    share = seconds / max(pack.polarisation_resistance_ohm * pack.polarisation_capacitance_f, 1e-12)
    decays, means = np.exp(-share), -np.expm1(-share) / share
    branch_v = chemical = heat = 0.0
    flowing, terminal, made, reasons = [], [], [], []
    for power, step, decay, mean in zip(
        power_w.tolist(), seconds.tolist(), decays.tolist(), means.tolist(), strict=True
    ):
        cells_v = models.open_circuit_voltage_v(drive, charge)
        open_v = cells_v + mean * branch_v
        ohm = pack.series_resistance_ohm + (1.0 - mean) * pack.polarisation_resistance_ohm
        current = 2.0 * -power / (open_v + math.sqrt(max(open_v**2 - 4.0 * ohm * power, 0.0)))
        most, reason = stop_limits.largest_charge_a(drive, charge, (cells_v, open_v, ohm), limits)
        if current > max(most, 0.0):
            current = max(most, 0.0)
            power = -(open_v + ohm * current) * current  # noqa: PLW2901, what flows instead
            reasons.append(reason)
        else:
            reasons.append("")
        mean_branch_v = mean * branch_v + (1.0 - mean) * pack.polarisation_resistance_ohm * current
        heat += (pack.series_resistance_ohm * current + mean_branch_v) * current * step
        chemical -= cells_v * current * step
        branch_v = decay * branch_v + (1.0 - decay) * pack.polarisation_resistance_ohm * current
        charge = min(max(charge + current * step / (3600.0 * pack.capacity_ah), 0.0), 1.0)
        flowing.append(current)
        terminal.append(open_v + ohm * current)
        made.append(power)
    left = 0.5 * pack.polarisation_capacitance_f * branch_v**2
    return _Battery(
        np.array(flowing),
        np.array(terminal),
        np.array(made),
        reasons,
        chemical,
        heat - left,
        left,
    )
