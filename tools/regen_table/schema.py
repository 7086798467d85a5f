# SPDX-License-Identifier: Apache-2.0
"""Reading a drive from TOML, and everything that is wrong with it, one line each.

Light to import (pydantic and the standard library): the simulator reads the same files through this
module.
"""

import tomllib
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from regen_table import inputs, installation, refusals
from regen_table.errors import ConfigurationError
from regen_table.sections import Drive, bounds, range_of
from regen_table.suggest import suggestion

__all__ = ["ConfigurationError", "Drive", "load", "parse"]

MAX_FILE_BYTES = 1 << 20


def load(path: str | Path) -> Drive:
    """Read and check one TOML file.

    Parameters
    ----------
    path : str or Path
        The file, or the bare name of a drive that comes along ("lu2013"); its name without
        ``.toml`` becomes the name of the configuration.

    Raises
    ------
    ConfigurationError
        A line for everything that is wrong: file, key, what is wrong, what is accepted.
    """
    path = installation.drive_file(path)
    text = inputs.read_text(path, MAX_FILE_BYTES, "a TOML file")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(
            f"{path}: not valid TOML: {' '.join(str(error).split())}"
        ) from error
    except RecursionError as error:
        raise ConfigurationError(f"{path}: not valid TOML: nested too deeply") from error
    return parse(data, name=path.stem, source=str(path))


def parse(data: Mapping[str, Any], name: str, source: str) -> Drive:
    """Check a drive that is already in memory as nested mappings.

    ``source`` begins every error line; there is one for everything that is wrong.
    """
    tree = dict(data)
    try:
        drive = Drive.model_validate(tree).named(name)
    except ValidationError as error:
        raise _refusal(source, _single_mistakes(tree, error, name)) from error
    except ConfigurationError as error:
        raise _refusal(source, [str(error)]) from error
    mistakes = refusals.mistakes(drive)
    if mistakes:
        raise _refusal(source, mistakes)
    return drive


def _refusal(source: str, lines: list[str]) -> ConfigurationError:
    return ConfigurationError("\n".join(f"{source}: {line}" for line in lines))


# A misspelt key shows up twice, as an unknown one and as a missing one: unknown keys come first.
_ORDER = {"extra_forbidden": 0, "missing": 1}


def _single_mistakes(tree: dict[str, Any], error: ValidationError, name: str) -> list[str]:
    """Return a line for each key that is wrong by itself, then for what else does not fit.

    The rest is looked at with those keys anywhere in their ranges; what does not depend on them
    is wrong as well.
    """
    found = sorted(error.errors(include_url=False), key=lambda d: _ORDER.get(d["type"], 2))
    lines: dict[str, str] = {}
    for details in found:
        keys = [str(part) for part in details["loc"][:2]]
        lines.setdefault(".".join(keys), f"{'.'.join(keys)}: {_explain(details, keys)}")
    misspelt = _meant_by_unknown(found)
    answers = [line for key, line in lines.items() if key not in misspelt]
    try:
        low, middle, high = (
            refusals.mistakes(Drive.model_validate(_repaired(tree, found, share)).named(name))
            for share in (0.0, 0.5, 1.0)
        )
    except (ValidationError, ConfigurationError, KeyError, TypeError):
        return answers
    wrong = [key.rpartition(".")[2] for key in lines]
    always = {line.partition(":")[0] for line in low}
    always &= {line.partition(":")[0] for line in high}
    return answers + [
        line
        for line in middle
        if line.partition(":")[0] in always and not any(key in line for key in wrong)
    ]


def _meant_by_unknown(found: list[ErrorDetails]) -> set[str]:
    """Return the missing keys that unknown ones of their section were meant to be."""
    meant = set()
    for details in found:
        keys = [str(part) for part in details["loc"][:2]]
        if details["type"] == "extra_forbidden" and len(keys) == 2:
            guess = suggestion(keys[1], _section(keys[0]).model_fields)
            meant.add(f"{keys[0]}.{guess.removeprefix('did you mean ').rstrip('?')}")
    missing = {".".join(map(str, d["loc"][:2])) for d in found if d["type"] == "missing"}
    return meant & missing


