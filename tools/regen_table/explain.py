# SPDX-License-Identifier: Apache-2.0
"""What a key of a drive means: from its declaration, and from who reads it."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from pydantic.fields import FieldInfo

from regen_table import filling, image, schema
from regen_table.errors import ConfigurationError
from regen_table.sections import Drive
from regen_table.suggest import suggestion

PLANT_SECTIONS = {
    name
    for name, info in Drive.model_fields.items()
    if str(getattr(info.annotation, "__module__", "")).endswith(".plant_sections")
}


def matching(word: str) -> list[str]:
    """Return the keys that a word names: "section.key", a key of any section, or a section."""
    known = filling.declared()
    found = [key for key in known if word in (key, *key.split("."))]
    if not found:
        names = [*known, *(key.partition(".")[2] for key in known)]
        raise ConfigurationError(f"no key {word!r}, {suggestion(word, names, 'see the sections')}")
    return found


def text(key: str) -> str:
    """Return unit, range, meaning, default and users of a key, a line each."""
    info = filling.declared()[key]
    lines = [
        key,
        f"  meaning   {info.description or 'as its name says'}",
        f"  accepted  {schema.accepted_values(info)}",
        *(f"  absent    {line}" for line in _absent(info)),
        f"  used in   {', '.join(used_in(key)) or 'nothing yet'}",
    ]
    return "\n".join(lines)


def _absent(info: FieldInfo) -> Iterator[str]:
    """Say what an absent key stands for."""
    rule = filling.rule_of(info)
    if rule is not None:
        yield f"assumed: {rule.how}"
        yield f"if wrong: {rule.cost}"
    elif info.is_required():
        yield "refused: nothing that it could be assumed from"
    elif info.default is None:
        yield "as its meaning says"
    else:
        yield filling.shown(info.default)


def used_in(key: str) -> list[str]:
    """Return the fields of the firmware that have the key's name, and the modules that read it."""
    fields = [f"the firmware's {name}" for name in image.fields_named_after(key)]
    if key.partition(".")[0] in PLANT_SECTIONS:
        fields.append("the simulated plant")
    return fields + [module for module, keys in _readers().items() if key in keys]


@cache
def _readers() -> dict[str, set[str]]:
    """Return the keys that each module of the packages reads, by the module's name."""
    home = Path(__file__).resolve().parent
    folders = [home] + [
        folder
        for folder in (home.parent / "hubsim", home.parents[1] / "host_sim/python/hubsim")
        if folder.is_dir()
    ]
    found = {}
    for folder in folders:
        for path in sorted(folder.rglob("*.py")):
            name = ".".join([folder.name, *path.relative_to(folder).with_suffix("").parts])
            if keys := set(_read(ast.parse(path.read_text(encoding="utf-8")))):
                found[name] = keys
    return found


def _read(tree: ast.AST) -> Iterator[str]:
    """Return the keys that a module's attributes and texts name.

    As an attribute of a section, as "section.key", or, where only one section has it, by its own
    name of several words.
    """
    known = filling.declared()
    alone = _of_one_section()
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Attribute):
            owner = node.value
            section = owner.attr if isinstance(owner, ast.Attribute) else getattr(owner, "id", "")
            names = [f"{section}.{node.attr}", alone.get(node.attr, "")]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names = [node.value, alone.get(node.value, "")]
        yield from (name for name in names if name in known)


@cache
def _of_one_section() -> dict[str, str]:
    """Return the keys that one section alone has and whose names are several words."""
    keys = [key.partition(".")[2] for key in filling.declared()]
    return {
        name: key
        for key, name in zip(filling.declared(), keys, strict=True)
        if keys.count(name) == 1 and "_" in name
    }
