# SPDX-License-Identifier: Apache-2.0
"""What the independent monitor tolerates, and for how long; every key has a default."""

from typing import Annotated, Literal

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, Temperature, number

Resistance = Annotated[float, number(0.1, 10e6, "ohm", "a resistance")]
SensorPoint = Annotated[tuple[Temperature, Resistance], Field(strict=False)]


class Monitor(Section):
    """Trips, tolerances, qualify and heal times."""

    overcurrent_a: Annotated[
        float | None,
        number(
            0.1,
            4000.0,
            "A",
            "length of the current vector that trips; absent: 1.3 times max_phase_current_a, within"
            " the converter's range",
        ),
    ] = None
    overcurrent_periods: Annotated[
        int, number(1, 16, "1", "PWM periods in a row that an over-current takes")
    ] = 2
    overvoltage_v: Annotated[
        float | None,
        number(
            1.0,
            2000.0,
            "V",
            "bus voltage that trips; absent: 5 % above max_voltage_v, within 98 % of"
            " voltage_full_scale_v",
        ),
    ] = None
    undervoltage_v: Annotated[
        float | None,
        number(
            0.5,
            2000.0,
            "V",
            "bus voltage that trips while switching; absent: 10 % below min_voltage_v",
        ),
    ] = None
    current_sum_a: Annotated[
        float | None,
        number(
            0.01,
            4000.0,
            "A",
            "largest |i_a + i_b + i_c|; absent: 5 % of current_full_scale_a and what the sensors'"
            " noise adds",
        ),
    ] = None
    current_dead_periods: Annotated[
        int, number(2, 16, "1", "PWM periods after which a current that vanished is a dead sensor")
    ] = 2
    current_missing_as: Annotated[
        float | None,
        number(
            1e-6,
            100.0,
            "A s",
            "current demanded times time in which the sensors show none; absent: 60 ms times one"
            " and a half codes, or what a disturbance or the dead time takes if that is longer",
        ),
    ] = None
    offset_tolerance_codes: Annotated[
        int,
        number(1, 1024, "1", "a current sensor's zero from the middle of its range"),
        Assumed(defaults.offset_tolerance, "a start that is refused"),
    ] = 200
    torque_tolerance_nm: Annotated[
        float | None,
        number(
            0.001,
            1000.0,
            "N m",
            "more torque than commanded; absent: 10 % of max_torque_nm, at least 0.5 N m",
        ),
    ] = None
    torque_fault_time_s: Annotated[
        float, number(0.001, 1.0, "s", "how long the torque may be wrong")
    ] = 0.05
    sensor_fault_time_s: Annotated[
        float,
        number(0.001, 1.0, "s", "of current sum, saturated current sensor and temperature"),
    ] = 0.02
    voltage_fault_time_s: Annotated[
        float,
        number(
            0.001, 1.0, "s", "a bus below its trip is a fault after it and battery_message_time_s"
        ),
    ] = 0.005
    rotor_fault_time_s: Annotated[
        float, number(0.001, 10.0, "s", "of an invalid rotor angle, once the torque is zero")
    ] = 0.25
    angle_fault_time_s: Annotated[
        float, number(0.008, 1.0, "s", "of an angle that contradicts the back-EMF")
    ] = 0.02
    rotor_warning_time_s: Annotated[
        float, number(0.001, 60.0, "s", "heal time of the rotor sensor's warning, and so of LIMP")
    ] = 10.0
    battery_message_time_s: Annotated[
        float,
        number(
            0.005,
            10.0,
            "s",
            "a bus beyond a trip waits this long for the message that the battery is disconnected"
            " before it is a fault",
        ),
    ] = 0.3
    diode_fault_time_s: Annotated[
        float, number(0.001, 1.0, "s", "of a diode current in freewheel")
    ] = 0.02
    overtemperature_margin_k: Annotated[
        float,
        number(0.0, 50.0, "K", "above the end of the derating, where a temperature is a fault"),
    ] = 10.0
    lowest_temperature_c: Annotated[
        float, number(-200.0, 0.0, "degC", "below it a temperature sensor counts as broken")
    ] = -60.0
    highest_temperature_c: Annotated[
        float, number(100.0, 299.98, "degC", "above it a temperature sensor counts as broken")
    ] = 290.0
    tyre_grip_m_per_s2: Annotated[
        float,
        number(1.0, 20.0, "m/s2", "largest deceleration of the vehicle, for the speed upper bound"),
    ] = 11.768
    coasting_m_per_s2: Annotated[
        float,
        number(0.001, 2.0, "m/s2", "smallest deceleration of the coasting vehicle, likewise"),
    ] = 0.098
    standstill_rpm: Annotated[
        float, number(0.1, 47.0, "r/min", "below it the wheel counts as at standstill")
    ] = 2.865
    short_release_share: Annotated[
        float,
        number(
            0.5,
            0.999,
            "1",
            "of the speed where it begins, below which an active short circuit ends",
        ),
    ] = 0.9
    winding_sensor: Annotated[
        Literal["ntc", "kty84", "pt1000", "table", "none"],
        Field(description="none: the controller estimates the winding's temperature alone"),
    ] = "ntc"
    winding_sensor_ohm_25c: Annotated[float, number(10.0, 1e6, "ohm", "of an ntc at 25 degC")] = (
        10e3
    )
    winding_sensor_beta_k: Annotated[float, number(500.0, 10e3, "K", "B of an ntc")] = 3380.0
    winding_sensor_points: Annotated[
        tuple[SensorPoint, ...] | None,
        Field(
            strict=False, min_length=2, description="of a table: [degC, ohm], temperature rising"
        ),
    ] = None
    winding_sensor_divider_ohm: Annotated[
        float, number(10.0, 1e6, "ohm", "the board's resistor in series")
    ] = 10e3
    winding_sensor_to_supply: Annotated[
        bool, Field(description="the sensor hangs on the supply, its divider's resistor on ground")
    ] = False
    switch_sensor: Annotated[
        Literal["ntc", "kty84", "pt1000", "table", "none"],
        Field(description="none: likewise of the switches"),
    ] = "ntc"
    switch_sensor_ohm_25c: Annotated[float, number(10.0, 1e6, "ohm", "of an ntc at 25 degC")] = 10e3
    switch_sensor_beta_k: Annotated[
        float,
        number(500.0, 10e3, "K", "B of an ntc"),
        Assumed(defaults.switch_sensor_beta, "2 K at 100 degC for 3 %"),
    ] = 3380.0
    switch_sensor_points: Annotated[
        tuple[SensorPoint, ...] | None,
        Field(
            strict=False, min_length=2, description="of a table: [degC, ohm], temperature rising"
        ),
    ] = None
    switch_sensor_divider_ohm: Annotated[
        float,
        number(10.0, 1e6, "ohm", "the board's resistor in series"),
        Assumed(defaults.switch_sensor_divider, "all temperatures wrong"),
    ] = 10e3
    switch_sensor_to_supply: Annotated[
        bool, Field(description="the sensor hangs on the supply, its divider's resistor on ground")
    ] = True
    coldest_ambient_c: Annotated[
        float,
        number(-50.0, 50.0, "degC", "the controller's estimate never starts below it"),
    ] = 20.0
    warmest_ambient_c: Annotated[
        float,
        number(
            0.0,
            100.0,
            "degC",
            "the controller's estimate takes the warmest reading at the start for the ambient, at"
            " most this",
        ),
    ] = 40.0
    flux_tolerance: Annotated[
        float,
        number(
            0.02,
            1.0,
            "1",
            "the back-EMF differs this share, and its uncertainty, from the magnets': a warning",
        ),
    ] = 0.15
