# SPDX-License-Identifier: Apache-2.0
"""Gains and per-unit constants of the fast loop.

margins.py judges their stability, envelope.py their formats.

Bases: current I_base = current_full_scale, bus voltage V_base = voltage_full_scale, electrical
speed omega_base = 2 pi f_pwm / 16. The configuration stores gains relative to V_base; once a
millisecond the firmware multiplies them by V_base sqrt(3) / (limit v_dc), which turns volts into
shares of the voltage circle's radius.
"""

import math
from dataclasses import dataclass

from regen_table import derived, halls
from regen_table.sections import Drive

MODULATION_MAX = 0.98
FIELD_WEAKENING_BANDWIDTH_HZ = 30.0
ROUNDING_COUNTS = 2  # as in foc/modulation.c
PERIOD_COUNTS = 256, 16384  # as in config/bases.h
SETTLING_S = 0.5e-6  # of a shunt amplifier after its low side begins to conduct
EMF_TOLERANCE = 0.01  # flux linkage and voltages are not known any better
DEAD_TIME_ZONE_MIN = 128.0 / 32768.0  # as in config.h
# Of the current demanded while the dead time holds it at zero: a cold winding, longer dead time.
DEAD_TIME_MARGIN = 1.5


@dataclass(frozen=True)
class Bases:
    """Bases of the per-unit system (A, V, electrical rad/s) and the fast loop's period (s)."""

    current_a: float
    voltage_v: float
    speed_rad_s: float
    period_s: float


def bases(drive: Drive) -> Bases:
    """Return the bases of a drive."""
    frequency = drive.inverter.pwm_frequency_hz
    return Bases(
        current_a=drive.inverter.current_full_scale_a,
        voltage_v=drive.inverter.voltage_full_scale_v,
        speed_rad_s=2.0 * math.pi * frequency / 16.0,
        period_s=1.0 / frequency,
    )


def undervoltage_trip_v(drive: Drive) -> float:
    """Bus voltage in V below which the bridge does not run.

    The lowest one the gains are scaled for.
    """
    wanted = drive.monitor.undervoltage_v
    return 0.9 * drive.battery.min_voltage_v if wanted is None else wanted


def pwm_period_counts(drive: Drive) -> int:
    """Timer counts of half a PWM period: bases_pwm_period_counts()."""
    return nearest(drive.inverter.pwm_timer_clock_hz / (2.0 * drive.inverter.pwm_frequency_hz))


def min_pulse_s(drive: Drive) -> float:
    """Return the seconds for which every low side conducts at least.

    Before and after the top of the count.

    What the gate driver and its bootstrap supply need. Without a word from the configuration, twice
    the dead time, and at least a microsecond.
    """
    inverter = drive.inverter
    return (
        inverter.min_pulse_s
        if inverter.min_pulse_s is not None
        else max(1e-6, 2.0 * inverter.dead_time_s)
    )


def min_pulse_counts(drive: Drive) -> int:
    """Return the same in timer counts: bases_min_pulse_counts()."""
    return math.ceil(min_pulse_s(drive) * drive.inverter.pwm_timer_clock_hz - 1e-9)


def dead_time_counts(drive: Drive) -> int:
    """Timer counts by which the dead-time compensation may move a compare value: dead_time_init().

    A leg loses t_d f (v_dc + 2 V_f): in the one dead interval a diode lies where the switch was to
    be, in the other one it adds its drop. As a share of the bus voltage that is t_d f (1 + 2 V_f /
    v_dc), here at the middle of the battery's range.
    """
    inverter, middle_v = (
        drive.inverter,
        (drive.battery.min_voltage_v + drive.battery.max_voltage_v) / 2.0,
    )
    lost = (
        inverter.dead_time_s
        * inverter.pwm_frequency_hz
        * (1.0 + 2.0 * inverter.diode_forward_voltage_v / middle_v)
    )
    return nearest(lost * pwm_period_counts(drive))


