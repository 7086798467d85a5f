# SPDX-License-Identifier: Apache-2.0
"""The binary image of config_t: from a checked drive to the bytes the firmware reads.

``fields(drive)`` computes every value, ``build(drive)`` packs them by field name into the layout of
config.h, within the ranges config.h accepts, and seals them with the CRC-32 that the firmware
checks in BOOT.
"""

import math
import zlib
from typing import Any

from regen_table import (
    STRATEGIES,
    __version__,
    current_audit,
    derived,
    layout,
    loops,
    mapped_tables,
    margins,
    models,
    refusals,
    stored_flux,
    thermometers,
)
from regen_table.errors import ConfigurationError
from regen_table.loops import nearest
from regen_table.schema import Drive

Values = dict[str, dict[str, int | list[int]]]
SWITCH_TEMPERATURE_OFF_CC = 30000
_WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
RPM_TO_MRAD_S = 1000.0 * 3.141592653589793 / 30.0
# Sections of the drive whose keys are passed on to fields of the same name (passed_on()).
_SOURCES = {
    "motor": ("motor",),
    "drive": ("inverter",),
    "battery": ("battery",),
    "brake": ("brake", "control"),
    "vehicle": ("vehicle",),
    "driver": ("driver",),
    "pedals": ("pedals",),
    "service": ("service",),
    "can": ("can",),
    "tolerance": ("tolerance",),
    "modes": ("control",),
    "monitor": ("monitor",),
    "thermal": ("thermal",),
}
# Unit of a field: that of the key, and how many of the field's are one of the key's.
_UNITS = {
    "Hz": ("hz", 1.0),
    "cC": ("c", 1e2),
    "g": ("kg", 1e3),
    "mA": ("a", 1e3),
    "mJ_K": ("j_per_k", 1e3),
    "mK_W": ("k_per_w", 1e3),
    "mNm": ("nm", 1e3),
    "mNm_s": ("nm_per_s", 1e3),
    "mV": ("v", 1e3),
    "mW": ("w", 1e3),
    "mm_s2": ("m_per_s2", 1e3),
    "mrad_s": ("rpm", RPM_TO_MRAD_S),
    "ms": ("s", 1e3),
    "nF": ("f", 1e9),
    "nH": ("h", 1e9),
    "nWb": ("wb", 1e9),
    "ns": ("s", 1e9),
    "permille": ("", 1e3),
    "ppm_K": ("per_k", 1e6),
    "q15": ("", 32768.0),
    "rad_q15": ("deg", 32768.0 * math.pi / 180.0),
    "uNm_s": ("nm_s", 1e6),
    "uOhm": ("ohm", 1e6),
    "um": ("m", 1e6),
}


def build(drive: Drive) -> bytes:
    """Return the image of a drive: what the firmware, the simulator and config_validate() accept.

    A drive whose loop has too little phase margin or whose quantities leave their number formats is
    refused.

    Raises
    ------
    ConfigurationError
        One line that names the field whose value the firmware could not take.
    """
    header = layout.load()
    image: Any = header.ffi.new("config_t *")
    image.magic = header.constants["CONFIG_MAGIC"]
    image.format_version = header.constants["CONFIG_FORMAT_VERSION"]
    image.size_bytes = header.size_bytes
    image.generator_version = generator_version()
    image.name = drive.name.encode("ascii")
    for section, values in checked_fields(drive).items():
        target = getattr(image, section)
        for name, value in values.items():
            if isinstance(value, list):
                getattr(target, name)[0 : len(value)] = value
            else:
                setattr(target, name, value)
    raw = bytes(header.ffi.buffer(image))
    body = raw[: header.ffi.offsetof("config_t", "crc32")]
    return body + zlib.crc32(body).to_bytes(4, "little") + raw[len(body) + 4 :]


def generator_version() -> int:
    """Return the package's version as 0x00MMmmpp."""
    major, minor, patch = (int(part) for part in __version__.split("."))
    return major << 16 | minor << 8 | patch


