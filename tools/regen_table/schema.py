# SPDX-License-Identifier: Apache-2.0
"""Reading a drive from TOML, and everything that is wrong with it, one line each.

Light to import (pydantic and the standard library): the simulator reads the same files through this
module.
"""

import re
import tomllib
import types
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from regen_table import filling, inputs, installation, refusals, settings, supply_relations
from regen_table.errors import ConfigurationError
from regen_table.sections import Drive, bounds, range_of
from regen_table.suggest import suggestion

__all__ = ["ConfigurationError", "Drive", "load", "parse"]

MAX_FILE_BYTES = 1 << 20
_HERE = Path()


def load(path: str | Path, changes: Sequence[str] = ()) -> Drive:
    """Read and check one TOML file.

    Parameters
    ----------
    path : str or Path
        The file, or the bare name of a drive that comes along ("lu2013"); its name without
        ``.toml`` becomes the name of the configuration.
    changes : sequence of str
        ``"section.key=value"`` on top of it; the values become part of the name.

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
    for (section, key), value in settings.parse(changes).items():
        keys = data.setdefault(section, {})
        if not isinstance(keys, dict):
            raise ConfigurationError(f"--set {section}.{key}: accepted: section.key=value")
        keys[key] = value
    name = settings.name_of(path.stem, changes)
    source = f"{path} with --set" if changes else str(path)
    drive = parse(data, name=name, source=source, beside=path.parent)
    return drive.found_in(path.parent)


def parse(data: Mapping[str, Any], name: str, source: str, beside: Path = _HERE) -> Drive:
    """Check a drive that is already in memory as nested mappings.

    ``source`` begins every error line; there is one for everything that is wrong. The file of a
    flux map is looked for in ``beside``.
    """
    replaced = _replaced(data)
    filled = filling.fill(_placeheld(data, replaced), name)
    try:
        if replaced:
            constants = _constants(data, filled.tree, replaced, beside)
            filled = filling.fill(_placeheld(data, constants), name)
        drive = Drive.model_validate(filled.tree).named(name)
        drive.fields.values()
    except ValidationError as error:
        lines = _single_mistakes(_placeheld(data, replaced), filled, error, name)
        raise _refusal(source, [x for x in lines if not any(k in x for k in replaced)]) from error
    except ConfigurationError as error:
        raise _refusal(source, [str(error)]) from error
    drive.motor.model_fields_set.difference_update(replaced)
    if "control.current_bandwidth_hz" in filled.assumed:
        drive = refusals.with_fitting_bandwidth(drive)
    filling.forget(drive, filled.assumed)
    mistakes = refusals.mistakes(drive)
    if mistakes:
        raise _refusal(source, [_with_origin(line, filled.assumed) for line in mistakes])
    return drive


_OF_BOARD = {
    *("current_full_scale_a", "voltage_full_scale_v", "pwm_timer_clock_hz", "dead_time_s"),
    *("min_pulse_s", "switch_resistance_ohm", "diode_resistance_ohm"),
}


def refused_with(drive: Drive, board: str) -> list[str]:
    """Return the keys for which a drive is refused with another board; none: it is accepted.

    What the drive says of its own bridge gives way to what follows from the board.
    """
    data = drive.model_dump(exclude_none=True, exclude_unset=True)
    kept = {key: value for key, value in data["inverter"].items() if key not in _OF_BOARD}
    data["inverter"] = {**kept, "board": board}
    try:
        parse(data, drive.name, "", drive.folder)
    except ConfigurationError as error:
        return list(dict.fromkeys(line.split(":")[1].strip() for line in str(error).splitlines()))
    return []


# Keys of [motor] that another key of it stands for, with values that may hold their place.
_STAND_FOR = {
    "flux_map": {"flux_linkage_wb": 0.1, "d_inductance_h": 1e-3, "q_inductance_h": 1e-3},
    "d_inductance_curve_h": {"d_inductance_h": 1e-3},
    "q_inductance_curve_h": {"q_inductance_h": 1e-3},
}


def _replaced(tree: Mapping[str, Any]) -> dict[str, float]:
    """Return the keys of [motor] that follow from a flux map or curves, with place-holders."""
    motor = tree.get("motor")
    if not isinstance(motor, Mapping):
        return {}
    return {
        key: value
        for name, keys in _STAND_FOR.items()
        if motor.get(name) is not None
        for key, value in keys.items()
    }


def _placeheld(tree: Mapping[str, Any], motor: Mapping[str, Any]) -> Mapping[str, Any]:
    return {**tree, "motor": {**tree["motor"], **motor}} if motor else tree


def _constants(
    data: Mapping[str, Any],
    filled: Mapping[str, Any],
    replaced: Mapping[str, float],
    beside: Path,
) -> dict[str, Any]:
    """Return where the map of [motor] is, and the constants that fit it."""
    given = {key: value for key, value in data["motor"].items() if value is not None}
    named = [name for name in _STAND_FOR if name in given]
    for name in named:
        others = [*_STAND_FOR[name], *(named[1:] if name == "flux_map" else [])]
        for key in others:
            if key in given:
                raise ConfigurationError(f"motor.{key}: accepted: without {name}, which holds it")
    Drive.model_validate(filled)
    # With NumPy, which whoever reads other drives does not need.
    from regen_table import flux_constants  # noqa: PLC0415

    motor = {key: value for key, value in filled["motor"].items() if key not in replaced}
    completed = flux_constants.completed({**filled, "motor": motor}, beside)
    return {key: completed["motor"][key] for key in [*replaced, *given.keys() & {"flux_map"}]}


def _refusal(source: str, lines: list[str]) -> ConfigurationError:
    return ConfigurationError("\n".join(f"{source}: {line}" for line in lines))


def _with_origin(line: str, assumed: set[str]) -> str:
    """Say of the keys in a line that the file does not give how they came about."""
    words = set(re.findall(r"[\w.]+", line))
    origins = []
    for key in sorted(assumed & words | {k for k in assumed if k.partition(".")[2] in words}):
        rule = filling.rule_of(filling.declared()[key])
        assert rule is not None
        origins.append(f"{key} was assumed: {rule.how}")
    return f"{line} ({'; '.join(origins)})" if origins else line


# A misspelt key shows up twice, as an unknown one and as a missing one: unknown keys come first.
_ORDER = {"extra_forbidden": 0, "missing": 1}


def _single_mistakes(
    data: Mapping[str, Any], filled: filling.Filled, error: ValidationError, name: str
) -> list[str]:
    """Return a line for each key that is wrong by itself, then for what else does not fit.

    The rest is looked at with those keys anywhere in their ranges; what does not depend on them
    is wrong as well. Of keys that were to be assumed only those count that are the file's own
    mistake: what follows from a wrong key is wrong because of it.
    """
    found = sorted(error.errors(include_url=False), key=lambda d: _ORDER.get(d["type"], 2))
    lines: dict[str, str] = {}
    for details in found:
        keys = [str(part) for part in details["loc"][:2]]
        lines.setdefault(".".join(keys), f"{'.'.join(keys)}: {_explain(details, keys)}")
    misspelt = _meant_by_unknown(found)
    own = {key: line for key, line in lines.items() if key not in filled.assumed | filled.open}
    answers = [
        _with_origin(line, filled.assumed)
        for key, line in (own or lines).items()
        if key not in misspelt and key.partition(".")[0] not in misspelt
    ]
    try:
        low, middle, high = (_of_the_rest(data, found, name, share) for share in (0.0, 0.5, 1.0))
    except (ValidationError, ConfigurationError, KeyError, TypeError):
        return answers + _unknown_board(data)
    wrong = [key.rpartition(".")[2] for key in lines]
    always = {line.partition(":")[0] for line in low}
    always &= {line.partition(":")[0] for line in high}
    return answers + [
        line
        for line in middle
        if line.partition(":")[0] in always - filled.assumed
        and not any(key in line for key in wrong)
    ]


def _unknown_board(data: Mapping[str, Any]) -> list[str]:
    """Return the line for a board that no one knows, which nothing else is needed for."""
    inverter = data.get("inverter")
    named = inverter.get("board") if isinstance(inverter, Mapping) else None
    return list(supply_relations.unknown_board(named)) if isinstance(named, str) else []


def _of_the_rest(
    data: Mapping[str, Any], found: list[ErrorDetails], name: str, share: float
) -> list[str]:
    """Return what else is wrong, with the wrong keys somewhere in their ranges."""
    again = filling.fill(_repaired(data, found, share), name)
    return refusals.mistakes(Drive.model_validate(again.tree).named(name))


def _meant_by_unknown(found: list[ErrorDetails]) -> set[str]:
    """Return the missing keys and sections that unknown ones were meant to be."""
    meant = set()
    for details in found:
        keys = [str(part) for part in details["loc"][:2]]
        if details["type"] == "extra_forbidden":
            known = Drive.model_fields if len(keys) == 1 else _section(keys[0]).model_fields
            guess = suggestion(keys[-1], known).removeprefix("did you mean ").rstrip("?")
            meant.add(".".join([*keys[:-1], guess]))
    missing = {".".join(map(str, d["loc"][:2])) for d in found if d["type"] == "missing"}
    absent_sections = {key.partition(".")[0] for key in missing}
    return meant & (missing | absent_sections)


def _repaired(data: Mapping[str, Any], found: list[ErrorDetails], share: float) -> dict[str, Any]:
    """Return the tree without unknown keys, and with numbers out of range somewhere within."""
    tree = {
        section: dict(keys) if isinstance(keys, Mapping) else keys for section, keys in data.items()
    }
    for details in found:
        section, *rest = (str(part) for part in details["loc"])
        if len(rest) > 1 or section not in tree or (rest and rest[0] not in tree[section]):
            continue
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
        return f"must be a section, found {_show(value)}"
    info = parent.model_fields.get(keys[1])
    if info is None:  # of [fields], whose names are those of config.h
        return f"{_show(value)} is not accepted, accepted: a whole number or a list of them"
    accepted, rule = accepted_values(info), filling.rule_of(info)
    if kind != "missing" or len(details["loc"]) != 2:
        return f"{_show(value)} is not accepted, accepted: {accepted}"
    instead = "" if rule is None else f", or what it is assumed from: {rule.how}"
    return f"missing, accepted: {accepted}{instead}"


def _show(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _section(name: str) -> type[BaseModel]:
    """Return the class of a section."""
    section = Drive.model_fields[name].annotation
    assert isinstance(section, type) and issubclass(section, BaseModel)
    return section


def accepted_values(info: FieldInfo) -> str:
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
    if kind in {bool, str}:
        return f"text of {lowest} to {highest} characters" if kind is str else "true or false"
    return f"{'a whole number' if kind is int else 'a number'} from {lowest:g} to {highest:g}" + (
        f" {unit}" if unit != "1" else ""
    )


def _is_union(annotation: object) -> bool:
    return get_origin(annotation) in {Union, types.UnionType}
