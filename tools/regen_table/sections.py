# SPDX-License-Identifier: Apache-2.0
"""A drive and the sections of its TOML file: every key, its unit, its accepted range.

One class a section, one line a key. All classes are strict (no text taken for a number), frozen,
and refuse unknown keys and non-finite numbers. An optional key that is absent switches its feature
off; no key is ever guessed.
"""

import re
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

from regen_table.errors import ConfigurationError

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")


def _number(lowest: float, highest: float, unit: str, text: str) -> FieldInfo:
    """Describe a number: its closed range, its unit and its meaning."""
    field = Field(ge=lowest, le=highest, description=text, json_schema_extra={"unit": unit})
    assert isinstance(field, FieldInfo)
    return field


class Section(BaseModel):
    """What all sections share."""

    model_config = ConfigDict(
        strict=True, frozen=True, extra="forbid", allow_inf_nan=False, protected_namespaces=()
    )


IronCoefficient = Annotated[
    float, _number(0.0, 1e6, "ohm or ohm s", "a0 or a1 of R_i = a0 + a1 omega_e")
]
Temperature = Annotated[float, _number(-100.0, 300.0, "degC", "a temperature")]
Degrees = Annotated[float, _number(0.0, 360.0, "deg", "an electrical angle")]
Volts = Annotated[float, _number(1.0, 2000.0, "V", "a battery voltage")]
SocPoint = Annotated[
    tuple[Annotated[float, _number(0.0, 1.0, "1", "state of charge")], Volts], Field(strict=False)
]
SocCurve = Annotated[tuple[SocPoint, ...], Field(strict=False)]


Points = Annotated[int, _number(2, 65, "1", "grid points")] | Literal["auto"]
TemperaturePoints = Annotated[int, _number(2, 17, "1", "grid points")] | Literal["auto"]


class Motor(Section):
    """A permanent-magnet synchronous machine and its limits."""

    name: Annotated[str, Field(min_length=1, max_length=80, description="for people")]
    type: Annotated[
        Literal["spmsm", "ipmsm"], Field(description="surface (L_d = L_q) or interior magnets")
    ]
    pole_pairs: Annotated[int, _number(1, 60, "1", "electrical turns in a mechanical turn")]
    phase_resistance_ohm: Annotated[
        float, _number(1e-5, 100.0, "ohm", "one phase, at reference_temperature_c")
    ]
    reference_temperature_c: Annotated[
        float, _number(-50.0, 150.0, "degC", "where phase_resistance_ohm holds")
    ]
    resistance_temperature_coefficient_per_k: Annotated[
        float, _number(0.0, 0.01, "1/K", "copper 0.00393")
    ]
    d_inductance_h: Annotated[float, _number(1e-7, 1.0, "H", "direct axis")]
    q_inductance_h: Annotated[float, _number(1e-7, 1.0, "H", "quadrature axis")]
    flux_linkage_wb: Annotated[
        float, _number(1e-6, 2.0, "Wb", "PEAK PHASE flux linkage of the magnets")
    ]
    flux_temperature_coefficient_per_k: Annotated[
        float | None,
        _number(
            -0.01,
            0.0,
            "1/K",
            "magnets at winding temperature; NdFeB -0.0011; absent: constant flux",
        ),
    ] = None
    iron_loss_resistance_ohm: Annotated[
        tuple[IronCoefficient, IronCoefficient] | None,
        Field(strict=False, description="[a0, a1]; absent: no iron loss"),
    ] = None
    friction_torque_nm: Annotated[float, _number(0.0, 1000.0, "N m", "Coulomb friction")] = 0.0
    viscous_friction_nm_s: Annotated[
        float, _number(0.0, 1000.0, "N m s", "friction per mechanical rad/s")
    ] = 0.0
    rated_torque_nm: Annotated[float, _number(0.01, 20e3, "N m", "continuous")]
    max_torque_nm: Annotated[float, _number(0.01, 20e3, "N m", "either direction")]
    max_power_w: Annotated[
        float, _number(1.0, 1e6, "W", "electromagnetic, either direction (P_en of the paper)")
    ]
    max_phase_current_a: Annotated[float, _number(0.1, 3000.0, "A", "peak")]
    max_speed_rpm: Annotated[float, _number(10.0, 47e3, "r/min", "mechanical")]
    max_winding_temperature_c: Annotated[
        float, _number(40.0, 300.0, "degC", "no torque beyond; derating starts 20 K below")
    ]