def modulation_limit(drive: Drive) -> float:
    """Largest modulation that leaves the shortest pulse and the shunts' sampling window.

    Modulation is abs(u) / (v_dc / sqrt(3)).

    Min/max injection centres the three phases: the largest compare value is period/2 (1 + span /
    v_dc), and the line-to-line span of a voltage vector is at most sqrt(3) |u|, which is the
    modulation m times v_dc. Dead-time compensation and rounding take their part, so period/2 (1 +
    m) + trim + 2 <= period - min_pulse.

    Only two currents are sampled, those of the legs whose low sides conduct longest. The shorter of
    these two has at most period/2 (1 + cos(30 deg) m), where two phases are equal; it must leave
    the dead time and the settling time.
    """
    period, taken = pwm_period_counts(drive), dead_time_counts(drive) + ROUNDING_COUNTS
    window = (drive.inverter.dead_time_s + SETTLING_S) * drive.inverter.pwm_timer_clock_hz
    by_pulse = 1.0 - 2.0 * (min_pulse_counts(drive) + taken) / period
    by_sampling = (1.0 - 2.0 * (window + taken) / period) / math.cos(math.pi / 6.0)
    return min(MODULATION_MAX, by_pulse, by_sampling)


def phase_voltage_limit_v(drive: Drive, bus_voltage_v: float) -> float:
    """Peak phase voltage in V that the firmware can make from a bus voltage."""
    return modulation_limit(drive) * bus_voltage_v / math.sqrt(3.0)


def weakening_warning(drive: Drive) -> str | None:
    """Return a line when i_d cannot hold the top speed's EMF at the lowest bus voltage, or None.

    The motor then brakes at any commanded torque: not refused, because it occurs only with an empty
    pack, but the builder is warned.
    """
    motor, lowest = drive.motor, drive.battery.min_voltage_v
    emf, made = derived.line_emf_v(drive), modulation_limit(drive) * lowest
    weakening = drive.control.field_weakening_current_a or 0.0
    short_circuit_a = motor.flux_linkage_wb / motor.d_inductance_h
    left = emf * max(1.0 - weakening / short_circuit_a, 0.0)
    if left <= (1.0 + EMF_TOLERANCE) * made:
        return None
    needed = short_circuit_a * (1.0 - made / emf)
    reached = made / left * motor.max_speed_rpm
    remedy = f"{needed:.4g} A would be enough"
    if needed > motor.max_phase_current_a:
        remedy = (
            f"not even max_phase_current_a = {motor.max_phase_current_a:g} A would be enough,"
            f" {needed:.4g} A would"
        )
    return (
        f"control.field_weakening_current_a: {weakening:g} A leave {left:.4g} V of back-EMF between"
        f" lines at {motor.max_speed_rpm:g} r/min, above the {made:.4g} V that the bridge makes of"
        f" battery.min_voltage_v = {lowest:g} V: torque is not controlled there beyond"
        f" {reached:.4g} r/min; {remedy}"
    )


@dataclass(frozen=True)
class AxisGains:
    """Gains of one axis of the current loop: V/A, and V/A added every PWM period."""

    proportional: float
    integral: float


def axis_gains(drive: Drive, inductance_h: float) -> AxisGains:
    """Return the gains that make one axis follow like a first-order pole at omega_c.

    Behind a delay of 1.5 periods.

    The winding under a held voltage is (1 - p) / (R (z - p)), p = exp(-R T / L) (R with one switch,
    at the reference temperature). With k_i / k_p = 1 - p the regulator's zero lies on that pole,
    and what is left is the loop K / (z (z - 1)), K = k_i / R: one period until the voltage acts,
    one until a sample shows what it did. Its closed loop has poles that add up to one and whose
    product is K: one of them is a = exp(-omega_c T), as designed, when

        K = a (1 - a)        k_i = K R        k_p = K R / (1 - p), which is K L / T (1 + R T / (2
        L))

    The firmware scales k_i to the winding's resistance (resistance_ratio()). The other pole and
    where in a period the answer begins are left to the shape of the reference
    (margins.reference_shape()).
    """
    period = 1.0 / drive.inverter.pwm_frequency_hz
    pole = math.exp(-2.0 * math.pi * drive.control.current_bandwidth_hz * period)
    gain = pole * (1.0 - pole)
    resistance = drive.motor.phase_resistance_ohm + drive.inverter.switch_resistance_ohm
    return AxisGains(
        gain * resistance / -math.expm1(-resistance * period / inductance_h), gain * resistance
    )


def resistance_ratio(drive: Drive, winding_temperature_c: float) -> float:
    """Return the winding's resistance over that at its reference temperature.

    The firmware scales k_i by it.
    """
    rise = winding_temperature_c - drive.motor.reference_temperature_c
    return 1.0 + drive.motor.resistance_temperature_coefficient_per_k * rise


@dataclass(frozen=True)
class PerUnitGains:
    """Gains of the current loop relative to V_base.

    Volts per ampere, per ampere and speed, per speed.
    """

    proportional: dict[str, float]
    integral: float
    inductance: dict[str, float]
    flux: float


