# SPDX-License-Identifier: Apache-2.0
"""Short files: what the keys that a file does not give are assumed to be.

Each rule stands in the declaration of its key (``Assumed``); here they are applied, in whatever
order they need each other, and reported. A key that was assumed is not among a section's
``model_fields_set``: that is the only place where it is remembered, so a drive that is written out
and read again with other keys is assumed anew.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from pydantic.fields import FieldInfo

from regen_table.assumed import Assumed
from regen_table.section import Section
from regen_table.sections import Drive


@dataclass(frozen=True)
class Filled:
    """A file's tree with all that could be assumed.

    Attributes
    ----------
    tree : dict
        Section, key, value.
    assumed : set of str
        "section.key" of those that were.
    open : set of str
        Those whose rule needs a key that is missing or wrong itself: no mistake of their own.
    """

    tree: dict[str, Any]
    assumed: set[str] = field(default_factory=set)
    open: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Assumption:
    """One assumed key, for people."""

    key: str
    value: Any
    unit: str
    how: str
    cost: str

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.key} = {shown(self.value)}{unit}: {self.how}; if wrong: {self.cost}"


def fill(tree: Mapping[str, Any], name: str) -> Filled:
    """Return the tree with every absent key that has a rule which the others suffice for."""
    known = _Known(tree, name)
    out = Filled({key: dict(v) if isinstance(v, Mapping) else v for key, v in tree.items()})
    for key, info in rules().items():
        section, name_of = key.split(".")
        if known.given(key) or not isinstance(out.tree.setdefault(section, {}), dict):
            continue
        try:
            value = known(key)
        except _UnknownError:
            out.open.add(key)
            continue
        if value is not None and (info.is_required() or value != info.default):
            out.tree[section][name_of] = value
            out.assumed.add(key)
    return out


def forget(drive: Drive, assumed: set[str]) -> None:
    """Take assumed keys out of what the sections count as given."""
    for key in assumed:
        section, name = key.split(".")
        getattr(drive, section).model_fields_set.discard(name)


def assumptions(drive: Drive) -> Iterator[Assumption]:
    """Return what was assumed of a drive, in the order of its sections."""
    for key, info in rules().items():
        section, name = key.split(".")
        keys: Section = getattr(drive, section)
        value = getattr(keys, name)
        if name in keys.model_fields_set or (not info.is_required() and value == info.default):
            continue
        if key == "motor.q_inductance_h" and _curved(drive):
            continue
        rule = rule_of(info)
        assert rule is not None
        yield Assumption(key, value, unit_of(info), rule.how, rule.cost)


def _curved(drive: Drive) -> bool:
    return drive.motor.flux_map is not None or drive.motor.q_inductance_curve_h is not None


@cache
def rules() -> dict[str, FieldInfo]:
    """Return the keys with a rule, as "section.key"."""
    return {key: info for key, info in declared().items() if rule_of(info) is not None}


@cache
def declared() -> dict[str, FieldInfo]:
    """Return all keys of all sections, as "section.key"."""
    found: dict[str, FieldInfo] = {}
    for section, info in Drive.model_fields.items():
        kind = info.annotation
        assert isinstance(kind, type) and issubclass(kind, Section)
        found |= {f"{section}.{key}": about for key, about in kind.model_fields.items()}
    return found


def rule_of(info: FieldInfo) -> Assumed | None:
    """Return the rule of a key; None where it has none."""
    return next((note for note in info.metadata if isinstance(note, Assumed)), None)


def unit_of(info: FieldInfo) -> str:
    """Return the unit of a key, "1" where it has none."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    return str(extra.get("unit", "1"))


def shown(value: object) -> str:
    """Return a value as TOML has it, numbers with five digits."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.5g}"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return f"[{', '.join(shown(item) for item in value)}]"
    return str(value)


class _UnknownError(Exception):
    """A rule needs what is missing, wrong or open itself."""


class _Known:
    """Values of a drive, each rule applied once and when it is needed."""

    def __init__(self, tree: Mapping[str, Any], name: str) -> None:
        self._tree, self._name = tree, name
        self._found: dict[str, Any] = {}
        self._under_way: list[str] = []

    def given(self, key: str) -> bool:
        section, _, name = key.partition(".")
        keys = self._tree.get(section)
        return isinstance(keys, Mapping) and name in keys

    def __call__(self, key: str) -> Any:  # noqa: ANN401, whatever TOML can say
        if key == "name":
            return self._name
        section, _, name = key.partition(".")
        if self.given(key):
            return self._tree[section][name]
        if key not in self._found:
            self._found[key] = self._assumed(key)
        value = self._found[key]
        if value is _UNKNOWN:
            raise _UnknownError(key)
        return value

    def _assumed(self, key: str) -> Any:  # noqa: ANN401, whatever TOML can say
        info = declared()[key]
        rule = rule_of(info)
        default = _UNKNOWN if info.is_required() else info.default
        if rule is None or key in self._under_way:
            return default
        self._under_way.append(key)
        try:
            found = rule.value(self)
        except (_UnknownError, ArithmeticError, TypeError, ValueError):
            return _UNKNOWN
        finally:
            self._under_way.pop()
        return default if found is None and not info.is_required() else found


_UNKNOWN = object()