class Inverter(Section):
    """A two-level bridge of MOSFETs (or of switches described as resistances) and its measuring ranges."""

    switch_resistance_ohm: Annotated[float, _number(0.0, 10.0, "ohm", "one switch, conducting")]
    diode_forward_voltage_v: Annotated[float, _number(0.0, 10.0, "V", "diode drop at zero current")]
    diode_resistance_ohm: Annotated[float, _number(0.0, 10.0, "ohm", "slope of the diode drop")]
    dead_time_s: Annotated[float, _number(0.0, 1e-5, "s", "between the two switches of a leg")]
    pwm_frequency_hz: Annotated[float, _number(4e3, 1e5, "Hz", "rate of the current loop")]
    turn_on_loss_j_per_a: Annotated[float, _number(0.0, 0.1, "J/A", "k_on of the paper's (12)")]
    turn_off_loss_j_per_a: Annotated[float, _number(0.0, 0.1, "J/A", "k_off of the paper's (12)")]
    current_full_scale_a: Annotated[
        float, _number(1.0, 4000.0, "A", "what half the converter's range stands for")
    ]
    voltage_full_scale_v: Annotated[
        float, _number(5.0, 2000.0, "V", "what the converter's whole range stands for")
    ]
    pwm_timer_clock_hz: Annotated[
        int, _number(1_000_000, 1_000_000_000, "Hz", "counts of the PWM timer")
    ] = 168_000_000
    min_pulse_s: Annotated[
        float | None,
        _number(
            0.0,
            2e-5,
            "s",
            "what the low side conducts at least before the top of the count; absent: max(1 us, 2 dead times)",
        ),
    ] = None
    max_switch_temperature_c: Annotated[
        float | None,
        _number(
            40.0, 250.0, "degC", "no torque beyond; derating starts 20 K below; absent: not watched"
        ),
    ] = None


class Battery(Section):
    """A battery as open-circuit voltage, series resistance and one RC branch.

    Limits are those of the whole pack.
    """

    open_circuit_voltage_v: Annotated[
        Volts | SocCurve, Field(description="V, or [[soc, V], ...] with rising soc")
    ]
    series_resistance_ohm: Annotated[float, _number(0.0, 10.0, "ohm", "R_s")]
    polarisation_resistance_ohm: Annotated[float, _number(0.0, 10.0, "ohm", "R_t")]
    polarisation_capacitance_f: Annotated[float, _number(1e-3, 1e7, "F", "C_t")]
    capacity_ah: Annotated[float, _number(0.01, 1e5, "A h", "")]
    initial_soc: Annotated[
        float | None, _number(0.0, 1.0, "1", "state of charge where work begins")
    ] = None
    max_charge_current_a: Annotated[
        float, _number(0.0, 2e4, "A", "0: no regeneration into the battery")
    ]
    max_discharge_current_a: Annotated[float, _number(0.1, 2e4, "A", "")]
    max_voltage_v: Annotated[float, _number(1.0, 1900.0, "V", "end of charge")]
    min_voltage_v: Annotated[float, _number(1.0, 1900.0, "V", "end of discharge")]


