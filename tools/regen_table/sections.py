# SPDX-License-Identifier: Apache-2.0
"""A drive: all sections of its TOML file, and the grid of its map.

One class a section, one line a key, each in the module called after it; what only the simulated
plant reads is in ``plant_sections``. An optional key that is absent switches its feature off or has
the default given in its line. A key with a rule (``Assumed``) is derived from what the file gives,
and reported as assumed.
"""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.battery_section import Battery
from regen_table.brake_section import Brake
from regen_table.can_section import Can
from regen_table.control_section import Control
from regen_table.driver_section import Driver
from regen_table.errors import ConfigurationError
from regen_table.fields_section import Fields
from regen_table.inverter_section import Inverter
from regen_table.monitor_section import Monitor
from regen_table.motor_section import Motor
from regen_table.pedals_section import Pedals
from regen_table.plant_sections import Bms, Bus, Chassis, Sensors, Thermal, Tyre
from regen_table.rotor_section import Rotor
from regen_table.section import Section, Temperature, number
from regen_table.service_section import Service
from regen_table.tolerance_section import Tolerance
from regen_table.vehicle_section import Vehicle

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")
Points = Annotated[int, number(2, 65, "1", "grid points")] | Literal["auto"]
TemperaturePoints = Annotated[int, number(2, 17, "1", "grid points")] | Literal["auto"]


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
    can: Can = Can()
    tolerance: Tolerance = Tolerance()
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
