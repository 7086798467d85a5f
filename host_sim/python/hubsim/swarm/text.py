# SPDX-License-Identifier: Apache-2.0
"""A case as the text of a scenario's file, which ``hubsim run`` reads."""

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hubsim import scenario
from hubsim.scenario.schema import Scenario
from hubsim.swarm.draw import Case

WIDTH = 100
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_of(case: Case, description: str = "") -> str:
    """Return the file's text; its first lines say how to repeat the run."""
    first = [
        "# SPDX-License-Identifier: Apache-2.0",
        f"# hubsim run FILE --config {case.config}",
        f"# hubsim swarm --scenario FILE --config {case.config}",
        f"description = {_value(description[:200] or f'seed {case.seed}')}",
    ]
    return "\n".join([*first, *_lines(case.data)]) + "\n"


def _lines(data: Mapping[str, Any]) -> Iterator[str]:
    sections = ("drive", "plant", "events")
    for key, value in data.items():
        if key not in (*sections, "description"):
            yield f"{key} = {_value(value)}"
    yield from _tables("drive", data["drive"])
    yield from _tables("plant", _by_section(data["plant"]))
    yield from _tables("events", data["events"])


def _tables(head: str, tables: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    for name, keys in tables.items():
        yield ""
        yield f"[{head}.{name}]"
        for key, value in keys.items():
            yield f"{key} = {_value(value)}"


def _by_section(plant: Mapping[str, float]) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for name, value in plant.items():
        section, _, key = name.partition(".")
        found.setdefault(section, {})[key] = value
    return found


def _value(value: Any) -> str:  # noqa: ANN401, whatever TOML can say
    """Return a value as TOML writes it; long lists go over several lines."""
    if isinstance(value, Mapping):
        inner = ", ".join(f"{_key(key)} = {_value(each)}" for key, each in value.items())
        return f"{{ {inner} }}"
    if isinstance(value, list | tuple):
        parts = [_value(each) for each in value]
        whole = f"[{', '.join(parts)}]"
        return whole if len(whole) < WIDTH // 2 else _wrapped(parts)
    return json.dumps(value)


def _wrapped(parts: list[str]) -> str:
    out, line = ["["], "   "
    for part in parts:
        if len(line) + len(part) + 2 > WIDTH:
            out.append(line)
            line = "   "
        line += f" {part},"
    return "\n".join([*out, line, "]"])


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key)


def read(path: Path, config: str, seed: int = 0) -> Case:
    """Return the case of a file that ``toml_of`` wrote, or of any scenario on a drive's file."""
    _, found, _ = scenario.load(str(path), {})
    return Case(seed, config, _data(found))


def _data(found: Scenario) -> dict[str, Any]:
    data = found.model_dump(mode="json", exclude_unset=True, exclude={"criteria"})
    for section in ("drive", "plant", "events"):
        data.setdefault(section, {})
    return data
