# SPDX-License-Identifier: Apache-2.0
"""Rules by which an absent key follows from those that are there, the board and the cells.

Each stands beside its key in the section's class (``Assumed``). The first sentence of a docstring
is what ``generate`` and ``explain`` print. Motor rules hold for gearless hub motors with rare-earth
magnets; their constants come from the six drives of tools/motors/public. Standard library only.
"""

import math

from regen_table import boards
from regen_table.assumed import Known

CELL_SOC_V = ((0.0, 3.0), (0.1, 3.35), (0.5, 3.65), (0.9, 4.05), (1.0, 4.18))  # NMC at rest
CELL_FULL_V, CELL_EMPTY_V, CELL_NOMINAL_V = 4.2, 3.0, 3.6
CELL_OHM_AH = 0.1  # series resistance of a cell times its capacity: 35 mOhm at 2.9 A h
POLARISATION_SHARE, POLARISATION_S = 0.5, 30.0
TORQUE_NM = 1.9  # continuous torque of a gearless hub motor of 1 kg
PEAK_OVER_RATED = 2.5
HIGH_VOLTAGE_V = 150.0  # beyond, bridges are IGBT or SiC modules
SWITCH_DROP_SHARE = 0.004  # of the pack's voltage, at the largest current
MODULATION = 0.85  # of the bus voltage between lines, dead times and shortest pulses taken off
HALVINGS = 60  # of an interval that holds a root
PERIODS_IN_A_TURN = 18.0  # envelope: 16 at 5 % above the largest speed
TRANSITION_S = 150e-9  # overlap of voltage and current in a switch
WINDOW_MARGIN_S = 10e-9  # a count of the timer and the rounding to it
OVERCURRENT_MARGIN = 1.05  # of the trip above the largest reference (refusals)
CAR_KG = 300.0  # from here on a vehicle has the drag of a car
AMBIENT_C = 40.0
WINDING_SHARE, COPPER_J_PER_KG_K = 0.14, 385.0
IRON_SHARE, IRON_J_PER_KG_K = 0.8, 460.0
PULL_OUT_KMH, END_KMH = 2.5, 1.0


def board(known: Known) -> boards.Board | None:
    """Return the board that the file names; None where it names none, or none that is known."""
    name = known("inverter.board")
    return boards.known().get(name) if isinstance(name, str) else None


# ---- [motor] ----


def name(known: Known) -> str:
    """Return the name of the file."""
    return str(known("name"))


def motor_type(known: Known) -> str:
    """Return surface magnets, or interior ones where the file gives two unequal inductances."""
    unequal = known("motor.q_inductance_h") != known("motor.d_inductance_h")
    return "ipmsm" if unequal else "spmsm"


def room_temperature(_known: Known) -> float:
    """Return 25 degC: data sheets measure a cold winding."""
    return 25.0


def copper(_known: Known) -> float:
    """Return that of copper, IEC 60028."""
    return 0.00393


def q_inductance(known: Known) -> float:
    """Return d_inductance_h: surface magnets."""
    return float(known("motor.d_inductance_h"))


def rated_torque(known: Known) -> float | None:
    """Return 1.9 N m times (motor.mass_kg / 1 kg)^(4/3).

    At one current density the copper loss grows with the mass and the torque with mass times
    radius, so with the mass to the power of 4/3. The constant is that of a 6.5 inch wheel (6 N m,
    2.3 kg) and of a 3 kW hub (35 N m, 8.5 kg).
    """
    mass = known("motor.mass_kg")
    return None if mass is None else TORQUE_NM * mass ** (4.0 / 3.0)


def _torque_per_ampere(known: Known) -> float:
    """Return the torque of a peak ampere at i_d = 0: T = 1.5 p psi i_q."""
    return float(1.5 * known("motor.pole_pairs") * known("motor.flux_linkage_wb"))


def largest_torque_nm(
    pole_pairs: int, flux_wb: float, d_henry: float, q_henry: float, current_a: float
) -> float:
    """Return the largest torque in N m of a peak phase current at standstill, without iron loss.

    T = 1.5 p (psi + (L_d - L_q) i_d) i_q on the circle i_d^2 + i_q^2 = I^2. With d = L_q - L_d the
    best i_d solves 2 d i_d^2 - psi i_d - d I^2 = 0; the root below is the one with the larger
    torque for either sign of d.
    """
    saliency = q_henry - d_henry
    i_d = 0.0
    if saliency != 0.0:
        root = math.sqrt(flux_wb * flux_wb + 8.0 * (saliency * current_a) ** 2)
        i_d = -2.0 * saliency * current_a * current_a / (flux_wb + root)
    i_q = math.sqrt(max(current_a * current_a - i_d * i_d, 0.0))
    return 1.5 * pole_pairs * (flux_wb - saliency * i_d) * i_q