class Bus(Section):
    """What lies between pack and bridges.

    Read by the simulated plant only; absent: the bridges sit on the pack's terminals.
    """

    capacitance_f: Annotated[
        float, _number(0.0, 1.0, "F", "of all bridges' capacitors together; 0: none")
    ] = 0.0
    cable_resistance_ohm: Annotated[
        float, _number(0.0, 10.0, "ohm", "from the pack to the bus, both ways")
    ] = 0.0


class Bms(Section):
    """What the battery management tells the controllers, on top of the pack's current limits.

    Read by the simulated plant only.
    """

    fade_soc: Annotated[
        float,
        _number(0.0, 1.0, "1", "state of charge over which the limits fold back at both ends"),
    ] = 0.02
    keep_voltage: Annotated[
        bool,
        Field(description="true: limits also keep the settled voltage within the battery's ends"),
    ] = False
    temperature_c: Annotated[float, _number(-60.0, 100.0, "degC", "of the cells")] = 25.0
    cold_charge_c: Annotated[
        tuple[Temperature, Temperature] | None,
        Field(
            strict=False,
            description="[no charge below, all charge from here on]; absent: cells are never too cold",
        ),
    ] = None
    period_s: Annotated[float, _number(0.0, 10.0, "s", "of the message; 0: every millisecond")] = (
        0.0
    )
    current_step_a: Annotated[
        float, _number(0.0, 1e3, "A", "resolution of the message; 0: none")
    ] = 0.0


class Thermal(Section):
    """Heat of one motor and one inverter.

    Read by the simulated plant only, and only where a scenario lets them warm up.
    """

    winding_heat_capacity_j_per_k: Annotated[float, _number(0.0, 1e7, "J/K", "copper")] = 0.0
    winding_thermal_resistance_k_per_w: Annotated[
        float, _number(0.0, 1e3, "K/W", "winding to housing; 0: insulated")
    ] = 0.0
    housing_heat_capacity_j_per_k: Annotated[
        float, _number(0.0, 1e7, "J/K", "iron and housing; 0: none")
    ] = 0.0
    housing_thermal_resistance_k_per_w: Annotated[
        float, _number(0.0, 1e3, "K/W", "housing to ambient; 0: insulated")
    ] = 0.0
    switch_heat_capacity_j_per_k: Annotated[float, _number(0.0, 1e7, "J/K", "all six switches")] = (
        0.0
    )
    switch_thermal_resistance_k_per_w: Annotated[
        float, _number(0.0, 1e3, "K/W", "switches to heat sink; 0: insulated")
    ] = 0.0
    heatsink_heat_capacity_j_per_k: Annotated[float, _number(0.0, 1e7, "J/K", "0: none")] = 0.0
    heatsink_thermal_resistance_k_per_w: Annotated[
        float, _number(0.0, 1e3, "K/W", "heat sink to ambient; 0: insulated")
    ] = 0.0
    switch_resistance_temperature_coefficient_per_k: Annotated[
        float, _number(0.0, 0.1, "1/K", "of switch_resistance_ohm, from 25 degC; 0: constant")
    ] = 0.0


class Chassis(Section):
    """Wheels and axles: read by the simulated plant only, and only where a scenario lets wheels slip."""

    wheel_inertia_kg_m2: Annotated[
        float,
        _number(0.0, 1e3, "kg m2", "of one driven wheel and its rotor; part of the vehicle's mass"),
    ] = 0.0
    wheelbase_m: Annotated[
        float, _number(0.0, 50.0, "m", "from axle to axle; 0: no load transfer")
    ] = 0.0
    centre_of_gravity_height_m: Annotated[float, _number(0.0, 10.0, "m", "above the road")] = 0.0
    front_load_share: Annotated[
        float, _number(0.0, 1.0, "1", "of the weight on the front axle, standing on the flat")
    ] = 0.5
    wheels_per_axle: Annotated[int, _number(1, 8, "1", "1 for a bicycle, 2 for a car")] = 2
    rear_driven: Annotated[
        bool, Field(description="true: the driven wheels begin on the rear axle")
    ] = False
    pitch_time_constant_s: Annotated[
        float, _number(0.0, 10.0, "s", "lag of the load behind the acceleration; 0: none")
    ] = 0.0


