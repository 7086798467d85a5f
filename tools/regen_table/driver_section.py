# SPDX-License-Identifier: Apache-2.0
"""What the controller makes of the driver's demands; every key has a default."""

from typing import Annotated

from pydantic import Field

from regen_table.section import COMMANDED_HYDRAULIC_NM, Section, number


class Driver(Section):
    """Lost demands, drive direction, hold at standstill."""

    lost_demand_hold_s: Annotated[
        float, number(0.0, 10.0, "s", "a braking demand is kept this long after it counts as lost")
    ] = 0.3
    no_other_brake: Annotated[
        bool,
        Field(
            description=(
                "the vehicle has no brake but those that this controller commands: a lost braking"
                " demand is kept until standstill"
            )
        ),
    ] = False
    direction_change_speed_m_per_s: Annotated[
        float,
        number(0.0, 10.0, "m/s", "a drive direction is refused while rolling faster against it"),
    ] = 0.833
    hold_torque_nm: Annotated[
        float | None,
        number(
            0.0,
            COMMANDED_HYDRAULIC_NM,
            "N m",
            "hydraulic torque that holds the vehicle at standstill until it drives off; absent: no"
            " hold",
            "WheelBrake.hydraulic_torque_nm",
        ),
    ] = None
    hold_release_s: Annotated[
        float,
        number(
            0.01,
            10.0,
            "s",
            "from the driving demand until the hold is gone at the latest, unless the vehicle rolls"
            " back",
        ),
    ] = 1.0
    largest_drive_torque_nm: Annotated[
        float | None,
        number(
            0.001,
            20e3,
            "N m",
            "a Demand by CAN with more driving torque is refused; absent: 1.25 times the largest"
            " of motor and pedal",
        ),
    ] = None
    largest_brake_torque_nm: Annotated[
        float | None,
        number(
            0.001,
            20e3,
            "N m",
            "a Demand by CAN with more braking torque is refused; absent: 1.25 times the largest"
            " of both brakes and pedal",
        ),
    ] = None
    demand_rise_s: Annotated[
        float,
        number(
            0.0,
            1.0,
            "s",
            "a Demand by CAN that rises faster than from zero to the largest in this time is"
            " refused; 0: any is accepted",
        ),
    ] = 0.02
    demand_lost_frames: Annotated[
        int,
        Field(
            ge=0,
            le=3,
            description="Demand frames in a row that may be missing before the sender has to"
            " qualify again",
        ),
    ] = 2
