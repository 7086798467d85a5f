# SPDX-License-Identifier: Apache-2.0
"""A drive and the sections of its TOML file: every key, its unit, its accepted range.

One class a section, one line a key; [brake] is in ``brake_section``, [driver] in
``driver_section``, [pedals] in ``pedals_section``, [service] in ``service_section``, [monitor] in
``monitor_section``, what only the simulated plant reads in ``plant_sections``. All classes are
strict (no text taken for a number), frozen, and refuse unknown keys and non-finite numbers. An
optional key that is absent switches its feature off or has the default given in its line. A key
with a rule (``Assumed``) is derived from what the file gives, and reported as assumed.
"""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.brake_section import Brake
from regen_table.driver_section import Driver
from regen_table.errors import ConfigurationError
from regen_table.fields_section import Fields
from regen_table.monitor_section import Monitor
from regen_table.pedals_section import Pedals
from regen_table.plant_sections import (
    DEMANDED_DRIVE_NM,
    Bms,
    Bus,
    Chassis,
    Section,
    Sensors,
    Temperature,
    Thermal,
    Tyre,
    number,
)
from regen_table.service_section import Service

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")


IronCoefficient = Annotated[
    float, number(0.0, 1e6, "ohm or ohm s", "a0 or a1 of R_i = a0 + a1 omega_e")
]
Degrees = Annotated[float, number(0.0, 360.0, "deg", "an electrical angle")]
VoltageUse = Annotated[float, number(0.0, 0.99, "1", "square of the share of the circle")]
OffsetCode = Annotated[float, number(0.0, 4095.0, "1", "a code of the 12-bit converter")]
Volts = Annotated[float, number(1.0, 2000.0, "V", "a battery voltage")]
SocPoint = Annotated[
    tuple[Annotated[float, number(0.0, 1.0, "1", "state of charge")], Volts], Field(strict=False)
]
SocCurve = Annotated[tuple[SocPoint, ...], Field(strict=False)]


CurvePoint = Annotated[
    tuple[
        Annotated[float, number(-3000.0, 3000.0, "A", "current of the axis")],
        Annotated[float, number(1e-7, 1.0, "H", "flux over current, not its slope")],
    ],
    Field(strict=False),
]
InductanceCurve = Annotated[tuple[CurvePoint, ...], Field(strict=False, min_length=1)]


Points = Annotated[int, number(2, 65, "1", "grid points")] | Literal["auto"]
TemperaturePoints = Annotated[int, number(2, 17, "1", "grid points")] | Literal["auto"]


