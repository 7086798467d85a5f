# SPDX-License-Identifier: Apache-2.0
"""Fields of the image that a file gives as such, in the place of what its keys make of them.

    [fields]
    "driver.lost_hold_ms" = 250

Whole numbers in the unit of the field, lists for fields with several. So any image can be written
as a file: what was changed in a wheel (``hubfoc params export``) stands behind the drive's keys.
"""

from pydantic import ConfigDict, Field

from regen_table import layout
from regen_table.errors import ConfigurationError
from regen_table.section import Section
from regen_table.suggest import suggestion

Value = int | list[int]


class Fields(Section):
    """Values by "section.field" of config_t; ranges are those of config.h."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Value] = Field(init=False)

    def values(self) -> dict[tuple[str, str], Value]:
        """Return the values by section and field; refuse what the image has no place for."""
        sections = layout.load().sections
        out: dict[tuple[str, str], Value] = {}
        for key, value in (self.__pydantic_extra__ or {}).items():
            section, _, name = key.partition(".")
            info = sections.get(section, {}).get(name)
            if info is None:
                known = [f"{one}.{field}" for one, fields in sections.items() for field in fields]
                hint = suggestion(key, known, "accepted: those of 'hubfoc params get'")
                raise ConfigurationError(f"fields: unknown field {key!r}, {hint}")
            given = value if isinstance(value, list) else [value]
            if isinstance(value, list) != (info.count > 0) or len(given) != max(info.count, 1):
                what = f"a list of {info.count} whole numbers" if info.count else "a whole number"
                raise ConfigurationError(f"fields: {key}: accepted: {what}")
            for item in given:
                if not info.lowest <= item <= info.highest:
                    raise ConfigurationError(
                        f"fields: {key}: {item}, accepted: {info.lowest} to {info.highest}"
                        f" {info.unit}"
                    )
            out[section, name] = value
        return out