def _torque_of(known: Known, current_a: float) -> float:
    """Return the largest torque of a peak phase current."""
    magnets = known("motor.pole_pairs"), known("motor.flux_linkage_wb")
    return largest_torque_nm(
        *magnets, known("motor.d_inductance_h"), known("motor.q_inductance_h"), current_a
    )


def max_torque(known: Known) -> float:
    """Return 2.5 times rated_torque_nm, within what max_phase_current_a gives.

    Hub motors stand two to three times their continuous torque for some ten seconds.
    """
    peak = PEAK_OVER_RATED * known("motor.rated_torque_nm")
    return float(min(peak, _torque_of(known, known("motor.max_phase_current_a"))))


def max_phase_current(known: Known) -> float:
    """Return what the largest torque takes with the best i_d, within what the board carries.

    The largest torque is max_torque_nm, else 2.5 times the rated one; without a board there is no
    other bound.
    """
    peak = (
        known("motor.max_torque_nm")
        if known.given("motor.max_torque_nm")
        else PEAK_OVER_RATED * known("motor.rated_torque_nm")
    )
    low, high = 0.0, peak / _torque_per_ampere(known) * 2.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if _torque_of(known, middle) >= peak else (middle, high)
    most = math.inf
    if (of_board := board(known)) is not None:
        full = known("inverter.current_full_scale_a")
        seen = (2047 - known("monitor.offset_tolerance_codes")) / 2048.0
        most = min(of_board.current_most_a, 0.999 * seen * full / OVERCURRENT_MARGIN)
    return float(min(high, most))


def max_power(known: Known) -> float:
    """Return max_torque_nm at max_speed_rpm: no bound beyond those of torque and speed."""
    return float(known("motor.max_torque_nm") * known("motor.max_speed_rpm") * math.pi / 30.0)


def max_speed(known: Known) -> float:
    """Return where the line-to-line EMF takes modulation_target of the full pack: sqrt(3) p psi n.

    Beyond it the field has to be weakened.
    """
    volts = known("control.modulation_target") * known("battery.max_voltage_v")
    electrical = volts / (math.sqrt(3.0) * known("motor.flux_linkage_wb"))
    return float(electrical / known("motor.pole_pairs") * 30.0 / math.pi)


def max_winding_temperature(_known: Known) -> float:
    """Return 120 degC: insulation class B less 10 K, and magnets that are glued."""
    return 120.0


# ---- [inverter] ----


def switch_resistance(known: Known) -> float:
    """Return the board's, else what drops 0.4 % of the full pack at max_phase_current_a."""
    of_board = board(known)
    if of_board is not None and of_board.switch_resistance_ohm is not None:
        return of_board.switch_resistance_ohm
    volts = SWITCH_DROP_SHARE * known("battery.max_voltage_v")
    return float(volts / known("motor.max_phase_current_a"))


def diode_forward_voltage(known: Known) -> float:
    """Return 0.8 V of a silicon MOSFET's body diode, 1.2 V of a module beyond 150 V."""
    return 0.8 if known("battery.max_voltage_v") < HIGH_VOLTAGE_V else 1.2


def diode_resistance(known: Known) -> float:
    """Return switch_resistance_ohm."""
    return float(known("inverter.switch_resistance_ohm"))


def dead_time(known: Known) -> float:
    """Return the least that the board permits; without a board 0.5 us, beyond 150 V 1 us."""
    if (of_board := board(known)) is not None:
        return of_board.dead_time_s
    return 5e-7 if known("battery.max_voltage_v") < HIGH_VOLTAGE_V else 1e-6


def pwm_frequency(known: Known) -> float:
    """Return 20 kHz, beyond 150 V 16 kHz; at least 18 periods to an electrical turn."""
    usual = 20e3 if known("battery.max_voltage_v") < HIGH_VOLTAGE_V else 16e3
    turns_hz = known("motor.max_speed_rpm") / 60.0 * known("motor.pole_pairs")
    return float(max(usual, math.ceil(PERIODS_IN_A_TURN * turns_hz / 1e3) * 1e3))


def switching_loss(known: Known) -> float:
    """Return V t / 2 with the full pack's voltage and 150 ns in which voltage and current overlap.

    N. Mohan, T. Undeland, W. Robbins, Power Electronics, 2-4: a current that commutates linearly
    under the bus voltage takes E = V I t / 2.
    """
    return float(0.5 * known("battery.max_voltage_v") * TRANSITION_S)


def current_full_scale(known: Known) -> float:
    """Return the board's, else 1.6 times max_phase_current_a, so that over-current trips inside."""
    if (of_board := board(known)) is not None:
        return of_board.current_full_scale_a
    return float(1.6 * known("motor.max_phase_current_a"))