class Motor(Section):
    """A permanent-magnet synchronous machine and its limits."""

    name: Annotated[
        str,
        Field(min_length=1, max_length=80, description="for people"),
        Assumed(defaults.name, "nothing: it is for people"),
    ]
    type: Annotated[
        Literal["spmsm", "ipmsm"],
        Field(description="surface (L_d = L_q) or interior magnets"),
        Assumed(defaults.motor_type, "the reluctance torque of interior magnets"),
    ]
    pole_pairs: Annotated[int, number(1, 60, "1", "electrical turns in a mechanical turn")]
    phase_resistance_ohm: Annotated[
        float, number(1e-5, 100.0, "ohm", "one phase, at reference_temperature_c")
    ]
    reference_temperature_c: Annotated[
        float,
        number(-50.0, 150.0, "degC", "where phase_resistance_ohm holds"),
        Assumed(defaults.room_temperature, "25 K are 10 % of the resistance: 0.1 to 1.4 %"),
    ]
    resistance_temperature_coefficient_per_k: Annotated[
        float,
        number(0.0, 0.01, "1/K", "copper 0.00393"),
        Assumed(defaults.copper, "windings are copper"),
    ]
    d_inductance_h: Annotated[float, number(1e-7, 1.0, "H", "direct axis")]
    q_inductance_h: Annotated[
        float,
        number(1e-7, 1.0, "H", "quadrature axis"),
        Assumed(defaults.q_inductance, "currents that answer slower or faster; no energy"),
    ]
    flux_linkage_wb: Annotated[
        float, number(1e-6, 2.0, "Wb", "PEAK PHASE flux linkage of the magnets")
    ]
    flux_map: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=400,
            description=(
                "CSV, NPZ or Parquet beside this file, at reference_temperature_c: in place of the"
                " three keys above"
            ),
        ),
    ] = None
    d_inductance_curve_h: Annotated[
        InductanceCurve | None,
        Field(description="[[i_d, L_d], ...], psi_d = psi + L_d i_d: in place of d_inductance_h"),
    ] = None
    q_inductance_curve_h: Annotated[
        InductanceCurve | None,
        Field(description="[[|i_q|, L_q], ...], psi_q = L_q i_q: in place of q_inductance_h"),
    ] = None
    flux_temperature_coefficient_per_k: Annotated[
        float | None,
        number(
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
    friction_torque_nm: Annotated[float, number(0.0, 1000.0, "N m", "Coulomb friction")] = 0.0
    viscous_friction_nm_s: Annotated[
        float, number(0.0, 1000.0, "N m s", "friction per mechanical rad/s")
    ] = 0.0
    rated_torque_nm: Annotated[
        float,
        number(0.01, DEMANDED_DRIVE_NM, "N m", "continuous", "Demand.drive_torque_nm"),
        Assumed(defaults.rated_torque, "a motor that overheats, or is used too little"),
    ]
    max_torque_nm: Annotated[
        float,
        number(0.01, DEMANDED_DRIVE_NM, "N m", "either direction", "Demand.drive_torque_nm"),
        Assumed(defaults.max_torque, "more demand for the friction brake, or a hot winding"),
    ]
    max_power_w: Annotated[
        float,
        number(1.0, 1e6, "W", "electromagnetic, either direction (P_en of the paper)"),
        Assumed(defaults.max_power, "nothing: other limits come first"),
    ]
    max_phase_current_a: Annotated[
        float,
        number(0.1, 3000.0, "A", "peak"),
        Assumed(defaults.max_phase_current, "demagnetised magnets where they stand less"),
    ]
    max_speed_rpm: Annotated[
        float,
        number(10.0, 47e3, "r/min", "mechanical"),
        Assumed(defaults.max_speed, "no driving torque beyond"),
    ]
    max_winding_temperature_c: Annotated[
        float,
        number(40.0, 300.0, "degC", "no torque beyond, below it derating"),
        Assumed(defaults.max_winding_temperature, "a burnt winding where it stands less"),
    ]
    derate_winding_temperature_c: Annotated[
        float | None,
        number(0.0, 300.0, "degC", "derating starts; absent: 20 K below max_winding_temperature_c"),
    ] = None
    mass_kg: Annotated[
        float | None,
        number(
            0.05,
            1000.0,
            "kg",
            "of the motor alone: what [thermal] is assumed from; absent: nothing",
        ),
    ] = None
    speed_fade_share: Annotated[
        float,
        number(0.0, 0.5, "1", "last part of the speed range over which driving torque fades out"),
    ] = 1.0 / 32.0

    @property
    def has_map(self) -> bool:
        """Whether the iron saturates, as a map or curves say."""
        curves = (self.flux_map, self.d_inductance_curve_h, self.q_inductance_curve_h)
        return any(curve is not None for curve in curves)


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
            defaults.dead_time, "twice: 0.14 %, but 8 % where it takes the voltage (3 us at 12 kHz)"
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


class Battery(Section):
    """A battery as open-circuit voltage, series resistance and one RC branch.

    Limits are those of the whole pack.
    """

    cells: Annotated[
        int | None,
        number(
            1, 400, "1", "lithium-ion cells in series: what voltages are assumed from; absent: none"
        ),
    ] = None
    open_circuit_voltage_v: Annotated[
        Volts | SocCurve,
        Field(description="V, or [[soc, V], ...] with rising soc"),
        Assumed(
            defaults.open_circuit_voltage,
            "other cells, such as LiFePO4: fold-back at another charge",
        ),
    ]
    series_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "R_s"),
        Assumed(
            defaults.series_resistance, "simulated packs alone: twice, 2.7 % of the power at 1 C"
        ),
    ]
    polarisation_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "R_t"),
        Assumed(
            defaults.polarisation_resistance,
            "simulated packs alone: twice, 1.4 % of the power at 1 C",
        ),
    ]
    polarisation_capacitance_f: Annotated[
        float,
        number(1e-3, 1e7, "F", "C_t"),
        Assumed(defaults.polarisation_capacitance, "simulated packs alone"),
    ]
    capacity_ah: Annotated[
        float,
        number(0.01, 1e5, "A h", ""),
        Assumed(defaults.capacity, "both current limits in proportion: give it"),
    ]
    initial_soc: Annotated[
        float, number(0.0, 1.0, "1", "state of charge where work begins; absent: 0.7")
    ] = 0.7
    max_charge_current_a: Annotated[
        float,
        number(0.0, 2e4, "A", "0: no regeneration into the battery"),
        Assumed(
            defaults.max_charge_current, "too low: hard stops by friction; too high: aged cells"
        ),
    ]
    max_discharge_current_a: Annotated[
        float,
        number(0.1, 2e4, "A", ""),
        Assumed(defaults.max_discharge_current, "driving power alone"),
    ]
    max_voltage_v: Annotated[
        float,
        number(1.0, 1900.0, "V", "end of charge"),
        Assumed(defaults.max_voltage, "an over-charged pack of other cells: LiFePO4 has 3.65 V"),
    ]
    min_voltage_v: Annotated[
        float,
        number(1.0, 1900.0, "V", "end of discharge"),
        Assumed(defaults.min_voltage, "an exhausted pack of other cells: LiFePO4 has 2.5 V"),
    ]
    charge_foldback_voltage_v: Annotated[
        float | None,
        number(
            1.0, 1900.0, "V", "charge current starts to fold back; absent: 98 % of max_voltage_v"
        ),
    ] = None
    discharge_foldback_voltage_v: Annotated[
        float | None,
        number(
            1.0,
            1900.0,
            "V",
            "discharge current starts to fold back; absent: as far above min_voltage_v as charge's"
            " lies below max_voltage_v",
        ),
    ] = None
    current_filter_s: Annotated[
        float,
        number(
            0.0,
            10.0,
            "s",
            "longest time constant of the current that the battery management reports: the motor's"
            " current sensors are compared with it over eight times this",
        ),
    ] = 2.0