def checked_fields(drive: Drive) -> Values:
    """Return every field of every section in the header's order; refuse out-of-range values."""
    header, values = layout.load(), fields(drive)
    for (section, name), value in drive.fields.values().items():
        values[section][name] = value
    for section, known in header.sections.items():
        odd = set(known) ^ set(values.get(section, {}))
        if odd:
            raise ConfigurationError(
                f"config.h and this generator disagree about {section}.{min(odd)}: one of them is"
                " newer"
            )
        for name, info in known.items():
            value = values[section][name]
            for item in value if isinstance(value, list) else [value]:
                if not info.lowest <= item <= info.highest:
                    unit = f" {info.unit}" if info.unit not in {"", "1"} else ""
                    raise ConfigurationError(
                        f"{section}.{name}: {item}{unit} does not fit the controller, accepted:"
                        f" {info.lowest} to {info.highest}{unit}"
                    )
    return {
        section: {name: values[section][name] for name in known}
        for section, known in header.sections.items()
    }


def passed_on(section: str, drive: Drive) -> dict[str, Any]:
    """Return the fields of a section that are keys of the drive, in the unit of the field.

    ``rated_torque_mNm`` is the key ``rated_torque_nm``. A field that is computed from other keys,
    or from an absent one, stands in the function of its section, which counts.
    """
    sources = _SOURCES.get(section, ())
    keys = {key: value for name in sources for key, value in getattr(drive, name)}
    out: dict[str, Any] = {}
    for name in layout.load().sections[section]:
        for unit, (key_unit, factor) in _UNITS.items():
            if not name.endswith(f"_{unit}"):
                continue
            value = keys.get("_".join(filter(None, (name.removesuffix(f"_{unit}"), key_unit))))
            if isinstance(value, float):
                out[name] = loops.fixed(value, 15) if unit == "q15" else nearest(value * factor)
        if isinstance(keys.get(name), int):
            out[name] = int(keys[name])
    return out


def fields_named_after(key: str) -> list[str]:
    """Return the fields of config_t that are "section.key", passed on or computed in its place."""
    section, _, name = key.partition(".")
    return [
        f"{target}.{field}"
        for target, sources in _SOURCES.items()
        if section in sources
        for field in layout.load().sections[target]
        if field == name
        or any(
            field == "_".join(filter(None, (name.removesuffix(f"_{key_unit}"), unit)))
            for unit, (key_unit, _) in _UNITS.items()
            if not key_unit or name.endswith(f"_{key_unit}")
        )
    ]


def fields(drive: Drive) -> Values:
    """Compute every field of config_t, in the units its name ends in."""
    computed, bounding = _computed(drive), stored_flux.bounding(drive)
    return {
        section: passed_on(section, bounding) | computed.get(section, {})
        for section in layout.load().sections
    }


def _computed(drive: Drive) -> Values:
    """Return what is more than a key in another unit."""
    refusals.refuse(drive)
    margins.refuse_thin_margins(drive, margins.current_loop(drive))
    currents = mapped_tables.currents(drive, current_audit.choose(drive))
    table = mapped_tables.braking(drive, current_audit.braking_table(drive))
    flux, bounding = stored_flux.of(drive), stored_flux.bounding(drive)
    return {
        "motor": _motor(bounding),
        "drive": _drive(drive),
        "current_loop": dict(loops.current_loop(bounding)),
        "rotor": loops.rotor(drive),
        "battery": _battery(drive),
        "brake": _brake(drive),
        "vehicle": {"wheel_position": _WHEELS.index(drive.vehicle.wheel_position)},
        "driver": _driver(drive),
        "pedals": _pedals(drive),
        "monitor": _monitor(drive),
        "temperature": _temperature(drive),
        "regen_map": {
            "speed_points": table.torque_mNm.shape[1],
            "speed_step_log2": table.speed_step_log2,
            "temperature_points": table.torque_mNm.shape[0],
            "temperature_step_log2": table.temperature_step_log2,
            "temperature_origin_cC": table.temperature_origin_cC,
            "lsb_log2": table.lsb_log2,
            "torque_lsb": [int(value) >> table.lsb_log2 for value in table.torque_mNm.ravel()],
        },
        "current_map": {
            "torque_points": currents.current_d_mA.shape[2],
            "torque_step_log2": currents.torque_step_log2,
            "speed_points": currents.current_d_mA.shape[1],
            "speed_step_log2": currents.speed_step_log2,
            "temperature_points": currents.current_d_mA.shape[0],
            "temperature_step_log2": currents.temperature_step_log2,
            "temperature_origin_cC": currents.temperature_origin_cC,
            "lsb_log2": currents.lsb_log2,
            "current_d_lsb": [
                int(value) >> currents.lsb_log2 for value in currents.current_d_mA.ravel()
            ],
        },
        "flux_map": stored_flux.NONE if flux is None else flux.fields(),
    }


