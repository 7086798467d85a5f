# SPDX-License-Identifier: Apache-2.0
"""From a motor's label to a short TOML file: the numbers that people have, as keys.

Labels state line-to-line and DC quantities, the keys are PEAK PHASE quantities of the equivalent
star. Each conversion is one function here, with its convention. What a label does not state is
estimated where that is possible, with constants of the gearless hub motors in tools/motors/public;
the rest of the drive is assumed when the file is read (``defaults``). Standard library only.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field

from regen_table import boards, defaults
from regen_table.errors import ConfigurationError

TRAPEZOID = 6.0 * math.sqrt(3.0) / math.pi**2  # fundamental of the line EMF over its flat top
IRON_SHARE = 0.8  # of the no-load loss, at the no-load speed
NO_LOAD_SHARE = 0.035  # no-load loss over rated power: 0.033 to 0.037 of three public motors
MOTOR_CONSTANT = 0.3  # (N m)^2/W of a hub motor of 1 kg: 0.25 to 0.34 of three public motors
SHORT_CIRCUIT_OVER_RATED = 5.5  # psi / L over the rated current: 4.1 to 7.2 of four public motors
RATED_OVER_NO_LOAD_SPEED = 0.8
SALIENCY = 2.0  # L_q / L_d of interior magnets
OWN_BOARD = "own"
LINES_MAX = 20


@dataclass(frozen=True)
class Quantity:
    """One number of a label: option and question."""

    option: str
    lowest: float
    highest: float
    unit: str
    text: str
    whole: bool = False

    @property
    def name(self) -> str:
        """Name of the option as an attribute."""
        return self.option.removeprefix("--").replace("-", "_")

    @property
    def metavar(self) -> str:
        """Unit in capitals, as a help text has it."""
        unit = self.unit.replace("r/min", "rpm").replace(" per ", "_per_").replace(" ", "")
        return unit.upper() or "N"


@dataclass(frozen=True)
class Choice:
    """One word of a label: option and question; the first is what is taken."""

    option: str
    words: tuple[str, ...]
    text: str

    @property
    def name(self) -> str:
        """Name of the option as an attribute."""
        return self.option.removeprefix("--").replace("-", "_")


QUANTITIES = (
    Quantity("--pole-pairs", 1, 60, "", "pole pairs; or --magnets", whole=True),
    Quantity("--magnets", 2, 120, "", "magnets on the rotor, two to a pole pair", whole=True),
    Quantity("--kv", 0.05, 1e4, "r/min per V", "no-load speed per volt"),
    Quantity("--flux-linkage", 1e-6, 2.0, "Wb", "peak phase, as VESC's detection shows it"),
    Quantity("--no-load-rpm", 1.0, 47e3, "r/min", "no-load speed, at --at-volt; in place of Kv"),
    Quantity("--at-volt", 1.0, 1000.0, "V", "bus voltage of no-load speed and no-load current"),
    Quantity("--line-resistance", 2e-5, 200.0, "ohm", "between two wires, cold"),
    Quantity("--line-inductance", 2e-7, 2.0, "H", "between two wires"),
    Quantity("--no-load-current", 0.001, 1000.0, "A", "from the supply, at --at-volt"),
    Quantity("--rated-torque", 0.01, 1638.0, "N m", "continuous, of the motor"),
    Quantity("--rated-current", 0.05, 2000.0, "A", "continuous, rms of a phase; not the battery's"),
    Quantity("--rated-power", 1.0, 1e6, "W", "continuous, as on a label"),
    Quantity("--max-torque", 0.01, 1638.0, "N m", "for some ten seconds"),
    Quantity("--motor-mass", 0.05, 1000.0, "kg", "of the motor alone"),
    Quantity("--wheel-diameter", 0.02, 4.0, "m", "outer diameter of the tyre"),
    Quantity("--gear-ratio", 0.1, 100.0, "", "motor turns to a turn of the wheel"),
    Quantity("--wheels", 1, 16, "", "motors on one battery", whole=True),
    Quantity("--mass", 1.0, 1e5, "kg", "vehicle with driver and load"),
    Quantity("--cells", 1, 400, "", "lithium-ion cells in series", whole=True),
    Quantity("--capacity", 0.01, 1e5, "A h", "of the battery"),
    Quantity("--hydraulic-torque", 0.0, 3276.0, "N m", "of a brake that this controller commands"),
)
CHOICES = (
    Choice("--type", ("spmsm", "ipmsm"), "magnets on the surface, or inside"),
    Choice("--kv-of", ("dc", "line-rms"), "volts of Kv: of the bus, or rms between two wires"),
    Choice("--emf", ("sine", "trapezoid"), "shape of the back-EMF"),
    Choice("--rotor-sensor", ("hall", "angle"), "three halls, or an absolute angle"),
    Choice("--winding-sensor", ("none", "ntc", "kty84", "pt1000"), "in the motor"),
)


# ---- conversions ----


def flux_linkage_wb(kv_rpm_per_v: float, pole_pairs: int, kv_of: str, emf: str) -> float:
    """Return the peak phase flux linkage of the fundamental from the no-load speed per volt.

    A bridge without load turns the motor until the peak of the line-to-line EMF is the bus
    voltage, under block commutation as under field-oriented control without field weakening:

        V = sqrt(3) psi p Omega      psi = 60 / (2 pi sqrt(3) p Kv)

    (J. R. Hendershot, T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010, ch. 7;
    the ODrive guide's 16 r/min per volt of a 15-pole-pair wheel give its 23 mWb.) Volts rms between
    lines are 1/sqrt(2) of that peak. A trapezoidal EMF with a flat top of 120 deg, as the ideal
    machine of block commutation has it, has a line-to-line fundamental of 6 sqrt(3) / pi^2 = 1.053
    times the flat top; torque by sinusoidal currents comes from the fundamental alone.
    """
    peak = 60.0 / (2.0 * math.pi * math.sqrt(3.0) * pole_pairs * kv_rpm_per_v)
    factor = math.sqrt(2.0) if kv_of == "line-rms" else 1.0
    return peak * factor * (TRAPEZOID if emf == "trapezoid" else 1.0)


def phase_resistance_ohm(line_resistance_ohm: float) -> float:
    """Return half: between two wires lie two phases of a star, and of a triangle its equivalent."""
    return line_resistance_ohm / 2.0


def phase_inductances_h(line_inductance_h: float, magnets: str) -> tuple[float, float]:
    """Return L_d and L_q.

    Between two wires, with the third one open, lie L_d + L_q + (L_q - L_d) cos(2 theta): twice the
    mean. Interior magnets: L_q = 2 L_d, as one reading at an unknown angle cannot tell.
    """
    mean = line_inductance_h / 2.0
    if magnets == "spmsm":
        return mean, mean
    return 2.0 * mean / (1.0 + SALIENCY), 2.0 * SALIENCY * mean / (1.0 + SALIENCY)


def rated_torque_nm(rated_current_a: float, pole_pairs: int, flux_wb: float) -> float:
    """Return 1.5 p psi sqrt(2) I of a phase current I rms, i_d = 0."""
    return 1.5 * pole_pairs * flux_wb * math.sqrt(2.0) * rated_current_a


def no_load(
    loss_w: float, speed_rpm: float, pole_pairs: int, flux_wb: float
) -> tuple[float, float]:
    """Return iron-loss resistance (ohm, constant) and friction torque (N m) of a no-load loss.

    What the supply gives without load, V I_0, goes into iron and friction; copper takes less than
    a hundredth of it. One number cannot part them: four fifths are taken as iron loss at that
    speed, 1.5 (omega psi)^2 / R_i, as eddy currents make it, and a fifth as friction.
    """
    mechanical = speed_rpm * math.pi / 30.0
    emf = mechanical * pole_pairs * flux_wb
    return 1.5 * emf**2 / (IRON_SHARE * loss_w), (1.0 - IRON_SHARE) * loss_w / mechanical


def estimated_resistance_ohm(motor_kg: float, pole_pairs: int, flux_wb: float) -> float:
    """Return k_t^2 / (1.5 K_m^2) with K_m^2 = 0.3 (N m)^2/W times (mass / 1 kg)^(5/3).

    Motors of one shape at one current density: torque grows with mass^(4/3) (``defaults``), copper
    loss with mass, so K_m^2 = T^2 / P with mass^(5/3). k_t = 1.5 p psi for a peak ampere.
    """
    per_ampere = 1.5 * pole_pairs * flux_wb
    return float(per_ampere**2 / (1.5 * MOTOR_CONSTANT * motor_kg ** (5.0 / 3.0)))


# ---- the file ----


@dataclass
class _Sheet:
    """Lines of the file, what was estimated, and what is missing."""

    lines: list[str] = field(default_factory=list)
    estimated: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)

    def add(self, key: str, value: float | str, source: str, estimated: bool = False) -> None:
        text = f'"{value}"' if isinstance(value, str) else f"{value:.5g}"
        self.lines.append(f"{key} = {text}  # {'estimated: ' if estimated else ''}{source}")
        if estimated:
            self.estimated.append(f"{key} = {text}: {source}")


@dataclass(frozen=True)
class Written:
    """A short file and what is to be said about it."""

    text: str
    estimated: list[str]
    board: str


def short_file(
    name: str, given: Mapping[str, float | str], refused: Collection[str] = ()
) -> Written:
    """Return the TOML file of a label.

    Parameters
    ----------
    name : str
        Of the drive.
    given : mapping
        Options by name ("line_resistance"), those that are known.
    refused : collection of str
        Boards that are not proposed, because the drive is refused with them.

    Raises
    ------
    ConfigurationError
        Naming everything that is missing and cannot be estimated, a line each.
    """
    known = {choice.name: choice.words[0] for choice in CHOICES} | dict(given)
    sheet = _Sheet()
    pairs, flux = _magnets(known, sheet)
    cells = _cells(known, sheet)
    rated = _rated(known, sheet, pairs, flux, cells)
    for option in ("wheel_diameter", "mass"):
        if option not in known:
            sheet.missing.append(_missing(option))
    if sheet.missing or pairs is None or flux is None or cells is None or rated is None:
        raise ConfigurationError("\n".join(f"{name}: {line}" for line in sheet.missing))
    motor_kg = _motor_mass(known, sheet, rated)
    _winding(known, sheet, pairs, flux, rated, motor_kg)
    _no_load(known, sheet, pairs, flux, rated, cells)
    board = known.get("board") or proposed_board(rated / (1.5 * pairs * flux), cells, refused)
    if "board" not in known:
        sheet.estimated.append(f"inverter.board: {board}: {_why(str(board), refused)}")
    _rest(known, sheet, str(board), cells)
    head = f"# {name}: from a label (regen_table new); what is absent is assumed (generate says so)"
    return Written("\n".join([head, *sheet.lines]) + "\n", sheet.estimated, str(board))


def _number(known: Mapping[str, float | str], name: str) -> float | None:
    value = known.get(name)
    return None if value is None else float(value)


def _missing(name: str, instead: str = "") -> str:
    about = next(quantity for quantity in QUANTITIES if quantity.name == name)
    unit = f", {about.unit}" if about.unit else ""
    return f"{about.option}: missing, accepted: {about.text}{unit}{instead}"


def _magnets(known: Mapping[str, float | str], sheet: _Sheet) -> tuple[int | None, float | None]:
    """Write pole pairs and flux linkage."""
    pairs, magnets = _number(known, "pole_pairs"), _number(known, "magnets")
    if pairs is None and magnets is None:
        sheet.missing.append(_missing("pole_pairs"))
    elif pairs is None and magnets is not None and magnets % 2:
        sheet.missing.append(f"--magnets: {magnets:g}, accepted: an even number")
    elif pairs is None and magnets is not None:
        pairs = magnets / 2
        sheet.add("motor.pole_pairs", pairs, f"{magnets:g} magnets / 2")
    elif pairs is not None:
        sheet.add("motor.pole_pairs", pairs, "label")
    flux = _number(known, "flux_linkage")
    if flux is not None:
        sheet.add("motor.flux_linkage_wb", flux, "label, peak phase")
        return None if pairs is None else int(pairs), flux
    kv, source = _kv(known, sheet)
    torque, current = _number(known, "rated_torque"), _number(known, "rated_current")
    if pairs is not None and kv is not None:
        of, emf = str(known["kv_of"]), str(known["emf"])
        flux = flux_linkage_wb(kv, int(pairs), of, emf)
        words = "V rms between lines" if of == "line-rms" else "V of the bus"
        sheet.add("motor.flux_linkage_wb", flux, f"{source} r/min per {words}, {emf}")
    elif pairs is not None and torque is not None and current is not None:
        flux = torque / (1.5 * pairs * math.sqrt(2.0) * current)
        sheet.add("motor.flux_linkage_wb", flux, f"{torque:g} N m / (1.5 p sqrt2 {current:g} A)")
    elif kv is None and (torque is None or current is None):
        instead = (
            "; or --flux-linkage, --no-load-rpm and --at-volt, --rated-torque and --rated-current"
        )
        sheet.missing.append(_missing("kv", instead))
    return None if pairs is None else int(pairs), flux


def _kv(known: Mapping[str, float | str], sheet: _Sheet) -> tuple[float | None, str]:
    """Return no-load speed per volt, and its source: given, or speed and voltage of a test."""
    kv, speed = _number(known, "kv"), _number(known, "no_load_rpm")
    if kv is not None or speed is None:
        return kv, f"{kv or 0.0:g}"
    volts, cells = _number(known, "at_volt"), _number(known, "cells")
    if volts is None and cells is None:
        sheet.missing.append(_missing("at_volt"))
        return None, ""
    if volts is None and cells is not None:
        volts = defaults.CELL_NOMINAL_V * cells
        sheet.estimated.append(f"--at-volt = {volts:g} V: 3.6 V times --cells")
    assert volts is not None
    # The copper's drop at no load, R I_0 between two wires, is not EMF.
    drop = (_number(known, "line_resistance") or 0.0) * (_number(known, "no_load_current") or 0.0)
    return speed / (volts - min(drop, 0.1 * volts)), f"{speed:g} / {volts:g}"


def _cells(known: Mapping[str, float | str], sheet: _Sheet) -> int | None:
    cells, volts = _number(known, "cells"), _number(known, "at_volt")
    if cells is not None:
        return int(cells)
    if volts is None:
        sheet.missing.append(_missing("cells"))
        return None
    return max(1, round(volts / defaults.CELL_NOMINAL_V))


def _rated(
    known: Mapping[str, float | str],
    sheet: _Sheet,
    pairs: int | None,
    flux: float | None,
    cells: int | None,
) -> float | None:
    """Write the continuous torque."""
    torque, current = _number(known, "rated_torque"), _number(known, "rated_current")
    motor_kg, power = _number(known, "motor_mass"), _number(known, "rated_power")
    if torque is not None:
        sheet.add("motor.rated_torque_nm", torque, "label")
    elif current is not None:
        if pairs is None or flux is None:
            return None
        torque = rated_torque_nm(current, pairs, flux)
        sheet.add("motor.rated_torque_nm", torque, f"1.5 p psi sqrt2 {current:g} A rms")
    elif power is not None:
        if pairs is None or flux is None or cells is None:
            return None
        speed = defaults.CELL_NOMINAL_V * cells / (math.sqrt(3.0) * flux * pairs)
        torque = power / (RATED_OVER_NO_LOAD_SPEED * speed)
        source = f"{power:g} W at four fifths of the no-load speed; labels state peaks"
        sheet.add("motor.rated_torque_nm", torque, source, estimated=True)
    elif motor_kg is not None:
        torque = defaults.TORQUE_NM * motor_kg ** (4.0 / 3.0)
        source = "1.9 N m (mass / 1 kg)^(4/3); a third off is usual"
        sheet.add("motor.rated_torque_nm", torque, source, estimated=True)
    else:
        instead = "; or --rated-current, --rated-power, --motor-mass"
        sheet.missing.append(_missing("rated_torque", instead))
    if (largest := _number(known, "max_torque")) is not None:
        sheet.add("motor.max_torque_nm", largest, "label")
    return torque


def _motor_mass(known: Mapping[str, float | str], sheet: _Sheet, rated: float) -> float:
    mass = _number(known, "motor_mass")
    if mass is not None:
        sheet.add("motor.mass_kg", mass, "label")
        return mass
    mass = float((rated / defaults.TORQUE_NM) ** 0.75)
    sheet.add(
        "motor.mass_kg", mass, "(T / 1.9 N m)^(3/4): else the winding is watched wrongly", True
    )
    return mass


def _winding(
    known: Mapping[str, float | str],
    sheet: _Sheet,
    pairs: int,
    flux: float,
    rated: float,
    motor_kg: float,
) -> None:
    """Write resistance and inductances."""
    line_ohm, line_h = _number(known, "line_resistance"), _number(known, "line_inductance")
    magnets = str(known["type"])
    if line_ohm is not None:
        value = phase_resistance_ohm(line_ohm)
        sheet.add("motor.phase_resistance_ohm", value, f"{line_ohm:g} ohm between wires / 2")
    else:
        value = estimated_resistance_ohm(motor_kg, pairs, flux)
        source = "of the motor's mass; 10 % off cost 0.1 to 1.4 %"
        sheet.add("motor.phase_resistance_ohm", value, source, estimated=True)
    if line_h is not None:
        source = f"{line_h:g} H between wires / 2"
    else:
        line_h = 2.0 * flux / SHORT_CIRCUIT_OVER_RATED / (rated / (1.5 * pairs * flux))
        source = "psi / L = 5.5 rated currents; off by 30 % the currents are slower, no energy"
    guessed = "line_inductance" not in known
    d, q = phase_inductances_h(line_h, magnets)
    sheet.add("motor.d_inductance_h", d, source, estimated=guessed)
    if magnets == "ipmsm":
        sheet.add("motor.q_inductance_h", q, "L_q = 2 L_d with the same mean", estimated=True)


def _no_load(
    known: Mapping[str, float | str],
    sheet: _Sheet,
    pairs: int,
    flux: float,
    rated: float,
    cells: int,
) -> None:
    """Write iron-loss resistance and friction."""
    volts = _number(known, "at_volt") or defaults.CELL_NOMINAL_V * cells
    speed = _number(known, "no_load_rpm") or (
        volts / (math.sqrt(3.0) * flux * pairs) * 30.0 / math.pi
    )
    current = _number(known, "no_load_current")
    if current is not None:
        loss, source = volts * current, f"80 % of {volts:g} V {current:g} A at {speed:.4g} r/min"
    else:
        loss = NO_LOAD_SHARE * rated * speed * math.pi / 30.0
        source = "no-load loss 3.5 % of rated power; half of it costs up to 1.1 %"
    guessed = current is None
    resistance, friction = no_load(loss, speed, pairs, flux)
    sheet.lines.append(
        f"motor.iron_loss_resistance_ohm = [{resistance:.5g}, 0.0]  #"
        f" {'estimated: ' if guessed else ''}{source}"
    )
    if guessed:
        sheet.estimated.append(f"motor.iron_loss_resistance_ohm = [{resistance:.5g}, 0]: {source}")
    sheet.add("motor.friction_torque_nm", friction, "the other 20 % of the no-load loss")


def _rest(known: Mapping[str, float | str], sheet: _Sheet, board: str, cells: int) -> None:
    """Write board, pack, vehicle and sensors."""
    if board != OWN_BOARD:
        sheet.add("inverter.board", board, "its header" if "board" in known else "proposed")
    sheet.add("battery.cells", cells, "in series", estimated="cells" not in known)
    if (capacity := _number(known, "capacity")) is not None:
        sheet.add("battery.capacity_ah", capacity, "label")
    sheet.add("vehicle.mass_kg", float(known["mass"]), "with driver")
    radius = float(known["wheel_diameter"]) / 2.0
    gear = _number(known, "gear_ratio")
    divided = "" if gear is None else f" / gear ratio of {gear:g}"
    sheet.add("vehicle.wheel_radius_m", radius / (gear or 1.0), f"diameter / 2{divided}")
    if (wheels := _number(known, "wheels")) is not None:
        sheet.add("vehicle.driven_wheels", wheels, "motors on one battery")
    if (hydraulic := _number(known, "hydraulic_torque")) is not None:
        sheet.add("brake.max_hydraulic_torque_nm", hydraulic, "of each driven wheel")
    sheet.add("rotor.sensor", str(known["rotor_sensor"]), "edges: regen_table calibrate")
    if (sensor := str(known["winding_sensor"])) != "ntc":
        how = "temperature estimated" if sensor == "none" else "in the motor"
        sheet.add("monitor.winding_sensor", sensor, how)


def proposed_board(rated_peak_a: float, cells: int, but: Collection[str] = ()) -> str:
    """Return the first board that stands the pack and carries the rated current, or "own"."""
    for board in _by_size():
        carried = board.current_most_a / defaults.OVERCURRENT_MARGIN
        if board.name in but:
            continue
        if cells * defaults.CELL_FULL_V <= board.voltage_most_v and rated_peak_a <= carried:
            return board.name
    return OWN_BOARD


def _by_size() -> Iterator[boards.Board]:
    """Return the boards, the smallest and those with shunts in the phases first."""
    shipped = (board for board in boards.known().values() if board.name != boards.DESCRIPTION)
    yield from sorted(
        shipped,
        key=lambda board: (board.voltage_most_v, board.settled_s is not None, board.name),
    )


def _why(board: str, refused: Collection[str]) -> str:
    others = f"; not {', '.join(refused)}: --board says why" if refused else ""
    if board == OWN_BOARD:
        other = "other " if refused else ""
        return (
            f"no {other}board with a header stands this pack and current; a bridge of one's own,"
            f" such as {boards.DESCRIPTION} describes{others}"
        )
    return f"the smallest that stands the pack and carries the rated current{others}"
