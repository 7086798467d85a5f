# SPDX-License-Identifier: Apache-2.0
"""Front and rear wheels that differ: what both files have to agree on, and who makes how much."""

from regen_table import derived
from regen_table.schema import Drive

from hubsim.errors import HubsimError
from hubsim.run import plant

# Of the vehicle as a whole: one battery, one body, one road.
SHARED = ("battery.", "bms.", "bus.", "chassis.", "tyre.", "vehicle.", "wheel_speed.")
ROUNDING = 1e-6


def most_drive_nm(drive: Drive) -> float:
    """Return the end of the drive pedal at one wheel."""
    return drive.motor.max_torque_nm


def most_brake_nm(drive: Drive) -> float:
    """Return the end of the brake pedal at one wheel, both its brakes together."""
    return drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm


def front_bias(front: Drive, rear: Drive) -> float:
    """Return ``driver.front_bias`` with which each motor makes the same share of its torque."""
    front_nm, rear_nm = most_drive_nm(front), most_drive_nm(rear)
    return (front_nm - rear_nm) / (front_nm + rear_nm)


def brake_bias(front: Drive, rear: Drive) -> float:
    """Return ``driver.front_bias`` with which each wheel makes the same share of its brakes."""
    front_nm, rear_nm = most_brake_nm(front), most_brake_nm(rear)
    return (front_nm - rear_nm) / (front_nm + rear_nm)


def driver_parameters(front: Drive, rear: Drive) -> dict[str, float]:
    """Return what the driver of a vehicle with two kinds of drives has, as means of the wheels."""
    return {
        "driver.front_bias": front_bias(front, rear),
        "driver.most_drive_nm": 0.5 * (most_drive_nm(front) + most_drive_nm(rear)),
        "driver.most_brake_nm": 0.5 * (most_brake_nm(front) + most_brake_nm(rear)),
    }


def check(front: Drive, rear: Drive) -> None:
    """Refuse two drives that cannot be in one vehicle.

    Raises
    ------
    HubsimError
        The key in which they differ, and what is accepted.
    """
    in_front, at_rear = plant.parameters(front), plant.parameters(rear)
    for name, value in in_front.items():
        if name.startswith(SHARED) and at_rear[name] != value:
            raise HubsimError(
                f"{rear.name}: {name}: {at_rear[name]:g}, accepted: {value:g} as in {front.name},"
                " because both axles have one vehicle and one battery"
            )
    if front.battery.open_circuit_voltage_v != rear.battery.open_circuit_voltage_v:
        raise HubsimError(
            f"{rear.name}: battery.open_circuit_voltage_v: accepted: as in {front.name}"
        )
    numbers = (("vehicle", "can_base"), ("service", "can_base"), ("can", "vesc_status"))
    for section, key in numbers:
        if getattr(getattr(front, section), key) != getattr(getattr(rear, section), key):
            raise HubsimError(f"{rear.name}: {section}.{key}: accepted: as in {front.name}")
    shares = derived.pack_share(front), derived.pack_share(rear)
    wheels = front.vehicle.driven_wheels / 2
    if wheels * sum(shares) > 1.0 + ROUNDING:
        raise HubsimError(
            f"vehicle.pack_share: {shares[0]:g} in {front.name}, {shares[1]:g} in {rear.name},"
            f" accepted: {1.0 / wheels:g} together, or the wheels take more than the battery gives"
        )