class Vehicle(Section):
    """What the motors move."""

    mass_kg: Annotated[float, number(1.0, 1e5, "kg", "with load")]
    wheel_radius_m: Annotated[
        float,
        number(0.01, 2.0, "m", "rolling radius, divided by the gear ratio where there is a gear"),
    ]
    frontal_area_m2: Annotated[
        float,
        number(0.0, 20.0, "m2", ""),
        Assumed(defaults.frontal_area, "simulated vehicles and ideal stops alone"),
    ]
    drag_coefficient: Annotated[
        float,
        number(0.0, 2.0, "1", ""),
        Assumed(defaults.drag, "simulated vehicles and ideal stops alone"),
    ]
    rolling_resistance: Annotated[
        float,
        number(0.0, 0.2, "1", ""),
        Assumed(defaults.rolling, "simulated vehicles and ideal stops alone"),
    ]
    driven_wheels: Annotated[
        int,
        number(1, 16, "1", "motors on one battery"),
        Assumed(defaults.one_wheel, "pack limits are shared by this number"),
    ]
    pack_share: Annotated[
        float | None,
        number(
            0.01, 1.0, "1",
            "of the pack's limits that this motor may use; all motors on a pack make 1 together;"
            " absent: motors alike, 1/driven_wheels"),
    ] = None  # fmt: skip
    wheel_position: Annotated[
        Literal["front_left", "front_right", "rear_left", "rear_right"],
        Field(description="this controller's address on CAN"),
    ] = "front_left"
    can_base: Annotated[
        int,
        number(0, 0x740, "1", "lowest identifier on CAN, a multiple of 32"),
    ] = 0x100