def _motor(drive: Drive) -> dict[str, Any]:
    motor = drive.motor
    a0, a1 = motor.iron_loss_resistance_ohm or (0.0, 0.0)
    return {
        "type": {"spmsm": 0, "ipmsm": 1}[motor.type],
        "resistance_coefficient_ppm_K": nearest(
            motor.resistance_temperature_coefficient_per_k * 1e6
        ),
        "flux_coefficient_ppm_K": nearest((motor.flux_temperature_coefficient_per_k or 0.0) * 1e6),
        "iron_loss_resistance_mOhm": nearest(a0 * 1e3),
        "iron_loss_resistance_slope_nOhm_s": nearest(a1 * 1e9),
        "derate_winding_temperature_cC": nearest(derived.derate_winding_temperature_c(drive) * 1e2),
    }


def _drive(drive: Drive) -> dict[str, Any]:
    inverter, bridge = drive.inverter, models.bridge(drive)
    start = derived.derate_switch_temperature_c(drive)
    hottest = inverter.max_switch_temperature_c
    return {
        "diode_drop_mV": nearest(inverter.diode_forward_voltage_v * 1e3),
        "min_pulse_ns": math.ceil(loops.min_pulse_s(drive) * 1e9 - 1e-3),
        "derate_switch_temperature_cC": (
            SWITCH_TEMPERATURE_OFF_CC if start is None else nearest(start * 1e2)
        ),
        "max_switch_temperature_cC": (
            SWITCH_TEMPERATURE_OFF_CC if hottest is None else nearest(hottest * 1e2)
        ),
        "device_voltage_mV": nearest(derived.device_voltage_v(drive) * 1e3),
        "loss_per_ampere_uW_A": nearest(bridge.linear_w_per_a * 1e6),
        "loss_resistance_uOhm": nearest(bridge.square_w_per_a2 / 1.5 * 1e6),
        **{
            f"offset_{phase}_q4": nearest(code * 16.0)
            for phase, code in zip("abc", inverter.current_offset_codes, strict=True)
        },
    }


def _battery(drive: Drive) -> dict[str, Any]:
    battery, trip = drive.battery, derived.overvoltage_trip_v(drive)
    motors = 1.0 / derived.pack_share(drive)  # like this one, of which the pack would feed so many
    foldback = derived.foldback_voltage_v(drive)
    return {
        "driven_wheels": drive.vehicle.driven_wheels,
        "pack_share_q15": math.floor((drive.vehicle.pack_share or 0.0) * 2**15),
        "max_charge_current_mA": nearest(battery.max_charge_current_a / motors * 1e3),
        "max_discharge_current_mA": nearest(battery.max_discharge_current_a / motors * 1e3),
        "foldback_voltage_mV": nearest(foldback * 1e3),
        "discharge_foldback_voltage_mV": nearest(derived.discharge_foldback_voltage_v(drive) * 1e3),
        "resistance_uOhm": nearest(battery.series_resistance_ohm * motors * 1e6),
        "overvoltage_trip_mV": nearest(trip * 1e3),
        "undervoltage_trip_mV": nearest(loops.undervoltage_trip_v(drive) * 1e3),
    }


