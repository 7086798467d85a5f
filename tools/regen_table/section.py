# SPDX-License-Identifier: Apache-2.0
"""What every section of a drive's TOML file is, and how its numbers are described and compared.

All classes are strict (no text taken for a number), frozen, and refuse unknown keys and non-finite
numbers.
"""

from collections.abc import Iterator
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

DEMANDED_DRIVE_NM = 1638.2  # end of Demand.drive_torque_nm on CAN
DEMANDED_BRAKE_NM = 3276.6  # end of Demand.brake_torque_nm
COMMANDED_HYDRAULIC_NM = 3276.7  # end of WheelBrake.hydraulic_torque_nm


def number(lowest: float, highest: float, unit: str, text: str, carried_by: str = "") -> FieldInfo:
    """Describe a number: its closed range, its unit and its meaning.

    ``carried_by`` is the signal on CAN where it ends the range.
    """
    extra = {"unit": unit, "carried_by": carried_by}
    field = Field(ge=lowest, le=highest, description=text, json_schema_extra={**extra})
    assert isinstance(field, FieldInfo)
    return field


class Section(BaseModel):
    """What all sections share."""

    model_config = ConfigDict(
        strict=True, frozen=True, extra="forbid", allow_inf_nan=False, protected_namespaces=()
    )


Temperature = Annotated[float, number(-100.0, 300.0, "degC", "a temperature")]


def at_most(keys: Section, section: str, lower: str, upper: str, unit: str) -> Iterator[str]:
    """Refuse two keys in the wrong order.

    Of both the one that the file gives is named; the lower if it gives both.
    """
    low, high = getattr(keys, lower), getattr(keys, upper)
    if low <= high:
        return
    if lower in keys.model_fields_set:
        yield f"{section}.{lower}: {low:g} {unit}, accepted: at most {upper} = {high:g} {unit}"
    else:
        yield f"{section}.{upper}: {high:g} {unit}, accepted: at least {lower} = {low:g} {unit}"
