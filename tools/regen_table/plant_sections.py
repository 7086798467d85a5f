# SPDX-License-Identifier: Apache-2.0
"""Sections of a drive that only the simulated plant reads."""

from typing import Annotated

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, Temperature, number


class Bus(Section):
    """What lies between pack and bridges.

    Read by the simulated plant only; absent: the bridges sit on the pack's terminals.
    """

    capacitance_f: Annotated[
        float, number(0.0, 1.0, "F", "of all bridges' capacitors together; 0: none")
    ] = 0.0
    cable_resistance_ohm: Annotated[
        float, number(0.0, 10.0, "ohm", "from the pack to the bus, both ways")
    ] = 0.0


class Bms(Section):
    """Limits sent by the battery management in addition to the pack's current limits.

    Read by the simulated plant only.
    """

    fade_soc: Annotated[
        float,
        number(0.0, 1.0, "1", "state of charge over which the limits fold back at both ends"),
    ] = 0.02
    keep_voltage: Annotated[
        bool,
        Field(description="true: limits also keep the settled voltage within the battery's ends"),
    ] = False
    temperature_c: Annotated[float, number(-60.0, 100.0, "degC", "of the cells")] = 25.0
    cold_charge_c: Annotated[
        tuple[Temperature, Temperature] | None,
        Field(
            strict=False,
            description=(
                "[no charge below, all charge from here on]; absent: cells are never too cold"
            ),
        ),
    ] = None
    period_s: Annotated[float, number(0.0, 10.0, "s", "of the message; 0: every millisecond")] = 0.0
    current_step_a: Annotated[
        float, number(0.0, 1e3, "A", "resolution of the message; 0: none")
    ] = 0.0


class Thermal(Section):
    """Heat of one motor and one inverter.

    The simulated plant warms up where a scenario lets it; the controller estimates both
    temperatures beside their sensors.
    """

    winding_heat_capacity_j_per_k: Annotated[
        float,
        number(0.0, 2e6, "J/K", "copper"),
        Assumed(defaults.winding_heat_capacity, "a warm-up that is estimated too fast or slow"),
    ] = 0.0
    winding_thermal_resistance_k_per_w: Annotated[
        float,
        number(0.0, 1e3, "K/W", "winding to housing; 0: insulated"),
        Assumed(defaults.winding_thermal_resistance, "derating early or late"),
    ] = 0.0
    housing_heat_capacity_j_per_k: Annotated[
        float,
        number(0.0, 2e6, "J/K", "iron and housing; 0: none"),
        Assumed(defaults.housing_heat_capacity, "a warm-up that is estimated too fast or slow"),
    ] = 0.0
    housing_thermal_resistance_k_per_w: Annotated[
        float,
        number(0.0, 1e3, "K/W", "housing to ambient; 0: insulated"),
        Assumed(defaults.housing_thermal_resistance, "derating early or late"),
    ] = 0.0
    switch_heat_capacity_j_per_k: Annotated[float, number(0.0, 2e6, "J/K", "all six switches")] = (
        0.0
    )
    switch_thermal_resistance_k_per_w: Annotated[
        float, number(0.0, 1e3, "K/W", "switches to heat sink; 0: insulated")
    ] = 0.0
    heatsink_heat_capacity_j_per_k: Annotated[float, number(0.0, 2e6, "J/K", "0: none")] = 0.0
    heatsink_thermal_resistance_k_per_w: Annotated[
        float, number(0.0, 1e3, "K/W", "heat sink to ambient; 0: insulated")
    ] = 0.0
    switch_resistance_temperature_coefficient_per_k: Annotated[
        float, number(0.0, 0.1, "1/K", "of switch_resistance_ohm, from 25 degC; 0: constant")
    ] = 0.0


class Chassis(Section):
    """Wheels and axles: for the simulated plant, where a scenario lets wheels slip."""

    wheel_inertia_kg_m2: Annotated[
        float,
        number(0.0, 1e3, "kg m2", "of one driven wheel and its rotor; part of the vehicle's mass"),
    ] = 0.0
    wheelbase_m: Annotated[
        float, number(0.0, 50.0, "m", "from axle to axle; 0: no load transfer")
    ] = 0.0
    centre_of_gravity_height_m: Annotated[float, number(0.0, 10.0, "m", "above the road")] = 0.0
    front_load_share: Annotated[
        float, number(0.0, 1.0, "1", "of the weight on the front axle, standing on the flat")
    ] = 0.5
    wheels_per_axle: Annotated[int, number(1, 8, "1", "1 for a bicycle, 2 for a car")] = 2
    rear_driven: Annotated[
        bool, Field(description="true: the driven wheels begin on the rear axle")
    ] = False
    pitch_time_constant_s: Annotated[
        float, number(0.0, 10.0, "s", "lag of the load transfer to the acceleration; 0: none")
    ] = 0.0


class Tyre(Section):
    """The tyres of the driven wheels (LuGre model).

    Read by the simulated plant only, and only where a scenario lets wheels slip.
    """

    bristle_stiffness_per_m: Annotated[
        float, number(0.0, 1e5, "1/m", "force over load a metre of deflection")
    ] = 0.0
    bristle_damping_s_per_m: Annotated[float, number(0.0, 100.0, "s/m", "")] = 0.0
    contact_length_m: Annotated[float, number(0.0, 1.0, "m", "of the contact patch")] = 0.0
    sliding_share: Annotated[
        float, number(0.0, 1.0, "1", "friction of a locked wheel at speed over that at rest")
    ] = 0.0
    stribeck_speed_m_per_s: Annotated[
        float, number(0.0, 100.0, "m/s", "sliding speed over which friction falls")
    ] = 0.0


class Sensors(Section):
    """Imperfections of the sensors.

    Read by the simulated plant only, unknown to the controller.
    """

    current_noise_a: Annotated[float, number(0.0, 100.0, "A", "standard deviation")] = 0.0
    bus_voltage_noise_v: Annotated[float, number(0.0, 100.0, "V", "standard deviation")] = 0.0
    current_offset_a: Annotated[
        float, number(-100.0, 100.0, "A", "of phases a and c; the opposite in b")
    ] = 0.0
    hall_edge_error_deg: Annotated[
        float, number(0.0, 30.0, "deg", "alternating misplacement of the edges, electrical")
    ] = 0.0
    adc_bits: Annotated[int, number(8, 16, "1", "resolution of every converter")] = 12