def per_unit_gains(drive: Drive) -> PerUnitGains:
    """Return the gains of the current loop, the cross-coupling and the back-EMF, per unit."""
    motor, base = drive.motor, bases(drive)
    impedance = base.current_a / base.voltage_v
    axes = {"d": motor.d_inductance_h, "q": motor.q_inductance_h}
    gains = {axis: axis_gains(drive, value) for axis, value in axes.items()}
    return PerUnitGains(
        proportional={axis: gain.proportional * impedance for axis, gain in gains.items()},
        integral=gains["d"].integral * impedance,  # R alone: both axes have the same
        inductance={axis: base.speed_rad_s * value * impedance for axis, value in axes.items()},
        flux=base.speed_rad_s * motor.flux_linkage_wb / base.voltage_v,
    )


def dead_time_zone_pu(drive: Drive) -> float:
    """Per-unit current below which the dead-time compensation is proportional.

    During a dead interval the leg takes the voltage that the current's sign gives it, until the
    current has gone. Over a period the error is at most t_d f (v_dc + 2 V_f), which moves the
    current by t_d (v_dc + 2 V_f) / L: a smaller current may end inside the interval. The smaller
    inductance lets it end soonest. Not below 128 LSB, the noise of a 12-bit converter. This is for
    the middle of the battery's range; the firmware moves it with the bus voltage.
    """
    zone = drive.control.dead_time_zone_a
    if zone is not None:
        return zone / drive.inverter.current_full_scale_a
    inductance = min(drive.motor.d_inductance_h, drive.motor.q_inductance_h)
    against_v = (
        drive.battery.min_voltage_v + drive.battery.max_voltage_v
    ) / 2.0 + 2.0 * drive.inverter.diode_forward_voltage_v
    extinguished_a = drive.inverter.dead_time_s * against_v / inductance
    return min(max(extinguished_a / drive.inverter.current_full_scale_a, DEAD_TIME_ZONE_MIN), 1.0)


def current_loop(drive: Drive) -> dict[str, int]:
    """Fill config_current_loop_t."""
    motor, control, base, gains = drive.motor, drive.control, bases(drive), per_unit_gains(drive)
    largest = motor.max_phase_current_a / base.current_a
    limit, target = modulation_limit(drive), fixed(control.modulation_target, 15)
    return {
        "bandwidth_Hz": nearest(control.current_bandwidth_hz),
        "proportional_d_pu_q16": fixed(gains.proportional["d"], 16),
        "proportional_q_pu_q16": fixed(gains.proportional["q"], 16),
        "integral_d_pu_q24": fixed(gains.integral, 24),
        "integral_q_pu_q24": fixed(gains.integral, 24),
        "inductance_d_pu_q16": fixed(gains.inductance["d"], 16),
        "inductance_q_pu_q16": fixed(gains.inductance["q"], 16),
        "flux_pu_q16": fixed(gains.flux, 16),
        "modulation_limit_pu_q15": math.floor(limit * 32768),
        "modulation_target_pu_q15": target,
        "modulation_reserve_pu_q15": target // 128
        if control.modulation_reserve is None
        else fixed(control.modulation_reserve, 15),
        "max_current_pu_q15": fixed(largest, 15),
        "field_weakening_gain_pu_q15": fixed(field_weakening_gain(drive), 15),
        "field_weakening_current_pu_q15": fixed(
            (control.field_weakening_current_a or 0.0) / base.current_a, 15
        ),
        "dead_time_zone_pu_q15": fixed(dead_time_zone_pu(drive), 15),
    }


def overcurrent_share_max(drive: Drive) -> float:
    """Return what a sensor with the worst zero shows at least of half its range, 2047 codes.

    A clipped sample hides the real current.
    """
    return (2047 - drive.monitor.offset_tolerance_codes) / 2048


