# SPDX-License-Identifier: Apache-2.0
"""How the braking demand is shared, and what is known of the hydraulic brake."""

from typing import Annotated, Literal

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import COMMANDED_HYDRAULIC_NM, Section, number


class Brake(Section):
    """How the braking demand is shared."""

    strategy: Annotated[
        Literal["parallel_ratio", "parallel_free_travel", "series_optimal"],
        Field(description="what the vehicle is shipped with"),
        Assumed(defaults.strategy, "another share of the same demand"),
    ]
    parallel_electric_share: Annotated[
        float,
        number(0.0, 1.0, "1", "electric part of the whole demand (parallel_ratio)"),
        Assumed(defaults.electric_share, "nothing with series_optimal"),
    ]
    electric_rated_torque_nm: Annotated[
        float,
        number(0.0, 20e3, "N m", "electric torque before the hydraulic brake adds"),
        Assumed(defaults.electric_rated_torque, "nothing with series_optimal"),
    ]
    hydraulic_dead_time_s: Annotated[
        float,
        number(0.0, 1.0, "s", ""),
        Assumed(defaults.hydraulic_dead_time, "a jerk where torque is handed over"),
    ]
    hydraulic_time_constant_s: Annotated[
        float,
        number(1e-3, 2.0, "s", ""),
        Assumed(defaults.hydraulic_time_constant, "a jerk where torque is handed over"),
    ]
    hydraulic_rate_nm_per_s: Annotated[
        float,
        number(0.1, 1e6, "N m/s", ""),
        Assumed(defaults.hydraulic_rate, "a jerk where torque is handed over"),
    ]
    max_hydraulic_torque_nm: Annotated[
        float,
        number(
            0.0,
            COMMANDED_HYDRAULIC_NM,
            "N m",
            "per driven wheel; 0: none",
            "WheelBrake.hydraulic_torque_nm",
        ),
        Assumed(defaults.no_hydraulic, "a brake that is there is not used"),
    ]
    hydraulic_knee_torque_nm: Annotated[
        float,
        number(
            0.0, 20e3, "N m", "torque rises slowly up to here (simulated plant only); 0: no knee"
        ),
    ] = 0.0
    hydraulic_knee_rate_nm_per_s: Annotated[
        float, number(0.0, 1e6, "N m/s", "of the rise below the knee")
    ] = 0.0
    hydraulic_timeout_s: Annotated[
        float,
        number(
            0.0,
            1.0,
            "s",
            "reports of the hydraulic torque that are missing for longer are not used; 0: none is"
            " used",
        ),
    ] = 0.07
    hydraulic_report_delay_s: Annotated[
        float, number(0.0, 0.04, "s", "from the hydraulic torque to its report")
    ] = 0.01
    hydraulic_gain_band: Annotated[
        float,
        number(0.0, 0.5, "1", "the brake's gain is learned within 1 -+ this; 0: not learned"),
    ] = 0.2
    hydraulic_tolerance_nm: Annotated[
        float | None,
        number(
            0.001,
            20e3,
            "N m",
            "four standard deviations of the noise of a report; farther from what the commands"
            " explain it shows a wrong brake;"
            " absent: 1.25 % of max_hydraulic_torque_nm",
        ),
    ] = None
    bridging_time_s: Annotated[
        float | None,
        number(
            0.0,
            10.0,
            "s",
            "in which motor torque above a deferrable limit goes down to a tenth; absent:"
            " hydraulic_dead_time_s and 2.3 hydraulic_time_constant_s",
        ),
    ] = None
    loss_braking: Annotated[
        bool,
        Field(
            description=(
                "where the battery takes nothing, the motor brakes with what its own losses take"
            )
        ),
    ] = True
    shortfall_band_nm: Annotated[
        float | None,
        number(
            0.001,
            1e3,
            "N m",
            "missing motor torque tolerated before the hydraulic brake fills it; absent: 5 % of"
            " motor.max_torque_nm",
        ),
    ] = None
    motor_arrival_s: Annotated[
        float,
        number(
            0.001, 1.0, "s", "torque that the motor reaches within this time counts as available"
        ),
    ] = 0.1
    abs_hold_s: Annotated[
        float,
        number(0.0, 10.0, "s", "no electric braking this long after an anti-lock intervention"),
    ] = 0.3
    stop_lamp_on_m_per_s2: Annotated[
        float,
        number(
            0.1, 20.0, "m/s2", "deceleration without a braking demand above which the lamp is lit"
        ),
    ] = 1.3
    stop_lamp_off_m_per_s2: Annotated[
        float, number(0.0, 20.0, "m/s2", "deceleration below which the lamp is switched off")
    ] = 0.7
    stop_lamp_filter_s: Annotated[
        float,
        number(
            0.001,
            1.024,
            "s",
            "time constant of its low-passes of speed and deceleration, to the nearest power of two"
            " of milliseconds",
        ),
    ] = 0.064