class Control(Section):
    """Requirements of the control loops."""

    current_bandwidth_hz: Annotated[
        float,
        number(10.0, 1e4, "Hz", "closed current loop"),
        Assumed(defaults.current_bandwidth, "slower or faster currents; no energy"),
    ]
    torque_rate_nm_per_s: Annotated[
        float,
        number(0.1, 2e6, "N m/s", "fastest change of motor torque"),
        Assumed(defaults.torque_rate, "a jerk, or a late brake"),
    ]
    handover_start_rpm: Annotated[
        float,
        number(0.0, 9500.0, "r/min", "blend-out of regenerative torque begins below"),
        Assumed(defaults.handover_start, "the last metre: 1 % of the kinetic energy from 25 km/h"),
    ]
    handover_end_rpm: Annotated[
        float,
        number(0.0, 9500.0, "r/min", "no regenerative torque below"),
        Assumed(defaults.handover_end, "the last metre: 1 % of the kinetic energy from 25 km/h"),
    ]
    field_weakening_current_a: Annotated[
        float | None,
        number(0.0, 3000.0, "A", "largest demagnetising current; absent: off"),
        Assumed(defaults.field_weakening_current, "no control of torque at top speed when empty"),
    ] = None
    dead_time_zone_a: Annotated[
        float | None,
        number(1e-3, 3000.0, "A", "absent: what the dead time can extinguish, t_d v_dc / L"),
    ] = None
    demand_timeout_s: Annotated[float, number(0.005, 1.0, "s", "older demands count as lost")] = 0.1
    modulation_target: Annotated[
        float,
        number(0.5, 0.98, "1", "share of the voltage circle that field weakening regulates to"),
    ] = 0.96887
    modulation_reserve: Annotated[
        float | None,
        number(
            0.0,
            0.099,
            "1",
            "of the circle: the torque limits keep this much below; absent: 1/128 of "
            "modulation_target",
        ),
    ] = None
    torque_growth_voltage_use: Annotated[
        tuple[VoltageUse, VoltageUse],
        Field(
            strict=False,
            description=(
                "square of the voltage over its circle's: torque grows at its whole rate below the"
                " first, no more above the second"
            ),
        ),
    ] = (0.94, 0.96)
    limp_drive_share: Annotated[
        float, number(0.0, 1.0, "1", "of the driving torque, left after a warning")
    ] = 0.3
    selftest_timeout_s: Annotated[
        float, number(0.01, 60.0, "s", "a self-test without a result is a fault")
    ] = 1.0
    coast_delay_s: Annotated[
        float,
        number(
            0.0,
            60.0,
            "s",
            "zero demand this long opens the bridge below the EMF limit; 0: it keeps switching",
        ),
    ] = 0.1
    offset_wait_s: Annotated[
        float,
        number(
            0.01,
            60.0,
            "s",
            "a start on a wheel whose EMF drives a current waits this long, then takes the stored"
            " offsets",
        ),
    ] = 0.1


class Table(Section):
    """The grid of the stored optimum."""

    speed_points: Annotated[
        Points,
        Field(description="from standstill; auto: the smallest grid that suffices"),
        Assumed(defaults.smallest_grid, "nothing"),
    ]
    temperature_points: Annotated[
        TemperaturePoints,
        Field(description="auto: the smallest grid that suffices"),
        Assumed(defaults.smallest_grid, "nothing"),
    ]
    temperature_range_c: Annotated[
        tuple[Temperature, Temperature],
        Field(strict=False, description="winding [lowest, highest]"),
        Assumed(defaults.temperature_range, "outside, the nearest edge is used"),
    ]