def current_missing_ms(drive: Drive) -> float:
    """Return the per-unit reference times ms in which the sensors may show no current.

    As configured, or the longest that healthy sensors show none. A disturbance that decays with
    L_q / R: while the reference is r such a current passes zero, within one and a half codes z, in
    2 z (L_q / R) / r. And a small reference whose current the dead time holds at zero, until the
    loop's voltage, K R f times reference and time (axis_gains()), exceeds what the legs lose.
    """
    wanted, inverter = drive.monitor.current_missing_as, drive.inverter
    if wanted is not None:
        return 1e3 * wanted / inverter.current_full_scale_a
    resistance = drive.motor.phase_resistance_ohm + inverter.switch_resistance_ohm
    disturbed = 1.5 / 2048.0 * max(60.0, 3e3 * drive.motor.q_inductance_h / resistance)
    lost_v = inverter.dead_time_s * inverter.pwm_frequency_hz
    lost_v *= drive.battery.max_voltage_v + 2.0 * inverter.diode_forward_voltage_v
    pole = math.exp(-2.0 * math.pi * drive.control.current_bandwidth_hz / inverter.pwm_frequency_hz)
    zero_as = 4.0 / 3.0 * lost_v / (pole * (1.0 - pole) * resistance * inverter.pwm_frequency_hz)
    zero = DEAD_TIME_MARGIN * 1e3 * zero_as / inverter.current_full_scale_a
    return max(disturbed, zero)


def overcurrent_pu(drive: Drive) -> float:
    """Per-unit length of the current vector that trips.

    As configured, or 30 % above the largest reference, inside the converter's range.
    """
    full, wanted = drive.inverter.current_full_scale_a, drive.monitor.overcurrent_a
    if wanted is not None:
        return wanted / full
    return min(overcurrent_share_max(drive), 1.3 * drive.motor.max_phase_current_a / full)


def field_weakening_gain(drive: Drive) -> float:
    """Per-unit demagnetising current added per PWM period and unit of missing squared voltage.

    Voltages u are shares of the circle's radius, limit v_dc / sqrt(3). The regulator integrates
    target^2 - u^2. In the steady state one ampere of i_d moves u by up to omega L_d sqrt(3) /
    (limit v_dc) and its square by 2 target times that, so the loop's bandwidth is the gain times
    f_pwm 2 target omega L_d I_base sqrt(3) / (limit v_dc). It is set to 30 Hz at the largest speed
    and the lowest bus voltage, where it is fastest, well below the current loop's. Zero when field
    weakening is off.
    """
    if not drive.control.field_weakening_current_a:
        return 0.0
    base = bases(drive)
    reactance = derived.omega_max(drive) * drive.motor.d_inductance_h
    slope = (
        2.0
        * drive.control.modulation_target
        * reactance
        * base.current_a
        / phase_voltage_limit_v(drive, drive.battery.min_voltage_v)
    )
    bandwidth = min(FIELD_WEAKENING_BANDWIDTH_HZ, drive.control.current_bandwidth_hz / 10.0)
    return min(2.0 * math.pi * bandwidth * base.period_s / slope, 32767.0 / 32768.0)


def rotor(drive: Drive) -> dict[str, int | list[int]]:
    """Fill config_rotor_t: a tracking loop with both poles at the bandwidth (damping 1)."""
    natural = 2.0 * math.pi * drive.rotor.pll_bandwidth_hz * bases(drive).period_s
    wiring = halls.wiring(drive.rotor)
    return {
        "sensor": {"angle": 0, "hall": 1, "encoder": 2}[drive.rotor.sensor],
        "pll_bandwidth_Hz": nearest(drive.rotor.pll_bandwidth_hz),
        "pll_proportional_q16": fixed(2.0 * natural, 16),
        "pll_integral_q24": fixed(natural * natural, 24),
        "encoder_counts": drive.rotor.encoder_counts or 0,
        "encoder_index_turn": _turn(drive.rotor.encoder_index_deg or 0.0),
        "encoder_index_tolerance_counts": drive.rotor.encoder_index_tolerance_counts,
        "encoder_reversed": int(drive.rotor.encoder_reversed),
        "observer_speed_mrad_s": nearest(derived.observer_speed_rad_s(drive) * 1e3),
        "observer_takeover": int(drive.rotor.observer_takeover),
        "hall_lines": wiring.lines,
        "edge_turn": [_turn(edge) for edge in wiring.edges_deg],
    }


def _turn(degrees: float) -> int:
    """Electrical angle with 65 536 to a turn."""
    return nearest(degrees / 360.0 * 65536.0) % 65536


def nearest(value: float) -> int:
    """Nearest whole number, halves upwards."""
    return math.floor(value + 0.5)


def fixed(value: float, fraction_bits: int) -> int:
    """Nearest fixed-point number with so many fraction bits.

    1.0 in Q15 becomes the largest int16.
    """
    scaled = nearest(value * (1 << fraction_bits))
    return min(scaled, 32767) if fraction_bits == 15 and scaled == 32768 else scaled
