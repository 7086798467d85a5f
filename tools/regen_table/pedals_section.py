# SPDX-License-Identifier: Apache-2.0
"""Pedals that are wired to the controller; every key has a default, and none is wired by default.

Lists of four channels are in the order accelerator a, accelerator b, brake a, brake b, lists of
four wheels in the order front left, front right, rear left, rear right.
"""

from typing import Annotated, Literal

from pydantic import Field

from regen_table.section import DEMANDED_BRAKE_NM, DEMANDED_DRIVE_NM, Section, number

Ratio = Annotated[float, number(0.0, 1.0, "1", "of the sensor's supply")]
Ratios = tuple[Ratio, Ratio, Ratio, Ratio]
Share = Annotated[float, number(0.0, 1.0, "1", "of a wheel of share 1")]
Shares = tuple[Share, Share, Share, Share]
Wheel = Literal["front_left", "front_right", "rear_left", "rear_right"]


class Pedals(Section):
    """Accelerator and brake pedal with up to two channels each."""

    accelerator_channels: Annotated[
        int, number(0, 2, "1", "wired; 0: the driving demand comes by CAN")
    ] = 0
    brake_channels: Annotated[
        int, number(0, 2, "1", "wired; 0: the braking demand comes by CAN")
    ] = 0
    interpretation: Annotated[
        Literal["proportional", "free_travel"],
        Field(
            description=(
                "of the brake pedal: torque in proportion to its travel, or two straight lines"
                " that meet where the friction brake's free travel ends"
            )
        ),
    ] = "proportional"
    drive_torque_nm: Annotated[
        float | None,
        number(
            0.0,
            DEMANDED_DRIVE_NM,
            "N m",
            "whole accelerator; absent: motor.max_torque_nm",
            "Demand.drive_torque_nm",
        ),
    ] = None
    lift_off_torque_nm: Annotated[
        float,
        number(
            0.0,
            DEMANDED_DRIVE_NM,
            "N m",
            "braking torque of the released accelerator; 0: it coasts",
            "Demand.drive_torque_nm",
        ),
    ] = 0.0
    lift_off_travel: Annotated[
        float,
        number(0.0101, 0.5, "1", "of the accelerator: lift-off braking fades out over it"),
    ] = 0.15
    brake_torque_nm: Annotated[
        float | None,
        number(
            0.0,
            DEMANDED_BRAKE_NM,
            "N m",
            "whole brake pedal, motor and hydraulic brake; absent: the sum of their limits, within"
            " the range",
            "Demand.brake_torque_nm",
        ),
    ] = None
    free_travel: Annotated[
        float,
        number(0.0101, 0.99, "1", "of the brake pedal: the friction brake's free travel"),
    ] = 0.3
    free_travel_torque_nm: Annotated[
        float | None,
        number(
            0.0,
            DEMANDED_BRAKE_NM,
            "N m",
            "at its end; absent: brake.electric_rated_torque_nm",
            "Demand.brake_torque_nm",
        ),
    ] = None
    dead_band: Annotated[
        float,
        number(0.0051, 0.25, "1", "of either pedal: within it the pedal is released"),
    ] = 0.05
    difference: Annotated[
        float,
        number(0.0101, 0.5, "1", "of the travel: channels farther apart are implausible"),
    ] = 0.1
    fault_time_s: Annotated[
        float,
        number(0.001, 1.0, "s", "qualify and heal time of an implausible channel"),
    ] = 0.1
    override: Annotated[
        float,
        number(
            0.0,
            1.0,
            "1",
            "of the accelerator: farther with the brake pedal pressed it must be released before"
            " it counts again; 1: never",
        ),
    ] = 0.25
    other_wheels: Annotated[
        tuple[Wheel, ...],
        Field(
            strict=False,
            description="that this controller sends the CAN message Demand to",
        ),
    ] = ()
    lowest: Annotated[
        Ratios, Field(strict=False, description="a channel below it is shorted or open")
    ] = (0.05, 0.03, 0.05, 0.03)
    highest: Annotated[
        Ratios,
        Field(strict=False, description="a channel above it is shorted to the supply"),
    ] = (0.95, 0.5, 0.95, 0.5)
    released: Annotated[
        Ratios,
        Field(strict=False, description="of the sensor's supply, at 0 % of the travel"),
    ] = (0.15, 0.075, 0.15, 0.075)
    pressed: Annotated[
        Ratios,
        Field(strict=False, description="of the sensor's supply, at 100 % of the travel"),
    ] = (0.85, 0.425, 0.85, 0.425)
    drive_share: Annotated[
        Shares,
        Field(strict=False, description="of driving and lift-off torque, at each wheel"),
    ] = (1.0, 1.0, 1.0, 1.0)
    brake_share: Annotated[
        Shares, Field(strict=False, description="of the braking torque, at each wheel")
    ] = (1.0, 1.0, 1.0, 1.0)