def _repaired(tree: dict[str, Any], found: list[ErrorDetails], share: float) -> dict[str, Any]:
    """Return the tree without unknown keys, and with numbers out of range somewhere within."""
    tree = {
        section: dict(keys) if isinstance(keys, Mapping) else keys for section, keys in tree.items()
    }
    for details in found:
        section, *rest = (str(part) for part in details["loc"][:2])
        if details["type"] == "extra_forbidden":
            (tree[section] if rest else tree).pop(rest[0] if rest else section, None)
        elif details["type"] in {"less_than_equal", "greater_than_equal"} and rest:
            _, lowest, highest = range_of(f"{section}.{rest[0]}")
            by_decades = lowest > 0.0
            value = (
                lowest * (highest / lowest) ** share
                if by_decades
                else lowest + (highest - lowest) * share
            )
            tree[section][rest[0]] = type(tree[section][rest[0]])(value)
    return tree


def _explain(details: ErrorDetails, keys: list[str]) -> str:
    """Say what is wrong with one value and what would be accepted."""
    kind, value = details["type"], details["input"]
    parent = Drive if len(keys) == 1 else _section(keys[0])
    if kind == "extra_forbidden":
        what = "section" if parent is Drive and isinstance(value, Mapping) else "key"
        return f"unknown {what}, {suggestion(keys[-1], parent.model_fields)}"
    if parent is Drive:
        return (
            "this section is missing"
            if kind == "missing"
            else f"must be a section, found {_show(value)}"
        )
    accepted = _accepted(parent.model_fields[keys[1]])
    absent = kind == "missing" and len(details["loc"]) == 2
    return (
        f"missing, accepted: {accepted}"
        if absent
        else f"{_show(value)} is not accepted, accepted: {accepted}"
    )


def _show(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _section(name: str) -> type[BaseModel]:
    """Return the class of a section."""
    section = Drive.model_fields[name].annotation
    assert isinstance(section, type) and issubclass(section, BaseModel)
    return section


def _accepted(info: FieldInfo) -> str:
    """Describe what a key takes: kind, range and unit."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    unit = str(extra.get("unit", "1"))
    carried = f", carried on CAN by {extra['carried_by']}" if extra.get("carried_by") else ""
    kinds = (
        [kind for kind in get_args(info.annotation) if kind is not type(None)]
        if _is_union(info.annotation)
        else [info.annotation]
    )
    return " or ".join(_accepted_kind(kind, info.metadata, unit) for kind in kinds) + carried


def _accepted_kind(kind: object, metadata: list[Any], unit: str) -> str:
    """Describe one of the kinds of value that a key takes."""
    if get_origin(kind) is Annotated:
        bare, *notes = get_args(kind)
        fields = [note for note in notes if isinstance(note, FieldInfo)]
        extra = next(
            (f.json_schema_extra for f in fields if isinstance(f.json_schema_extra, dict)), {}
        )
        return _accepted_kind(
            bare, [m for f in fields for m in f.metadata], str(extra.get("unit", "1"))
        )
    if get_origin(kind) is Literal:
        return " or ".join(f'"{choice}"' for choice in get_args(kind))
    if get_origin(kind) is tuple:
        elements = get_args(kind)
        if elements[-1] is Ellipsis:
            return f"a list of ({_accepted_kind(elements[0], [], unit)})"
        texts = [_accepted_kind(element, [], unit) for element in elements]
        return f"a list of {len(texts)}: " + (
            f"{texts[0]} each" if len(set(texts)) == 1 else ", ".join(texts)
        )
    lowest, highest = bounds(metadata)
    if kind is str:
        return f"text of {lowest} to {highest} characters"
    return f"{'a whole number' if kind is int else 'a number'} from {lowest:g} to {highest:g}" + (
        f" {unit}" if unit != "1" else ""
    )


def _is_union(annotation: object) -> bool:
    return get_origin(annotation) in {Union, types.UnionType}
