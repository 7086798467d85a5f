# SPDX-License-Identifier: Apache-2.0
"""The drives that come along, for runs of all of them."""

from functools import lru_cache

from regen_table import installation
from regen_table.schema import Drive

from hubsim.scenario import overrides

DRIVES = ("lu2013", "ebike36v", "scooter48v", "ipm400v")


@lru_cache(maxsize=16)
def drive_named(name: str) -> Drive:
    """Return a drive of tools/motors; besides DRIVES there are some more, in its folders."""
    return overrides.load_drive(installation.drive_file(name), overrides.Overrides())


def with_open_circuit_voltage(drive: Drive, open_circuit_v: float) -> Drive:
    """Return the drive with this voltage, where its own does not depend on the charge."""
    if not isinstance(drive.battery.open_circuit_voltage_v, float | int):
        return drive
    battery = drive.battery.model_copy(update={"open_circuit_voltage_v": open_circuit_v})
    return drive.model_copy(update={"battery": battery})
