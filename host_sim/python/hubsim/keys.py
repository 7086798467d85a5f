# SPDX-License-Identifier: Apache-2.0
"""What the sections of a scenario's file share: strictness, and how a number states its range."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """Strict (no text taken for a number), frozen, refuses unknown keys and numbers that are none."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


def number(lowest: float, highest: float, text: str) -> Any:  # noqa: ANN401, pydantic's own type for this
    """Describe a number: its closed range and its meaning."""
    return Field(ge=lowest, le=highest, description=text)


def listed(text: str, accepted: str) -> Any:  # noqa: ANN401, pydantic's own type for this
    """Describe a key whose shape needs words."""
    return Field(description=text, json_schema_extra={"accepted": accepted})


def listing(text: str, accepted: str) -> Any:  # noqa: ANN401, pydantic's own type for this
    """Describe a key that takes a list; TOML knows no tuples."""
    return Field(strict=False, description=text, json_schema_extra={"accepted": accepted})