def voltage_full_scale(known: Known) -> float:
    """Return the board's, else 1.25 times the full pack, so that over-voltage trips inside."""
    if (of_board := board(known)) is not None:
        return of_board.voltage_full_scale_v
    return float(1.25 * known("battery.max_voltage_v"))


def timer_clock(known: Known) -> int | None:
    """Return the board's chip."""
    of_board = board(known)
    return None if of_board is None else of_board.timer_clock_hz


def min_pulse(known: Known) -> float | None:
    """Return what low-side shunts need to settle and be sampled; else max(1 us, 2 dead times)."""
    of_board = board(known)
    window_s = None if of_board is None else of_board.window_s(known("inverter.dead_time_s"))
    return None if window_s is None else window_s + WINDOW_MARGIN_S


def max_switch_temperature(known: Known) -> float | None:
    """Return 100 degC at the sensor of the board; absent without a board: not watched."""
    return None if board(known) is None else 100.0


# ---- [monitor] ----


def offset_tolerance(known: Known) -> int | None:
    """Return what the board's header states; absent: 200 codes."""
    of_board = board(known)
    return None if of_board is None else of_board.offset_tolerance_codes


def switch_sensor_beta(known: Known) -> float | None:
    """Return what the board's header states."""
    of_board = board(known)
    return None if of_board is None else of_board.switch_sensor_beta_k


def switch_sensor_divider(known: Known) -> float | None:
    """Return what the board's header states."""
    of_board = board(known)
    return None if of_board is None else of_board.switch_sensor_divider_ohm


# ---- [battery] ----


def open_circuit_voltage(known: Known) -> list[list[float]] | None:
    """Return battery.cells times the rest voltage of a lithium-ion cell (NMC): 3.0 V to 4.18 V."""
    cells = known("battery.cells")
    if cells is None:
        return None
    return [[soc, round(volts * cells, 4)] for soc, volts in CELL_SOC_V]


def max_voltage(known: Known) -> float | None:
    """Return battery.cells at 4.2 V."""
    cells = known("battery.cells")
    return None if cells is None else CELL_FULL_V * cells


def min_voltage(known: Known) -> float | None:
    """Return battery.cells at 3.0 V."""
    cells = known("battery.cells")
    return None if cells is None else CELL_EMPTY_V * cells


def capacity(known: Known) -> float:
    """Return half an hour of all motors' rated torque at max_speed_rpm."""
    speed = known("motor.max_speed_rpm") * math.pi / 30.0
    watts = known("vehicle.driven_wheels") * known("motor.rated_torque_nm") * speed
    return float(0.5 * watts / known("battery.max_voltage_v"))


def series_resistance(known: Known) -> float:
    """Return cells in series times 0.1 ohm A h over capacity_ah: a cell of 2.9 A h has 35 mOhm."""
    cells = known("battery.max_voltage_v") / CELL_FULL_V
    return float(cells * CELL_OHM_AH / known("battery.capacity_ah"))


def polarisation_resistance(known: Known) -> float:
    """Return half of series_resistance_ohm."""
    return float(POLARISATION_SHARE * known("battery.series_resistance_ohm"))


def polarisation_capacitance(known: Known) -> float:
    """Return a time constant of 30 s with polarisation_resistance_ohm."""
    return float(POLARISATION_S / known("battery.polarisation_resistance_ohm"))


def max_charge_current(known: Known) -> float:
    """Return 1 C, 2 C of a car's pack from 300 kg on."""
    return float((2.0 if _car(known) else 1.0) * known("battery.capacity_ah"))


def max_discharge_current(known: Known) -> float:
    """Return 3 C."""
    return float(3.0 * known("battery.capacity_ah"))


# ---- [vehicle] ----


def _car(known: Known) -> bool:
    return float(known("vehicle.mass_kg")) >= CAR_KG


def frontal_area(known: Known) -> float:
    """Return 0.6 m2 of a rider, 2.3 m2 of a car from 300 kg on."""
    return 2.3 if _car(known) else 0.6


def drag(known: Known) -> float:
    """Return 0.9 of a rider, 0.3 of a car from 300 kg on."""
    return 0.3 if _car(known) else 0.9


def rolling(known: Known) -> float:
    """Return 0.012 of small tyres, 0.009 of a car's from 300 kg on."""
    return 0.009 if _car(known) else 0.012


def one_wheel(_known: Known) -> int:
    """Return one driven wheel."""
    return 1


# ---- [brake] ----


def _hydraulic(known: Known) -> bool:
    return float(known("brake.max_hydraulic_torque_nm")) > 0.0


def strategy(_known: Known) -> str:
    """Return series_optimal: the motor up to the optimum, the hydraulic brake the rest."""
    return "series_optimal"


def electric_share(_known: Known) -> float:
    """Return a fifth, as in the paper; read by parallel_ratio alone."""
    return 0.2


def electric_rated_torque(known: Known) -> float:
    """Return motor.rated_torque_nm; read by parallel_free_travel and its pedal alone."""
    return float(known("motor.rated_torque_nm"))


