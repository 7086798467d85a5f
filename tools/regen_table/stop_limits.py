# SPDX-License-Identifier: Apache-2.0
"""What the limits of a drive's file leave an ideal stop, each by its name (STOP_LIMITS)."""

import math
from collections.abc import Collection

import numpy as np

from regen_table import braking, derived, loops
from regen_table.models import Array
from regen_table.schema import Drive

WHOLE = 1.0


def largest_voltage_v(drive: Drive, omega_rad_s: Array, bus_v: Array) -> Array:
    """Return the largest mean phase voltage (peak, V) of the limit ``voltage``.

    The bridge's vector stands still for a PWM period T while the rotor turns by omega T, so its
    mean in the rotor's frame is shorter by sin(x)/x, x = omega T / 2.
    """
    control = drive.control
    reserve = (
        control.modulation_target / 128.0
        if control.modulation_reserve is None
        else control.modulation_reserve
    )
    share = loops.modulation_limit(drive) * (control.modulation_target - reserve) / math.sqrt(3.0)
    turned = 0.5 * omega_rad_s / drive.inverter.pwm_frequency_hz
    return np.asarray(share * bus_v * np.sinc(turned / np.pi))


def derated_share(drive: Drive, temperature_c: float) -> float:
    """Return what winding temperature leaves of the largest torque, 0 to 1."""
    begin, end = derived.derate_winding_temperature_c(drive), drive.motor.max_winding_temperature_c
    if temperature_c <= begin:
        return WHOLE
    return max((end - temperature_c) / (end - begin), 0.0) if end > begin else 0.0


def bounds(
    drive: Drive,
    strategy: str,
    demand_nm: Array,
    speed: Array,
    temperature_c: float,
    limits: Collection[str],
) -> dict[str, Array]:
    """Bounds of the motor's braking torque at the shaft, N m, that do not ask for a current."""
    most, rated = drive.motor.max_torque_nm, drive.brake.electric_rated_torque_nm
    share = np.ones_like(speed)
    if "blend_out" in limits:
        start, end = (
            rpm * math.pi / 30.0
            for rpm in (drive.control.handover_start_rpm, drive.control.handover_end_rpm)
        )
        share = np.clip((speed - end) / max(start - end, 1e-9), 0.0, 1.0)
    series = strategy == "series_optimal"
    faded = np.where(share < WHOLE, share * (most if series else rated), np.inf)
    part = drive.brake.parallel_electric_share * demand_nm * share
    found = {
        "demand": demand_nm,
        "max_torque_or_power": braking.torque_limit_nm(drive, speed),
        "strategy": {
            "parallel_ratio": np.minimum(part, rated),
            "parallel_free_travel": np.full_like(speed, rated),
        }.get(strategy, np.full_like(speed, np.inf)),
        "blend_out": faded,
    }
    if "winding_temperature" in limits:
        left = derated_share(drive, temperature_c)
        found["winding_temperature"] = np.full_like(speed, left * most if left < WHOLE else np.inf)
    return found


def largest_charge_a(
    drive: Drive, soc: float, source: tuple[float, float, float], limits: Collection[str]
) -> tuple[float, str]:
    """Return the largest charge current of the whole pack in A, and which limit it is.

    ``source``: open-circuit voltage, voltage and resistance behind the terminals for this step.
    Fold-back: q = most (max_voltage - v) / width with v = open_v + R q.
    """
    pack, bms = drive.battery, drive.bms
    cells_v, open_v, ohm = source
    found = [(math.inf, "")]
    if "charge_current" in limits:
        by_charge = (1.0 - soc) / bms.fade_soc if bms.fade_soc > 0.0 else float(soc < 1.0)
        warm = 1.0
        if bms.cold_charge_c is not None:
            coldest, full = bms.cold_charge_c
            warm = min(max((bms.temperature_c - coldest) / (full - coldest), 0.0), 1.0)
        found.append((pack.max_charge_current_a * min(by_charge, 1.0) * warm, "charge_current"))
        if bms.keep_voltage:
            settled = pack.series_resistance_ohm + pack.polarisation_resistance_ohm
            found.append(((pack.max_voltage_v - cells_v) / settled, "charge_current"))
    if "fold_back" in limits:
        width = pack.max_voltage_v - derived.foldback_voltage_v(drive)
        most = pack.max_charge_current_a
        line = most * (pack.max_voltage_v - open_v) / max(width + most * ohm, 1e-12)
        found.append((line if line < most else math.inf, "fold_back"))
    return min(found)
