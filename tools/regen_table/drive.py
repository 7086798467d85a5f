# SPDX-License-Identifier: Apache-2.0
"""A drive: one motor with its inverter, battery, vehicle, brake and limits.

Its sections are checked one by one.
"""

import re
from typing import Self

from regen_table.errors import ConfigurationError
from regen_table.sections import (
    Battery,
    Bms,
    Brake,
    Bus,
    Chassis,
    Control,
    Inverter,
    Motor,
    Rotor,
    Section,
    Sensors,
    Table,
    Thermal,
    Tyre,
    Vehicle,
)

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")


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
        """Return the same drive under another name (letter first.

        Letters, digits, - and _; at most 31).
        """
        if not _NAME.fullmatch(name):
            raise ConfigurationError(
                f"configuration name {name!r}: must be a letter followed by at most 30 letters, digits, '-' or '_'"
            )
        copy = self.model_copy()
        copy._name = name
        return copy