def hydraulic_dead_time(known: Known) -> float:
    """Return 30 ms; 0 without a hydraulic brake."""
    return 0.03 if _hydraulic(known) else 0.0


def hydraulic_time_constant(known: Known) -> float:
    """Return 60 ms; without a hydraulic brake no meaning."""
    return 0.06 if _hydraulic(known) else 0.05


def hydraulic_rate(known: Known) -> float:
    """Return all of max_hydraulic_torque_nm in 0.1 s; without a hydraulic brake no meaning."""
    return 10.0 * float(known("brake.max_hydraulic_torque_nm")) if _hydraulic(known) else 100.0


def no_hydraulic(_known: Known) -> float:
    """Return none that this controller commands."""
    return 0.0


# ---- [control], [table] ----


def current_bandwidth(known: Known) -> float:
    """Return a twentieth of pwm_frequency_hz, less where the gains' number formats need it."""
    return float(known("inverter.pwm_frequency_hz") / 20.0)


def field_weakening_current(known: Known) -> float | None:
    """Return what holds the EMF at max_speed_rpm on an empty pack; absent where that is given.

    psi / L_d (1 - u / EMF) with u = 0.85 of min_voltage_v, what a bridge makes of it, and within
    max_phase_current_a. A file that gives its largest speed also says whether it is to be held.
    """
    if known.given("motor.max_speed_rpm"):
        return None
    made = known("battery.min_voltage_v") * MODULATION
    emf = known("control.modulation_target") * known("battery.max_voltage_v")
    short_circuit = known("motor.flux_linkage_wb") / known("motor.d_inductance_h")
    needed = short_circuit * max(1.0 - made / emf, 0.0)
    return float(min(needed, known("motor.max_phase_current_a")))


def torque_rate(known: Known) -> float:
    """Return max_torque_nm in 0.2 s."""
    return float(known("motor.max_torque_nm") / 0.2)


def _rpm_at(known: Known, kmh: float) -> float:
    return float(kmh / 3.6 / known("vehicle.wheel_radius_m") * 30.0 / math.pi)


def handover_start(known: Known) -> float:
    """Return 2.5 km/h, at least 2.5 times handover_end_rpm."""
    return float(max(_rpm_at(known, PULL_OUT_KMH), 2.5 * known("control.handover_end_rpm")))


def handover_end(known: Known) -> float:
    """Return 1 km/h, at least an electrical turn a second, down to which halls measure a speed."""
    return float(max(_rpm_at(known, END_KMH), 60.0 / known("motor.pole_pairs")))


def smallest_grid(_known: Known) -> str:
    """Return the smallest grid that loses at most 0.02 % of a manoeuvre's energy."""
    return "auto"


def temperature_range(known: Known) -> list[float]:
    """Return -20 degC to max_winding_temperature_c."""
    return [-20.0, float(known("motor.max_winding_temperature_c"))]


# ---- [thermal] ----


def winding_heat_capacity(known: Known) -> float | None:
    """Return 14 % of motor.mass_kg is copper of 385 J/(kg K); absent without motor.mass_kg."""
    mass = known("motor.mass_kg")
    return None if mass is None else WINDING_SHARE * mass * COPPER_J_PER_KG_K


def housing_heat_capacity(known: Known) -> float | None:
    """Return 80 % of motor.mass_kg is iron of 460 J/(kg K); absent without motor.mass_kg."""
    mass = known("motor.mass_kg")
    return None if mass is None else IRON_SHARE * mass * IRON_J_PER_KG_K


def _thermal_resistance(known: Known) -> float:
    """Return the K/W with which rated_torque_nm ends at max_winding_temperature_c, air at 40 degC.

    Copper loss alone: 1.5 R_hot i_q^2 with i_q = T / (1.5 p psi).
    """
    hottest = known("motor.max_winding_temperature_c")
    rise = known("motor.resistance_temperature_coefficient_per_k") * (
        hottest - known("motor.reference_temperature_c")
    )
    current = known("motor.rated_torque_nm") / _torque_per_ampere(known)
    loss = 1.5 * known("motor.phase_resistance_ohm") * (1.0 + rise) * current**2
    return float((hottest - AMBIENT_C) / loss)


def winding_thermal_resistance(known: Known) -> float | None:
    """Return a third of what lets rated_torque_nm end at max_winding_temperature_c."""
    if known("motor.mass_kg") is None:
        return None
    return min(_thermal_resistance(known) / 3.0, 1e3)


def housing_thermal_resistance(known: Known) -> float | None:
    """Return two thirds of what lets rated_torque_nm end at max_winding_temperature_c."""
    if known("motor.mass_kg") is None:
        return None
    return min(_thermal_resistance(known) * 2.0 / 3.0, 1e3)
