# SPDX-License-Identifier: Apache-2.0
"""Requirements of the control loops."""

from typing import Annotated

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, number

VoltageUse = Annotated[float, number(0.0, 0.99, "1", "square of the share of the circle")]


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