class Tyre(Section):
    """The tyres of the driven wheels (LuGre model).

    Read by the simulated plant only, and only where a scenario lets wheels slip.
    """

    bristle_stiffness_per_m: Annotated[
        float, _number(0.0, 1e5, "1/m", "force over load a metre of deflection")
    ] = 0.0
    bristle_damping_s_per_m: Annotated[float, _number(0.0, 100.0, "s/m", "")] = 0.0
    contact_length_m: Annotated[float, _number(0.0, 1.0, "m", "of the contact patch")] = 0.0
    sliding_share: Annotated[
        float, _number(0.0, 1.0, "1", "friction of a locked wheel at speed over that at rest")
    ] = 0.0
    stribeck_speed_m_per_s: Annotated[
        float, _number(0.0, 100.0, "m/s", "sliding speed over which friction falls")
    ] = 0.0


class Vehicle(Section):
    """What the motors move."""

    mass_kg: Annotated[float, _number(1.0, 1e5, "kg", "with load")]
    wheel_radius_m: Annotated[
        float,
        _number(0.01, 2.0, "m", "rolling radius, divided by the gear ratio where there is a gear"),
    ]
    frontal_area_m2: Annotated[float, _number(0.0, 20.0, "m2", "")]
    drag_coefficient: Annotated[float, _number(0.0, 2.0, "1", "")]
    rolling_resistance: Annotated[float, _number(0.0, 0.2, "1", "")]
    driven_wheels: Annotated[int, _number(1, 16, "1", "motors on one battery")]
    wheel_position: Annotated[
        Literal["front_left", "front_right", "rear_left", "rear_right"],
        Field(description="this controller's address on CAN"),
    ] = "front_left"


class Brake(Section):
    """How the braking demand is shared."""

    strategy: Annotated[
        Literal["parallel_ratio", "parallel_free_travel", "series_optimal"],
        Field(description="what the vehicle is shipped with"),
    ]
    parallel_electric_share: Annotated[
        float, _number(0.0, 1.0, "1", "electric part of the whole demand (parallel_ratio)")
    ]
    electric_rated_torque_nm: Annotated[
        float, _number(0.0, 20e3, "N m", "electric torque before the hydraulic brake adds")
    ]
    hydraulic_dead_time_s: Annotated[float, _number(0.0, 1.0, "s", "")]
    hydraulic_time_constant_s: Annotated[float, _number(1e-3, 2.0, "s", "")]
    hydraulic_rate_nm_per_s: Annotated[float, _number(0.1, 1e6, "N m/s", "")]
    max_hydraulic_torque_nm: Annotated[
        float, _number(0.0, 20e3, "N m", "per driven wheel; 0: none")
    ]
    hydraulic_knee_torque_nm: Annotated[
        float,
        _number(
            0.0, 20e3, "N m", "torque rises slowly up to here (simulated plant only); 0: no knee"
        ),
    ] = 0.0
    hydraulic_knee_rate_nm_per_s: Annotated[
        float, _number(0.0, 1e6, "N m/s", "of the rise below the knee")
    ] = 0.0


class Control(Section):
    """What is asked of the control loops."""

    current_bandwidth_hz: Annotated[float, _number(10.0, 1e4, "Hz", "closed current loop")]
    torque_rate_nm_per_s: Annotated[
        float, _number(0.1, 2e6, "N m/s", "fastest change of motor torque")
    ]
    handover_start_rpm: Annotated[
        float, _number(0.0, 9500.0, "r/min", "blend-out of regenerative torque begins below")
    ]
    handover_end_rpm: Annotated[
        float, _number(0.0, 9500.0, "r/min", "no regenerative torque below")
    ]
    field_weakening_current_a: Annotated[
        float | None, _number(0.0, 3000.0, "A", "largest demagnetising current; absent: off")
    ] = None
    dead_time_zone_a: Annotated[
        float | None,
        _number(1e-3, 3000.0, "A", "absent: what the dead time can extinguish, t_d v_dc / L"),
    ] = None
    demand_timeout_s: Annotated[float, _number(0.005, 1.0, "s", "older demands count as lost")] = (
        0.1
    )


