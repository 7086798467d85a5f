# SPDX-License-Identifier: Apache-2.0
"""Every quantity that a configuration can command or permit fits its signal on CAN."""

from collections.abc import Callable
from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database
from regen_table import derived, layout, section
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

DBC = Path(__file__).resolve().parents[4] / "firmware" / "comms" / "hubfoc.dbc"
MILLI = 1000
TORQUE = ("motor.max_torque_mNm", "motor.rated_torque_mNm")
TEMPERATURES = ("monitor.lowest_temperature_cC", "monitor.highest_temperature_cC")
# Signal: the fields whose value it may have to carry, and how many of their unit are one of its.
# A pack's current is that of all driven wheels.
CARRIES: dict[str, tuple[tuple[str, ...], float]] = {
    "Demand.drive_torque_nm": (
        (*TORQUE, "pedals.drive_torque_mNm", "pedals.lift_off_torque_mNm"),
        MILLI,
    ),
    "Demand.brake_torque_nm": (
        ("pedals.brake_torque_mNm", "pedals.free_travel_torque_mNm"),
        MILLI,
    ),
    "HydraulicFeedback.measured_torque_nm": (("brake.max_hydraulic_torque_mNm",), MILLI),
    "BatteryLimits.charge_current_a": (("battery.max_charge_current_mA",), MILLI / 16),
    "BatteryLimits.discharge_current_a": (("battery.max_discharge_current_mA",), MILLI / 16),
    "WheelState.motor_torque_estimate_nm": (TORQUE, MILLI),
    "WheelState.speed_rad_s": (("motor.max_speed_mrad_s",), MILLI),
    "WheelBrake.hydraulic_torque_nm": (
        ("brake.max_hydraulic_torque_mNm", "driver.hold_torque_mNm"),
        MILLI,
    ),
    "WheelBrake.electric_brake_available_nm": (TORQUE, MILLI),
    "WheelDrive.motor_torque_command_nm": (TORQUE, MILLI),
    "WheelDrive.current_q_a": (("motor.max_phase_current_mA",), MILLI),
    "WheelPower.bus_voltage_v": (
        ("drive.voltage_full_scale_mV", "battery.overvoltage_trip_mV"),
        MILLI,
    ),
    "WheelPower.bus_current_a": (
        ("battery.max_charge_current_mA", "battery.max_discharge_current_mA"),
        MILLI,
    ),
    "WheelPower.motor_torque_uncertainty_nm": (TORQUE, MILLI),
    "WheelHealth.winding_temperature_c": (TEMPERATURES, 100),
    "WheelHealth.switch_temperature_c": (TEMPERATURES, 100),
    "WheelAhead.electric_brake_ahead_nm": (TORQUE, MILLI),
    "WheelAhead.drive_ahead_nm": (TORQUE, MILLI),
    "WheelAvailable.drive_available_nm": (TORQUE, MILLI),
}
# Limited or left out by its sender, whose message may say less than there is.
SENDERS_OWN = {
    "Demand.abs_motor_share_percent",
    "BatteryPeak.charge_peak_current_a",
    "BatteryPeak.pack_voltage_v",
    "BatteryPeak.pack_current_a",
    *(f"WheelEnergy.{name}_wh" for name in ("drawn", "returned", "life_drawn", "life_returned")),
    *("WheelEnergy.friction_percent", "WheelEnergy.life_friction_percent"),
}


@pytest.fixture(scope="module")
def database() -> Database:
    found = cantools.database.load_file(str(DBC), strict=True)
    assert isinstance(found, Database)
    return found


def test_every_quantity_on_can_is_compared_with_the_configuration(database: Database) -> None:
    quantities = {
        f"{message.name}.{signal.name}"
        for message in database.messages
        for signal in message.signals
        if signal.unit
    }
    assert quantities == set(CARRIES) | SENDERS_OWN


@pytest.mark.parametrize("name", CARRIES)
def test_no_accepted_field_lies_beyond_the_signal_that_carries_it(
    name: str, database: Database
) -> None:
    message, signal = name.split(".")
    found = database.get_message_by_name(message).get_signal_by_name(signal)
    assert found.minimum is not None and found.maximum is not None
    fields, per_unit = CARRIES[name]
    for field in fields:
        section, key = field.split(".")
        info = layout.load().sections[section][key]
        assert info.highest <= found.maximum * per_unit + 1e-6, field
        assert info.lowest >= found.minimum * per_unit - 1e-6, field


@pytest.mark.parametrize(
    ("key", "end", "signal"),
    [
        ("motor.max_torque_nm", section.DEMANDED_DRIVE_NM, "Demand.drive_torque_nm"),
        ("motor.rated_torque_nm", section.DEMANDED_DRIVE_NM, "Demand.drive_torque_nm"),
        ("pedals.drive_torque_nm", section.DEMANDED_DRIVE_NM, "Demand.drive_torque_nm"),
        ("pedals.lift_off_torque_nm", section.DEMANDED_DRIVE_NM, "Demand.drive_torque_nm"),
        ("pedals.brake_torque_nm", section.DEMANDED_BRAKE_NM, "Demand.brake_torque_nm"),
        (
            "pedals.free_travel_torque_nm",
            section.DEMANDED_BRAKE_NM,
            "Demand.brake_torque_nm",
        ),
        (
            "brake.max_hydraulic_torque_nm",
            section.COMMANDED_HYDRAULIC_NM,
            "WheelBrake.hydraulic_torque_nm",
        ),
        (
            "driver.hold_torque_nm",
            section.COMMANDED_HYDRAULIC_NM,
            "WheelBrake.hydraulic_torque_nm",
        ),
    ],
)
def test_a_torque_beyond_its_signal_is_refused_with_key_range_and_signal(
    key: str, end: float, signal: str, change: Callable[..., Drive], database: Database
) -> None:
    message, name = signal.split(".")
    assert database.get_message_by_name(message).get_signal_by_name(name).maximum == end
    with pytest.raises(ConfigurationError) as caught:
        change({key: end + 0.1})
    line = str(caught.value)
    assert line.startswith(f"changed.toml: {key}: ")
    assert line.endswith(f" to {end:g} N m, carried on CAN by {signal}")


def test_a_brake_pedal_that_is_not_scaled_stays_within_what_a_demand_carries(
    change: Callable[..., Drive],
) -> None:
    drive: Drive = change({"brake.max_hydraulic_torque_nm": section.COMMANDED_HYDRAULIC_NM})
    assert derived.pedal_brake_torque_nm(drive) == section.DEMANDED_BRAKE_NM