class Rotor(Section):
    """How the controller learns the rotor's angle."""

    sensor: Annotated[
        Literal["hall", "encoder", "angle"],
        Field(
            description=(
                "three hall sensors, an incremental encoder with index, or an absolute electrical"
                " angle"
            )
        ),
    ] = "angle"
    hall_edges_deg: Annotated[
        tuple[Degrees, Degrees, Degrees, Degrees, Degrees, Degrees],
        Field(
            strict=False,
            description=(
                "electrical angle at which sector k begins when turning forward; the first where"
                " sensor a rises"
            ),
        ),
    ] = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0)
    hall_spacing_deg: Annotated[
        Literal[120, 60],
        Field(description="electrical, from a to b and from b to c, which rise in this order"),
    ] = 120
    hall_inverted: Annotated[
        Literal["", "a", "b", "c", "ab", "ac", "bc", "abc"],
        Field(description="sensors whose level is inverted"),
    ] = ""
    hall_order: Annotated[
        Literal["abc", "acb", "bac", "bca", "cab", "cba"],
        Field(description="sensors at the board's inputs A, B, C"),
    ] = "abc"
    pll_bandwidth_hz: Annotated[float, number(1.0, 1000.0, "Hz", "tracking of the angle")] = 50.0
    encoder_counts: Annotated[
        int | None,
        number(32, 65536, "1", "in a mechanical turn, four to a line; absent: no encoder"),
    ] = None
    encoder_index_deg: Annotated[
        float | None, number(0.0, 360.0, "deg", "electrical angle at the index pulse")
    ] = None
    encoder_index_tolerance_counts: Annotated[
        int,
        number(
            0,
            1024,
            "1",
            "how far beside its place an index pulse is still the expected one: its width",
        ),
    ] = 4
    encoder_reversed: Annotated[bool, Field(description="the count falls when turning forward")] = (
        False
    )
    observer_speed_rpm: Annotated[
        float | None,
        number(
            0.1,
            4e4,
            "r/min",
            "from which the EMF observer's angle counts; absent: EMF equal to the resistive drop"
            " at rated torque and the dead times' voltage",
        ),
    ] = None
    observer_takeover: Annotated[
        bool,
        Field(
            description=(
                "the EMF observer watches the sensor and takes over from it; else it only reports"
            )
        ),
    ] = True


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
    driver: Driver = Driver()
    pedals: Pedals = Pedals()
    service: Service = Service()
    monitor: Monitor = Monitor()
    sensors: Sensors = Sensors()
    bus: Bus = Bus()
    bms: Bms = Bms()
    thermal: Thermal = Thermal()
    chassis: Chassis = Chassis()
    tyre: Tyre = Tyre()
    fields: Fields = Fields()
    _name: str = "unnamed"
    _folder: Path = Path()

    @property
    def name(self) -> str:
        """Name of the configuration: the file's name without its ending."""
        return self._name

    @property
    def folder(self) -> Path:
        """Where the file is, with what it names."""
        return self._folder

    def found_in(self, folder: Path) -> Self:
        """Return the same drive of another folder."""
        copy = self.model_copy()
        copy._folder = folder
        return copy

    def named(self, name: str) -> Self:
        """Return the same drive under another name.

        A letter, then letters, digits, - and _, at most 31.
        """
        if not _NAME.fullmatch(name):
            raise ConfigurationError(
                f"configuration name {name!r}: must be a letter followed by at most 30 letters,"
                " digits, '-' or '_'"
            )
        copy = self.model_copy()
        copy._name = name
        return copy


def bounds(metadata: Iterable[Any]) -> tuple[Any, Any]:
    """Return the lowest and the highest value, or length, of a key's description."""
    found: list[Any] = []
    for names in (("ge", "min_length"), ("le", "max_length")):
        ends = (getattr(note, name, None) for note in metadata for name in names)
        found.append(next((end for end in ends if end is not None), None))
    return found[0], found[1]


def range_of(name: str) -> tuple[str, float, float]:
    """Return unit, lowest and highest value of the number "section.key"."""
    section, key = name.split(".")
    kind = Drive.model_fields[section].annotation
    assert isinstance(kind, type) and issubclass(kind, Section)
    info = kind.model_fields[key]
    assert isinstance(info.json_schema_extra, dict)
    lowest, highest = bounds(info.metadata)
    return str(info.json_schema_extra["unit"]), float(lowest), float(highest)