class Table(Section):
    """The grid of the stored optimum."""

    speed_points: Annotated[
        Points, Field(description="from standstill; auto: the smallest grid that suffices")
    ]
    temperature_points: Annotated[
        TemperaturePoints, Field(description="auto: the smallest grid that suffices")
    ]
    temperature_range_c: Annotated[
        tuple[Temperature, Temperature],
        Field(strict=False, description="winding [lowest, highest]"),
    ]


class Rotor(Section):
    """How the controller learns the rotor's angle."""

    sensor: Annotated[
        Literal["hall", "encoder", "angle"],
        Field(
            description="three hall sensors, an incremental encoder with index, or an absolute electrical angle"
        ),
    ] = "angle"
    hall_edges_deg: Annotated[
        tuple[Degrees, Degrees, Degrees, Degrees, Degrees, Degrees],
        Field(
            strict=False,
            description="electrical angle at which sector k begins when turning forward",
        ),
    ] = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0)
    pll_bandwidth_hz: Annotated[float, _number(1.0, 1000.0, "Hz", "tracking of the angle")] = 50.0
    encoder_counts: Annotated[
        int | None,
        _number(32, 65536, "1", "in a mechanical turn, four to a line; absent: no encoder"),
    ] = None
    encoder_index_deg: Annotated[
        float | None, _number(0.0, 360.0, "deg", "electrical angle at the index pulse")
    ] = None
    encoder_index_tolerance_counts: Annotated[
        int,
        _number(
            0,
            1024,
            "1",
            "how far beside its place an index pulse is still the expected one: its width",
        ),
    ] = 4
    encoder_reversed: Annotated[bool, Field(description="the count falls when turning forward")] = (
        False
    )


class Sensors(Section):
    """Imperfections of the sensors.

    Read by the simulated plant only, unknown to the controller.
    """

    current_noise_a: Annotated[float, _number(0.0, 100.0, "A", "standard deviation")] = 0.0
    bus_voltage_noise_v: Annotated[float, _number(0.0, 100.0, "V", "standard deviation")] = 0.0
    current_offset_a: Annotated[
        float, _number(-100.0, 100.0, "A", "of phases a and c; the opposite in b")
    ] = 0.0
    hall_edge_error_deg: Annotated[
        float, _number(0.0, 30.0, "deg", "alternating misplacement of the edges, electrical")
    ] = 0.0
    adc_bits: Annotated[int, _number(8, 16, "1", "resolution of every converter")] = 12


class Drive(Section):
    """Everything known about one drive, SI units, keys as in the TOML file."""

    motor: Motor
    inverter: Inverter
    battery: Battery
    vehicle: Vehicle
    brake: Brake
    control: Control
    table: Table
    rotor: Rotor = Rotor()
    sensors: Sensors = Sensors()
    bus: Bus = Bus()
    bms: Bms = Bms()
    thermal: Thermal = Thermal()
    chassis: Chassis = Chassis()
    tyre: Tyre = Tyre()
    _name: str = "unnamed"

    @property
    def name(self) -> str:
        """Name of the configuration: the file's name without its ending."""
        return self._name

    def named(self, name: str) -> Self:
        """Return the same drive under another name: a letter, then letters, digits, - and _, at most 31."""
        if not _NAME.fullmatch(name):
            raise ConfigurationError(
                f"configuration name {name!r}: must be a letter followed by at most 30 letters, digits, '-' or '_'"
            )
        copy = self.model_copy()
        copy._name = name
        return copy