def _brake(drive: Drive) -> dict[str, Any]:
    brake, control = drive.brake, drive.control
    growth_start, growth_end = control.torque_growth_voltage_use
    band = brake.shortfall_band_nm
    if band is None:
        band = 0.05 * drive.motor.max_torque_nm
    return {
        "strategy": STRATEGIES.index(brake.strategy),
        "hydraulic_tolerance_mNm": max(1, nearest(derived.hydraulic_tolerance_nm(drive) * 1e3)),
        "bridging_time_ms": nearest(derived.bridging_time_s(drive) * 1e3),
        "blend_out_start_mrad_s": nearest(control.handover_start_rpm * RPM_TO_MRAD_S),
        "blend_out_end_mrad_s": nearest(control.handover_end_rpm * RPM_TO_MRAD_S),
        "shortfall_band_mNm": max(1, nearest(band * 1e3)),
        "torque_growth_end_q15": loops.fixed(growth_end, 15),
        "torque_growth_slope_q9": loops.fixed(1.0 / (growth_end - growth_start), 9),
        "stop_lamp_filter_log2": nearest(math.log2(brake.stop_lamp_filter_s * 1e3)),
    }


def _within(torque_nm: float) -> int:
    """Return a torque in mN m, at most the end of the fields' range."""
    return min(nearest(torque_nm * 1e3), 20_000_000)


def _driver(drive: Drive) -> dict[str, Any]:
    driver = drive.driver
    turning = driver.direction_change_speed_m_per_s / drive.vehicle.wheel_radius_m
    return {
        "lost_hold_ms": nearest(driver.lost_demand_hold_s * 1e3),
        "direction_change_mrad_s": nearest(turning * 1e3),
        "hold_torque_mNm": nearest((driver.hold_torque_nm or 0.0) * 1e3),
        "largest_drive_mNm": _within(derived.largest_drive_torque_nm(drive)),
        "largest_brake_mNm": _within(derived.largest_brake_torque_nm(drive)),
    }


def _pedals(drive: Drive) -> dict[str, Any]:
    pedals = drive.pedals

    def shares(values: tuple[float, ...]) -> list[int]:
        return [nearest(value * 32768.0) for value in values]

    return {
        "interpretation": ("proportional", "free_travel").index(pedals.interpretation),
        "drive_torque_mNm": nearest(derived.pedal_drive_torque_nm(drive) * 1e3),
        "brake_torque_mNm": nearest(derived.pedal_brake_torque_nm(drive) * 1e3),
        "free_travel_torque_mNm": nearest(derived.free_travel_torque_nm(drive) * 1e3),
        "other_wheels": sum(1 << _WHEELS.index(wheel) for wheel in set(pedals.other_wheels)),
        "lowest_q15": shares(pedals.lowest),
        "highest_q15": shares(pedals.highest),
        "released_q15": shares(pedals.released),
        "pressed_q15": shares(pedals.pressed),
        "drive_share_q15": shares(pedals.drive_share),
        "brake_share_q15": shares(pedals.brake_share),
    }


def _monitor(drive: Drive) -> dict[str, Any]:
    monitor, full = drive.monitor, drive.inverter.current_full_scale_a
    # Three independent samples in the sum: four standard deviations of it, above 5 % of the range.
    noise = 4.0 * 3.0**0.5 * drive.sensors.current_noise_a / full
    summed = 0.05 + noise if monitor.current_sum_a is None else monitor.current_sum_a / full
    torque = monitor.torque_tolerance_nm
    if torque is None:
        torque = max(0.1 * drive.motor.max_torque_nm, 0.5)
    return {
        "current_missing_pu_q15": loops.fixed(loops.current_missing_ms(drive), 15),
        "overcurrent_pu_q15": loops.fixed(loops.overcurrent_pu(drive), 15),
        "current_sum_pu_q15": loops.fixed(summed, 15),
        "torque_tolerance_mNm": nearest(torque * 1e3),
        "overtemperature_margin_cC": nearest(monitor.overtemperature_margin_k * 1e2),
        "short_release_permille": nearest(monitor.short_release_share * 1e3),
        "winding_sensor_fitted": int(monitor.winding_sensor != "none"),
        "switch_sensor_fitted": int(monitor.switch_sensor != "none"),
    }


def _temperature(drive: Drive) -> dict[str, Any]:
    winding, switches = (
        thermometers.curve(thermometers.of_drive(drive, which)) for which in ("winding", "switch")
    )
    return {
        "winding_lowest_code": winding.lowest_code,
        "winding_highest_code": winding.highest_code,
        "switch_lowest_code": switches.lowest_code,
        "switch_highest_code": switches.highest_code,
        "winding_cC": list(winding.point_cc),
        "switch_cC": list(switches.point_cc),
    }
