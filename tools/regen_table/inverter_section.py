# SPDX-License-Identifier: Apache-2.0
"""The bridge with its current and voltage measurement, and what it loses."""

from typing import Annotated

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, number

OffsetCode = Annotated[float, number(0.0, 4095.0, "1", "a code of the 12-bit converter")]


class Inverter(Section):
    """A two-level bridge of MOSFETs (or resistive switches) and its measuring ranges."""

    board: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=40,
            description="one with a header in hal/PORT/boards: what its keys are assumed from;"
            " absent: a board of one's own",
        ),
    ] = None
    switch_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "one switch, conducting"),
        Assumed(defaults.switch_resistance, "adds to the winding's: 10 % of both, 0.1 to 1.4 %"),
    ]
    diode_forward_voltage_v: Annotated[
        float,
        number(0.0, 10.0, "V", "diode drop at zero current"),
        Assumed(defaults.diode_forward_voltage, "acts in the dead times alone"),
    ]
    diode_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "slope of the diode drop"),
        Assumed(defaults.diode_resistance, "acts in the dead times alone"),
    ]
    dead_time_s: Annotated[
        float,
        number(0.0, 1e-5, "s", "between the two switches of a leg"),
        Assumed(
            defaults.dead_time,
            "twice: up to 0.7 %; 3 to 12 % near the largest speed and on an empty pack, where the"
            " EMF needs the voltage of which it takes 10 t_d f (DERIVATIONS, Dead time)",
        ),
    ]
    pwm_frequency_hz: Annotated[
        float,
        number(4e3, 1e5, "Hz", "rate of the current loop"),
        Assumed(defaults.pwm_frequency, "switching losses in proportion: twice, up to 0.8 %"),
    ]
    turn_on_loss_j_per_a: Annotated[
        float,
        number(0.0, 0.1, "J/A", "k_on of the paper's (12)"),
        Assumed(defaults.switching_loss, "twice: up to 0.8 %"),
    ]
    turn_off_loss_j_per_a: Annotated[
        float,
        number(0.0, 0.1, "J/A", "k_off of the paper's (12)"),
        Assumed(defaults.switching_loss, "twice: up to 0.8 %"),
    ]
    current_full_scale_a: Annotated[
        float,
        number(1.0, 4000.0, "A", "what half the converter's range stands for"),
        Assumed(defaults.current_full_scale, "every torque in proportion: measure it"),
    ]
    voltage_full_scale_v: Annotated[
        float,
        number(5.0, 2000.0, "V", "what the converter's whole range stands for"),
        Assumed(defaults.voltage_full_scale, "every voltage in proportion: measure it"),
    ]
    pwm_timer_clock_hz: Annotated[
        int,
        number(1_000_000, 1_000_000_000, "Hz", "to its counts the voltage limit is rounded"),
        Assumed(defaults.timer_clock, "the board's start refuses another"),
    ] = 168_000_000
    min_pulse_s: Annotated[
        float | None,
        number(
            0.0,
            2e-5,
            "s",
            "what the low side conducts at least before the top of the count; absent: max(1 us, 2"
            " dead times)",
        ),
        Assumed(defaults.min_pulse, "wrong currents at full voltage"),
    ] = None
    max_switch_temperature_c: Annotated[
        float | None,
        number(40.0, 250.0, "degC", "no torque beyond, below it derating; absent: not watched"),
        Assumed(defaults.max_switch_temperature, "torque lost early, or a hot bridge"),
    ] = None
    derate_switch_temperature_c: Annotated[
        float | None,
        number(0.0, 250.0, "degC", "derating starts; absent: 20 K below max_switch_temperature_c"),
    ] = None
    device_voltage_v: Annotated[
        float | None,
        number(
            1.0,
            2000.0,
            "V",
            "rating of switches and capacitors; absent: the over-voltage trip, which leaves no"
            " room above it",
        ),
    ] = None
    bus_capacitance_f: Annotated[
        float,
        number(
            0.0,
            1.0,
            "F",
            "of this inverter's bus capacitors; 0: unknown, a short circuit ends only without"
            " current",
        ),
    ] = 0.0
    current_offset_codes: Annotated[
        tuple[OffsetCode, OffsetCode, OffsetCode],
        Field(
            strict=False,
            description=(
                "zero-current codes of the three current sensors, for a start on a wheel too fast"
                " to measure them"
            ),
        ),
    ] = (2048.0, 2048.0, 2048.0)
