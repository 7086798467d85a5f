# SPDX-License-Identifier: Apache-2.0
"""Keys of a scenario's file: how they are declared, and one line for what is wrong with them."""

import types
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails
from regen_table.suggest import suggestion


class Section(BaseModel):
    """Strict (no text taken for a number), frozen; refuses unknown keys and NaN."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


def number(lowest: float, highest: float, text: str) -> Any:  # noqa: ANN401, pydantic's own
    """Describe a number: its closed range and its meaning."""
    return Field(ge=lowest, le=highest, description=text)


def listed(text: str, accepted: str) -> Any:  # noqa: ANN401, pydantic's own
    """Describe a key whose shape needs words."""
    return Field(description=text, json_schema_extra={"accepted": accepted})


def listing(text: str, accepted: str) -> Any:  # noqa: ANN401, pydantic's own
    """Describe a key with a list; TOML has no tuples."""
    return Field(strict=False, description=text, json_schema_extra={"accepted": accepted})


# A misspelt key shows up twice, as an unknown one and as a missing one: the first of these says
# more.
_ORDER = {"extra_forbidden": 0, "missing": 1}


def first(error: ValidationError, model: type[BaseModel]) -> tuple[str, str]:
    """Return the key (dotted.

    Empty for the whole) of the most specific error and its explanation.
    """
    details = min(error.errors(include_url=False), key=lambda d: _ORDER.get(d["type"], 2))
    return _explain(details, model)


def _explain(details: ErrorDetails, model: type[BaseModel]) -> tuple[str, str]:
    path, owner, field = _place(details["loc"], model)
    key = ".".join(path)
    if details["type"] == "value_error":
        return key, str(details["msg"]).removeprefix("Value error, ")
    if details["type"] == "extra_forbidden":
        return key, f"unknown key, {suggestion(path[-1], owner.model_fields)}"
    takes = accepted(field) if field is not None else "a section"
    if details["type"] == "missing" and len(details["loc"]) == len(path):
        return key, f"missing, accepted: {takes}"
    value = repr(details["input"])
    return (
        key,
        f"{value if len(value) <= 40 else value[:37] + '...'} is not accepted, accepted: {takes}",
    )


def _place(
    loc: Sequence[int | str], model: type[BaseModel]
) -> tuple[list[str], type[BaseModel], FieldInfo | None]:
    """Follow a validator's path as far as it goes through keys of files.

    What follows is its own bookkeeping.
    """
    path: list[str] = []
    owner, field = model, None
    parts = list(loc)
    while parts:
        part = str(parts.pop(0))
        path.append(part)
        field = owner.model_fields.get(part)
        inner = section_of(field.annotation) if field is not None else None
        if inner is None or not parts:
            break
        path.append(str(parts.pop(0)))  # the name of the section
        owner, field = inner, None
    return path, owner, field


def section_of(annotation: object) -> type[BaseModel] | None:
    """Return the class of the named sections that a key holds, if it does."""
    if get_origin(annotation) is dict:
        inner = get_args(annotation)[1]
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            return inner
    return None


def accepted(field: FieldInfo) -> str:
    """Describe what a key takes."""
    extra = field.json_schema_extra
    if isinstance(extra, Mapping) and "accepted" in extra:
        return str(extra["accepted"])
    return " or ".join(_kind(kind, field.metadata) for kind in _kinds(field.annotation))


def _kinds(annotation: Any) -> list[Any]:  # noqa: ANN401, an annotation can be anything
    if get_origin(annotation) in {Union, types.UnionType}:
        return [kind for kind in get_args(annotation) if kind is not types.NoneType]
    return [annotation]


def _kind(kind: Any, metadata: Sequence[Any]) -> str:  # noqa: ANN401, an annotation can be anything
    if get_origin(kind) is Annotated:
        kind, *notes = get_args(kind)
        metadata = [m for note in notes if isinstance(note, FieldInfo) for m in note.metadata]
    if kind is bool:
        return "true or false"
    if kind is str:
        return "text"
    if get_origin(kind) in {tuple, list}:
        return "a list"
    if get_origin(kind) is dict:
        return "a section"
    bounds = {name: getattr(m, name) for m in metadata for name in ("ge", "le") if hasattr(m, name)}
    number = "a whole number" if kind is int else "a number"
    return f"{number} from {bounds['ge']:g} to {bounds['le']:g}" if len(bounds) == 2 else number
