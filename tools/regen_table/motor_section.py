# SPDX-License-Identifier: Apache-2.0
"""A machine: its constants, what it loses, and what it may carry."""

from typing import Annotated, Literal

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import DEMANDED_DRIVE_NM, Section, number

IronCoefficient = Annotated[
    float, number(0.0, 1e6, "ohm or ohm s", "a0 or a1 of R_i = a0 + a1 omega_e")
]
CurvePoint = Annotated[
    tuple[
        Annotated[float, number(-3000.0, 3000.0, "A", "current of the axis")],
        Annotated[float, number(1e-7, 1.0, "H", "flux over current, not its slope")],
    ],
    Field(strict=False),
]
InductanceCurve = Annotated[tuple[CurvePoint, ...], Field(strict=False, min_length=1)]


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
