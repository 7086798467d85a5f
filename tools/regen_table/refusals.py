# SPDX-License-Identifier: Apache-2.0
"""Everything that refuses a drive as a whole, each as one line with the user's own key.

``relations`` compares keys with each other; here stand the consequences of several keys for the
firmware's number formats, with the value of one key that would do. Scalar arithmetic alone, as in
``relations``.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from regen_table import derived, envelope, loops, relations
from regen_table.envelope import Proof
from regen_table.errors import ConfigurationError
from regen_table.sections import Drive, range_of

SCANNED = 80  # values of a key between the present one and the end of its range
HALVINGS = 40
DIGITS = 4
ROUNDING_SHARE = 0.98  # of a bandwidth at the end of a number format
KEYS_MAX = 8  # of one answer about number formats


def mistakes(drive: Drive) -> list[str]:
    """Return one line "section.key: what, accepted" for everything that refuses the drive.

    One a key: the first that is wrong with it.
    """
    found = relations.mistakes(drive)
    for check in (_pwm_frequency, _currents, _wheel_share, _voltages):
        found += check(drive)
    if not found:
        found = _formats(drive)
    first: dict[str, str] = {}
    for line in found:
        first.setdefault(line.partition(":")[0], line)
    return list(first.values())


def refuse(drive: Drive) -> None:
    """Raise ConfigurationError with all lines of mistakes()."""
    found = mistakes(drive)
    if found:
        raise ConfigurationError("\n".join(found))


def _pwm_frequency(drive: Drive) -> Iterator[str]:
    inverter, (least, most) = drive.inverter, loops.PERIOD_COUNTS
    lowest, highest = (inverter.pwm_timer_clock_hz / (2.0 * n) for n in (most, least))
    if not lowest <= inverter.pwm_frequency_hz <= highest:
        yield (
            f"inverter.pwm_frequency_hz: {inverter.pwm_frequency_hz:g} Hz, accepted:"
            f" {math.ceil(lowest)} to {math.floor(highest)} Hz from a timer of"
            f" {inverter.pwm_timer_clock_hz:g} Hz"
        )


def _currents(drive: Drive) -> Iterator[str]:
    full, wanted = drive.inverter.current_full_scale_a, drive.monitor.overcurrent_a
    largest, trip = drive.motor.max_phase_current_a / full, loops.overcurrent_pu(drive)
    seen = loops.overcurrent_share_max(drive)
    if wanted is not None and trip < 1.05 * largest <= seen:
        yield (
            f"monitor.overcurrent_a: {wanted:g} A, accepted: at least {1.05 * largest * full:.6g}"
            f" A, 5 % above motor.max_phase_current_a = {drive.motor.max_phase_current_a:g} A"
        )
    elif trip < 1.05 * largest:
        yield (
            f"motor.max_phase_current_a: {drive.motor.max_phase_current_a:g} A, accepted: at most"
            f" {trip / 1.05 * full:.4g} A, 5 % below the overcurrent trip, which lies inside"
            f" inverter.current_full_scale_a = {full:g} A"
        )
    if wanted is not None and trip > seen:
        yield (
            f"monitor.overcurrent_a: {wanted:g} A, accepted: at most {seen * full:.4g} A, what a"
            " sensor shows of"
            f" inverter.current_full_scale_a = {full:g} A whose zero is off by"
            f" monitor.offset_tolerance_codes = {drive.monitor.offset_tolerance_codes}"
        )


def _wheel_share(drive: Drive) -> Iterator[str]:
    motors = 1.0 / derived.pack_share(drive)
    for key, (lowest, highest) in {
        "max_charge_current_a": (0.0, 2000.0),
        "max_discharge_current_a": (0.1, 2000.0),
        "series_resistance_ohm": (0.0, 100.0),
    }.items():
        share = motors if key == "series_resistance_ohm" else 1.0 / motors
        value: float = getattr(drive.battery, key)
        least, most = lowest / share, highest / share
        unit = range_of(f"battery.{key}")[0]
        if not least <= value <= most:
            end = f"at least {least:g}" if value < least else f"at most {most:g}"
            yield (
                f"battery.{key}: {value:g} {unit} for {motors:g} driven wheels, accepted: {end}"
                f" {unit}"
            )


def _voltages(drive: Drive) -> Iterator[str]:
    battery, foldback = drive.battery, derived.foldback_voltage_v(drive)
    seen = drive.monitor.overvoltage_v is None
    if seen and derived.overvoltage_trip_v(drive) <= battery.max_voltage_v:
        yield (
            f"inverter.voltage_full_scale_v: {drive.inverter.voltage_full_scale_v:g} V, accepted:"
            f" more than {battery.max_voltage_v / 0.98:.4g} V, so that the board can see"
            " battery.max_voltage_v being exceeded"
        )
    if battery.charge_foldback_voltage_v is None and battery.min_voltage_v >= foldback:
        yield (
            f"battery.min_voltage_v: {battery.min_voltage_v:g} V, accepted: less than"
            f" {foldback:.4g} V, where charging starts to fold back"
        )


# ---- number formats ----


def with_fitting_bandwidth(drive: Drive) -> Drive:
    """Return a drive whose current loop was not given with one that fits its number formats.

    A little below the fastest that does: the firmware judges gains that are rounded. Where slower
    ones soon do not fit either, in the middle of those that do.
    """
    name = "control.current_bandwidth_hz"
    if relations.mistakes(drive) or _fits(drive):
        return drive
    beyond = {proof.quantity for proof in envelope.proofs(drive) if not proof.holds}

    def none_beyond(other: Drive) -> bool:
        failed = (proof.quantity for proof in envelope.proofs(other) if not proof.holds)
        return beyond.isdisjoint(failed) and not relations.mistakes(other)

    enough = _nearest_good(drive, name, range_of(name)[1], none_beyond)
    if enough is None or not _fits(with_value(drive, name, enough)):
        return drive
    slower = ROUNDING_SHARE * enough
    if not _fits(with_value(drive, name, slower)):
        slower = math.sqrt(enough * _last_good(drive, name, enough, slower, _fits))
    return with_value(drive, name, slower)


def _formats(drive: Drive) -> list[str]:
    """Return one line where one key mends all quantities beyond their formats.

    Else one for each of several keys, which together do.
    """
    broken = [proof for proof in envelope.proofs(drive) if not proof.holds]
    if not broken:
        return []
    keys = [change for proof in broken for change in proof.remedy]
    mended = _mended(drive, broken[0], keys, _fits)
    if mended is not None:
        return [mended.line]
    lines: dict[str, str] = {}
    while broken and len(lines) < KEYS_MAX:
        left = [change for change in broken[0].remedy if change.split()[1] not in lines]
        mended = _mended(drive, broken[0], left, _holds(broken[0].quantity))
        if mended is None:
            lines.setdefault("", _unmended(drive, broken[0]))
            break
        lines[mended.name], drive = mended.line, mended.drive
        broken = [proof for proof in envelope.proofs(drive) if not proof.holds]
    return list(lines.values())


@dataclass(frozen=True)
class _Mended:
    """A key with a value that would do, the answer about it, and the drive with it."""

    name: str
    line: str
    drive: Drive


def _fits(drive: Drive) -> bool:
    return not relations.mistakes(drive) and all(proof.holds for proof in envelope.proofs(drive))


def _holds(quantity: str) -> Callable[[Drive], bool]:
    def holds(drive: Drive) -> bool:
        found = [proof for proof in envelope.proofs(drive) if proof.quantity == quantity]
        return bool(found) and found[0].holds and not relations.mistakes(drive)

    return holds


def _own_first(drive: Drive, changes: Sequence[str]) -> list[str]:
    """Return the changes, those of keys that the file gives first."""

    def given(change: str) -> bool:
        section, key = change.split()[1].split(".")
        return key in getattr(drive, section).model_fields_set

    return sorted(dict.fromkeys(changes), key=lambda change: not given(change))


def _mended(
    drive: Drive, proof: Proof, changes: Sequence[str], good: Callable[[Drive], bool]
) -> _Mended | None:
    """Return the first key of which some value is good."""
    for change in _own_first(drive, changes):
        direction, name = change.split()
        value = _value(drive, name)
        if value is None:
            continue
        unit, lowest, highest = range_of(name)
        enough = _nearest_good(drive, name, highest if direction == "raise" else lowest, good)
        if enough is not None:
            most = "at most" if enough < value else "at least"
            line = (
                f"{name}: {value:g} {unit}, accepted: {most} {enough:.6g} {unit}; beyond,"
                f" {proof.consequence}"
            )
            return _Mended(name, line, with_value(drive, name, enough))
    return None


def _unmended(drive: Drive, proof: Proof) -> str:
    names = [change.split()[1] for change in _own_first(drive, proof.remedy)]
    value, (unit, *_) = _value(drive, names[0]), range_of(names[0])
    shown = "absent" if value is None else f"{value:g} {unit}"
    others = " and ".join(names[1:])
    return (
        f"{names[0]}: {shown}, accepted: no value of this key alone, but with {others}:"
        f" {proof.consequence}"
    )


def _value(drive: Drive, name: str) -> float | None:
    section, key = name.split(".")
    value: float | None = getattr(getattr(drive, section), key)
    return value


def with_value(drive: Drive, name: str, value: float) -> Drive:
    """Return the drive with another value of "section.key"."""
    section, key = name.split(".")
    changed = getattr(drive, section).model_copy(update={key: value})
    return drive.model_copy(update={section: changed})


def _nearest_good(
    drive: Drive, name: str, end: float, good: Callable[[Drive], bool]
) -> float | None:
    """Return the value nearest to the present one that is good, rounded towards the end."""
    value = _value(drive, name)
    assert value is not None
    if value <= 0.0 or end == value:
        return None
    end = max(end, 1e-3 * value)
    steps = [value * (end / value) ** (k / SCANNED) for k in range(1, SCANNED + 1)]
    bad = value
    for step in steps:
        if not good(with_value(drive, name, step)):
            bad = step
            continue
        rounded = _rounded(_last_good(drive, name, step, bad, good), end < value)
        return rounded if good(with_value(drive, name, rounded)) else None
    return None


def _last_good(
    drive: Drive, name: str, enough: float, bad: float, good: Callable[[Drive], bool]
) -> float:
    """Return the good value next to the bad ones, between one that is good and one that is not."""
    for _ in range(HALVINGS):
        middle = math.sqrt(bad * enough)
        if good(with_value(drive, name, middle)):
            enough = middle
        else:
            bad = middle
    return enough


def _rounded(value: float, down: bool) -> float:
    """Return the value with four digits, away from the bad side."""
    unit = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return (math.floor if down else math.ceil)(value / unit) * unit
